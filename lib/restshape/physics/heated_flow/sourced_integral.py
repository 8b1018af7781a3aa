"""The integral of an element with a source that varies from place to place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from restshape.fem.integral import Integral


@dataclass(frozen=True, eq=False)
class SourcedIntegral(Integral):
    """An integral whose last parameter is a source, in which its residual is linear; further arguments:

    Args:
        source_rate: gives the rates (ne, 1) of the source when nodes move with rates (n, d); None: it is constant.
    """

    source_rate: Callable[[np.ndarray], np.ndarray] | None = None

    def add_design_product(self, x: np.ndarray, dX: np.ndarray, out: np.ndarray, dx: np.ndarray | None = None) -> None:
        """Add (dr/dX) dX + (dr/dx) dx to `out` (n, f), with the rate of the source; arguments as of `Integral`."""
        super().add_design_product(x, dX, out, dx)
        if self.source_rate is None:
            return
        for sign, source in ((1.0, self.source_rate(dX)[:, 0]), (-1.0, 0.0)):
            parameters, own = self.parameters.copy(), np.zeros_like(out)
            parameters[:, -1] = source
            replace(self, parameters=parameters).add_residual(x, own)
            out += sign * own
