"""Eigensolvers of SLEPc as rivals of the one in use: the same frames, the same starts, the same kept factors."""

from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from restshape.algebra.eigenproblems.davidson import Found
from restshape.algebra.eigenproblems.krylov_schur import KeptFactor, krylov_schur, refine_ritz
from restshape.algebra.eigenproblems.pencil import Deflation, Pencil
from restshape.errors import ReplayProblem

MOST = 200
"""Iterations after which a rival is given up."""

FEW = 4
"""Vectors of Krylov-Schur's basis beyond the wanted ones: a start by the last modes needs few."""


@dataclass
class Frame:
    """One eigenproblem, and what the rivals may know before it.

    Args:
        near: K, M, and a factor of K - s M of some frame ago, s above the wanted eigenvalues.
        definite: the same with s a little below 0, of the same frame.
        deflation: the rigid motions.
        count: eigenpairs that are wanted.
        spare: more of them that may be carried along.
        tolerance: of |K phi - lambda M phi| relative to |lambda M phi|.
    """

    near: Pencil
    definite: Pencil
    deflation: Deflation
    count: int
    spare: int
    tolerance: float


class Rival:
    """One of SLEPc's solvers, from frame to frame.

    Args:
        name: for people.
        kind: of `SLEPc.EPS`.
        definite: its preconditioner is a positive definite one.
        frames: whose modes it starts with.

    Attributes:
        history: modes of the last frames, the newest first.
        substitutions: with a factor in the last frame; iterations: as SLEPc counts them.
    """

    def __init__(self, name: str, kind: str, definite: bool = False, frames: int = 1) -> None:
        self.name, self.kind, self.definite, self.frames = name, kind, definite, frames
        self.history: list[np.ndarray] = []
        self.substitutions = self.iterations = 0

    def solve(self, frame: Frame) -> Found:
        """The lowest eigenpairs.

        Raises:
            ReplayProblem: it does not converge.
        """
        pencil = frame.definite if self.definite else frame.near
        before = pencil.substitutions
        found = self._solve(frame, pencil)
        self.substitutions = pencil.substitutions - before
        self.history = [found.modes, *self.history[: self.frames - 1]]
        return found

    def _solve(self, frame: Frame, pencil: Pencil) -> Found:
        from slepc4py import SLEPc

        eps = SLEPc.EPS().create(PETSc.COMM_SELF)
        eps.setOperators(pencil.stiffness, pencil.mass)
        eps.setProblemType(SLEPc.EPS.ProblemType.GHEP)
        eps.setType(self.kind)
        eps.setWhichEigenpairs(SLEPc.EPS.Which.SMALLEST_REAL)
        transform = eps.getST()
        transform.setType(SLEPc.ST.Type.PRECOND)
        inner = transform.getKSP()
        # GD and LOBPCG apply the preconditioner; JD solves its correction equation with it.
        inner.setType("bcgsl" if self.kind == SLEPc.EPS.Type.JD else "preonly")
        inner.getPC().setType(PETSc.PC.Type.PYTHON)
        inner.getPC().setPythonContext(KeptFactor(pencil))
        starts = [*self.history[0], *(row for block in self.history[1:] for row in block[: frame.count])]
        if self.kind == SLEPc.EPS.Type.GD:
            eps.setGDInitialSize(len(starts))
        deflated, first = _vectors(frame.deflation.rigid), _vectors(starts)
        eps.setDeflationSpace(deflated)
        eps.setInitialSpace(first)
        wanted = frame.count
        eps.setDimensions(wanted, max(2 * wanted + 16, len(starts) + 2 * wanted + 16))
        if self.kind == SLEPc.EPS.Type.LOBPCG:
            wanted = frame.count + frame.spare
            eps.setDimensions(wanted)
            eps.setLOBPCGBlockSize(wanted)
        # SLEPc measures |K phi - lambda M phi| / |lambda|: LOBPCG of modes of unit mass, the others of unit length.
        weight = _weight(pencil, self.history[0][: frame.count], self.kind == SLEPc.EPS.Type.LOBPCG)
        eps.setTolerances(frame.tolerance * weight, MOST)
        eps.solve()
        self.iterations = eps.getIterationNumber()
        taken = min(eps.getConverged(), frame.count + frame.spare)
        modes, vector = np.empty((taken, pencil.size)), pencil.stiffness.createVecRight()
        for k in range(taken):
            eps.getEigenpair(k, vector)
            modes[k] = vector.getArray()
        for part in (vector, *deflated, *first, eps):
            part.destroy()
        if taken < frame.count:
            raise ReplayProblem(f"{taken} of {frame.count} modes in {self.iterations} iterations")
        return refine_ritz(pencil, frame.deflation, modes, frame.count, frame.tolerance, self.iterations)


class KrylovSchur(Rival):
    """SLEPc's Krylov-Schur with shift-and-invert: a factor of each frame's own matrices, started by the last modes.

    Args:
        blocks: the factor is made in blocks of a node, as fast as any here; it counts nothing, and need not.
    """

    def __init__(self, blocks: bool = False) -> None:
        super().__init__(f"Krylov-Schur{', factor in blocks' * blocks}", "krylovschur", definite=True)
        self.own: Pencil | None = None
        self.blocks = blocks

    def _solve(self, frame: Frame, pencil: Pencil) -> Found:
        if self.own is None or not self.own.ready or self.own.size != pencil.size:
            self.own = Pencil(pencil.stages, self.blocks)
        own, before = self.own, self.own.substitutions
        own.set_matrices(pencil.stiffness, pencil.mass, False)
        own.factor(pencil.shift)
        found = krylov_schur(own, frame.deflation, self.history[0].sum(axis=0), frame.count, frame.tolerance, FEW)
        pencil.substitutions += own.substitutions - before
        self.iterations = own.substitutions - before
        return found


def rivals() -> list[Rival]:
    """All of them, without a history yet."""
    return [
        KrylovSchur(),
        KrylovSchur(blocks=True),
        Rival("GD", "gd"),
        Rival("GD, modes of three frames", "gd", frames=3),
        Rival("JD", "jd"),
        Rival("LOBPCG", "lobpcg", definite=True),
    ]


def _vectors(rows: np.ndarray | list[np.ndarray]) -> list[PETSc.Vec]:
    return [PETSc.Vec().createWithArray(np.array(row), comm=PETSc.COMM_SELF) for row in rows]


def _weight(pencil: Pencil, modes: np.ndarray, dofs_with_mass: bool) -> float:
    """The least |M phi| of modes (k, n), or where these are not `dofs_with_mass`, |M phi| / |phi|."""
    mass_products = np.empty_like(modes)
    pencil.apply(pencil.mass, np.ascontiguousarray(modes), mass_products)
    sizes = np.linalg.norm(mass_products, axis=1)
    return float((sizes if dofs_with_mass else sizes / np.linalg.norm(modes, axis=1)).min())
