"""How large studies of the accuracy of cloth may be."""

from restshape_studies.accuracy.scale import StudyScale

from restshape.application import Application
from restshape.scene.model import Scene


def scale_of(scene: Scene, application: Application, order: int) -> StudyScale:
    """The scale of scenes of cloth, whose folds go on from frame to frame; arguments as of the usual one.

    Morley's triangles have three unknowns a node and three an edge, of which there are three times as many. Forces are
    small differences of tensions, so that rounding decides early.
    """
    return StudyScale(6e3, 4e4, 1.0, (1e-7, 1e-6, 1e-5), 8, per_node=12.0, tightest=1e-8, continues=True)
