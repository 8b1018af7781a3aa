"""Eigenpairs near those of the frame before: a Davidson iteration with an old factor, on a recycled subspace."""

from dataclasses import dataclass

import numpy as np

from restshape.algebra.eigenproblems.pencil import Deflation, Pencil
from restshape.algebra.factors.row_share import RowShare
from restshape.algebra.row_products import add_combined, combined
from restshape.arrays import Reals

DEPENDENT = 1e-10
"""A direction of which less than this is left beside the search space adds nothing to it."""


@dataclass
class Found:
    """What an iteration for eigenpairs has come to.

    Args:
        values: (k,) eigenvalues, ascending.
        modes: (k, n) rows with phi M phi = 1; all rows are this rank's columns.
        residuals: (k,) |K phi - lambda M phi| / |lambda M phi|.
        iterations: times that the search space grew.
        converged: all of the wanted ones are within the tolerance.
        mass_products, forces: (k, n) M phi, and K phi - lambda M phi, where the search has them.
    """

    values: Reals
    modes: Reals
    residuals: Reals
    iterations: int
    converged: bool
    mass_products: Reals | None = None
    forces: Reals | None = None


class SearchSpace:
    """Rows that are orthonormal in the mass and free of rigid motions, with their products.

    Args:
        pencil: K and M.
        capacity: rows that it may hold.

    Attributes:
        found: what the last search in it has come to, which may go on; set by who searches.
    """

    def __init__(self, pencil: Pencil, capacity: int) -> None:
        self.pencil, self.capacity = pencil, capacity
        self.rows, self.stiff, self.mass_products = (np.empty((capacity, pencil.share.count)) for _ in range(3))
        self.projected = np.zeros((capacity, capacity))
        self.count = self._multiplied = 0
        self.begun: Reals | None = None
        self.found: Found | None = None

    def holds(self, capacity: int) -> bool:
        """Whether there is room for so many rows of the pencil's matrices."""
        return self.capacity >= capacity and self.rows.shape[1] == self.pencil.share.count

    def begin(self, deflation: Deflation) -> None:
        """Empty the space, for matrices that are others now; its memory is kept: new pages cost more than a frame."""
        self.deflation, self.count, self.begun = deflation, 0, None
        self._multiplied = 0

    def begin_with(self, deflation: Deflation, rows: Reals) -> None:
        """Empty the space, and begin a search in it with rows (k, n), for which `davidson` need not do so again."""
        self.begin(deflation)
        self.append(rows)
        self.begun = rows

    def append(self, rows: Reals) -> int:
        """Widen the space by the directions of rows (k, n); how many of them are new."""
        share = self.pencil.share
        norms = np.sqrt(share.squares(rows, rows))
        rows = rows[norms > 0.0] / norms[norms > 0.0, None]
        if not len(rows):
            return 0
        own, weights = self.rows[: self.count], self.mass_products[: self.count]
        self.deflation.clean(rows)
        add_combined(-share.products(rows, weights), own, rows)
        mass_products = np.empty_like(rows)
        self.pencil.apply(self.pencil.mass, rows, mass_products)
        rows, mass_products = _orthonormal(rows, mass_products, share)
        # Twice is enough (Kahan, Parlett): what the first pass leaves behind by rounding goes in the second.
        self.deflation.clean(rows, mass_products)
        parts = -share.products(rows, weights)
        add_combined(parts, own, rows)
        add_combined(parts, weights, mass_products)
        rows, mass_products = _orthonormal(rows, mass_products, share)
        room = len(self.rows) - self.count
        rows, mass_products = rows[:room], mass_products[:room]
        start, stop = self.count, self.count + len(rows)
        self.rows[start:stop], self.mass_products[start:stop] = rows, mass_products
        self.count = stop
        return stop - start

    def _project(self) -> None:
        """Multiply with K what has been added, all at once."""
        start, stop = self._multiplied, self.count
        if start == stop:
            return
        self.pencil.apply(self.pencil.stiffness, self.rows[start:stop], self.stiff[start:stop])
        block = self.pencil.share.products(self.rows[:stop], self.stiff[start:stop])
        self.projected[:stop, start:stop] = block
        self.projected[start:stop, :stop] = block.T
        self._multiplied = stop

    def ritz(self, count: int) -> tuple[Reals, Reals, Reals, Reals]:
        """The lowest Ritz values, vectors, and their products with K and with M, at most `count`."""
        self._project()
        k = self.count
        values, weights = np.linalg.eigh(self.projected[:k, :k])
        chosen = np.ascontiguousarray(weights[:, :count].T)
        return values[:count], *(combined(chosen, part[:k]) for part in (self.rows, self.stiff, self.mass_products))

    def ritz_values(self) -> Reals:
        """All Ritz values, ascending."""
        self._project()
        return np.linalg.eigvalsh(self.projected[: self.count, : self.count])


