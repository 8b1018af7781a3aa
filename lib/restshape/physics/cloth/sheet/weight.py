"""What cloth weighs."""

from restshape.scene.expressions import Expression
from restshape.scene.model import Scene
from restshape.scene.physics import Rows
from restshape.scene.plan import Plan


def mass_and_weight(scene: Scene, plan: Plan, area: float) -> tuple[dict[str, float], Rows]:
    """Mass by area [kg/m^2] of cloth of one material, its ``mass`` [kg] and ``weight`` [N], and these as a row.

    Args:
        scene: of cloth.
        plan: its effects.
        area: of the flat cloth [m^2].
    """
    if len(scene.material) != 1:
        return {}, []
    (material,) = scene.material.values()
    if isinstance(material.thickness, Expression) or material.region:
        return {}, []
    by_area = material.rho * material.thickness
    mass = by_area * area
    gravity = plan.settings("gravity")
    found = {"mass_by_area": by_area, "mass": mass, "weight": mass * (gravity.size if gravity else 0.0)}
    words = (
        f"mass {mass:.4g} kg, weight {found['weight']:.4g} N; {1e3 * by_area:.4g} g/m^2, which is rho times thickness"
    )
    return found, [("cloth", words)]
