"""How large a study of accuracy may be: what its settings, its reference and its number of frames are chosen by."""

from dataclasses import dataclass

from restshape.application import Application
from restshape.physics.elasticity.thickness_layers import layers_of
from restshape.scene.model import Scene


@dataclass(frozen=True)
class StudyScale:
    """What is affordable for the scenes of an application, and how near to exact they can be solved.

    Args:
        finest: unknowns, about, of the finest setting of an order that is tried unasked.
        reference: unknowns, about, of the reference.
        corners: how many times as fine the reference is at the corners of the shape, where stresses may be singular.
        tolerances: of the reference, the next where rounding does not let a frame reach the first.
        frames: of a script that are replayed unasked, from the first that changes the shape on.
        per_node: unknowns, about, of a node of the plane.
        tightest: tolerance beyond which rounding decides.
        continues: the answer of a frame depends on the one before it, so that the reference takes every frame,
            and an analysis of something at rest has `start_from`.
    """

    finest: float
    reference: float
    corners: float
    tolerances: tuple[float, ...]
    frames: int
    per_node: float = 2.0
    tightest: float = 1e-12
    continues: bool = False


PLANE = StudyScale(4e4, 1.3e5, 16.0, (1e-10, 1e-8, 1e-6), 40)
MOTION = StudyScale(1e4, 2.5e4, 4.0, (1e-10, 1e-8, 1e-6), 6, continues=True)


def scale_of(scene: Scene, application: Application, order: int) -> StudyScale:
    """The scale of scenes whose application names none: layers of elements and time steps cost the most.

    Args:
        scene: whose layers count; application: of the scene; order: of the elements.
    """
    if "layers" in application.mesh_keys:
        # Modes alone: their frequencies are right to the square of the tolerance.
        per_node = 3.0 * (order * layers_of(scene) + 1)
        return StudyScale(1.2e4, 2.2e4, 4.0, (1e-7, 1e-6), 24, per_node, continues=application.transient(scene))
    return MOTION if application.transient(scene) else PLANE
