"""What cloth wants to know of a material."""

from typing import Annotated, Any, Self

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema, model_validator

from restshape.physics.elasticity.elasticity_material_keys import ElasticMaterial
from restshape.scene.materials import FABRIC, library
from restshape.scene.units import UnitError
from restshape.scene.values import Measured, read_number

CLOTH_MATERIALS = library("E", "orthotropic", FABRIC)
"""Fabrics, and materials whose stiffness is known, by name."""


def _read_bending(raw: Any, info: ValidationInfo) -> float | tuple[float, float]:
    """One bending stiffness, or two, along and across the grain."""
    given = raw if isinstance(raw, (list, tuple)) else [raw, raw]
    if len(given) != 2:
        raise UnitError(f"two bending stiffnesses are wanted, along and across the grain, or one, not {len(given)}")
    along, across = (read_number(value, "bending stiffness", info) for value in given)
    if min(along, across) < 0.0:
        raise UnitError(f"{min(along, across):g} is too small", "write a bending stiffness of at least 0")
    return along if given is not raw else (along, across)


Bending = Annotated[
    float | tuple[float, float],
    BeforeValidator(_read_bending),
    WithJsonSchema(
        {
            "anyOf": [{"type": kind} for kind in ("number", "string", "array")],
            "description": 'in N m, such as "5e-6 N m", or two along and across the grain',
        }
    ),
    Measured("bending stiffness"),
]


class ClothMaterial(ElasticMaterial):
    """``[material.NAME]``: an elastic material; cloth of it bends by E thickness^3/(12 (1 - nu^2)) [N m].

    Or it bends by ``bending``; two values are those along and across the grain.

    Args:
        bending: bending stiffness [N m], or those along and across the grain.
    """

    bending: Bending | None = None

    @model_validator(mode="after")
    def _bends_in_one_way(self) -> Self:
        if isinstance(self.bending, tuple) and self.orthotropic is None:
            raise UnitError("an isotropic material has one bending stiffness", "give one, or add orthotropic")
        return self
