"""Stresses of plane solids, and measures of them."""

from collections.abc import Callable

import numpy as np

from restshape import _kernels
from restshape.fem.space import Space
from restshape.physics.elasticity.plane_strains import plane_strains
from restshape.physics.elasticity.thickness_stretch import thickness_stretch

REFERENCE_NODES = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0.5], [0, 0.5], [0.5, 0]], dtype=float)
"""Reference coordinates of a triangle's corners and the middles of its sides."""

ONE_LOOP = "linear_elastic_tri3"
"""The element of which `_kernels.triangle_stress` knows stress and energy."""
SEVERAL_CELLS = "linear_elastic_tri6"
"""That of which `_kernels.quadratic_stress` knows stresses of several cells at once."""


class PlaneStresses:
    """Stresses of the cells of a plane solid.

    Args:
        space: by reference.
        element: of the law.
        parameters: of the element, without body force.
        large: the law is that of St. Venant and Kirchhoff; thins: in plane stress.
    """

    def __init__(
        self, space: Space, element: _kernels.Element, parameters: np.ndarray, large: bool, thins: bool
    ) -> None:
        self.space, self.element, self.parameters, self.large, self.thins = space, element, parameters, large, thins

    def cauchy(self, x: np.ndarray, points: np.ndarray | None = None) -> np.ndarray:
        """Cauchy's stresses [Pa] of each cell: xx, yy, xy, zz; not numbers where plane stress thins a cell to nothing.

        Args:
            x: (n, 2) displacement [m].
            points: (m, 2) reference coordinates; without them the centroids are meant.

        Returns:
            (ne, m, 4), or (ne, 4) at centroids.
        """
        out = self._evaluate(x, points)
        if self.thins:
            # The element knows lambda* and a thickness that stays, with which its zz means nothing.
            out[..., 3] = 0.0
            if self.large:
                out /= thickness_stretch(self.space.X, x, self.space.cells, self._ratio, points)[..., None]
        return out

    @property
    def one_loop(self) -> bool:
        """Whether stresses and energies come of one loop."""
        return self.element.name == ONE_LOOP

    def with_energies(self, x: np.ndarray, points: np.ndarray | None) -> tuple[np.ndarray, np.ndarray | None]:
        """The same stresses, and the cells' strain energies (ne,) [J], None where `one_loop` is not."""
        if not self.one_loop:
            return self.cauchy(x, points), None
        space, x = self.space, np.ascontiguousarray(x)
        return _kernels.triangle_stress(space.X, x, space.cells, self.parameters, self.thins)

    def energies(self, x: np.ndarray) -> np.ndarray:
        """These energies (ne,) [J] alone, where `one_loop` is."""
        return _kernels.triangle_energies(self.space.X, np.ascontiguousarray(x), self.space.cells, self.parameters)

    def strain(self, x: np.ndarray, points: np.ndarray | None = None) -> np.ndarray:
        """Strains [1] of each cell, xx, yy, xy, zz: small ones, or Green's; arguments and shape as of `cauchy`."""
        space = self.space
        return plane_strains(space.X, x, space.cells, points, self.large, self._ratio if self.thins else None)

    def of_estimate(self, x: np.ndarray, points: np.ndarray | None = None) -> np.ndarray:
        """Stresses [Pa] as the energy norm takes them, zz meaning nothing; arguments as in `cauchy`.

        Of large strains they are those of Piola and Kirchhoff of the second kind, so that the norm is that of Green's
        strain in the law's own energy.
        """
        x = np.ascontiguousarray(x)
        out = self._evaluate(x, points)
        if self.large:
            at = np.full((1, 2), 1 / 3) if points is None else points
            _kernels.pull_back(self.space.X, x, self.space.cells, at, out)
        return out

    def objection(self, x: np.ndarray) -> str:
        """What is wrong with a displacement x (n, 2) [m] that cells cannot bear; empty where nothing is."""
        return self._inversion(x) or self._vanishing(x) if self.large else ""

    def _evaluate(self, x: np.ndarray, points: np.ndarray | None) -> np.ndarray:
        space = self.space
        if self.element.name == SEVERAL_CELLS and points is not None:
            x, points = np.ascontiguousarray(x), np.ascontiguousarray(points)
            return _kernels.quadratic_stress(space.X, x, space.cells, self.parameters, points)
        out = np.empty((len(space.cells), 4) if points is None else (len(space.cells), len(points), 4))
        self.element.stress(space.X, x, space.cells, self.parameters, out, points)
        return out

    @property
    def _ratio(self) -> np.ndarray:
        return 0.5 * self.parameters[..., 0] / self.parameters[..., 1]

    def _inversion(self, x: np.ndarray) -> str:
        cells = _kernels.inverted_cells(self.space.X, x, self.space.cells)
        what = "turn inside out", "(St. Venant and Kirchhoff's law softens without bound in compression)"
        return self._where(cells, *what)

    def _vanishing(self, x: np.ndarray) -> str:
        if not self.thins:
            return ""
        space = self.space
        stretch = thickness_stretch(space.X, x, space.cells, self._ratio, REFERENCE_NODES[: space.cells.shape[1]])
        cells = np.flatnonzero(~(stretch > 0.0).all(axis=1))
        what = (
            "are stretched to no thickness",
            "(St. Venant and Kirchhoff's law in plane stress holds for small strains)",
        )
        return self._where(cells, *what)

    def _where(self, cells: np.ndarray, what: str, why: str) -> str:
        if not len(cells):
            return ""
        x, y = self.space.X[self.space.cells[cells[0]]].mean(axis=0)
        return f"{len(cells)} triangles {what}, one at ({x:.4g}, {y:.4g}) m {why}"


