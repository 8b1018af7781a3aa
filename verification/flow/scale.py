"""How large studies of accuracy of fluids may be."""

from dataclasses import replace

from restshape_studies.accuracy.scale import StudyScale, scale_of

from restshape.application import Application
from restshape.scene.model import Scene


def fluid_scale(scene: Scene, application: Application, order: int) -> StudyScale:
    """The scale of scenes of fluids, which have three or four unknowns a node, and of others as they are.

    Args:
        scene, application: which may be of a body that conducts heat.
        order: of the elements.
    """
    found = scale_of(scene, application, order)
    if "flow" not in scene.effects:
        return found
    return replace(found, per_node=4.0 if "heat" in scene.effects else 3.0)
