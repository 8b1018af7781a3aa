"""Run by mpiexec: eigenproblems whose rows ranks share; prints what each case comes to as JSON."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.eigenproblems.buckling_solver import BucklingSolver
from restshape.algebra.eigenproblems.eigen import EigenSolver
from restshape.algebra.factors import interior_factor, shared_factor
from restshape.algebra.factors.interior_factor import MumpsInterior, PlainInterior
from restshape.algebra.factors.shared_factor import SharedFactor
from restshape.algebra.stages import Stages
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem
from restshape.interface.first_frame import first_frame

WORLD = PETSc.COMM_WORLD
SCENES = Path(__file__).parents[1] / "scenes"
TWO_TRIANGLES = (
    'mesh.size="500 mm"',
    'shape.vertices.b=["30 mm", 0]',
    'shape.vertices.c=["30 mm", "30 mm"]',
    'mesh.mesher="gmsh"',
    "effects.modal.model=plate",
    "effects.modal.modes=2",
)


def shared(full: np.ndarray, sizes: list[int]) -> PETSc.Mat:
    """A dense array as a matrix on a full pattern, of which each rank has so many rows."""
    last = int(np.cumsum(sizes)[WORLD.rank])
    own, n = full[last - sizes[WORLD.rank] : last], len(full)
    indptr = np.arange(0, own.size + 1, n, dtype=np.int32)
    indices = np.tile(np.arange(n, dtype=np.int32), len(own))
    mat = PETSc.Mat().createAIJ(((len(own), n),) * 2, csr=(indptr, indices, own.ravel()), comm=WORLD)
    mat.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    return mat


def sparse(full: np.ndarray, also: np.ndarray, sizes: list[int]) -> PETSc.Mat:
    """A dense array as a matrix on its own pattern and that of another one."""
    last = int(np.cumsum(sizes)[WORLD.rank])
    first = last - sizes[WORLD.rank]
    there = (full != 0.0) | (also != 0.0)
    indptr = np.r_[0, np.cumsum(there[first:last].sum(axis=1))].astype(np.int32)
    indices = np.nonzero(there[first:last])[1].astype(np.int32)
    csr = (indptr, indices, full[first:last][there[first:last]])
    return PETSc.Mat().createAIJ(((last - first, len(full)),) * 2, csr=csr, comm=WORLD)


def grid(side: int) -> np.ndarray:
    """The Laplacian of a square of nodes, whose rows are numbered along it."""
    chain = 2.0 * np.eye(side) - np.eye(side, k=1) - np.eye(side, k=-1)
    return np.kron(np.eye(side), chain) + np.kron(chain, np.eye(side))


def chain(n: int) -> np.ndarray:
    """A free chain of unit springs."""
    inner = np.r_[1.0, np.full(n - 2, 2.0), 1.0]
    return np.diag(inner) - np.eye(n, k=1) - np.eye(n, k=-1)


def factored(K: np.ndarray, M: np.ndarray, sizes: list[int], shifts: tuple[float, ...]) -> dict[str, object]:
    """Counts below shifts beside LAPACK's, the largest error of a solve, and whether a second factor has the bits."""
    mats = [sparse(one, other, sizes) for one, other in ((K, M), (M, K))]
    factor, again, last = SharedFactor(), SharedFactor(), int(np.cumsum(sizes)[WORLD.rank])
    rows = np.random.default_rng(5).uniform(-1.0, 1.0, (3, len(K)))
    counts, expected, errors, same = [], [], [], True
    for shift in shifts:
        counts.append(factor.make(*mats, shift))
        expected.append(int(np.sum(np.linalg.eigvalsh(K - shift * M) < 0.0)))
        again.make(*mats, shift)
        for part in (rows, rows[:1]):
            own = np.ascontiguousarray(part[:, last - sizes[WORLD.rank] : last])
            found = factor.solve_rows(own)
            same = same and np.array_equal(found, again.solve_rows(own))
            whole = np.concatenate(WORLD.tompi4py().allgather(found), axis=1)
            errors.append(float(np.abs(whole @ (K - shift * M) - part).max()))
    factor.forget()
    return {"counts": counts, "expected": expected, "error": max(errors), "same": same}


def multiplied(K: np.ndarray, sizes: list[int]) -> float:
    """The largest error of products of a shared matrix with eleven rows, now and once its entries are others."""
    last, mat, errors = int(np.cumsum(sizes)[WORLD.rank]), sparse(K, K, sizes), []
    rows = np.random.default_rng(9).uniform(-1.0, 1.0, (11, len(K)))
    own = np.ascontiguousarray(rows[:, last - sizes[WORLD.rank] : last])
    for size in (1.0, 2.0):
        out = np.full_like(own, np.nan)
        assert _kernels.matrix_products(mat.handle, own, out)
        whole = np.concatenate(WORLD.tompi4py().allgather(out), axis=1)
        errors.append(float(np.abs(whole - size * rows @ K.T).max()))
        mat.scale(2.0)
    return max(errors)


