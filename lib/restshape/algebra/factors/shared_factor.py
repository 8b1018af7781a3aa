"""A complete factor of a matrix whose rows ranks share: each factors what is inside of its part, one their border."""

import logging

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.factors.interior_factor import InteriorFactor, first_rows, has_mumps, interior_factor
from restshape.algebra.factors.node_factors import DenseBorder, NodeInterior
from restshape.algebra.factors.rank_border import Csr, RankBorder
from restshape.arrays import Reals
from restshape.errors import ReplayProblem
from restshape.first_use import made

log = logging.getLogger("restshape.algebra")

NO_FACTOR = "the pencil of stiffness and mass has no factor at this shift"
TOO_LARGE = "the factor of the stiffness takes more memory than a rank has: start more ranks, or take a coarser mesh"

MOST_BORDER = 16_000
"""Unknowns between ranks whose dense factor, of 2 GB, the first rank can be asked for."""


class SharedFactor:
    """A complete factor of K - s M on several ranks, whose pivots count eigenvalues, and whose bits repeat.

    Substructuring: the ranks' insides do not couple, so that the Schur complement of their border is the sum of what
    each of them leaves there. The first rank factors it, dense: `MOST_BORDER` unknowns at most. By Haynsworth's rule
    the eigenvalues below s are the negative ones of the insides and of this complement.

    Args:
        nodes: unknowns of a node, where no rows are exchanged: all factors are in blocks of nodes then, which takes a
            quarter of the time, and is accurate where the matrix is positive definite; 0: rows are exchanged.

    Attributes:
        made: whether there is one; stale_pattern: whether the next one is of another pattern.
        nonzeros: of all ranks.

    Source: J. S. Przemieniecki, AIAA J. 1 (1963) 138; E. V. Haynsworth, Linear Algebra Appl. 1 (1968) 73.
    """

    def __init__(self, nodes: int = 0) -> None:
        self.made, self.stale_pattern, self.nonzeros = False, True, 0.0
        self._nodes, self._dense = nodes, DenseBorder()
        self._shifted: PETSc.Mat = None
        self._border: RankBorder | None = None
        self._inside: InteriorFactor | NodeInterior

    def forget(self) -> None:
        """Let go of the factor."""
        if self._border is not None:
            self._inside.destroy()
            self._dense.destroy()
        if self._shifted is not None:
            self._shifted.destroy()
        self.made, self.stale_pattern, self._shifted, self._border = False, True, None, None

    def substitute_by_panels(self, single: bool = False) -> None:
        """Substitute by panels of nodes, in `single` precision or in double, which MUMPS does by itself."""
        if isinstance(self._inside, NodeInterior):
            for part in (self._inside.factor, self._dense.factor):
                part.substitute_by_panels(single)

    def make(self, stiffness: PETSc.Mat, mass: PETSc.Mat, shift: float) -> int:
        """Factor; the number of eigenvalues below the shift, the same on all ranks.

        Raises:
            ReplayProblem: there is no factor: the shift is an eigenvalue, the matrices are not numbers, or what ranks
                share is too large for one of them.
        """
        border = self._begin(stiffness) if self._border is None or self.stale_pattern else self._border
        matrix = self._shift(stiffness, mass, shift) if shift else stiffness
        count, finite = len(border.inside), _kernels.finite_rows(matrix.handle)
        # Of numbers that are none no library promises an end.
        schur = np.zeros(2 * (len(border.beside),))
        if isinstance(self._inside, NodeInterior):
            schur = self._inside.make(matrix, border.number) if count and finite else schur
        else:
            local = border.local(matrix)
            self._beside = first_rows(local, count)[1]
            schur = self._inside.make(local) if count and finite else schur
        why = "" if finite and not (count and self._inside.singular) else NO_FACTOR
        why = TOO_LARGE if count and finite and self._inside.too_large else why
        below, self.nonzeros = self._factor_border(border, schur, border.between(matrix), why)
        self.made = True
        return below

    def _shift(self, stiffness: PETSc.Mat, mass: PETSc.Mat, shift: float) -> PETSc.Mat:
        """The matrix K - s M."""
        if self._shifted is None:
            self._shifted = stiffness.duplicate(copy=True)
        else:
            stiffness.copy(self._shifted, structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        self._shifted.axpy(-shift, mass, structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        return self._shifted

    def _begin(self, stiffness: PETSc.Mat) -> RankBorder:
        """Take up another pattern; its border."""
        self.forget()
        border = RankBorder(stiffness)
        if (m := len(border.rows)) > MOST_BORDER:
            what = f"{m:,} unknowns couple the parts of {stiffness.getComm().size} ranks"
            much = f"their factor would take {8e-9 * m * m:.1f} GB of the first rank"
            raise ReplayProblem(f"{what}, and {much}: start fewer ranks, or take a coarser mesh")
        self._border = border
        count, beside = len(border.inside), len(border.beside)
        self._inside = NodeInterior(beside, self._nodes) if self._nodes else interior_factor(count, beside)
        self._world = stiffness.getComm().tompi4py()
        self.stale_pattern = False
        if not self._nodes and not has_mumps() and len(border.rows):
            log.info("ST factor: PETSc has no MUMPS, so that a border of %d costs as much", len(border.rows))
        return border

    def _factor_border(self, border: RankBorder, schur: Reals, between: Csr, why: str) -> tuple[int, float]:
        """Sum what the ranks leave on their border, in their order, and factor it on the first one; `make`'s answer.

        Args:
            border: of the ranks; schur: what this rank leaves there; between: its entries there.
            why: it has no factor, empty where it has one.
        """
        inside = self._inside
        own = (border.beside, between, inside.negative, inside.nonzeros, why)
        parts, answer = self._world.gather(own), None
        if parts is None:
            self._world.Send(schur, 0)
        else:
            complement = np.zeros(2 * (len(border.rows),), order="F")
            for rank, (beside, (rows, columns, entries), *_) in enumerate(parts):
                left = schur
                if rank:
                    left = np.empty(2 * (len(beside),))
                    self._world.Recv(left, rank)
                complement[np.ix_(beside, beside)] += left
                # Of another rank's rows each has its half of the pattern.
                np.add.at(complement, (rows, columns), entries)
            whys = [part[-1] for part in parts if part[-1]]
            below, zero = (0, True) if whys else self._decompose(complement)
            why = max(whys, key=[NO_FACTOR, TOO_LARGE].index) if whys else NO_FACTOR if zero else ""
            nonzeros = sum(part[3] for part in parts) + complement.size
            answer = (below + sum(part[2] for part in parts), float(nonzeros), why)
        below, nonzeros, why = self._world.bcast(answer)
        if why:
            self.forget()
            raise ReplayProblem(why)
        return below, nonzeros

    def _decompose(self, complement: Reals) -> tuple[int, bool]:
        """Factor the border's complement (m, m), on the first rank; its negative eigenvalues, and whether one is
        zero."""
        if not complement.size:
            return 0, False
        # Insides whose pivots are close to zero may leave numbers that are none.
        if not np.isfinite(complement).all():
            return 0, True
        if self._nodes:
            zero = self._dense.make(complement)
            return self._dense.negative, zero
        from scipy.linalg import lapack

        # By default it would work without blocks, which takes four times as long.
        room = int(lapack.dsytrf_lwork(len(complement), lower=1)[0])
        self._factors, self._pivots, zero = lapack.dsytrf(complement, lower=1, lwork=room, overwrite_a=1)
        single = self._pivots > 0
        # Of a pair of rows that pivot together one is negative (Bunch, Kaufman).
        pairs = int(np.count_nonzero(~single)) // 2
        return int(np.count_nonzero(np.diagonal(self._factors)[single] < 0.0)) + pairs, zero != 0

    def solve_rows(self, rows: Reals) -> Reals:
        """The inverse times each row (k, n), of which each rank has its columns; not in blocks of nodes; collective."""
        border, found = made(self._border), np.empty_like(rows)
        right = np.zeros((len(rows), len(border.rows)))
        right[:, border.own_places] = rows[:, border.own]
        inside = self._solve_inside(rows[:, border.inside])
        right[:, border.beside] -= (self._beside.T @ inside.T).T
        at_border = self._solve_border(right)
        there = np.ascontiguousarray(at_border[:, border.beside])
        if len(border.beside):
            inside -= self._solve_inside((self._beside @ there.T).T)
        found[:, border.inside], found[:, border.own] = inside, at_border[:, border.own_places]
        return found

    def _solve_row(self, row: Reals) -> Reals:
        """The inverse times a row (n,), by factors in blocks of nodes, which are passed once each way."""
        border, found, inside = made(self._border), np.empty_like(row), self._inside
        right = np.zeros(len(border.rows))
        right[border.own_places] = row[border.own]
        factor = inside.factor if isinstance(inside, NodeInterior) and len(border.inside) else None
        if factor:
            right[border.beside] += factor.eliminate(row[border.inside])
        at_border = self._solve_border(right[None])[0] if len(right) else right
        if factor:
            found[border.inside] = factor.complete(at_border[border.beside], len(border.inside))
        found[border.own] = at_border[border.own_places]
        return found

    def _solve_inside(self, rows: Reals) -> Reals:
        if not rows.size:
            return np.zeros_like(rows)
        if isinstance(self._inside, NodeInterior):
            raise RuntimeError("a factor in blocks of nodes solves by solve")
        return self._inside.solve(np.ascontiguousarray(rows))

    def _solve_border(self, right: Reals) -> Reals:
        """The border's unknowns (k, m) of the sum of all ranks' right sides (k, m)."""
        if not right.size:
            return right
        parts = np.empty((self._world.size, *right.shape)) if self._world.rank == 0 else None
        self._world.Gather(right, parts)
        found = np.empty_like(right)
        if parts is not None:
            total = parts.sum(axis=0)
            if self._nodes:
                found[:] = self._dense.solve(total)
            else:
                from scipy.linalg import lapack

                found[:] = lapack.dsytrs(self._factors, self._pivots, total.T, lower=1)[0].T
        self._world.Bcast(found)
        return found

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Forward and backward substitution."""
        right = b.getArray(readonly=True)
        x.getArray()[:] = self._solve_row(right) if self._nodes else self.solve_rows(right[None])[0]


def definite_on_ranks(mat: PETSc.Mat) -> bool:
    """Whether a symmetric matrix whose rows ranks share is positive definite; True where its factor is too large."""
    factor = SharedFactor()
    try:
        return factor.make(mat, mat, 0.0) == 0
    except ReplayProblem as problem:
        log.info("Stability is that of the ranks' own rows: %s", problem)
        return str(problem) != NO_FACTOR
    finally:
        factor.forget()
