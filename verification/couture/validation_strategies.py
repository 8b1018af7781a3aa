"""Validation cases of the solution strategies: energies on the way, repeated runs, two meshes."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import Check
from restshape_verification.couture.validation_cantilever import bent, off, tip

from restshape.application import application
from restshape.replay.first_frame import first_frame
from restshape.replay.replayed_files import replay_files

FOLDER = application("couture").folder
SCENES, EDITS = FOLDER / "scenes", FOLDER / "edits"
SPHERE = SCENES / "sphere.toml"
COARSE = ["effects.cloth.bending=hinge", 'mesh.size="40 mm"']


class Counted:
    """Equations that count how often a step is solved for.

    Args:
        motion: what is asked for all else.
    """

    def __init__(self, motion: Any) -> None:
        self.motion, self.solves = motion, 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self.motion, name)

    def step_matrix(self, *args: Any) -> PETSc.Mat:
        """That of the equations; it is asked for once a step that is tried."""
        self.solves += 1
        return self.motion.step_matrix(*args)


def resets(comm: PETSc.Comm) -> list[Check]:
    """Potential energies when velocities are set to zero, on the way of a cloth down a smooth ball."""
    smooth = ["bodies.ball.friction=0", "effects.drape.steps=1", "effects.drape.strategy=newton"]
    analysis = first_frame(SPHERE, [*COARSE, *smooth], comm).analysis
    sheet, moving = analysis.problem, analysis.state.solver.moving
    moving.motion = counted = Counted(moving.motion)
    x = sheet.flat(np.column_stack([sheet.mesh.X, np.zeros(len(sheet.mesh.X))]))
    start = sheet.energy(x)
    moving.run(x, 1e-3 * sheet.lumped.load)
    energies = np.array([start, *moving.resets])
    rise = float(np.diff(energies).max() / np.abs(energies).max())
    tried = counted.solves - moving.snes.getIterationNumber()
    source = "without friction a step that gains energy is taken back"
    return [
        Check(f"largest rise between {len(moving.resets)} resets, over the energy", max(rise, 0.0), 0.0, 1e-12, source),
        Check("steps that were taken back", moving.rejected, tried, 0, "linear solves less steps"),
    ]


def repeated(comm: PETSc.Comm) -> list[Check]:
    """Positions of two runs of the same scene, byte by byte."""
    checks = []
    runs: dict[str, Callable[[], np.ndarray]] = {
        "ball": lambda: first_frame(SPHERE, COARSE, comm).analysis.x,
        "strip": lambda: bent(8, (), comm).analysis.x,
    }
    for name, run in runs.items():
        first, second = (np.frombuffer(run().tobytes(), dtype=np.uint8) for _ in range(2))
        differ = float((first != second).sum())
        checks.append(Check(f"{name}, {len(first)} bytes: that differ", differ, 0.0, 0.0, "the same run"))
    return checks


def meshes(comm: PETSc.Comm) -> list[Check]:
    """Two nested meshes: at their rate where rest is unique, and where folds are not energies of cloth on a ball."""
    source, checks = "second order", []
    errors = [
        off(tip(bent(1, [f'mesh.size="{size} mm"', f"mesh.levels={level}"], comm)), 1)
        for level, size in ((1, 3.125), (2, 1.5625))
    ]
    checks.append(Check("strip, Gamma = 1: slope of the tip's error", slope(errors), 2.0, 0.05, source))
    sags = [
        replay_files(SCENES / "catenary.toml", EDITS / "catenary.jsonl", "auto", nested)["rows"][4]["q_sag"]
        for nested in ([f"mesh.size={0.04 / 2**level}", f"mesh.levels={level + 1}"] for level in range(3))
    ]
    checks.append(Check("chain, d/l = 0.9: slope of the sag's differences", slope(np.diff(sags)), 2.0, 0.05, source))
    rows = [
        first_frame(
            SPHERE, ["effects.cloth.bending=hinge", f'mesh.size="{40 / level} mm"', f"mesh.levels={level}"], comm
        ).row
        for level in (1, 2)
    ]
    for size, row in zip((40, 20), rows):
        checks.append(Check(f"ball, {size} mm: residual over the weight", row["residual"], 0.0, 1e-4, "rest"))
    coarse, fine = (row["q_potential"] for row in rows)
    return [*checks, Check("ball, 40 mm: potential energy [J]", coarse, fine, 0.05, "that on 20 mm")]


def slope(errors: Sequence[float]) -> float:
    """The power of the size that errors on a mesh and on one of half of its size go with."""
    return float(np.log2(errors[0] / errors[1]))
