"""The error estimate of cloth: tensions and moments against smoother ones, in the energy norm."""

from __future__ import annotations

import numpy as np

from restshape.physics.sheet import Sheet


class ClothEstimate:
    """Recovered tensions and moments less those of the elements, by their energies.

    Args:
        sheet: the cloth.

    Source: docs/theory.md, section "Error estimates"; Zienkiewicz and Zhu 1987.
    """

    def __init__(self, sheet: Sheet) -> None:
        self.sheet = sheet
        corners, X = sheet.blocks[0], sheet.X
        a, b, c = X[corners].swapaxes(0, 1)
        u, v = b - a, c - a
        self.area = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])

    def relative(self, x: np.ndarray) -> float:
        """The estimated error over the strain energy's norm at x (n, 3); 0 where nothing is strained."""
        sheet = self.sheet
        energy = sheet.stretching(x) + sheet.bent(x)
        C = np.broadcast_to(sheet.fabric.membrane, (len(self.area), 3, 3))
        wrong = self._distance(sheet.tensions(x), C)
        if sheet.space:
            D = np.broadcast_to(sheet.fabric.bending, (len(self.area), 3, 3))
            for component in np.moveaxis(sheet.curvatures(x), 1, 0):
                wrong += self._distance(np.einsum("eij,ej->ei", D, component), D)
        return float(np.sqrt(wrong / (2.0 * energy))) if energy > 0.0 else 0.0

    def _distance(self, moments: np.ndarray, stiffness: np.ndarray) -> float:
        """Twice the energy of recovered less constant values (ne, 3), of this stiffness (ne, 3, 3)."""
        corners, area = self.sheet.blocks[0], self.area
        sums, weights = np.zeros((self.sheet.n_nodes, 3)), np.zeros(self.sheet.n_nodes)
        for column in corners.T:
            np.add.at(sums, column, moments * area[:, None])
            np.add.at(weights, column, area)
        recovered = (sums / np.where(weights > 0.0, weights, 1.0)[:, None])[corners] - moments[:, None]
        # Exact for products of linear functions: the middles of the sides.
        middles = 0.5 * (recovered + np.roll(recovered, -1, axis=1))
        # Limp cloth has no moments, and no energy of them.
        limp = ~stiffness.any(axis=(1, 2))[:, None, None]
        compliance = np.where(limp, 0.0, np.linalg.inv(np.where(limp, np.eye(3), stiffness)))
        return float(np.einsum("e,eqi,eij,eqj->", area / 3.0, middles, compliance, middles))
