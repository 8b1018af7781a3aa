"""A linear problem of which some cells alone change: their unknowns are solved for, those of the rest follow."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import cast

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc

from restshape.algebra.factors.condensation import Condensation
from restshape.algebra.linear import LinearSolver
from restshape.algebra.linear_report import LinearReport, true_residual
from restshape.algebra.operator import Block, CellSubset, MatrixTerm, Operator
from restshape.analysis.guess import Guess
from restshape.analysis.static.border_quantities import BorderQuantities
from restshape.fem.integral import Integral
from restshape.fem.observer import Function, Observer
from restshape.fem.problem import INTERNAL, SteadyProblem

TIGHTER = 1e-2
"""Residuals of the part over those that a solve of the whole would leave: its iterations are cheap, and noise in the
border's unknowns would make each frame's way of the border a new one."""
LEFT_OUT = 0.9
"""Part of the residual that is allowed, which the unknowns of the rest may have."""


class ChangingPart:
    """Which entities and unknowns belong to the cells that change; all else stays, and so do the border's nodes.

    Args:
        blocks: of the problem, the cells first.
        mask: (n, f) uint8, 1 where an unknown is prescribed.
        cells: (k,) that change.

    Attributes:
        nodes: (m,) rows of the unknowns of these cells, ascending.
        entities: of each block those that change; fixed: those that do not.
        geometry, dofs: of those that change, the nodes of X, and rows among `nodes`, int32.
        local: (n,) rows of unknowns in `nodes`, -1 where they are of the rest; place: in that, of those that are.
        border: free unknowns of `nodes` that cells have that stay, among the m f; rest: all others of all n f.
    """

    def __init__(self, blocks: Sequence[Block], mask: np.ndarray, cells: np.ndarray) -> None:
        pairs = [block if isinstance(block, tuple) else (block, block) for block in blocks]
        (places, rows), (n, fields) = pairs[0], mask.shape
        changes = np.zeros(len(places), dtype=bool)
        changes[cells] = True
        touched, shared = np.zeros(n, dtype=bool), np.zeros(n, dtype=bool)
        touched[rows[cells]], shared[rows[~changes]] = True, True
        moving = np.zeros(int(places.max()) + 1, dtype=bool)
        moving[places[cells]] = True
        moving[places[~changes]] = False
        others = [moving[np.minimum(k, len(moving) - 1)].any(axis=1) for k, _ in pairs[1:]]
        chosen = [changes, *others]
        self.nodes = np.flatnonzero(touched)
        self.entities = [np.flatnonzero(one).astype(np.int32) for one in chosen]
        self.fixed = [np.flatnonzero(~one).astype(np.int32) for one in chosen]
        self._pairs = pairs
        self.local = np.full(n, -1, dtype=np.int32)
        self.local[self.nodes] = np.arange(len(self.nodes))
        self.geometry = [np.ascontiguousarray(k[e], dtype=np.int32) for (k, _), e in zip(pairs, self.entities)]
        self.dofs = [np.ascontiguousarray(self.local[k[e]]) for (_, k), e in zip(pairs, self.entities)]
        free = mask == 0
        own = free[self.nodes] & shared[self.nodes][:, None]
        self.border = np.flatnonzero(own)
        self.place = np.cumsum(~touched) - 1
        self.rest = np.flatnonzero(np.repeat(~touched, fields))
        self.border_rows = (self.nodes[:, None] * fields + np.arange(fields)).ravel()[self.border]
        self.border_nodes = np.unique(self.border // fields).astype(np.int32)

    def follow(self, changed: np.ndarray) -> np.ndarray | None:
        """Take in which cells (k,) flips have changed; their numbers here, None where one of them was to stay."""
        found = np.searchsorted(self.entities[0], changed)
        if (found == len(self.entities[0])).any() or (self.entities[0][found] != changed).any():
            return None
        (places, rows), entities = self._pairs[0], self.entities[0][found]
        self.geometry[0][found], self.dofs[0][found] = places[entities], self.local[rows[entities]]
        return found.astype(np.int32)


# More than 15 attributes: a linear system of its own, and the one that it is condensed from.
class Substructure:
    """The system of the part of a problem that changes, with the rest condensed onto its border.

    Args:
        problem: linear, symmetric and definite.
        whole: the operator of all of it, whose values are overwritten.
        cells: (k,) that change; all others stay as they are.
        backend: of operators.
        solver: of its own.
        guess: from its solutions.

    Raises:
        ReplayProblem: what stays has no factor.

    Source: docs/theory/substructures.md.
    """

    def __init__(
        self,
        problem: SteadyProblem,
        whole: Operator,
        cells: np.ndarray,
        backend: str | None,
        solver: LinearSolver,
        guess: Guess,
    ) -> None:
        self.problem, self.solver, self.guess = problem, solver, guess
        values, mask = problem.boundary.values, problem.boundary.mask
        self.part = part = ChangingPart(problem.blocks(), mask, cells)
        self._fixed_right = np.zeros(mask.shape)
        self._kept_parameters = [_rows(one.parameters, part.fixed[one.block or 0]) for one in self._integrals()]
        self._rest = self._condense(whole, values)
        self.operator = self._reduced_operator(mask, backend)
        count = len(part.nodes) * mask.shape[1]
        self._right, self._found = np.zeros(count), np.zeros(count)
        self._b, self._solution = (
            PETSc.Vec().createWithArray(array, size=(count, count), comm=whole.comm)
            for array in (self._right, self._found)
        )
        self._some, self._free = np.zeros(mask.shape), mask.ravel()[part.rest] == 0
        self._quantities: tuple[BorderQuantities | None, object] = (None, None)
        self._new, self._patched, self._norm = True, False, 0.0
        self.scale: float | None = None
        self._loads = self._force = self._alone = self._taken = np.empty(0)
        self._force_size = 0.0

    @property
    def tolerance(self) -> float:
        """That solutions meet."""
        return self.solver.tolerance

    def _integrals(self) -> list[Integral]:
        return list(self.problem.integrals(INTERNAL))

    def _condense(self, whole: Operator, values: np.ndarray) -> Condensation:
        """Assemble the cells that stay, and condense them."""
        part = self.part
        terms = self._terms(values, part.fixed, lambda block, some: CellSubset(block, some))
        mat = whole.assemble(terms, self._fixed_right.ravel())
        first, columns, entries = mat.getValuesCSR()
        order = np.concatenate([part.rest, part.border_rows])
        chosen = sp.csr_matrix((entries, columns, first), shape=mat.getSize())[order][:, order]
        return Condensation(sp.csr_matrix(chosen), len(part.border), values.shape[1])

    def _terms(
        self, x: np.ndarray, some: list[np.ndarray], block_of: Callable[[int, np.ndarray], int | CellSubset]
    ) -> list[MatrixTerm]:
        """The integrals over some entities of each block, at unknowns x (n, f) of the operator."""
        terms = []
        for integral in self._integrals():
            block, element, X, _, parameters, *rest = integral.term(x)
            chosen = some[cast(int, block)]
            if len(chosen):
                of = block_of(cast(int, block), chosen)
                terms.append(cast(MatrixTerm, (of, element, X, x, _rows(parameters, chosen), *rest)))
        return terms

    def _reduced_operator(self, mask: np.ndarray, backend: str | None) -> Operator:
        part, traits = self.part, self.solver.traits
        known = {"symmetric": traits.symmetric, "definite": traits.definite}
        offsets = np.array([0, len(part.nodes)], dtype=np.int32)
        operator = Operator(self.solver.comm, mask.shape[1], offsets, backend, **known)
        # What is condensed couples all nodes of the border.
        border = part.border_nodes[None]
        blocks: list[Block] = [*zip(part.geometry, part.dofs), *([border] if border.size else [])]
        operator.set_topology(blocks, mask[part.nodes])
        self._keep(operator)
        return operator

    def _keep(self, operator: Operator) -> None:
        """Have all later matrices start from the complement of the border."""
        border, core = self.part.border.astype(PETSc.IntType), operator.core
        core.begin()
        mat = core.mat
        if len(border):
            mat.setValues(border, border, self._rest.complement.ravel(), addv=PETSc.InsertMode.ADD_VALUES)
        mat.assemble()
        core.keep()
        core.end()

    def values_stay(self) -> bool:
        """Whether the values of the cells that stay are what they were, after a look at where the nodes are now."""
        if not self.problem.varies:
            return True
        self.problem.update()
        found = zip(self._integrals(), self._kept_parameters)
        return all(np.array_equal(_rows(one.parameters, self.part.fixed[one.block or 0]), kept) for one, kept in found)

    def flip(self, changed: np.ndarray) -> bool:
        """Follow flips of cells (k,); whether all of them are among those that change."""
        own = self.part.follow(changed)
        if own is None:
            return False
        self.operator.patch(0, own)
        self._keep(self.operator)
        self.solver.flip(self.part.dofs[0][own])
        self._patched = True
        return True

    def solve(
        self,
        x: np.ndarray | None,
        right: np.ndarray,
        hand: tuple[object, tuple[float, float]],
        scale: float | None,
    ) -> LinearReport:
        """Solve for the unknowns of the part that changes.

        Args:
            x: (n, f) unknowns to begin with; None: those of the last solve.
            right: (n, f) dead loads, 0 where prescribed.
            hand: the gesture, and the place of the hand in its coordinates.
            scale: what residuals are measured against; None: the norm of the right side of the whole.

        Raises:
            ReplayProblem: the solve does not converge.
        """
        part, prescribed = self.part, self.problem.boundary.values
        values = prescribed[part.nodes]
        with self.solver.stages("values"):
            mat = self._assemble(right, values)
        self.scale = scale
        guess = self.guess(values + self._found.reshape(values.shape) if x is None else x[part.nodes], hand)
        np.subtract(guess, values, out=self._found.reshape(values.shape))
        self._found[self.problem.boundary.mask[part.nodes].ravel() != 0] = 0.0
        if self._norm == 0.0:
            self._found[:] = 0.0
        self._b.stateIncrease()
        self._solution.stateIncrease()
        report = self.solver.solve(
            mat,
            self._b,
            self._solution,
            self._new,
            patched=self._patched,
            places=self._places(),
            scale=TIGHTER * (self.scale or self._norm) or None,
        )
        self._new = self._patched = False
        self.guess.keep(values + self._found.reshape(values.shape), hand)
        return report

    def _places(self) -> np.ndarray | None:
        """The nodes [m], where rigid motions are what coarse grids must know."""
        return self.problem.space.dof_X[self.part.nodes] if self.solver.traits.rigid_motions else None

    def _assemble(self, right: np.ndarray, values: np.ndarray) -> PETSc.Mat:
        """The matrix, and the right side less what the rest takes; sets the norm that the whole one has."""
        part = self.part
        if not np.array_equal(right, self._loads):
            self._take_loads(right)
        own = right[part.nodes] + self._fixed_right[part.nodes]
        terms = self._terms(values, part.entities, lambda block, some: block)
        mat = self.operator.assemble(terms, own.ravel(), kept=True)
        self._right[:] = own.ravel()
        self._norm = float(np.hypot(self._force_size, np.linalg.norm(self._right)))
        self._right[part.border] -= self._taken
        return mat

    def _take_loads(self, right: np.ndarray) -> None:
        """Find what the rest does under other dead loads (n, f); often those of the moving part alone have changed."""
        self._loads = right.copy()
        force = (right.ravel() + self._fixed_right.ravel())[self.part.rest]
        if not np.array_equal(force, self._force):
            self._force, self._alone = force, self._rest.alone(force)
            self._taken = self._rest.on_border(self._alone)
            self._force_size = float(np.linalg.norm(force))

    def unknowns(self) -> Callable[[], np.ndarray]:
        """What recovers the unknowns (n, f) of all, of the last solve; the rest of them is found when it is called."""
        part, rest, allowed = self.part, self._rest, self._allowed
        prescribed, found, alone = self.problem.boundary.values.copy(), self._found.copy(), self._alone

        def recover() -> np.ndarray:
            x = prescribed
            x[part.nodes] += found.reshape(-1, x.shape[1])
            x.ravel()[part.rest] += alone + rest.following(found[part.border], allowed)
            return x

        return recover

    def stays(self) -> np.ndarray:
        """Which nodes (n,) have cells alone that stay, or are on the border."""
        stays = self.part.local < 0
        stays[self.part.nodes[self.part.border_nodes]] = True
        return stays

    def at_border(self) -> np.ndarray:
        """The free unknowns (m,) of the border at the last solve, less what is prescribed."""
        return self._found[self.part.border]

    def seen_from_border(self, load: np.ndarray) -> np.ndarray:
        """The vector (m,) whose product with the border's unknowns is that of `load` (n, f) with all that follow."""
        inside = self._rest.alone(load.ravel()[self.part.rest] * self._free)
        return np.asarray(load.ravel()[self.part.border_rows] - self._rest.on_border(inside))

    def observe(self, functions: Mapping[str, Function], whole: Callable[[], np.ndarray]) -> dict[str, float]:
        """Values of quantities at the last solve.

        Args:
            functions: by name.
            whole: gives the unknowns (n, f) of all.
        """
        known, alone = self._quantities
        if known is None or known.functions is not functions or alone is not self._alone:
            known = BorderQuantities(self, whole, functions)
            self._quantities = known, self._alone
        found = known(self)
        others = Observer({name: one for name, one in functions.items() if name not in found})
        nodes = others.reads
        found |= others(whole() if nodes is None else self.at(nodes))
        return {name: found[name] for name in functions}

    def at(self, nodes: np.ndarray) -> np.ndarray:
        """Unknowns (n, f) of the last solve that hold at nodes (k,) alone, at others anything; not to be kept."""
        part, x, found = self.part, self._some, self._found.reshape(-1, self._some.shape[1])
        prescribed, local = self.problem.boundary.values, part.local[nodes]
        near, far = nodes[local >= 0], nodes[local < 0]
        x[near] = prescribed[near] + found[local[local >= 0]]
        if not len(far):
            return x
        rows = (part.place[far][:, None] * x.shape[1] + np.arange(x.shape[1])).ravel()
        follows = self._rest.following(self._found[part.border], self._allowed, rows) + self._alone[rows]
        x[far] = prescribed[far] + follows.reshape(-1, x.shape[1])
        return x

    @property
    def _allowed(self) -> float:
        """The norm of the residual that the unknowns of the rest may have."""
        return LEFT_OUT * self.tolerance * (self.scale or self._norm)

    def residual(self) -> float:
        """The true residual of the last solve over the right side, that of the rest included."""
        scale, left = self.scale or self._norm, self._rest.left(self._found[self.part.border])
        own = true_residual(self.operator.mat, self._b, self._solution, scale or None)
        return float(np.hypot(own, left / scale)) if scale and left <= self._allowed else own


def _rows(parameters: np.ndarray, some: np.ndarray) -> np.ndarray:
    """Parameters (p,), the same everywhere, or those of some entities (k, p)."""
    return parameters if parameters.ndim == 1 else np.ascontiguousarray(parameters[some])
