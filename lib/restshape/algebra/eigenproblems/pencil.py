"""The pencil K - s M of an eigenproblem: products, a factor that is kept, and how many eigenvalues lie below s."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.factors.lone_factor import CountedFactor, LoneFactor
from restshape.algebra.factors.row_share import RowShare
from restshape.algebra.factors.shared_factor import SharedFactor
from restshape.algebra.row_products import add_combined, combined
from restshape.algebra.stages import Stages
from restshape.arrays import Reals

SAME = 1e-12
"""Relative difference of products that rounding leaves of matrices which are multiples of each other."""


class Pencil:
    """K and M as they stand, and the last complete factor of K - s M, which may be of matrices of some frames ago.

    PETSc's own factor is L D L^T without pivoting: it serves indefinite matrices too, and D has their
    inertia. Of matrices that ranks share it is a `SharedFactor`; rows (k, n) are then this rank's columns of them.

    Args:
        stages: takes the time of factorisations.
        counted: factors of large matrices on one rank are a `CountedFactor`; mass must be positive semidefinite.

    Attributes:
        stiffness, mass: PETSc matrices of the same pattern, symmetric; set by `set_matrices`.
        share: what this rank has of their rows.
        shift: s of the factor.
        nonzeros: of the factor.
        factorisations, substitutions, products: counted since the start.
    """

    def __init__(self, stages: Stages, counted: bool = False) -> None:
        self.stages, self.counted = stages, counted
        self.stiffness = self.mass = PETSc.Mat()
        self.shift = 0.0
        self.nonzeros = 0.0
        self.factorisations = self.substitutions = self.products = 0
        self.share = RowShare(PETSc.COMM_SELF, slice(0, 0), 0)
        self._kept: LoneFactor | SharedFactor = LoneFactor()
        self._counting: LoneFactor | SharedFactor = LoneFactor()
        self._patterns = (0, 0)

    @property
    def ready(self) -> bool:
        """Whether there is a factor of this size."""
        return self._kept.made

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.stiffness.getSize()[0]

    @property
    def dofs_with_mass(self) -> int:
        """Number of unknowns with mass: as many eigenvalues are finite."""
        diagonal = self.mass.getDiagonal()
        count = np.float64(np.count_nonzero(diagonal.getArray()))
        diagonal.destroy()
        return int(self.share.summed(count))

    @property
    def entries(self) -> float:
        """Nonzeros of each matrix."""
        return self.stiffness.getInfo()["nz_used"]

    def set_matrices(self, stiffness: PETSc.Mat, mass: PETSc.Mat, new_system: bool) -> None:
        """Take up new values; where `new_system`, of other unknowns, for which no old factor serves."""
        self.stiffness, self.mass, self.share = stiffness, mass, RowShare.of(stiffness)
        if not self.share.alone and isinstance(self._kept, LoneFactor):
            self._kept, self._counting = SharedFactor(), SharedFactor()
        if new_system:
            self._kept.forget()
            if self.share.alone:
                self._kept = CountedFactor() if self.counted and CountedFactor.serves(self.size) else LoneFactor()
        elif self._kept.made:
            self._kept.substitute_by_panels()
        # Flips may have made other matrices of a larger pattern: what was analysed before no longer fits them.
        patterns = (stiffness.handle, mass.handle)
        if new_system or patterns != self._patterns:
            self._counting.forget()
            self._kept.stale_pattern = True
            self._patterns = patterns

    def apply(self, matrix: PETSc.Mat, rows: Reals, out: Reals) -> None:
        """Write the products of a matrix with each row (k, n) to `out` (k, n)."""
        self.products += len(rows)
        if len(rows) > 1 and _kernels.matrix_products(matrix.handle, rows, out):
            return
        for row, product in zip(rows, out):
            _through(matrix.mult, row, product, self.share)

    def norms(self, rows: Reals) -> Reals:
        """The squared norms phi^T M phi (k,) in the mass of rows (k, n) that all ranks have whole."""
        own = self.share.own(rows)
        mass_products = np.empty_like(own)
        self.apply(self.mass, own, mass_products)
        return self.share.squares(own, mass_products)

    def factor(self, shift: float) -> int:
        """Factor K - shift M as they stand, and keep it; the number of eigenvalues below the shift.

        Raises:
            ReplayProblem: there is no factor: the shift is an eigenvalue, or the matrices are not numbers.
        """
        with self.stages("factor"):
            below = self._kept.make(self.stiffness, self.mass, shift)
        self.factorisations += 1
        self.shift, self.nonzeros = shift, self._kept.nonzeros
        return below

    def below(self, shift: float) -> int:
        """The number of eigenvalues below a shift, rigid motions included, by a factor that is not kept (Sylvester)."""
        with self.stages("factor"):
            found = self._counting.make(self.stiffness, self.mass, shift)
        self.factorisations += 1
        return found

    def solve(self, rows: Reals) -> Reals:
        """The old (K - s M)^-1 times each row (k, n)."""
        out = np.empty_like(rows)
        self.substitutions += len(rows)
        if isinstance(self._kept, SharedFactor):
            return self._kept.solve_rows(rows)
        for row, solution in zip(rows, out):
            _through(self._kept.solve, row, solution, self.share)
        return out

    def auxiliary_solve(self, rows: Reals) -> Reals:
        """The same beside the work that is counted, for what decides nothing."""
        before = self.substitutions
        out = self.solve(rows)
        self.substitutions = before
        return out

    def solve_vector(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """The same for PETSc's vectors."""
        self.substitutions += 1
        self._kept.solve(b, x)


