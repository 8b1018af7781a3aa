"""Preconditioners for flows beside each other, on systems of `flow.toml`, of the steady template and of `thermal.toml`.

OMP_NUM_THREADS=1 python scripts/unsymmetric.py [KEY=VALUE ...]

Each KEY=VALUE changes all scenes, such as mesh.size=5mm. Columns: nonzeros over those of the matrix; least ms of a new
factor on the same pattern; least microseconds of an application, and of an iteration (ten in a row); iterations that
lower a residual tenfold with a fresh preconditioner, and with that of the first of all systems. Below: what the whole
edit costs with each candidate alone, by counted work.
"""

# More than 15 modules: a script joins all parts of a replay.
import math
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from petsc4py import PETSc

import restshape
from restshape import Run, _kernels
from restshape.algebra.krylov_method import set_krylov, solve_from
from restshape.algebra.reuse.candidates import FLOW_IN_TIME
from restshape.algebra.reuse.counted_work import EVENTS, counted_seconds
from restshape.replay.event_counts import EventCounts, begin_log
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

APPLICATION = Path(__file__).parents[1] / "apps" / "flow"
HEATED = APPLICATION.with_name("thermal")
SCENES = {
    "in time": (APPLICATION / "scenes" / "flow.toml", APPLICATION / "edits" / "flow.jsonl", range(60, 68)),
    "steady": (APPLICATION / "template" / "scene.toml", APPLICATION / "template" / "edits.jsonl", range(2, 12)),
    "with heat, in time": (HEATED / "scenes" / "thermal.toml", HEATED / "edits" / "thermal.jsonl", range(60, 68)),
}
KINDS = ("lu", "ilu(0)", "ilu(1)", "ilu(2)", "ilu(3)")
NODES = {_kernels.node_lu: "lu by nodes", _kernels.node_lu_single: "the same, single"}
REPEATED = 9


class System(NamedTuple):
    """A linear system, and the norm that a solve may leave of its residual."""

    mat: PETSc.Mat
    b: PETSc.Vec
    target: float

    @property
    def decades(self) -> float:
        """Powers of ten by which the residual is to be smaller."""
        return max(0.3, math.log10(self.b.norm() / self.target))


def begun(scene: Path, script: Path, changes: Sequence[str]) -> Run:
    """A run with nothing beside its frames."""
    read = load_scene(scene, changes)
    return restshape.replay(read, load_script(script, read), "auto", measured="nothing")


def systems(scene: Path, script: Path, frames: range, changes: Sequence[str]) -> list[System]:
    """Those of some frames that have the size of the first one."""
    run, found = begun(scene, script, changes), list[System]()
    solver = run.replay.analysis.solver
    solver.on_solve = lambda mat, b, x, new, places: found.append(System(mat.copy(), b.copy(), 0.0))
    solver.on_solved = lambda report: found.append(found.pop()._replace(target=solver.ksp.getTolerances()[1]))
    for row in run.rows():
        if int(row["index"]) not in frames:
            found.clear()
        if int(row["index"]) == frames[-1]:
            break
    found = [one for one in found if 0.0 < one.target < one.b.norm()]
    return [one for one in found if one.mat.getSize() == found[0].mat.getSize()]


def least(run: Callable[[], object]) -> float:
    """Seconds of a call, the least of several."""
    taken = []
    for _ in range(REPEATED):
        start = time.perf_counter()
        run()
        taken.append(time.perf_counter() - start)
    return min(taken)


def made(mat: PETSc.Mat, kind: str, krylov: str) -> PETSc.KSP:
    """A solver with a preconditioner of a matrix: one of `KINDS`, or a solver type in `NODES`."""
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    set_krylov(ksp, krylov)
    pc = ksp.getPC()
    pc.setType("ilu" if kind.startswith("ilu") else "lu")
    if kind in NODES:
        pc.setFactorSolverType(kind)
    elif kind == "lu":
        pc.setFactorOrdering("amd")
    else:
        pc.setFactorLevels(int(kind[4]))
    ksp.setOperators(mat)
    ksp.setUp()
    pc.setReusePreconditioner(True)
    return ksp


