"""What materials give to bodies that vibrate: moduli, density and thickness by region."""

from restshape.errors import UserError
from restshape.fem.elements import ANISOTROPIC, LINEAR_ELASTIC, Family
from restshape.fem.region_materials import names_by_region, require_value
from restshape.fem.space import Space
from restshape.scene.expressions import Value
from restshape.scene.model import Material, Scene


def materials_by_region(scene: Scene, plane: Space) -> list[Material]:
    """The material of each region of a plane mesh, that of the rest of the shape first.

    Raises:
        UserError: a region without a material, or a material without density.
    """
    require_mass(scene)
    names = names_by_region(scene, plane)
    # Regions that fill the shape leave no cell to the rest, whose material is never looked at.
    some = next(name for name in names if name is not None)
    return [scene.material[name or some] for name in names]


def require_mass(scene: Scene) -> None:
    """Makes sure that all materials have a density.

    Raises:
        UserError: one has none.
    """
    require_value(scene, "rho", "a body without density cannot vibrate", 'give it one, e.g. rho = "7850 kg/m^3"')


def law(materials: list[Material]) -> Family:
    """The law of small strains that all materials have: LINEAR_ELASTIC, or ANISOTROPIC if one has a grain."""
    return ANISOTROPIC if any(m.orthotropic for m in materials) else LINEAR_ELASTIC


def constant_thickness(material: Material) -> float:
    """The material's thickness [m], which must be a number here.

    Raises:
        UserError: it is a formula.
    """
    if not isinstance(material.thickness, float | int):
        raise UserError(
            "a plane solid has one thickness", "material", 'give a number, or use model = "solid" or "plate"'
        )
    return float(material.thickness)


def common_thickness(scene: Scene) -> Value:
    """The thickness of a body [m], a number or a formula of x and y.

    Raises:
        UserError: materials of different thickness.
    """
    given = {getattr(m.thickness, "text", m.thickness): m.thickness for m in scene.material.values()}
    if len(given) > 1:
        raise UserError(
            "the materials of a solid or a plate have one thickness",
            "material",
            "give all the same; it may be a formula of x and y",
        )
    return next(iter(given.values()))
