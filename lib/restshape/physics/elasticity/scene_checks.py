"""What models alone cannot check in a scene of elastic solids."""

from restshape.scene.expressions import Expression
from restshape.scene.model import Scene
from restshape.scene.source import Source, suggestion


def check_solids(scene: Scene, source: Source) -> None:
    """Checks a scene of elastic solids in the plane.

    Raises:
        UserError: the first thing that makes no sense.
    """
    check_goals(scene, source)
    for name, material in scene.material.items():
        if isinstance(material.thickness, Expression):
            what = f"the application {scene.app!r} knows one thickness a material only"
            raise source.error(("material", name, "thickness"), what, "give a number")
        if material.orthotropic is not None:
            what = f"the application {scene.app!r} knows isotropic materials only"
            raise source.error(("material", name), what, "give E and nu")


def check_goals(scene: Scene, source: Source) -> None:
    """Refuses a distance from a goal that is not there.

    Raises:
        UserError: the first one.
    """
    for name, quantity in scene.quantities.items():
        if quantity.distance is not None and quantity.distance not in scene.goal:
            what = f"there is no goal {quantity.distance!r}"
            raise source.error(
                ("quantities", name, "distance"), what, suggestion(quantity.distance, sorted(scene.goal))
            )
