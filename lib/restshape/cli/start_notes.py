"""What a replay says of its scene and script before it begins."""

from restshape.application import application_of
from restshape.cli.doubts import script_doubts
from restshape.errors import ReplayProblem, UserError
from restshape.outputs.si_numbers import counted, counted_are, si
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene
from restshape.scene.plan import plan
from restshape.shape.drawings.imported_shape import imported_shape

UNMOVED = 'time begins after the first frame, the only one: let it go on by events {"do": "idle", "frames": 20}'
"""Of motion and heat in time without a script."""


def start_notes(scene: Scene, script: Script) -> list[str]:
    """What effects and the script warn of, a line each, and how many more warnings `restshape check` has.

    Raises:
        UserError: an effect cannot be had in this scene.
    """
    app = application_of(scene)
    effects = plan(scene, app)
    own = [*effects.warnings, *script.warnings]
    if app.transient(scene) and not script.events:
        own.append(UNMOVED)
    try:
        data, _, outline = app.editing.checked(scene, effects)
        if closed := _closed_gaps(scene):
            own.append(closed)
    except (ReplayProblem, UserError):
        # The first frame says what is wrong with the shape.
        return own
    more = [warning for warning in data.get("warnings", ()) if warning not in own]
    if outline is not None:
        more += script_doubts(scene, outline, script)
    if len(more) > 1:
        more = [f"{counted(len(more), 'more warning')}, which restshape check lists; the first: {more[0]}"]
    return own + more


def _closed_gaps(scene: Scene) -> str:
    """How many gaps in a drawing `shape.tolerance` let close, and how large they were; "" without any."""
    drawing = None if scene.mesh.file else imported_shape(scene.shape, scene.folder)
    if drawing is None or not drawing.gaps:
        return ""
    many, largest = counted_are(len(drawing.gaps), "gap"), si(drawing.gaps[0].size, "m")
    return f"shape.tolerance: {many} closed in {scene.shape.file}, the largest of {largest}; restshape check lists them"
