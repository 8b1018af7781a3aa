"""Whether the analysis of a scene may go on to another scene."""

from restshape.application import Application
from restshape.errors import UserError
from restshape.scene.model import Scene
from restshape.scene.plan import plan, refuse_switched

FIXED = ("app", "quantities", "solve")
"""What an analysis, and the columns of its replay, are made for."""


def remembered(scene: Scene, app: Application) -> list[str]:
    """Summaries of the parts of a scene's physics that make its answer depend on the path to it."""
    planned = plan(scene, app)
    return [part.summary for name, part in app.derived.items() if part.remembers and planned.on(name)]


def can_follow(old: Scene, new: Scene, app: Application, continued: bool) -> bool:
    """Whether the analysis of a scene may go on to another one, and gives what one of its own would.

    Linear equations determine the solution alone, not the way to it. Where `continued`, nonlinear ones may follow a
    branch of solutions, and never do where a part of the physics remembers the path; modes keep their numbers.
    """
    if any(app.transient(scene) or remembered(scene, app) for scene in (old, new)):
        return False
    if not continued and plan(new, app).solver.equations != "linear":
        return False
    if any(getattr(old, key) != getattr(new, key) for key in FIXED):
        return False
    if old.mesh.file != new.mesh.file:
        return False
    try:
        refuse_switched(old, new, app)
    except UserError:
        return False
    return list(app.own_columns(old)) == list(app.own_columns(new))
