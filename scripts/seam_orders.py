"""Seams in the linear systems of cloth: ILU(0) by the order of nodes, and Lagrange multipliers instead of springs.

OMP_NUM_THREADS=1 python scripts/seam_orders.py [SCENE]

The tangents of implicit steps of a sewn scene at rest, by default of the skirt of two panels, for two time steps and
three stiffnesses of seams, those of the scene times 1, 100 and 1e4. Iterations of CG, and of GMRES where CG's
preconditioner is not definite, with ILU(0) to 1e-8 of the right side, the weight: emitting nodes (the side `from`),
receiving ones (`to`) and others in this order, as the thesis has it (5.3.2), the mesh's own order, and their reverses.
Then the same steps with a multiplier for each spring and direction: unknowns, negative pivots, time of a factor
and a solve in ms, the least of several, and iterations of GMRES with ILU(0), multipliers last.
"""

import sys
import time

import numpy as np
from petsc4py import PETSc
from scipy.sparse import bmat, coo_matrix, csr_matrix

from restshape.application import application
from restshape.interface.first_frame import first_frame
from restshape.physics.cloth.cloth_problem import ClothProblem

STEPS, TIMES = (5e-3, 40e-3), (1.0, 1e2, 1e4)
ROUNDS, MOST, TOLERANCE = 5, 2000, 1e-8


def nodes_in_order(problem: ClothProblem) -> dict[str, np.ndarray]:
    """Orders of the nodes, by name."""
    n = problem.n_nodes
    sides = [
        np.concatenate([getattr(pair, side).nodes for pair in problem.seams.pairs]) for side in ("first", "second")
    ]
    emitting, receiving = (np.unique(problem.corner_number[nodes]) for nodes in sides)
    first = np.concatenate([emitting, np.setdiff1d(receiving, emitting)])
    rest = np.setdiff1d(np.arange(n), first)
    natural = np.arange(n)
    return {
        "emitting, receiving, other": np.concatenate([first, rest]),
        "natural": natural,
        "reversed": natural[::-1],
        "other, receiving, emitting": np.concatenate([first, rest])[::-1],
    }


def sparse(matrix: PETSc.Mat) -> csr_matrix:
    """The matrix as scipy has it."""
    start, columns, values = matrix.convert("aij", PETSc.Mat()).getValuesCSR()
    return csr_matrix((values, columns, start), shape=matrix.getSize())


def iterations(A: csr_matrix, b: np.ndarray, kind: str = "cg") -> str:
    """Iterations of a Krylov method with ILU(0), or why it ended."""
    matrix = PETSc.Mat().createAIJ(A.shape, csr=(A.indptr, A.indices, A.data), comm=PETSc.COMM_SELF)
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setOperators(matrix)
    ksp.setType(kind)
    ksp.getPC().setType("ilu")
    ksp.getPC().setFactorOrdering("natural")
    ksp.getPC().setFactorShift(PETSc.Mat.FactorShiftType.NONZERO, 1e-10)
    ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED if kind == "cg" else PETSc.KSP.NormType.PRECONDITIONED)
    if kind == "fgmres":
        ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        ksp.setGMRESRestart(200)
    ksp.setTolerances(rtol=TOLERANCE, max_it=MOST)
    right, x = matrix.createVecLeft(), matrix.createVecRight()
    right.setArray(b)
    ksp.solve(right, x)
    if ksp.getConvergedReason() > 0:
        return str(ksp.getIterationNumber()) + (" (GMRES)" if kind == "fgmres" else "")
    if kind == "cg" and ksp.getConvergedReason() in (-8, -10):
        return iterations(A, b, "fgmres")
    return f"over {MOST}" if ksp.getConvergedReason() == -3 else "breaks down"


