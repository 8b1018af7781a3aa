"""Heat that enters a fluid by its border: given fluxes, as loads at nodes."""

import numpy as np

from restshape.fem.nodal_values import Nodal
from restshape.fem.space import PlaneSpace
from restshape.scene.model import Scene


class BorderHeat:
    """The given heat fluxes of a scene on a space.

    Args:
        scene: its boundaries and parameters.
        space: whose nodes may move; its facets stay on their edges.

    Attributes:
        time: at which formulas are evaluated [s].
    """

    def __init__(self, scene: Scene, space: PlaneSpace) -> None:
        self.scene, self.space, self.time = scene, space, 0.0
        self._parts = [
            (f"boundary.{name}.heat_flux", np.unique(np.concatenate([space.facets_of(on) for on in table.on])), value)
            for name, table in scene.boundary.items()
            if (value := table.heat_flux) is not None
        ]

    @property
    def largest(self) -> float:
        """The largest size of a flux on the mesh as it lies [W/m^2]."""
        sizes = [np.abs(flux).max(initial=0.0) for _, _, flux in self._fluxes()]
        return float(max(sizes, default=0.0))

    def loads(self, cells: np.ndarray | None = None, facets: np.ndarray | None = None) -> np.ndarray:
        """What enters at nodes (n,) [W/m], by the facets (k,) of some cells (k,) alone where these are given."""
        out = np.zeros(len(self.space.X))
        for index, along, flux in self._fluxes():
            chosen = self._chosen(index, cells, facets)
            share = np.linalg.norm(along, axis=1)[:, None] * (flux + flux.sum(axis=1, keepdims=True)) / 6.0
            np.add.at(out, self.space.facets[index[chosen]], share[chosen])
        return out

    def rates(self, dX: np.ndarray) -> np.ndarray:
        """Rates (n,) of what enters when nodes move with dX (n, 2)."""
        out = np.zeros(len(self.space.X))
        for (index, along, flux), (where, _, value) in zip(self._fluxes(), self._parts):
            ends = self.space.facets[index]
            nodal = Nodal(value, self._parameters, where)
            change = np.stack([nodal.rate(self.space.X[side], dX[side]) for side in ends.T], axis=1)
            length = np.linalg.norm(along, axis=1)
            stretch = np.einsum("kd,kd->k", along, dX[ends[:, 1]] - dX[ends[:, 0]]) / length
            share = length[:, None] * (change + change.sum(axis=1, keepdims=True))
            share += stretch[:, None] * (flux + flux.sum(axis=1, keepdims=True))
            np.add.at(out, ends, share / 6.0)
        return out

    @property
    def _parameters(self) -> dict[str, float]:
        return {**self.scene.parameters, "t": self.time}

    def _fluxes(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Of each table the facets (k,), their directions (k, 2) [m], and the fluxes (k, 2) at their ends [W/m^2]."""
        found, X = [], self.space.X
        for where, index, value in self._parts:
            ends, nodal = self.space.facets[index], Nodal(value, self._parameters, where)
            flux = np.stack([nodal(X[side]) for side in ends.T], axis=1)
            found.append((index, X[ends[:, 1]] - X[ends[:, 0]], flux))
        return found

    def _chosen(self, index: np.ndarray, cells: np.ndarray | None, facets: np.ndarray | None) -> np.ndarray:
        chosen = np.ones(len(index), dtype=bool)
        if cells is not None:
            chosen &= np.isin(self.space.facet_cell[index], cells)
        if facets is not None:
            chosen &= np.isin(index, facets)
        return chosen