def _through(operation: Callable[[PETSc.Vec, PETSc.Vec], None], row: Reals, out: Reals, share: RowShare) -> None:
    """Run an operation of PETSc from one array (n,) to another, this rank's part of which they are."""
    source, target = _vectors(len(row)) if share.alone else _shared_vectors(share.comm.size, len(row), share.size)
    source.placeArray(row)
    target.placeArray(out)
    try:
        operation(source, target)
    finally:
        source.resetArray()
        target.resetArray()


@lru_cache(maxsize=4)
def _vectors(n: int) -> tuple[PETSc.Vec, PETSc.Vec]:
    """Two vectors of n entries, in which arrays are placed: making them takes as long as a small product."""
    source, target = (PETSc.Vec().createWithArray(np.zeros(n), comm=PETSc.COMM_SELF) for _ in range(2))
    return source, target


@lru_cache(maxsize=4)
def _shared_vectors(_ranks: int, own: int, size: int) -> tuple[PETSc.Vec, PETSc.Vec]:
    """The same of all ranks together, of `own` entries here and `size` in all."""
    source, target = (
        PETSc.Vec().createWithArray(np.zeros(own), size=(own, size), comm=PETSc.COMM_WORLD) for _ in range(2)
    )
    return source, target


def sample(stiffness: PETSc.Mat, mass: PETSc.Mat) -> Reals:
    """The products (2, n) of both matrices with the same random row, by which `multiplied` knows them."""
    share = RowShare.of(stiffness)
    row = share.own(np.random.default_rng(3).uniform(-1.0, 1.0, (1, share.size)))[0]
    out = np.empty((2, len(row)))
    for matrix, product in zip((stiffness, mass), out):
        _through(matrix.mult, row, product, share)
    return share.whole(out)


def multiplied(before: Reals, now: Reals) -> bool:
    """Whether matrices are multiples of others, as far as a `sample` (2, n) of both shows."""
    factors = np.einsum("ki,ki->k", before, now) / np.einsum("ki,ki->k", before, before)
    apart = np.linalg.norm(now - factors[:, None] * before, axis=1)
    return bool(np.all(factors > 0.0) and np.all(apart <= SAME * np.linalg.norm(now, axis=1)))


class Deflation:
    """The rigid motions that supports leave free: exact eigenvectors of eigenvalue 0, kept out of all vectors.

    Args:
        rigid: (r, n) a basis of them at the places of the nodes now, this rank's columns of it; r may be 0.
        pencil: of the frame.

    Source: docs/theory/free-vibrations.md.
    """

    def __init__(self, rigid: Reals, pencil: Pencil) -> None:
        self.count = len(rigid)
        weighted = np.empty_like(rigid)
        pencil.apply(pencil.mass, rigid, weighted)
        if self.count:
            turn = np.linalg.inv(np.linalg.cholesky(pencil.share.products(weighted, rigid)))
            rigid, weighted = combined(turn, rigid), combined(turn, weighted)
        self.rigid, self.weighted, self.share = rigid, weighted, pencil.share

    def clean(self, rows: Reals, mass_products: Reals | None = None) -> None:
        """Make rows (k, n) orthogonal to the rigid motions in the mass, in place; their products M phi go with them."""
        if self.count:
            parts = -self.share.products(rows, self.weighted)
            add_combined(parts, self.rigid, rows)
            if mass_products is not None:
                add_combined(parts, self.weighted, mass_products)
