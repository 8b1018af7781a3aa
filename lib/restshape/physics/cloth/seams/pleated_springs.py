"""The springs of a seam with pleats, which sew all of their layers to the other side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from restshape.physics.cloth.seams.pleats import Pleats
from restshape.physics.cloth.seams.seam_lines import SAME, SeamPair
from restshape.physics.cloth.seams.seam_springs import Springs, edges_at

STEP = 1e-30
"""Of complex steps, which are exact: nothing is subtracted."""


@dataclass(frozen=True, eq=False)
class PleatedSprings(Springs):
    """The springs of a seam whose first side has pleats: each layer is sewn to the other side by itself.

    Args:
        pleats: of the first side; others as of `Springs`. A node of the second side has a spring to each layer there.
    """

    pleats: Pleats

    @classmethod
    def between(cls, pleats: Pleats, lengths: Sequence[np.ndarray]) -> PleatedSprings:
        """Springs between two sides with lengths (p,), (q,) [m] from their starts to their nodes."""
        folded, other = _shares(pleats, lengths)
        ends = np.sort(np.column_stack([folded[:-1], folded[1:]]), axis=1)
        inside = (other > ends[:, :1] + 2.0 * SAME) & (other < ends[:, 1:] - 2.0 * SAME)
        edge, node = np.nonzero(inside & (np.diff(lengths[0]) > 0.0)[:, None])
        line = np.repeat([0, 1], [len(folded), len(node)])
        first = np.arange(len(folded))
        found = cls(line, np.append(first, node), np.append(edges_at(other, folded), edge), pleats)
        order = np.argsort(found._along(lengths), kind="stable")
        return replace(found, lines=line[order], node=found.node[order], edge=found.edge[order])

    def coefficients(self, lengths: Sequence[np.ndarray]) -> np.ndarray:
        """As of `Springs`; complex where lengths are. All layers count for the length that they are sewn to."""
        out = self._places(_shares(self.pleats, lengths))
        along, folded = self._along(lengths), self.pleats.places(lengths[0])[-1]
        between = np.append(along[1:], along[-1]) - np.insert(along[:-1], 0, along[0])
        out[:, 0, 1] = 0.25 * between * (folded + lengths[1][-1]) / folded
        return out

    def coefficient_rates(self, lengths: Sequence[np.ndarray], rates: Sequence[np.ndarray]) -> np.ndarray:
        """As of `Springs`."""
        return self.coefficients([one + 1j * STEP * rate for one, rate in zip(lengths, rates)]).imag / STEP

    def _along(self, lengths: Sequence[np.ndarray]) -> np.ndarray:
        """Where (m,) [m] each spring is on the first side, as it is flat."""
        shares, flat = _shares(self.pleats, lengths), lengths[0]
        first = self.lines == 0
        begin, end = self.edge[~first], self.edge[~first] + 1
        part = (shares[1][self.node[~first]] - shares[0][begin]) / (shares[0][end] - shares[0][begin])
        out = np.empty(len(self.node), flat.dtype)
        out[first] = flat[self.node[first]]
        out[~first] = flat[begin] + part * (flat[end] - flat[begin])
        return out


def _shares(pleats: Pleats, lengths: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Places of both sides' nodes as shares of the lengths of both, the first one folded."""
    folded = pleats.places(lengths[0])
    return [folded / folded[-1], lengths[1] / lengths[1][-1]]


def springs_of(pair: SeamPair, lengths: Sequence[np.ndarray]) -> Springs:
    """The springs of a seam, with lengths (p,), (q,) [m] along both sides."""
    if pair.pleats:
        return PleatedSprings.between(pair.pleats, lengths)
    return Springs.of([part / part[-1] for part in lengths])