def iterations(ksp: PETSc.KSP, one: System) -> float:
    """Those that lower the residual tenfold."""
    x = one.mat.createVecRight()
    ksp.setOperators(one.mat)
    ksp.setTolerances(rtol=1e-300, atol=one.target, max_it=2000)
    solve_from(ksp, one.b, x)
    return ksp.getIterationNumber() / one.decades if ksp.getConvergedReason() > 0 else math.nan


def row(known: Sequence[System], kind: str, krylov: str) -> list[float]:
    """The columns of a preconditioner and an iteration."""
    first = known[0]
    kept, x, pattern = made(first.mat, kind, krylov), first.mat.createVecRight(), first.mat.getInfo()["nz_used"]
    pc = kept.getPC()
    old = float(np.mean([iterations(kept, one) for one in known]))
    kept.setTolerances(rtol=1e-300, atol=1e-300, divtol=1e300, max_it=10)
    ten = least(lambda: (x.set(0.0), solve_from(kept, first.b, x)))
    apply = least(lambda: pc.apply(first.b, x))
    pc.setReusePreconditioner(False)

    def numbers() -> None:
        first.mat.setValue(0, 0, 1.0, addv=PETSc.InsertMode.ADD_VALUES)
        first.mat.setValue(0, 0, -1.0, addv=PETSc.InsertMode.ADD_VALUES)
        first.mat.assemble()
        pc.setUp()

    kept.setOperators(first.mat)
    numeric, filled = least(numbers), pc.getFactorMatrix().getInfo()["nz_used"] / pattern
    fresh = float(np.mean([iterations(made(one.mat, kind, krylov), one) for one in known[:9]]))
    return [filled, 1e3 * numeric, 1e6 * apply, 1e5 * ten, fresh, old]


def products(known: Sequence[System]) -> float:
    """Microseconds of a product with the first matrix."""
    mat, b, x = known[0].mat, known[0].b, known[0].b.duplicate()
    return 1e6 * least(lambda: mat.mult(b, x))


def table(label: str, known: Sequence[System], kinds: Sequence[str]) -> None:
    """A line a preconditioner and iteration."""
    for kind in kinds:
        for krylov in ("fgmres", "bcgs"):
            value = row(known, kind, krylov)
            print(f"{label} {NODES.get(kind, kind):17}{krylov:6}{value[0]:8.2f}{value[1]:9.3f}{value[2]:11.1f}", end="")
            print(f"{value[3]:13.1f}{value[4]:8.1f}{value[5]:8.1f}", flush=True)


def alone(scene: Path, script: Path, changes: Sequence[str]) -> None:
    """What the whole edit costs with each candidate alone, and with the choice: counted work, iterations, factors."""
    for name in (*(one.name for one in FLOW_IN_TIME), "auto"):
        run = begun(scene, script, changes)
        solver, counts, seconds, spent = run.replay.analysis.solver, EventCounts(EVENTS), 0.0, 0
        for other in FLOW_IN_TIME:
            if name not in ("auto", other.name):
                solver.kept.choice.exclude(other)
        counts.since_last()
        factors = 0
        for row in run.rows():
            events = counts.since_last()
            seconds += counted_seconds(events, int(row["iterations"]), solver)
            spent, factors = spent + int(row["iterations"]), factors + events["MatLUFactorNum"]
        print(f"{name:20} {1e3 * seconds:8.1f} ms counted, {spent:6} iterations, {factors:4} factors", flush=True)


def main(changes: list[str]) -> None:
    """Print a table a scene."""
    _kernels.register_node_lu()
    begin_log()
    for name, (scene, script, frames) in SCENES.items():
        blocks = systems(scene, script, frames, changes)
        points = [one._replace(mat=one.mat.convert("seqaij", out=PETSc.Mat())) for one in blocks]
        print(f"\nflow {name}: {blocks[0].mat.getSize()[0]} unknowns, {len(blocks)} systems")
        own = products(blocks)
        for one in blocks:
            _kernels.multiply_in_registers(one.mat.handle)
        found = f"PETSc's blocks {own:.1f} us, points {products(points):.1f}, registers {products(blocks):.1f}"
        print(f"a product: {found}")
        print(f"{'':30}{'fill':>8}{'new, ms':>9}{'apply, us':>11}{'iterate, us':>13}{'fresh':>8}{'kept':>8}")
        table("blocks", blocks, (*KINDS, *NODES))
        table("points", points, KINDS)
        alone(scene, script, changes)


if __name__ == "__main__":
    main(sys.argv[1:])
