"""The cantilever beside what its script was made for: it brings the deformed outline to the goal."""

from petsc4py import PETSc
from restshape_studies.validation.case import OWN, Case, Check

from restshape.application import application
from restshape.interface.run import Run
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

FOLDER = application("cantilever").folder
SCENE, EDITS = FOLDER / "scenes" / "cantilever.toml", FOLDER / "edits" / "cantilever.jsonl"
LENGTH = 2.0


def missed(comm: PETSc.Comm, *overrides: str) -> float:
    """The mean distance [m] from the goal at the end of the session."""
    scene = load_scene(SCENE, overrides)
    script = load_script(EDITS, scene)
    run = Run(Request.of(scene, script, "auto"), summed=False, comm=comm)
    return [row["q_miss"] for row in run.rows()][-1]


def goal(comm: PETSc.Comm) -> list[Check]:
    """The mean distance of the two outlines ends below 0.5 % of the beam's length, on finer and better elements too."""
    source = "the goal's own outline; 0.5 % of the length"
    return [
        Check("mean distance over length", missed(comm) / LENGTH, 0.0, 0.005, source, OWN),
        Check("the same, second order", missed(comm, "mesh.order=2") / LENGTH, 0.0, 0.005, source, OWN),
    ]


COMPARISONS: dict[str, Case] = {"goal": goal}
