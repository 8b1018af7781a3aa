"""The body that a scene lets vibrate, by the model that its plan names, and the analysis of its modes."""

from restshape.analysis.analysis import Context
from restshape.analysis.modal.modal import ModalAnalysis
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.physics.elasticity.thickness_layers import layers_of
from restshape.physics.elasticity.vibrating_body import VibratingBody
from restshape.physics.elasticity.vibrating_plane import VibratingPlane
from restshape.physics.elasticity.vibrating_solid import VibratingSolid
from restshape.physics.plates.vibrating_plate import VibratingPlate
from restshape.scene.model import Scene
from restshape.scene.plan import Plan


def modal_analysis(scene: Scene, plan: Plan, context: Context) -> ModalAnalysis:
    """The analysis of free vibrations; arguments as of any `Analysis`."""
    return ModalAnalysis(scene, plan, context, vibrating_body)


def vibrating_body(scene: Scene, plan: Plan, plane: Mesh | LagrangeSpace, lumped: bool) -> VibratingBody:
    """The body over a plane mesh.

    Args:
        scene: materials, supports, layers.
        plan: its effect `modal` names the model: "plane_stress", "plane_strain", "plate" or "solid".
        plane: of the order that the plan wants.
        lumped: with the mass on the diagonal; a plate's never is.
    """
    model = plan.settings("modal").model
    if model == "solid":
        return VibratingSolid(scene, plane, layers_of(scene), lumped)
    if model == "plate":
        return VibratingPlate(scene, plane)
    return VibratingPlane(scene, plane, model == "plane_stress", lumped)
