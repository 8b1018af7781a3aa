"""Fluxes, or stresses, at nodes, recovered from those inside cells; at a border of materials one value a side."""

import numpy as np

from restshape import _kernels
from restshape.fem.space import Space


class NodalFlux:
    """Superconvergent patch recovery on each region of a mesh by itself, for fluxes jump between materials.

    A row is a node as one region sees it: a node between two regions has two rows. First-order cells give their one
    flux, second-order cells three; there the polynomials fitted to a patch are quadratic.

    Args:
        space: of first or second order; its nodes may move and its edges may flip inside regions.

    Attributes:
        points: (3, 2) reference coordinates at which second-order cells give their fluxes; None for first order.

    Source: Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 33 (1992) 1331.
    """

    def __init__(self, space: Space) -> None:
        self.space = space
        second = space.cells.shape[1] == 6
        self.points = _kernels.recovery_points() if second else None
        regions = np.unique(space.cell_region)
        self._cells = [np.flatnonzero(space.cell_region == region) for region in regions] if len(regions) > 1 else []
        parts = [np.unique(space.cells[cells]) for cells in self._cells] or [np.arange(len(space.X))]
        self.nodes = np.concatenate(parts) if self._cells else parts[0]
        self.region = np.repeat(regions, [len(part) for part in parts])
        self._parts = parts
        self._rows: tuple[int | None, np.ndarray] = (None, space.cells)
        self._patches: tuple[int | None, _kernels.PatchRecovery | None] = (None, None)

    @property
    def jumps(self) -> bool:
        """Whether there are several regions: nodes between them have a row for each."""
        return bool(self._cells)

    def rows(self, nodes: np.ndarray | slice, cells: np.ndarray) -> np.ndarray | slice:
        """Rows of these nodes: as the regions of `cells` see them, or, with no cells, as all do."""
        if not self._cells or isinstance(nodes, slice):
            return nodes
        chosen = np.isin(self.nodes, nodes)
        if len(cells):
            chosen &= np.isin(self.region, self.space.cell_region[cells])
        return np.flatnonzero(chosen)

    def cell_rows(self) -> np.ndarray:
        """Rows (ne, nodes) int32 of the cells' nodes, as the region of each cell sees them; not to be written to."""
        cells = self.space.cells
        if not self._cells:
            return cells
        topology, rows = self._rows
        if topology != self.space.topology:
            rows, first = np.empty_like(cells), 0
            for chosen, nodes in zip(self._cells, self._parts):
                rows[chosen] = first + np.searchsorted(nodes, cells[chosen])
                first += len(nodes)
            self._rows = (self.space.topology, rows)
        return rows

    def __call__(self, flux: np.ndarray) -> np.ndarray:
        """Recovered fluxes (rows, 4), one row each (see the class), from those of the cells.

        Args:
            flux: (ne, 4), or (ne, 3, 4) at `points`.
        """
        return self._linear(flux) if self.points is None else self._quadratic(flux)

    @property
    def patches(self) -> _kernels.PatchRecovery:
        """What recovers those of first order, on the cells as they are now."""
        space, (topology, patches) = self.space, self._patches
        if patches is None:
            patches = _kernels.PatchRecovery(space.cells, self.cell_rows(), len(self.nodes))
        elif topology != space.topology:
            patches.follow(space.cells, self.cell_rows())
        self._patches = (space.topology, patches)
        return patches

    def _linear(self, flux: np.ndarray) -> np.ndarray:
        out = np.empty((len(self.nodes), 4))
        self.patches(self.space.X, flux, out)
        return out

    def _quadratic(self, flux: np.ndarray) -> np.ndarray:
        X, cells = self.space.X, self.space.cells
        out = np.empty((len(X), 4))
        if not self._cells:
            _kernels.recover_quadratic(X, cells, flux, out)
            return out
        found = []
        for chosen, nodes in zip(self._cells, self._parts):
            _kernels.recover_quadratic(X, cells[chosen], flux[chosen], out)
            found.append(out[nodes])
        return np.concatenate(found)
