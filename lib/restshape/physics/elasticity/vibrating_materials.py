"""What materials give to bodies that vibrate: moduli, density and thickness by region."""

import numpy as np

from restshape.errors import UserError
from restshape.fem.space import Space
from restshape.scene.expressions import Value
from restshape.scene.model import Material, Scene


def materials_by_region(scene: Scene, plane: Space) -> list[Material]:
    """The material of each region of a plane mesh, that of the rest of the shape first.

    Raises:
        UserError: a region without a material, or a material without density.
    """
    for name, material in scene.material.items():
        if not material.rho:
            raise UserError(
                "a body without density cannot vibrate",
                f"material.{name}",
                'give it one, e.g. rho = "7850 kg/m^3"',
            )
    rest = next((m for m in scene.material.values() if not m.region), None)
    table = [rest]
    for loop in plane.outline.loops:
        if loop.kind == "region":
            own = next((m for m in scene.material.values() if m.region and loop.name in m.region), rest)
            table.append(own)
    used = np.unique(plane.cell_region)
    if any(table[region] is None for region in used):
        raise UserError(
            "part of the shape has no material",
            "material",
            "let one material have no region, or name the regions that are missing",
        )
    # Regions that fill the shape leave no cell to the rest, whose material is never looked at.
    some = next(m for m in table if m is not None)
    return [m if m is not None else some for m in table]


def law(materials: list[Material]) -> str:
    """The law of small strains that all materials have: "linear_elastic", or "anisotropic" if one has a grain."""
    return "anisotropic" if any(m.orthotropic for m in materials) else "linear_elastic"


def lame(material: Material, stress: bool) -> tuple[float, float]:
    """Lame coefficients (lambda, mu) [Pa], lambda* for plane stress."""
    E, nu = material.E, material.nu
    return (E * nu / (1 - nu**2) if stress else E * nu / ((1 + nu) * (1 - 2 * nu))), E / (2 * (1 + nu))


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
