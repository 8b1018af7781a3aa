"""Measures what a unit of counted work costs on this machine."""

import time
from collections.abc import Callable
from itertools import permutations
from typing import NamedTuple

import numpy as np
from petsc4py import PETSc
from scipy.optimize import nnls

from restshape import _kernels
from restshape.algebra.operator import Operator
from restshape.algebra.preconditioner import cycle_in_single, nonzeros, order_factor, set_preconditioner
from restshape.calibration import Calibration
from restshape.fem.elements import CONDUCTION, LINEAR_ELASTIC

SIDES = (32, 100)
"""Grid points a side of the two problems: 2,048 and 20,000 unknowns."""
LARGE_SET, TRIAD_BYTES, TRIAD_RUNS = 400e6, 4e6, 15
"""Bytes of a working set that no cache holds; bytes that a run of the triad moves at least, so that the clock sees
it; and runs."""
UNIT_STIFFNESS, UNIT_CONDUCTION = (1.0, 1.0, 1.0, 0.0, 0.0), (1.0, 1.0, 0.0)
"""Parameters of the elements of a plate."""
TINY_SIDE = 3
"""Of a problem with so little work that an iteration costs its overhead."""


def measure(machine: str) -> Calibration:
    """The calibration of this machine, from two plates of triangles with two unknowns a node; takes seconds.

    Args:
        machine: its name, for people.
    """
    counts, seconds = zip(*(measure_size(side) for side in SIDES), strict=True)
    count = {key: np.array([c[key] for c in counts]) for key in counts[0]}
    took = {key: np.array([s[key] for s in seconds]) for key in seconds[0]}
    symbolic = fit(took["symbolic"], count["filled"])
    numeric = fit(took["numeric"] - took["iteration"], count["filled"], count["filled"] ** 1.5)
    solve = fit(took["solve"], 2.0 * count["filled"])
    ilu = fit(took["ilu_numeric"], count["ilu"])
    ilu_solve = fit(took["ilu_solve"], count["ilu"])
    matvec = fit(took["matvec"], count["nonzeros"])
    overhead = measure_iteration(plate_system(*plate(TINY_SIDE)))
    vectors = fit(np.maximum(0.0, took["iteration"] - took["matvec"] - overhead), count["unknowns"])
    element = fit(took["assembly"], count["elements"])
    gamg = [fit(took[f"gamg_{part}"], count["gamg"]).item() for part in ("setup", "refresh", "solve")]
    units = [*symbolic, *numeric, *solve, *ilu, *ilu_solve, *matvec, *vectors, overhead, *element, *gamg]
    # Three digits: more would be noise, and a file that people may read.
    return Calibration(machine, *(float(f"{unit:.3g}") for unit in units))


def measure_size(side: int) -> tuple[dict[str, float], dict[str, float]]:
    """Counts of work and seconds of each operation on one plate of side x side nodes."""
    X, cells = plate(side)
    system = plate_system(X, cells)
    mat, x, b, _ = system
    filled, cholesky = measure_factor(system, "cholesky")
    ilu_filled, ilu = measure_factor(system, "ilu")
    gamg_filled, gamg = measure_gamg(system)
    work = {"unknowns": mat.getSize()[0], "nonzeros": mat.getInfo()["nz_used"], "elements": len(cells)}
    seconds = {
        **cholesky,
        **gamg,
        "ilu_numeric": ilu["numeric"],
        "ilu_solve": ilu["solve"],
        "matvec": median_seconds(lambda: mat.mult(b, x)),
        "iteration": measure_iteration(system),
        "assembly": measure_assembly(X, cells),
    }
    return {**work, "filled": filled, "ilu": ilu_filled, "gamg": gamg_filled}, seconds


def plate(side: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 2) and triangles (ne, 3) int32 of a square plate of side x side nodes."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, side), np.linspace(0.0, 1.0, side))
    first = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    lower = np.stack([first, first + 1, first + side + 1], axis=1)
    upper = np.stack([first, first + side + 1, first + side], axis=1)
    cells = np.concatenate([lower, upper]).astype(np.int32)
    return np.ascontiguousarray(np.stack([x.ravel(), y.ravel()], axis=1)), cells


def box(side: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 3) and tetrahedra (ne, 4) int32 of a unit cube of side x side x side nodes: six to a small cube."""
    places = np.linspace(0.0, 1.0, side)
    X = np.stack(np.meshgrid(places, places, places, indexing="ij"), axis=-1).reshape(-1, 3)
    steps = np.arange(side - 1)
    corner = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    cells = []
    for order in permutations(range(3)):
        path = np.vstack([np.zeros(3, int), np.cumsum(np.eye(3, dtype=int)[list(order)], axis=0)])
        nodes = (corner[:, None] + path) @ [side**2, side, 1]
        cells.append(nodes if np.linalg.det(path[1:]) > 0 else nodes[:, [0, 2, 1, 3]])
    return X, np.ascontiguousarray(np.vstack(cells), dtype=np.int32)


class PlateSystem(NamedTuple):
    """The matrix of a plate or a box that a side holds, a vector, a right side; the operator holds its numbers."""

    mat: PETSc.Mat
    x: PETSc.Vec
    b: PETSc.Vec
    operator: Operator


def plate_system(X: np.ndarray, cells: np.ndarray, fields: int = 2) -> PlateSystem:
    """The stiffness of that plate, or box, or the plate's conduction with one unknown a node, as replays make them."""
    operator = Operator(PETSc.COMM_SELF, fields, np.array([0, len(X)], dtype=np.int32))
    operator.set_topology([cells], np.repeat((X[:, 0] == 0.0).astype(np.uint8), fields))
    elements, params = (CONDUCTION, UNIT_CONDUCTION) if fields == 1 else (LINEAR_ELASTIC, UNIT_STIFFNESS)
    element = elements["tri3" if cells.shape[1] == 3 else "tet4"]
    zero = np.zeros((len(X), fields))
    mat = operator.assemble([(0, element, X, zero, np.array(params), 1.0)], None)
    x, b = mat.createVecs()
    b.set(1.0)
    return PlateSystem(mat, x, b, operator)


