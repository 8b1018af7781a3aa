"""Preconditioners for flows beside each other: systems of Newton's steps of `flow.toml`, and of the steady template.

OMP_NUM_THREADS=1 python scripts/unsymmetric.py [KEY=VALUE ...]

Each KEY=VALUE changes both scenes, such as mesh.size=5mm. Columns: nonzeros over those of the matrix; least ms of a new
factor on the same pattern; least microseconds of an application, and of an iteration (ten in a row); iterations that
lower a residual tenfold with a fresh preconditioner, and with that of the first of all systems.
"""

import math
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.krylov_method import set_krylov, solve_from
from restshape.application import application
from restshape.calibration import Calibration
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

APPLICATION = Path(__file__).parents[1] / "apps" / "flow"
SCENES = {
    "in time": (APPLICATION / "scenes" / "flow.toml", APPLICATION / "edits" / "flow.jsonl", range(60, 68)),
    "steady": (APPLICATION / "template" / "scene.toml", APPLICATION / "template" / "edits.jsonl", range(2, 12)),
}
KINDS = (("lu", 0), ("ilu", 0), ("ilu", 1), ("ilu", 2), ("ilu", 3))
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


def systems(scene: Path, script: Path, frames: range, changes: Sequence[str]) -> list[System]:
    """Those of some frames that have the size of the first one."""
    read = load_scene(scene, changes)
    asked = Request(read, load_script(script, read), application(read.app), policy("auto"), Calibration.load())
    replay, found = Replay(asked, PETSc.COMM_SELF), list[System]()
    solver = replay.analysis.solver
    solver.on_solve = lambda mat, b, x, new, places: found.append(System(mat.copy(), b.copy(), 0.0))
    solver.on_solved = lambda report: found.append(found.pop()._replace(target=solver.ksp.getTolerances()[1]))
    for row in replay.frames():
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


def made(mat: PETSc.Mat, kind: str, levels: int, krylov: str) -> PETSc.KSP:
    """A solver with a preconditioner of a matrix."""
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    set_krylov(ksp, krylov)
    pc = ksp.getPC()
    pc.setType(kind)
    if kind == "lu":
        pc.setFactorOrdering("amd")
    else:
        pc.setFactorLevels(levels)
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


def row(known: Sequence[System], kind: str, levels: int, krylov: str) -> list[float]:
    """The columns of a preconditioner and an iteration."""
    first = known[0]
    kept, x, pattern = made(first.mat, kind, levels, krylov), first.mat.createVecRight(), first.mat.getInfo()["nz_used"]
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
    fresh = float(np.mean([iterations(made(one.mat, kind, levels, krylov), one) for one in known[:9]]))
    return [filled, 1e3 * numeric, 1e6 * apply, 1e5 * ten, fresh, old]


def products(known: Sequence[System]) -> float:
    """Microseconds of a product with the first matrix."""
    mat, b, x = known[0].mat, known[0].b, known[0].b.duplicate()
    return 1e6 * least(lambda: mat.mult(b, x))


def table(label: str, known: Sequence[System]) -> None:
    """A line a preconditioner and iteration."""
    for kind, levels in KINDS:
        for krylov in ("gmres", "bcgs"):
            title = f"{label} {kind if kind == 'lu' else f'ilu({levels})'} {krylov}"
            value = row(known, kind, levels, krylov)
            print(f"{title:20}{value[0]:8.2f}{value[1]:9.3f}{value[2]:11.1f}{value[3]:13.1f}", end="")
            print(f"{value[4]:8.1f}{value[5]:8.1f}", flush=True)


def main(changes: list[str]) -> None:
    """Print a table a scene."""
    for name, (scene, script, frames) in SCENES.items():
        blocks = systems(scene, script, frames, changes)
        points = [one._replace(mat=one.mat.convert("seqaij", out=PETSc.Mat())) for one in blocks]
        print(f"\nflow {name}: {blocks[0].mat.getSize()[0]} unknowns, {len(blocks)} systems")
        own = products(blocks)
        for one in blocks:
            _kernels.multiply_in_registers(one.mat.handle)
        found = f"PETSc's blocks {own:.1f} us, points {products(points):.1f}, registers {products(blocks):.1f}"
        print(f"a product: {found}")
        print(f"{'':20}{'fill':>8}{'new, ms':>9}{'apply, us':>11}{'iterate, us':>13}{'fresh':>8}{'kept':>8}")
        table("blocks", blocks)
        table("points", points)


if __name__ == "__main__":
    main(sys.argv[1:])