def complete(A: csr_matrix, b: np.ndarray, kind: str) -> tuple[float, str]:
    """Time of a complete factor and a solve [ms], the least of several, and its negative pivots."""
    least, negative = np.inf, ""
    for _ in range(ROUNDS):
        matrix = PETSc.Mat().createAIJ(A.shape, csr=(A.indptr, A.indices, A.data), comm=PETSc.COMM_SELF)
        matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        ksp = PETSc.KSP().create(PETSc.COMM_SELF)
        ksp.setOperators(matrix)
        ksp.setType("preonly")
        ksp.getPC().setType(kind)
        ksp.getPC().setFactorSolverType("mumps")
        right, x = matrix.createVecLeft(), matrix.createVecRight()
        right.setArray(b)
        begin = time.perf_counter()
        ksp.setUp()
        ksp.solve(right, x)
        least = min(least, 1e3 * (time.perf_counter() - begin))
        negative = str(ksp.getPC().getFactorMatrix().getMumpsInfog(12))
    return least, negative


def constraints(problem: ClothProblem) -> csr_matrix:
    """What multipliers hold at 0: the distance across each spring, in each direction."""
    seams = problem.seams
    t, dofs = seams.shares_of_edges, seams.dofs
    rows = np.repeat(np.arange(len(dofs)), 3)
    values = np.column_stack([np.ones_like(t), t - 1.0, -t]).ravel()
    single = coo_matrix((values, (rows, dofs.ravel())), shape=(len(dofs), problem.n_nodes))
    free = problem.boundary.free.ravel()
    return csr_matrix(coo_matrix(np.kron(single.toarray(), np.eye(3)) * free))


def main() -> None:
    """Print both tables."""
    scene = sys.argv[1] if len(sys.argv) > 1 else application("couture").folder / "scenes" / "sewn_skirt.toml"
    analysis = first_frame(scene, ["effects.cloth.bending=hinge"]).analysis
    problem, x, equations = analysis.problem, analysis.x, analysis.state.solver.equations
    b = (problem.lumped.mass[:, None] * problem.g * problem.boundary.free).ravel()
    orders = {name: (3 * nodes[:, None] + np.arange(3)).ravel() for name, nodes in nodes_in_order(problem).items()}
    print(f"{len(b)} unknowns, {len(problem.seams.nodes)} springs; iterations with ILU(0)")
    print(f"{'time step':>9} {'stiffness':>9}  " + "  ".join(f"{name:>26}" for name in orders))
    for step in STEPS:
        for times in TIMES:
            problem.pull_seams(times)
            A = sparse(equations.step_matrix(x, 1.0 / step**2, False))
            found = [iterations(A[order][:, order].tocsr(), b[order]) for order in orders.values()]
            print(f"{1e3 * step:6.0f} ms {times:9.0e}  " + "  ".join(f"{one:>26}" for one in found))
    print("\nsprings and multipliers, complete factors")
    print(f"{'time step':>9}  {'':>11} {'unknowns':>8} {'negative':>8} {'factor and solve':>16}  GMRES, ILU(0)")
    B = constraints(problem)
    for step in STEPS:
        problem.pull_seams(1.0)
        sewn = sparse(equations.step_matrix(x, 1.0 / step**2, False))
        problem.pull_seams(0.0)
        loose = sparse(equations.step_matrix(x, 1.0 / step**2, False))
        first = orders["emitting, receiving, other"]
        both = csr_matrix(bmat([[loose[first][:, first], B[:, first].T], [B[:, first], None]]))
        both.setdiag(both.diagonal())
        right = np.concatenate([b[first], np.zeros(B.shape[0])])
        for name, A, c, kind in (("springs", sewn, b, "cholesky"), ("multipliers", both, right, "cholesky")):
            taken, negative = complete(A, c, kind)
            inner = iterations(
                A if name != "springs" else A[first][:, first].tocsr(), c if name != "springs" else b[first], "fgmres"
            )
            print(f"{1e3 * step:6.0f} ms  {name:>11} {len(c):8d} {negative:>8} {taken:13.1f} ms  {inner}")


if __name__ == "__main__":
    main()
