"""Cloth beside restshape's own values: energies on the way, repeated runs, two meshes of folds, and leaning blades."""

from collections.abc import Callable
from typing import Any

import numpy as np
from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_studies.validation.case import OWN, Case, Check
from restshape_verification.couture.validation_buckling import BLADE, critical, of_width
from restshape_verification.couture.validation_cantilever import bent

from restshape.application import application
from restshape.interface.first_frame import first_frame

SPHERE = application("couture").folder / "scenes" / "sphere.toml"
COARSE = ["effects.cloth.bending=hinge", 'mesh.size="40 mm"']


class Counted:
    """Equations that count how often the matrix of a step is made.

    Args:
        motion: what is asked for all else.
    """

    def __init__(self, motion: Any) -> None:
        self.motion, self.matrices = motion, 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self.motion, name)

    def step_matrix(self, *args: Any) -> PETSc.Mat:
        """That of the equations; it is asked for once a step that is tried, and where the run ends."""
        self.matrices += 1
        return self.motion.step_matrix(*args)


def resets(comm: PETSc.Comm) -> list[Check]:
    """Potential energies when velocities are set to zero, on the way of a cloth down a smooth ball."""
    smooth = ["bodies.ball.friction=0", "effects.drape.steps=1", "effects.drape.strategy=newton"]
    analysis = first_frame(SPHERE, [*COARSE, *smooth], comm).analysis
    sheet, moving = analysis.problem, analysis.state.solver.moving
    moving.motion = counted = Counted(moving.motion)
    x = sheet.flat(np.column_stack([sheet.mesh.X, np.zeros(len(sheet.mesh.X))]))
    # Triangles that get other points of contact on the way have another energy.
    sheet.contact.cut(sheet.corners(x))
    sheet.contact.cut = lambda corners, moving=False: None
    start = sheet.energy(x)
    moving.run(x, 1e-3 * sheet.lumped.load)
    energies = np.array([start, *moving.resets])
    rise = float(np.diff(energies).max() / np.abs(energies).max())
    tried = counted.matrices - moving.snes.getIterationNumber() - 1
    source = "without friction a step that gains energy is taken back"
    return [
        Check(
            f"largest rise between {len(moving.resets)} resets, over the energy", max(rise, 0), 0.0, 1e-12, source, OWN
        ),
        Check("steps that were taken back", moving.rejected, tried, 0, "matrices less steps and one at the end", OWN),
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
        checks.append(Check(f"{name}, {len(first)} bytes: that differ", differ, 0.0, 0.0, "the same run", OWN))
    return checks


@each_week()
def folds(comm: PETSc.Comm) -> list[Check]:
    """Cloth on a ball on two nested meshes: its folds are others on each, its energy is nearly the same."""
    rows = [
        first_frame(
            SPHERE, ["effects.cloth.bending=hinge", f'mesh.size="{40 / level} mm"', f"mesh.levels={level}"], comm
        ).row
        for level in (1, 2)
    ]
    coarse, fine = (row["q_potential"] for row in rows)
    residuals = [
        Check(f"ball, {size} mm: residual over the weight", row["residual"], 0.0, 1e-4, "equilibrium", OWN)
        for size, row in zip((40, 20), rows)
    ]
    return [*residuals, Check("ball, 40 mm: potential energy [J]", coarse, fine, 0.05, "that on 20 mm", OWN)]


def leaning(_comm: PETSc.Comm) -> list[Check]:
    """How a strip on edge rests around its critical weight: upright below, aside beyond, from where it is singular."""
    # Inertia is counted on one rank: each does the same.
    comm = PETSc.COMM_SELF
    load = critical(0.04, comm, 2)
    rows = {part: first_frame(BLADE, of_width(0.04, part * load, 2), comm).row for part in (0.97, 1.03, 1.06)}
    upright = rows[0.97]["q_aside"]
    checks = [Check("at 0.97 of the critical load: tip aside [L]", upright, 0.0, 1e-6, "upright is stable below", OWN)]
    for part, row in rows.items():
        what = f"at {part:g} of it: rests where it stays"
        checks.append(Check(what, row["tangent_positive_definite"], 1, 0, "1: it does", OWN))
    squares = [rows[part]["q_aside"] ** 2 for part in (1.03, 1.06)]
    # Beyond a pitchfork the square of what it opens by grows linearly.
    begin = 1.03 - squares[0] * 0.03 / (squares[1] - squares[0])
    source = "the same load: there the tip's (way aside)^2 begins to grow"
    return [*checks, Check("load at which it begins to lean, over the eigenvalue's", begin, 1.0, 5e-3, source, OWN)]


COMPARISONS: dict[str, Case] = {"resets": resets, "repeated": repeated, "folds": folds, "leaning": leaning}