def solved(method: str, K: np.ndarray, M: np.ndarray, rigid: np.ndarray, sizes: list[int]) -> dict[str, object]:
    """The lowest eigenvalues of a matrix, and of one near it from these modes."""
    solver, found = EigenSolver(method, 1e-10, Calibration.load(), Stages()), {}
    for name, size in (("first", 1.0), ("near", 1.01)):
        modes, report = solver.solve(shared(size * K, sizes), shared(M, sizes), rigid, 4, name == "first")
        found[name] = {"values": modes.values[:4].tolist(), "checked": report.inertia_checked}
    return found


def buckled(sizes: list[int]) -> list[float]:
    """The lowest load factors of a chain on springs that a load of either sign softens."""
    n = sum(sizes)
    K, G = chain(n) + np.eye(n), -np.diag(np.linspace(-1.0, 2.0, n))
    solver = BucklingSolver(True, True, 1e-10, Calibration.load(), Stages())
    found, _ = solver.solve(shared(K, sizes), shared(G, sizes), np.empty(0, dtype=int), 3, 50.0, True)
    values = np.linalg.eigvals(np.linalg.solve(K, -G)).real
    return [float(np.abs(found.values * -1.0 / np.sort(values)[::-1][:3] - 1.0).max())]


def refused(sizes: list[int]) -> bool:
    """Whether a shift that is an eigenvalue is refused, here as on all ranks, and the next one serves."""
    n, factor = sum(sizes), SharedFactor()
    K, M = (sparse(one, one, sizes) for one in (np.diag(np.arange(1.0, n + 1)), np.eye(n)))
    try:
        factor.make(K, M, float(n))
    except ReplayProblem:
        return factor.make(K, M, n - 0.5) == n - 1
    return False


def too_large(sizes: list[int]) -> list[str]:
    """What is said of a border beyond the most, and of insides for which there is no memory; then there is a factor."""
    n, factor, said = sum(sizes), SharedFactor(), []
    K, M = sparse(grid(6), np.eye(n), sizes), sparse(np.eye(n), grid(6), sizes)
    most, spaces = shared_factor.MOST_BORDER, interior_factor.SPACES
    for border, tried in ((2, spaces), (most, (-100,))):
        shared_factor.MOST_BORDER, interior_factor.SPACES = border, tried
        # Here it lacks on one rank alone.
        interior_factor.SPACES = tried if WORLD.rank == 1 else spaces
        try:
            said.append(f"factored: {factor.make(K, M, 1.3)}")
        except ReplayProblem as problem:
            said.append(str(problem))
    shared_factor.MOST_BORDER, interior_factor.SPACES = most, (-100, *spaces)
    return [*said, f"factored: {factor.make(K, M, 1.3)}"]


def tiny() -> list[list[float]]:
    """Frequencies of a plate of two triangles, on all ranks and on one."""
    scene = SCENES / "bar_100.toml"
    return [first_frame(scene, TWO_TRIANGLES, comm).analysis.frequencies.tolist() for comm in (WORLD, PETSc.COMM_SELF)]


def held() -> tuple[np.ndarray, np.ndarray]:
    """A chain whose first 8 unknowns, all of one rank, are held: alone on their rows, and without mass."""
    K, M = chain(24), np.eye(24)
    K[:8], K[:, :8] = 0.0, 0.0
    K[range(8), range(8)], M[range(8), range(8)] = 1.0, 0.0
    return K, M


def main() -> None:
    found: dict[str, object] = {}
    interior_factor.AT_ONCE = 5
    kinds: dict[str, Callable] = {"mumps": MumpsInterior, "plain": PlainInterior}
    mass = np.eye(64)
    for name, kind in kinds.items():
        shared_factor.interior_factor = kind
        found[name] = {
            "grid": factored(grid(8), mass, [24, 16, 24], (0.0, 1.3, 3.1)),
            "empty rank": factored(grid(8), mass, [0, 40, 24], (0.5, 1.3)),
            "alone": factored(grid(8), mass, [0, 64, 0], (1.3,)),
            "pieces": factored(np.kron(np.eye(3), chain(10)), np.eye(30), [10, 10, 10], (-0.1, 0.7)),
            "held": factored(*held(), [8, 8, 8], (-0.1, 0.7)),
            "refused": refused([2, 3, 2]),
        }
    shared_factor.interior_factor = MumpsInterior
    pieces = np.kron(np.eye(3), np.ones((1, 10)))
    found["solved"] = {
        method: {
            "chain": solved(method, chain(24), np.eye(24), np.ones((1, 24)), [0, 16, 8]),
            "pieces": solved(method, np.kron(np.diag([1.0, 1.7, 2.3]), chain(10)), np.eye(30), pieces, [10, 10, 10]),
        }
        for method in ("direct", "auto", "ilu")
    }
    blocks = np.kron(grid(4), np.arange(1.0, 10.0).reshape(3, 3))
    found["multiplied"] = [multiplied(blocks, [18, 0, 30]), multiplied(grid(6), [10, 20, 6])]
    found["too large"] = too_large([12, 12, 12])
    found["buckled"], found["tiny"] = buckled([7, 0, 9]), tiny()
    every = WORLD.tompi4py().allgather(json.dumps(found))
    if WORLD.rank == 0:
        print(json.dumps({**found, "alike": len(set(every)) == 1}))


main()
