"""Bridges beside restshape's own values on finer meshes: the constraint status of every design of a script."""

# More than 15 modules: each design is set up as a frame of a replay is, and solved twice.

from collections.abc import Iterator

import numpy as np
from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_studies.validation.case import OWN, Case, Check

from restshape.algebra.stages import Stages
from restshape.analysis.analysis import Context
from restshape.analysis.frame import Frame
from restshape.analysis.made_analysis import made_analysis
from restshape.application import application, application_of
from restshape.calibration import Calibration
from restshape.mesh.moving import MovingMesh
from restshape.policy import policy
from restshape.replay.constraints import HOLDS, constraint_status, limits_of
from restshape.replay.sessions import session_of
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene, revise
from restshape.scene.model import Scene
from restshape.shape.outline import Outline
from restshape.shape.session import EditFrame

FOLDER = application("bridge").folder
SCENE, EDITS = FOLDER / "scenes" / "bridge.toml", FOLDER / "edits" / "bridge-on-demand.jsonl"
REFINEMENTS = (1, 2, 4)


def designs() -> Iterator[tuple[Scene, Outline]]:
    """The designs that the script asks an analysis of."""
    scene = load_scene(SCENE)
    for frame in session_of(scene, load_script(EDITS, scene)).frames():
        if frame.do == "analyse":
            yield frame.scene, frame.outline


def solved(scene: Scene, outline: Outline, comm: PETSc.Comm) -> dict[str, float]:
    """The quantities of a scene with another outline, on a mesh of its own."""
    app = application_of(scene)
    moving = MovingMesh(outline, scene.mesh, ranks=comm.size)
    moving.update(EditFrame(0, 0.0, 0, "start", "start", None, (0.0, 0.0), scene, None, outline))
    context = Context(comm, policy("auto"), Calibration.load(), Stages())
    analysis = made_analysis(scene, app, context)
    mesh = moving.field_mesh
    cells = np.arange(len(mesh.cells), dtype=np.int32)
    analysis.solve(Frame(mesh, cells, None, scene, (None, (0.0, 0.0))))
    return analysis.observe()


def refined(comm: PETSc.Comm, scene: Scene, outline: Outline) -> list[dict[str, float]]:
    """The quantities of a design on the scene's mesh, and on meshes of half and a quarter of its size."""
    size = scene.mesh.size
    return [solved(revise(scene, "mesh.size", size / divisor), outline, comm) for divisor in REFINEMENTS]


@each_week(REFINEMENTS=(1, 2))
def constraint_statuses(comm: PETSc.Comm) -> list[Check]:
    """Each analysed design gets the same constraint status on three meshes; the stress of those that hold converges."""
    checks, holding = [], 0
    for number, (scene, outline) in enumerate(designs(), start=1):
        limits = limits_of(scene.quantities)
        found = refined(comm, scene, outline)
        given = [constraint_status(limits, quantities) for quantities in found]
        same = float(sum(one == given[-1] for one in given))
        source = f"the finest mesh says that design {number} {given[-1]}"
        what = f"design {number}: meshes of one constraint status"
        checks.append(Check(what, same, float(len(given)), 0.0, source, OWN))
        if given[-1] == HOLDS:
            holding += 1
            coarse, finest = (quantities["strength"] for quantities in (found[0], found[-1]))
            what = f"design {number}: stress on the scene's mesh [Pa]"
            checks.append(Check(what, coarse, finest, 1e-3, source, OWN))
    source = "what the script is made to show: 3 of 6"
    return [*checks, Check("designs that hold", float(holding), 3.0, 0.0, source, OWN)]


COMPARISONS: dict[str, Case] = {"constraint_status": constraint_statuses}
