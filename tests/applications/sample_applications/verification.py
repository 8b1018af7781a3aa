"""What verifies plane solids here: a validation case, hard cases, random scenes."""

from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from petsc4py import PETSc
from restshape_studies.accuracy.scale import StudyScale
from restshape_studies.stability.case import Case, Statement, Trial, near, valid
from restshape_studies.stability.known_bounds import DIRECT
from restshape_studies.stability.plane_strategies import solid_effects, solid_scenes
from restshape_studies.stability.random_scenes import RandomScenes
from restshape_studies.stability.scenery import STEEL, block, drag, head, meshed, plate, write_scene
from restshape_studies.validation.case import CLOSED_FORM, ROUNDING, Check

from restshape.application import Application
from restshape.interface.first_frame import first_frame
from restshape.scene.model import Scene


def patch(comm: PETSc.Comm) -> list[Check]:
    """A uniform stretch of a block is met exactly by linear elements."""
    text = head("plane") + block() + STEEL + '[supports.sides]\non = "outline"\nfix = { x = "1e-3*x", y = 0 }\n'
    with TemporaryDirectory() as folder:
        path = write_scene(Path(folder), text + meshed(0.3))
        replay = first_frame(path, ["solve.tolerance=1e-11"], comm)
    X = replay.moving.mesh.X
    difference = float(np.abs(replay.analysis.x - 1e-3 * X * (1, 0)).max() / 1e-3)
    # On one rank it is solved by factors, on several by an iteration.
    near = ROUNDING if comm.size == 1 else 1e-9
    return [Check("largest nodal error, relative", difference, 0.0, near, "exact for linear elements", CLOSED_FORM)]


def jump(trial: Trial) -> Iterator[Statement]:
    """A hole jumps over two fifths of the plate in one frame."""
    rows, statements = trial.compared(plate("plane", 0.2), drag("window", (0.5, 0.5), [(1.3, 0.5)]))
    yield from (*statements, *valid(rows, residual=2e-6))


def still_plate(trial: Trial) -> Iterator[Statement]:
    """A plate that nobody edits bears the whole pull."""
    rows = trial.rows(plate("plane", 0.3))
    yield near("the wall holds the whole pull", [row["q_wall"] for row in rows], -1e6, trial.solved(DIRECT))


VALIDATION = {"patch": patch}
HARD = {
    "jump": Case(jump, exempt={"thesis": "two sweeps of springs do not follow so far a jump"}),
    "still": Case(still_plate),
}
RANDOM = RandomScenes(solid_scenes("plane", solid_effects(), own=lambda effects: {}))


def cloth_scale(scene: Scene, application: Application, order: int) -> StudyScale:
    """The scale of scenes of cloth, whose folds go on from frame to frame; arguments as of the usual one."""
    return StudyScale(6e3, 4e4, 1.0, (1e-7, 1e-6, 1e-5), 8, per_node=12.0, tightest=1e-8, continues=True)
