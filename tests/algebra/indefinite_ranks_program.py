"""Run by mpiexec: symmetric systems that are not definite, on several ranks; prints their residuals as JSON."""

import json

import numpy as np
from mesh.mesh_samples import SQUARE, polygon_outline
from petsc4py import PETSc
from stokes import Stokes, flow

from restshape.algebra.linear import LinearSolver
from restshape.algebra.reuse.traits import Traits
from restshape.algebra.stages import Stages
from restshape.analysis.static.linear_system import LinearSystem
from restshape.calibration import Calibration
from restshape.fem.assembled import Assembled
from restshape.fem.problem import INTERNAL
from restshape.fem.residuals import dead_loads, internal_norm, residual_norm
from restshape.mesh.generate import generate
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.scene.model import MeshSpec

WORLD = PETSc.COMM_WORLD
METHODS = ("direct", "stale", "auto")
ROWS, FREE = 10, 40


def solver(method: str, traits: Traits) -> LinearSolver:
    return LinearSolver(WORLD, f"ranks_{method}_", method, 1e-9, Calibration.load(), Stages(), traits=traits)


def saddle() -> np.ndarray:
    """A matrix whose first rows are constraints: their block, which is the first rank's own, is zero."""
    rng = np.random.default_rng(1)
    stiffness = np.diag(np.arange(1.0, FREE + 1)) + 0.1 * np.eye(FREE, k=1) + 0.1 * np.eye(FREE, k=-1)
    rows = rng.uniform(-1, 1, (ROWS, FREE))
    return np.block([[np.zeros((ROWS, ROWS)), rows], [rows.T, stiffness]])


def shared(full: np.ndarray) -> PETSc.Mat:
    """A dense array as a matrix of which the first rank has the constraints alone."""
    mine = ROWS if WORLD.rank == 0 else FREE if WORLD.rank == 1 else 0
    mat = PETSc.Mat().createAIJ(((mine, None), (mine, None)), nnz=(len(full), len(full)), comm=WORLD)
    first, last = mat.getOwnershipRange()
    mat.setValues(range(first, last), range(len(full)), full[first:last])
    mat.assemble()
    mat.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    return mat


def constrained(method: str) -> dict[str, object]:
    """Of a saddle with a singular block, and of one near to it with the factor of the first."""
    full, one = saddle(), solver(method, Traits(definite=False, fields=1))
    near = full.copy()
    near[ROWS:, ROWS:] *= 1.01
    found = {}
    for name, matrix, new in (("first", full, True), ("near", near, False)):
        mat = shared(matrix)
        b, x = mat.createVecLeft(), mat.createVecRight()
        b.array = np.arange(*b.getOwnershipRange()) % 7 - 3.0
        report = one.solve(mat, b, x, new)
        rest = b.duplicate()
        mat.mult(x, rest)
        rest.axpy(-1.0, b)
        found[name] = {"residual": rest.norm() / b.norm(), "iterations": report.iterations, "made": report.refreshed}
    return found


def stokes(method: str) -> dict[str, float]:
    """Of Taylor and Hood's flow: the residual at its unknowns, and their distance from the closed form."""
    mesh = generate(polygon_outline(SQUARE), MeshSpec(size=0.2), WORLD.size)
    problem = Stokes(None, None, LagrangeSpace(mesh))
    traits = problem.traits(None)
    system = LinearSystem(WORLD, problem, None, traits)
    dead_loads(problem, system.right)
    system.mat = Assembled(problem.integrals(INTERNAL), system.operator).system(problem.boundary.values, system.right)
    system.b.stateIncrease()
    report = solver(method, traits).solve(system.mat, system.b, system.solution, True)
    system.gather()
    x = system.full.reshape(-1, 1) + problem.boundary.values
    away = problem.space.values("velocity", x) - flow(problem.space.X)[0]
    residual = residual_norm(problem, x) / internal_norm(problem, x)
    return {"residual": residual, "iterations": report.iterations, "error": float(np.abs(away).max())}


def main() -> None:
    found = {method: {"saddle": constrained(method), "stokes": stokes(method)} for method in METHODS}
    if WORLD.rank == 0:
        print(json.dumps(found))


main()
