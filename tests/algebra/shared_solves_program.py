"""Run by mpiexec: factors in blocks of nodes that ranks share, and cloth whose equations they share; prints JSON."""

import json
import tracemalloc

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc

from restshape.algebra.factors.shared_factor import SharedFactor
from restshape.algebra.factors.shared_solves import set_shared_factor
from restshape.algebra.linear import LinearSolver
from restshape.algebra.reuse.traits import Traits
from restshape.algebra.stages import Stages
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem

WORLD = PETSc.COMM_WORLD
SHIFT = 30.0


def grid(side: int, fields: int = 3) -> sp.csr_matrix:
    """A diagonally dominant matrix of a square of nodes with some unknowns each."""
    chain, step = sp.diags([1, 1, 1], [-1, 0, 1], (side, side)), sp.diags([1, 1], [-1, 1], (side, side))
    graph = sp.kron(sp.identity(side), chain) + sp.kron(step, sp.identity(side))
    blocks = sp.kron(graph, np.ones((fields, fields))).tocoo()
    values = np.random.default_rng(0).uniform(-1.0, 1.0, blocks.nnz)
    half = sp.csr_matrix((values, (blocks.row, blocks.col)), blocks.shape)
    whole = (half + half.T + SHIFT * sp.identity(fields * side * side)).tocsr()
    whole.sort_indices()
    return whole