def _orthonormal(rows: Reals, mass_products: Reals, share: RowShare) -> tuple[Reals, Reals]:
    """A basis of what rows (k, n) span, orthonormal in the mass, without directions that are lost in rounding."""
    gram = share.products(rows, mass_products)
    if len(rows) == 1 and gram[0, 0] > 0.0:
        weight = 1.0 / np.sqrt(gram[0, 0])
        return rows * weight, mass_products * weight
    scale = np.sqrt(np.maximum(np.diagonal(gram), 0.0))
    kept = scale > 0.0
    if not kept.all():
        rows, mass_products, gram, scale = rows[kept], mass_products[kept], gram[np.ix_(kept, kept)], scale[kept]
    if not len(rows):
        return rows, mass_products
    values, vectors = np.linalg.eigh(gram / np.outer(scale, scale))
    good = values > DEPENDENT
    weights = np.ascontiguousarray((vectors[:, good] / np.sqrt(values[good])).T / scale)
    return combined(weights, rows), combined(weights, mass_products)


def davidson(
    space: SearchSpace,
    deflation: Deflation,
    starts: list[Reals],
    count: int,
    spare: int,
    tolerance: float,
    limit: int,
) -> Found:
    """The lowest eigenpairs, from vectors that are near them and the pencil's kept factor.

    The search space begins with the vectors given, those of the last frames; Ritz values over them already follow the
    change of shape to the order of their number. Then each residual that is too large adds the old (K - s M)^-1 of it.

    Args:
        space: its pencil has a factor; where there are starts, what it holds is thrown away, but for a first block that
            it has begun with.
        deflation: the rigid motions.
        starts: blocks (k, n) of start vectors, the best first; without any, the last search in this space goes on.
        count: wanted.
        spare: how many more are carried along; they hold the wanted ones apart from the rest, and start the next frame.
        tolerance: of each residual, relative to |lambda M phi|.
        limit: most iterations.

    Source: E. R. Davidson, J. Comput. Phys. 17 (1975) 87; G. L. G. Sleijpen and H. A. van der Vorst, SIAM J. Matrix
        Anal. Appl. 17 (1996) 401; docs/theory/free-vibrations.md.
    """
    if starts and space.begun is not starts[0]:
        space.begin_with(deflation, starts[0])
    space.begun = None
    if starts[1:]:
        space.append(np.concatenate(starts[1:]))
    iterations, share = 0, space.pencil.share
    while True:
        values, modes, stiff, mass_products = space.ritz(count + spare)
        forces = stiff - values[:, None] * mass_products
        residuals = share.norms(forces) / (np.abs(values) * share.norms(mass_products))
        open_ones = np.flatnonzero(~(residuals[:count] <= tolerance))
        if not len(open_ones) and len(values) >= count:
            return Found(values, modes, residuals, iterations, True, mass_products, forces)
        if iterations >= limit:
            return Found(values, modes, residuals, iterations, False, mass_products, forces)
        if space.count + len(open_ones) > space.capacity:
            space.begin(deflation)
            space.append(modes)
        iterations += 1
        if not len(open_ones) or not space.append(space.pencil.solve(forces[open_ones])):
            return Found(values, modes, residuals, iterations, False, mass_products, forces)


def ritz_values(pencil: Pencil, deflation: Deflation, rows: Reals) -> Reals:
    """The Ritz values of rows (k, n), ascending."""
    space = SearchSpace(pencil, len(rows))
    space.begin(deflation)
    space.append(rows)
    return space.ritz_values()
