"""A preconditioner that outlives the matrix that it was made from."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.at_exit import destroyed_at_exit
from restshape.algebra.factors.pivots import factors_of, negative_pivots, zero_pivots
from restshape.algebra.krylov_method import set_krylov
from restshape.algebra.preconditioner import (
    COMPLETE,
    cycle_in_single,
    kind_of,
    nonzeros,
    set_preconditioner,
    set_rigid_motions,
)
from restshape.algebra.reuse.candidates import DECADES, ILU, THESIS_FLOW, Candidate
from restshape.algebra.reuse.choice import Choice
from restshape.algebra.reuse.prices import Prices, Size, prices
from restshape.algebra.reuse.traits import Traits
from restshape.arrays import Indices, Reals

if TYPE_CHECKING:
    from restshape.algebra.factors.shared_solves import SharedSolves

log = logging.getLogger("restshape.algebra")


NOWHERE = np.empty(0, dtype=np.int32)
OVERLAP, OVERLAP_OF_SOLIDS = 1, 2
PRODUCTS_ROWS = 200_000
"""Unknowns a rank from which on several ranks keep no parts of multigrid's products.

They are 240 MB a rank at 478,000 unknowns each. Without them a refresh finds the patterns of coarse matrices again; of
a drag of 174 frames five do.
"""
MOST_FLIPPED = 0.125
"""Share of the nodes up to which an old factor is corrected around flips: beyond it a new one is near anyway."""


# More than 15 attributes: half of them say what the preconditioner is, half what it is made of and when.
class KeptPreconditioner:
    """Sets up the preconditioner of a KSP, by name or as a `Choice` prefers, and keeps it.

    Args:
        ksp: whose preconditioner it is.
        choice: among candidates.
        traits: of the matrices.
        named: kind that the user names; None leaves it to the method.
        method: as of `LinearSolver`.

    Attributes:
        ranks: that share the matrix.
        kind: PETSc's type; candidate: that was chosen; None where there was no choice.
        chooses: each new system has its choice.
        ready: there is one, which fits the present system.
        filled: nonzeros in it.
        size: of the present system; handle: of its matrix.
        pattern_changed: since it was made.
        blocks: a complete Cholesky factor of this system is made in blocks of a node.
        single: panels of an old factor of this system may have single precision.
        flipped: (k,) nodes, ascending, around which edges have been flipped since it was made.
        exchanges: a complete factor exchanges rows (MUMPS).
        rounded: its substitutions are of single precision.
    """

    def __init__(self, ksp: PETSc.KSP, choice: Choice, traits: Traits, named: str | None, method: str) -> None:
        self.ksp, self.choice, self.traits = ksp, choice, traits
        self.ranks = int(ksp.getComm().size)
        self._named, self._method = named is not None, method
        self.kind = named or ("ilu" if method == "ilu" else traits.factor)
        self.size = Size(0, 0.0, traits.dimension, fields=traits.fields, sheet=traits.sheet)
        choice.krylov = PETSc.Options(ksp.getOptionsPrefix() or "").getString("ksp_type", "")
        self.chooses = method == "auto" and named is None and bool(choice.candidates(self.size))
        self.candidate: Candidate | None = None
        self.exchanges, self._without_pivots, self._precise = traits.pivots, set[str](), False
        self.ready = self.pattern_changed = False
        self.filled = 0.0
        self._paid: Prices | None = None
        self.handle = 0
        self._given: list[str] = []
        self.blocks = self.single = True
        self.flipped, self._corrected, self.rounded = NOWHERE, False, False
        self._shared: SharedSolves | None = None
        if method == "ilu" and named is None:
            self._take(THESIS_FLOW if self.may_exchange else ILU)
        elif not self.chooses:
            # What is chosen sets itself up; options of one that is never made would name the next one's kind.
            self._set(ILU.levels)

    @property
    def name(self) -> str:
        """As in tables."""
        if self.candidate:
            return self.candidate.name
        return f"{self.kind}, rows exchanged" if self.exchanges and not self.traits.pivots else self.kind

    @property
    def complete(self) -> bool:
        """Whether it is a complete factor, of each rank's own rows or of the whole matrix."""
        return self.kind in COMPLETE

    @property
    def exact(self) -> bool:
        """Whether it is a complete factor of the whole matrix."""
        return self.kind in COMPLETE and (self.ranks == 1 or self.exchanges or self._shared is not None)

    @property
    def may_exchange(self) -> bool:
        """Whether factors exchange rows where they have none without: where no pivot's sign says anything."""
        return not (self.traits.symmetric or self.traits.rigid_motions)

    @property
    def overlap(self) -> int:
        """Layers of other ranks' rows in a rank's factor.

        With one, flows take 0.6 to 0.8 of the iterations; with two, solids 0.4 of them on two ranks, 0.5 on eight.
        Incomplete factors gain little, and those of nearly symmetric tangents must show pivots of own rows alone.
        """
        if self.may_exchange:
            return OVERLAP
        return OVERLAP_OF_SOLIDS if self.kind == "cholesky" else 0

    @property
    def exchangeable(self) -> bool:
        """Whether it is a complete factor without exchanges of rows, in place of which there is one with them."""
        return self.exact and self.may_exchange and not (self.exchanges or self._named)

    @property
    def nested(self) -> bool:
        """Whether it consists of others: block Jacobi, multigrid, or what ranks have of a factor that they share."""
        return self.kind == "gamg" or (self.ranks > 1 and not (self.complete and self.exchanges))

    @property
    def inverts(self) -> bool:
        """Whether it is a Cholesky factor, all pivots positive, which solves with its own matrix by one application."""
        known = self.exact and self.kind == "cholesky" and not self.traits.pivots
        return known and not (self.negative_pivots() or self.zero_pivots())

    def measure(self, mat: PETSc.Mat) -> bool:
        """Take in the size of a matrix that is another one; returns whether it has changed."""
        before = self.size
        self.handle = mat.handle
        self.size = self._size_of(mat)
        return self.size != before

    def foresees_inverse(self, mat: PETSc.Mat) -> bool:
        """Whether a new system with such a matrix gets a complete Cholesky factor of all of it."""
        if self.ranks > 1 or self.traits.pivots:
            return False
        return (self.choice.foreseen(self._size_of(mat)).kind if self.chooses else self.kind) == "cholesky"

    def _size_of(self, mat: PETSc.Mat) -> Size:
        filled = mat.getInfo(PETSc.Mat.InfoType.GLOBAL_SUM)["nz_used"]
        blocks = mat.getType() == "seqbaij"
        known = self.traits
        return Size(mat.getSize()[0], filled, known.dimension, self.ranks, known.fields, blocks, known.sheet)

    def begin_system(self, uses: int = 1) -> None:
        """Forget what was made: the system is another one, which has its choice for known uses of each matrix."""
        self._reset()
        self._paid, self.choice.uses = None, uses
        self.ready = self.pattern_changed = False
        self.single = True
        if not self.blocks:
            self.blocks = True
            self._set(0)
        self._precise = False
        self.choice.excluded -= self._without_pivots
        self._without_pivots.clear()
        if self.chooses:
            self._change(self.choice(self.size))
        else:
            log.info("KSP %s PC %s, without a choice: %s", self.ksp.getOptionsPrefix(), self.name, self._why_fixed())

    def choose_again(self) -> None:
        """Before a refresh, change to another candidate where what has been counted makes it cheaper."""
        if self.chooses and self.candidate and self.ready:
            self._change(self.choice.again(self.size, self.candidate))

    @property
    def outdone(self) -> bool:
        """Whether it has cost more than another candidate would have, its set-up included."""
        return self.candidate is not None and self.choice.outlay.exceeded

    def _change(self, chosen: Candidate) -> None:
        if chosen is not self.candidate:
            self._reset()
            self._paid, self.ready = None, False
            self._take(chosen)

    def _why_fixed(self) -> str:
        """Why there is no choice of a preconditioner, for the log."""
        if self._named:
            return "PETSc's options name it"
        if self._method == "ilu":
            return f"the policy solves by {self._method}"
        if not self.traits.symmetric:
            return "the matrices are not symmetric, so that a complete factor is LU"
        if self.traits.pivots:
            return "the matrices are symmetric and not definite, so that a complete factor exchanges rows (MUMPS)"
        return f"the policy solves by {self._method}, with a complete factor"

    def make(self, mat: PETSc.Mat, places: Reals | None, rebuild: bool = False) -> None:
        """Make it from a matrix, then keep it.

        Args:
            mat: of the present system.
            places: (m, d) this rank's nodes [m], whose rigid motions coarse grids must know; None: none.
            rebuild: no interpolation of multigrid is kept either.
        """
        pc = self.ksp.getPC()
        self._forget_flips(mat)
        if self.kind == "gamg" and (rebuild or self.pattern_changed or not self.ready):
            # A reset, or a kept interpolation with another pattern, leaves coarse grids of the old sizes.
            pc.setType("none")
            self._set(0)
        if places is not None and self.kind == "gamg" and mat.getBlockSize() == places.shape[1]:
            set_rigid_motions(mat, places)
        if self.kind == "lu" and self.ranks == 1 and not self.exchanges:
            self._factor_by_nodes(mat)
        _kernels.forget_failure(pc.handle)
        pc.setReusePreconditioner(False)
        self.ksp.setOperators(mat)
        self.ksp.setUp()
        if self.ranks > 1:
            self.ksp.setUpOnBlocks()
        if self.kind == "gamg":
            cycle_in_single(pc)
            if self.ranks > 1 and self.size.unknowns >= PRODUCTS_ROWS * self.ranks:
                _kernels.forget_products(pc.handle)
        pc.setReusePreconditioner(True)
        if self._paid:
            self.choice.outlay.refresh(self._paid.refresh)
        self.ready, self.pattern_changed = True, False

    def _factor_by_nodes(self, mat: PETSc.Mat) -> None:
        """Have LU made by nodes where the matrix is in such blocks, rounded where the iteration bears it."""
        named = PETSc.Options(self.ksp.getOptionsPrefix() or "").hasName("pc_factor_mat_solver_type")
        if named or mat.getType() != "seqbaij" or mat.getBlockSize() not in (3, 4):
            self.rounded = False
            return
        _kernels.register_node_lu()
        self.rounded = self.ksp.getType() == "fgmres" and not self._precise
        self.ksp.getPC().setFactorSolverType(_kernels.node_lu_single if self.rounded else _kernels.node_lu)

    def substitute_by_panels(self, iterates: bool) -> None:
        """Let a complete factor substitute by panels, which are worth making where it serves several solves.

        Args:
            iterates: each of them is an iteration, for which single precision does.
        """
        if self._shared:
            self._shared.substitute_by_panels(iterates and self.single)
        elif self.kind == "cholesky":
            for part in factors_of(self.ksp):
                _kernels.solve_by_panels(part.getFactorMatrix().handle, iterates and self.single)

    @property
    def shared(self) -> bool:
        """Whether it is a complete factor that ranks share."""
        return self._shared is not None

    @property
    def by_panels(self) -> bool:
        """Whether a complete factor on one rank substitutes by panels already."""
        known = self.kind == "cholesky" and self.ranks == 1 and self.ready
        return known and _kernels.panel_value_bytes(self.ksp.getPC().getFactorMatrix().handle) > 0

    def flip(self, nodes: Indices) -> None:
        """Take in that edges of cells with these nodes (m, k) have been flipped."""
        if self.kind == "cholesky" and self.ranks == 1:
            # Of so few nodes numpy takes ten times as long.
            known = sorted({*self.flipped.tolist(), *nodes.ravel().tolist()})
            self.flipped = np.array(known, dtype=np.int32)

    def correct(self, mat: PETSc.Mat) -> None:
        """Let an old factor in blocks solve besides for the unknowns around flips, with the matrix as it is now.

        Source: docs/theory/levels-of-reuse.md.
        """
        fields, flipped = mat.getBlockSize(), self.flipped
        if len(flipped):
            nodes = flipped if len(flipped) * fields <= MOST_FLIPPED * self.size.unknowns else NOWHERE
            _kernels.correct_around(self.ksp.getPC().getFactorMatrix().handle, mat.handle, nodes, fields)
            self._corrected = True

    def _forget_flips(self, mat: PETSc.Mat) -> None:
        if self._corrected:
            _kernels.correct_around(self.ksp.getPC().getFactorMatrix().handle, mat.handle, NOWHERE, 1)
        self.flipped, self._corrected = NOWHERE, False

    def _reset(self) -> None:
        """Let go of what was made."""
        _kernels.forget_cycle(self.ksp.getPC().handle)
        self.ksp.reset()
        self.flipped, self._corrected = NOWHERE, False

    def note_kind(self) -> None:
        """Take in what PETSc has made of it, once the options for its set-up are not needed any more."""
        self._forget_options()
        self.kind = self.kind if self._shared else kind_of(self.ksp.getPC())

    def price(self) -> Prices:
        """Seconds that it costs, from counted work on all ranks and the calibration."""
        size = self.size
        stored = self._shared.nonzeros if self._shared else nonzeros(self.ksp.getPC())
        # An LU factor has the nonzeros of two triangles, of which the prices expect one.
        filled = self.filled = 0.5 * stored if self.kind == "lu" else stored
        if self.candidate and filled:
            self.choice.count_fill(self.candidate, size, filled)
        if self.candidate:
            self._paid = self.choice.prices(self.candidate, size, filled or size.nonzeros)
            return self._paid
        return prices(self.kind, size, filled or size.nonzeros, self.choice.calibration)

    def expected(self, counted: float) -> float:
        """Iterations of a solve with a fresh one; without a choice all that is known is what was `counted` last."""
        return self.choice.expected(self.candidate, self.size)[0] if self.candidate else counted

    def count(self, uses: int, iterations: int, decades: float = DECADES) -> None:
        """Take in a solve with it, the `uses`-th since it was made, that made its residual so much smaller."""
        if self.candidate:
            share = DECADES / decades if self.candidate.krylov else 1.0
            self.choice.count(self.candidate, self.size, uses, iterations * share)
            if self._paid:
                self.choice.outlay.solve(iterations * self._paid.iteration)

    def count_application(self) -> None:
        """Take in a solve by one application of a complete factor."""
        if self._paid:
            self.choice.outlay.solve(self._paid.apply)

    def replace_failed(self) -> bool:
        """After a failure of a fresh one, take one of another kind; returns whether any is left."""
        if self.kind == "cholesky" and self.blocks and not (self._named or self.traits.pivots or self._shared):
            log.info("KSP %s: a factor of single numbers, in place of one in blocks", self.ksp.getOptionsPrefix())
            self.blocks = False
            self._reset()
            self._set(0)
            return True
        if self.may_exchange:
            return self._exchange()
        if not self.chooses or self.candidate is None or (self.candidate.kind == "cholesky" and not self._shared):
            return False
        if self._shared:
            if self._shared.singular:
                return False
            # Its border may have been too large on this mesh alone.
            self._without_pivots.add(self.candidate.name)
        self.choice.exclude(self.candidate)
        left = self.choice.open(self.size)
        if left[0] is self.candidate or left[0].name in self.choice.excluded:
            return False
        self.choice.instead(left[0], self.size)
        self._change(left[0])
        return True

    def _exchange(self) -> bool:
        """Where one that exchanges no rows fails, take another, in the end a factor that does; whether there is one."""
        failed, pivots, prefix = self.name, self.zero_pivots(), self.ksp.getOptionsPrefix()
        why = "a zero pivot" if pivots else "pivots near zero" if self.complete else "no solution"
        if self._named or self.exchanges:
            return False
        if self.rounded and self.complete and not pivots:
            log.info("KSP %s: substitutions of double precision, in place of single ones", prefix)
            self._precise = True
            self._reset()
            self._set(0)
            return True
        if self.chooses and self.candidate:
            for other in self.choice.candidates(self.size):
                # Where one pivot is zero, others are near it: of those without exchanges the complete one is left.
                if other is self.candidate or ((pivots or self.complete) and not other.complete):
                    self._without_pivots.add(other.name)
            self.choice.excluded |= self._without_pivots
            self._change(self.choice(self.size))
        else:
            self.kind, self.candidate, self.exchanges = "lu", None, True
            self._reset()
            # A matrix that is singular shows in the true residual.
            if not self.choice.krylov:
                set_krylov(self.ksp, self.traits.krylov)
            self._set(0)
        log.warning("KSP %s: %s with %s, which exchanges no rows: %s takes its place", prefix, why, failed, self.name)
        return True

    def negative_pivots(self) -> int:
        """Negative pivots of a complete factor, shared or of all ranks' own blocks; 0 where there is none to ask.

        Nor are factors of indefinite systems asked: negative pivots are in their nature, and say nothing of stability.
        """
        if not (self.complete and self.traits.definite):
            return 0
        if self._shared:
            return self._shared.negative
        return self._summed(sum(negative_pivots(part.getFactorMatrix(), self.kind) for part in factors_of(self.ksp)))

    def zero_pivots(self) -> int:
        """Pivots of a factor that are zero, likewise; of one that is not symmetric those that it has ended at."""
        if self.exchanges:
            return 0
        if self._shared:
            return int(self._shared.singular)
        return self._summed(sum(zero_pivots(part.getFactorMatrix(), self.kind) for part in factors_of(self.ksp)))

    def shows_definite(self, mat: PETSc.Mat) -> bool:
        """Whether the matrix that a complete factor was just made from is positive definite; collective.

        Where ranks have factors of their own rows, positive pivots are not enough: a factor that they share decides.
        """
        if self.zero_pivots() or self.negative_pivots():
            return False
        if self.exact or not self.traits.minimises:
            return True
        # It brings SciPy, which one rank does not need.
        from restshape.algebra.factors.shared_factor import definite_on_ranks

        return definite_on_ranks(mat)

    def has_no_factor(self) -> bool:
        """Whether a factor of all ranks, or one that exchanges rows, came to no end: PETSc (3.18) forgets it."""
        if self._shared:
            return self._shared.singular
        if not self.exchanges:
            return False
        return self._summed(sum(part.getFactorMatrix().getMumpsInfog(1) < 0 for part in factors_of(self.ksp))) > 0

    def _summed(self, found: int) -> int:
        return found if self.ranks == 1 else self.ksp.getComm().tompi4py().allreduce(found)

    def _take(self, candidate: Candidate) -> None:
        self.candidate, self.kind = candidate, candidate.kind
        self.exchanges = self.traits.pivots or candidate.exchanges
        if candidate.krylov and not self.choice.krylov:
            set_krylov(self.ksp, candidate.krylov)
        self._set(candidate.levels)

    def _set(self, levels: int) -> None:
        self._forget_options()
        traits = self.traits
        self._shared = None
        if self.candidate and self.candidate.shared:
            # It brings SciPy, which one rank does not need.
            from restshape.algebra.factors.shared_solves import set_shared_factor

            self._shared = set_shared_factor(destroyed_at_exit(self.ksp), traits.fields or traits.dimension)
            return
        shifts = traits.symmetric or traits.definite
        with_rows = (self.overlap, traits.symmetric)
        self._given = set_preconditioner(self.ksp, self.kind, levels, self.exchanges, self.blocks, shifts, *with_rows)

    def _forget_options(self) -> None:
        """Take out of PETSc's database what was put there for a set-up: it is not what the user said."""
        options = PETSc.Options(self.ksp.getOptionsPrefix() or "")
        for key in self._given:
            options.delValue(key)
        self._given = []
