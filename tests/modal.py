"""Small modal problems that several tests share."""

from collections.abc import Sequence
from pathlib import Path

from petsc4py import PETSc

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.application import application_of
from restshape.calibration import Calibration
from restshape.interface.first_frame import first_frame
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

SCENES = EDITS = Path(__file__).parent / "scenes"

SMALL = {
    "plane": ("slender.toml", ['mesh.size="20 mm"', 'shape.vertices.c=[1, "50 mm"]', 'shape.vertices.d=[0, "50 mm"]']),
    "tet4": ("bar_100.toml", ['mesh.size="12 mm"', "mesh.layers=1", "effects.modal.modes=3"]),
    "tet10": ("bar_100.toml", ['mesh.size="15 mm"', "mesh.layers=1", "mesh.order=2", "effects.modal.modes=3"]),
    "plate": ("bar_100.toml", ['mesh.size="10 mm"', "effects.modal.model=plate", "effects.modal.modes=3"]),
}
"""Scene and overrides of a small problem of each model; the first one is held, the others are free."""


def solved(model: str, *overrides: str) -> ModalAnalysis:
    """The modes of a small problem, to rounding."""
    scene, own = SMALL[model]
    return first_frame(SCENES / scene, [*own, "solve.tolerance=1e-9", *overrides]).analysis


def replay(
    scene: str,
    edits: Path,
    overrides: Sequence[str] = (),
    name: str = "auto",
    predict: str = "none",
    guess: str | None = None,
) -> Replay:
    """A replay that has not begun."""
    read = load_scene(SCENES / scene, overrides)
    script = load_script(edits, read)
    app = application_of(read)
    request = Request(read, script, app, policy(name, guess), Calibration.load(), predict=predict)
    return Replay(request, PETSc.COMM_WORLD)