def shared(whole: sp.csr_matrix, fields: int = 3) -> PETSc.Mat:
    """The matrix, of which each rank has some nodes' rows, the last one none."""
    nodes, ranks = whole.shape[0] // fields, WORLD.size
    cuts = [fields * (nodes * rank // (ranks - 1)) for rank in range(ranks)] + [fields * nodes]
    first, last = cuts[WORLD.rank], cuts[WORLD.rank + 1]
    own = whole[first:last]
    size = (last - first, whole.shape[0])
    return PETSc.Mat().createAIJ((size, size), csr=(own.indptr, own.indices, own.data), comm=WORLD)


def factored(whole: sp.csr_matrix, fields: int = 3) -> dict[str, object]:
    """Pivots below zero beside LAPACK's eigenvalues, the residual of a solve, and whether a second one has its bits."""
    mat, found = shared(whole, fields), []
    b = mat.createVecLeft()
    b.setArray(np.random.default_rng(WORLD.rank).uniform(-1.0, 1.0, b.getLocalSize()))
    for _ in range(2):
        factor, x, left = SharedFactor(fields), b.duplicate(), b.duplicate()
        below = factor.make(mat, mat, 0.0)
        factor.solve(b, x)
        mat.mult(x, left)
        left.axpy(-1.0, b)
        found.append(x.getArray().tobytes())
        factor.forget()
    same = all(WORLD.tompi4py().allgather(found[0] == found[1]))
    expected = int((np.linalg.eigvalsh(whole.toarray()) < 0.0).sum())
    return {"below": below, "expected": expected, "left": left.norm() / b.norm(), "same": same}


def preconditioned(whole: sp.csr_matrix) -> list[int]:
    """Iterations of CG by the factor of a matrix, of one on a wider pattern, and of one that has none."""
    ksp, taken = PETSc.KSP().create(WORLD), []
    ksp.setType("cg")
    ksp.setTolerances(rtol=1e-10)
    set_shared_factor(ksp, 3)
    for one in (whole, whole @ whole, 0.0 * whole):
        one.sort_indices()
        mat = shared(one)
        b = mat.createVecLeft()
        b.set(1.0)
        x = b.duplicate()
        ksp.setOperators(mat)
        ksp.solve(b, x)
        taken.append(ksp.getIterationNumber() if ksp.getConvergedReason() > 0 else -1)
    ksp.destroy()
    return taken


def believed() -> dict[str, list[bool]]:
    """Whether chains are definite, by the solver and by the pivots of the ranks' own rows: Laplace's, less a shift."""
    nodes, size, traits = 30, 90, Traits(fields=3, dimension=2)
    found = {}
    for name, part in (("definite", 0.5), ("indefinite", 1.5)):
        shift = part * 4.0 * np.sin(0.5 * np.pi / (nodes + 1)) ** 2
        chain = sp.diags([-1.0, 2.0 - shift, -1.0], [-1, 0, 1], (nodes, nodes))
        mat = shared(sp.kron(chain, sp.identity(3)).tocsr() + 0.0 * sp.identity(size, format="csr"))
        mat.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        solver = LinearSolver(WORLD, f"{name}_", "stale", 1e-9, Calibration.load(), Stages(), traits=traits)
        whole = solver.definite(mat, None, True)
        found[name] = [whole, solver.negative_pivots() == 0]
    return found


def by_panels(whole: sp.csr_matrix) -> list[float]:
    """What solves leave of the right side: by rows of the factor, by its panels in single and in double precision."""
    mat, left = shared(whole), []
    b = mat.createVecLeft()
    b.set(1.0)
    factor, x, rest = SharedFactor(3), b.duplicate(), b.duplicate()
    factor.make(mat, mat, 0.0)
    for single in (None, True, False):
        if single is not None:
            factor.substitute_by_panels(single)
        factor.solve(b, x)
        mat.mult(x, rest)
        rest.axpy(-1.0, b)
        left.append(rest.norm() / b.norm())
    factor.forget()
    return left


def held() -> list[float]:
    """What a factor of a long strip holds of numpy's memory, and the most that it takes, over the rank's entries."""
    long, across = (sp.diags([1, 1, 1], [-1, 0, 1], (count, count)) for count in (400, 6))
    whole = (sp.kron(sp.kron(long, across), np.ones((3, 3))) + SHIFT * sp.identity(7200)).tocsr()
    whole.sort_indices()
    mat = shared(whole)
    own = max(8.0 * mat.getInfo(PETSc.Mat.InfoType.LOCAL)["nz_used"], 8.0)
    factor = SharedFactor(3)
    factor.make(mat, mat, 0.0)
    factor.forget()
    tracemalloc.start()
    factor.make(mat, mat, 0.0)
    now, most = (size / own for size in tracemalloc.get_traced_memory())
    factor.make(mat, mat, 0.0)
    again = tracemalloc.get_traced_memory()[1] / own
    tracemalloc.stop()
    factor.forget()
    return [now, most, again]


def chosen() -> dict[str, object]:
    """What `auto` takes for Laplace's matrix of 8,100 nodes of two unknowns, and how it goes on with an old factor."""
    side, taken = 90, []
    chain = sp.diags([-1.0, 2.0, -1.0], [-1, 0, 1], (side, side))
    graph = sp.kron(sp.identity(side), chain) + sp.kron(chain, sp.identity(side))
    whole = sp.kron(graph, np.array([[2.0, 0.5], [0.5, 1.0]])).tocsr()
    whole.sort_indices()
    solver = LinearSolver(WORLD, "chosen_", "auto", 1e-8, Calibration.load(), Stages(), traits=Traits())
    for share in (1.0, 1.0, 1.02):
        mat = shared(share * whole + 1e-2 * (share - 1.0) * sp.identity(whole.shape[0]), 2)
        b = mat.createVecLeft()
        b.set(1.0)
        x, rest = b.duplicate(), b.duplicate()
        report = solver.solve(mat, b, x, new_system=not taken)
        mat.mult(x, rest)
        rest.axpy(-1.0, b)
        taken.append((report.iterations, report.refreshed, rest.norm() / b.norm()))
    loose = whole.copy()
    loose[:2], loose[:, :2] = 0.0, 0.0
    try:
        solver.solve(shared(loose, 2), b, x, new_system=True)
        why = ""
    except ReplayProblem as problem:
        why = str(problem)
    x.set(0.0)
    taken.append((solver.solve(mat, b, x, new_system=True).iterations, why, 0.0))
    name, negative = solver.name, solver.negative_pivots()
    definite = [solver.definite(shared(part * whole, 2), None) for part in (1.0, -1.0)]
    return {"name": name, "taken": taken, "negative": negative, "definite": definite}


def main() -> None:
    """Print all cases."""
    whole = grid(9)
    indefinite = (whole - SHIFT * sp.identity(whole.shape[0])).tocsr()
    indefinite.sort_indices()
    cases = {"definite": factored(whole), "indefinite": factored(indefinite), "taken": preconditioned(whole)}
    single = (grid(9, 1) - 0.5 * SHIFT * sp.diags(np.arange(81.0) % 3, format="csr")).tocsr()
    single.sort_indices()
    cases["single"] = factored(single, 1)
    cases |= {"believed": believed(), "panels": by_panels(whole), "chosen": chosen()}
    cases["held"] = WORLD.tompi4py().allgather(held())
    if WORLD.rank == 0:
        print(json.dumps(cases))


main()