def von_mises(s: np.ndarray) -> np.ndarray:
    """Equivalent stresses (n,) [Pa] of plane stress states s (n, 4): xx, yy, xy, zz."""
    return _kernels.von_mises(np.ascontiguousarray(s))


def principal(s: np.ndarray, sign: float) -> np.ndarray:
    """The larger (sign 1) or smaller (sign -1) in-plane principal stresses (n,) [Pa] of states s (n, 4)."""
    xx, yy, xy, _ = s.T
    return 0.5 * (xx + yy) + sign * np.hypot(0.5 * (xx - yy), xy)


def principal_angle(s: np.ndarray) -> np.ndarray:
    """Angles (n,) [rad] from x towards y of the direction of the larger principal stress, between -pi/2 and pi/2."""
    xx, yy, xy, _ = s.T
    return np.asarray(0.5 * np.arctan2(2.0 * xy, xx - yy))


COMPONENTS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "xx": lambda s: s[:, 0],
    "yy": lambda s: s[:, 1],
    "xy": lambda s: s[:, 2],
    "zz": lambda s: s[:, 3],
    "von_mises": von_mises,
    "max_principal": lambda s: principal(s, 1.0),
    "min_principal": lambda s: principal(s, -1.0),
    "principal_angle": principal_angle,
}


def plane_compliance(lame: np.ndarray, shear: np.ndarray, thickness: np.ndarray) -> np.ndarray:
    """Compliances (k, 4, 4) [m^3/N] of stresses xx, yy, xy, zz integrated over the thickness, from plane moduli (k,).

    The stress along the normal has no part in it: it follows from the others, or does no work.

    Args:
        lame: lambda [Pa], that of plane stress where that is meant; shear: mu [Pa].
        thickness: [m].
    """
    out = np.zeros((len(lame), 4, 4))
    out[:, 0, 0] = out[:, 1, 1] = (lame + 2.0 * shear) / (4.0 * shear * (lame + shear))
    out[:, 0, 1] = out[:, 1, 0] = -lame / (4.0 * shear * (lame + shear))
    out[:, 2, 2] = 1.0 / shear
    return out * thickness[:, None, None]
