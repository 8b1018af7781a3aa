"""What a recording shows of a solid with one displacement."""

from typing import Any

import numpy as np

Fields = tuple[dict[str, np.ndarray], dict[str, np.ndarray]]
"""By name: fields of the nodes, fields of the cells."""


class DisplacedSolid:
    """Gives the fields of an analysis that has a displacement `x` (n, 2) and `von_mises()` (ne,)."""

    x: np.ndarray
    von_mises: Any

    def fields(self) -> Fields:
        """Displacement [m] of the nodes, equivalent stress [Pa] of the cells."""
        return {"displacement": self.x}, {"von_mises": self.von_mises()}

    def blank_fields(self, mesh: Any) -> Fields:
        """The same fields without any number, on a mesh that has not been solved on."""
        return (
            {"displacement": np.full((len(mesh.X), 2), np.nan)},
            {"von_mises": np.full(len(mesh.cells), np.nan)},
        )