def again(system: PlateSystem, pc: PETSc.PC) -> None:
    """Rebuild a preconditioner on the same pattern."""
    # A value set again makes PETSc take the matrix for a new one, of which it no longer knows that it is definite.
    system.mat.setValue(0, 0, system.mat.getValue(0, 0))
    system.mat.assemble()
    system.mat.setOption(PETSc.Mat.Option.SPD, True)
    pc.setUp()


def measure_factor(system: PlateSystem, kind: str) -> tuple[float, dict[str, float]]:
    """Nonzeros of a factor, and seconds of its symbolic part, its numeric part and one solve."""

    def make() -> PETSc.PC:
        pc = PETSc.PC().create(PETSc.COMM_SELF)
        pc.setType(kind)
        if kind == "cholesky":
            order_factor(pc)
        else:
            pc.setFactorOrdering("natural")
            pc.setFactorLevels(3)
        pc.setOperators(system.mat)
        pc.setUp()
        return pc

    whole = median_seconds(make, least=3)
    pc = make()
    numeric = median_seconds(lambda: again(system, pc))
    filled = pc.getFactorMatrix().getInfo()["nz_used"]
    if kind == "cholesky":
        # As factors that are kept do.
        _kernels.solve_by_panels(pc.getFactorMatrix().handle, single=True)
    solve = median_seconds(lambda: pc.apply(system.b, system.x))
    return filled, {"symbolic": max(0.0, whole - numeric), "numeric": numeric, "solve": solve}


def measure_gamg(system: PlateSystem) -> tuple[float, dict[str, float]]:
    """Nonzeros of all grids of algebraic multigrid; seconds of a rebuild, with the interpolation kept, and of a
    cycle."""
    made: list[PETSc.KSP] = []

    def make() -> None:
        ksp = PETSc.KSP().create(PETSc.COMM_SELF)
        ksp.setOptionsPrefix("calibration_")
        set_preconditioner(ksp, "gamg", 0)
        ksp.setOperators(system.mat)
        ksp.getPC().setUp()
        cycle_in_single(ksp.getPC())
        made.append(ksp)

    whole = median_seconds(make, least=3)
    pc = made[-1].getPC()

    def refresh() -> None:
        again(system, pc)
        cycle_in_single(pc)

    kept = median_seconds(refresh, least=3)
    cycle = median_seconds(lambda: pc.apply(system.b, system.x))
    filled = nonzeros(pc)
    for ksp in made:
        ksp.destroy()
    return filled, {"gamg_setup": whole, "gamg_refresh": kept, "gamg_solve": cycle}


def measure_iteration(system: PlateSystem) -> float:
    """Seconds of an iteration of conjugate gradients without a preconditioner."""
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setType("cg")
    ksp.getPC().setType("none")
    ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    ksp.setTolerances(rtol=1e-300, atol=0.0, max_it=20)
    ksp.setOperators(system.mat)
    ksp.setUp()
    seconds = median_seconds(lambda: ksp.solve(system.b, system.x))
    return seconds / max(1, ksp.getIterationNumber())


def measure_assembly(X: np.ndarray, cells: np.ndarray) -> float:
    """Seconds of the values of the plate's stiffness matrix on a pattern that stands."""
    nodes = len(X)
    operator = _kernels.Operator(False, 2, np.array([0, nodes], dtype=np.int32), 0, "csr")
    operator.set_topology([cells])
    operator.set_constraints(np.zeros(2 * nodes, dtype=np.uint8))
    element = LINEAR_ELASTIC["tri3"]
    params = np.array(UNIT_STIFFNESS)
    x, rhs = np.zeros_like(X), np.zeros(2 * nodes)

    def assemble() -> None:
        operator.begin()
        operator.add(0, X, [(element, x, params, 1.0)], rhs)
        operator.end()

    return median_seconds(assemble)


def measure_bandwidth(working_set: float = LARGE_SET) -> float:
    """Bytes a second that one core moves, by the triad of STREAM, whose three arrays take the working set together.

    Args:
        working_set: bytes; what fits in a cache is measured in that cache. By default larger than all caches.

    Source: McCalpin 1995, see `_kernels.triad_seconds`.
    """
    n = max(16, round(working_set / 24))
    a, b, c = np.zeros(n), np.full(n, 1.0), np.full(n, 2.0)
    passes = max(1, round(TRIAD_BYTES / (24 * n)))
    return 24.0 * n / _kernels.triad_seconds(a, b, c, passes, TRIAD_RUNS)


def median_seconds(run: Callable[[], object], least: int = 7, budget: float = 0.2) -> float:
    """The median time of a call, over at least `least` calls and about `budget` seconds, after one not counted."""
    run()
    times: list[float] = []
    while len(times) < least or (sum(times) < budget and len(times) < 1000):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return float(np.median(times))


def fit(seconds: np.ndarray, *counts: np.ndarray) -> np.ndarray:
    """Seconds a unit of each count, none negative, with the least relative error over the sizes.

    Args:
        seconds: (sizes,) measured.
        counts: (sizes,) units of work, one array a kind of work.
    """
    floor = np.maximum(seconds, 1e-9)
    return nnls(np.stack(counts, axis=1) / floor[:, None], seconds / floor)[0]
