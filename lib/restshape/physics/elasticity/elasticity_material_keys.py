"""What elasticity wants to know of a material, and materials that it knows by name."""

from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from restshape.outputs.si_numbers import si
from restshape.scene.expressions import Expression, Value
from restshape.scene.materials import library
from restshape.scene.model import Material
from restshape.scene.units import UnitError
from restshape.scene.values import Strict, number_of, value_of

ELASTIC_MATERIALS = library("E", "orthotropic")
"""Materials whose stiffness is known, by name."""


def _refuse_flat(value: Value) -> Value:
    """The thickness, unless it is a number that is not positive."""
    if not isinstance(value, Expression) and value <= 0.0:
        raise UnitError(f"a thickness is greater than 0, not {si(value, 'm')}")
    return value


Modulus = Annotated[number_of("pressure"), Field(gt=0)]
Ratio = number_of("number")


class Orthotropic(Strict):
    """``{ E = [E1, E2, E3], nu = [nu12, nu13, nu23], G = [G12, G13, G23] }``: stiffness along and across a grain.

    1 is along the grain, 2 across it in the plane, 3 through the thickness; nu12 is how much 2 contracts where 1 is
    pulled.

    Args:
        E: Young's moduli along 1, 2 and 3.
        nu: Poisson's ratios nu12, nu13, nu23.
        G: shear moduli G12, G13, G23.
    """

    E: tuple[Modulus, Modulus, Modulus]
    nu: tuple[Ratio, Ratio, Ratio]
    G: tuple[Modulus, Modulus, Modulus]

    @model_validator(mode="after")
    def _resists(self) -> Self:
        # The strain energy is positive: Jones, Mechanics of Composite Materials, 2nd edition, 1999, section 2.4.
        (E1, E2, E3), (n12, n13, n23) = self.E, self.nu
        couplings = (n12**2 * E2 / E1, n13**2 * E3 / E1, n23**2 * E3 / E2)
        if max(couplings) >= 1 or sum(couplings) + 2 * n12 * n13 * n23 * E3 / E1 >= 1:
            raise UnitError("with these ratios nu some strains would set energy free", "make them smaller")
        return self


class ElasticMaterial(Material):
    """``[material.NAME]``: what a body is made of; without ``region`` it fills what no other material does.

    Isotropic by ``E`` and ``nu``, or ``orthotropic`` with a ``grain`` at an angle from x towards y. ``name`` takes all
    of these and the density from a material that is known; what is given besides comes before that.

    Args:
        E: Young's modulus.
        nu: Poisson's ratio.
        orthotropic: stiffness along and across a grain, instead of E and nu.
        grain: the direction of fibres, from x towards y.
        rho: density.
        thickness: of the body over the plane.
    """

    E: Modulus | None = None
    nu: Annotated[Ratio, Field(gt=-1, lt=0.5)] | None = None
    orthotropic: Orthotropic | None = None
    grain: number_of("angle") = 0.0
    rho: Annotated[number_of("density"), Field(ge=0)] = 0.0
    thickness: Annotated[value_of("length", settled=True), AfterValidator(lambda value: _refuse_flat(value))] = 1.0

    @model_validator(mode="after")
    def _is_stiff_in_one_way(self) -> Self:
        missing = [key for key in ("E", "nu") if getattr(self, key) is None]
        if self.orthotropic is None:
            if missing:
                raise UnitError(
                    f"the key {missing[0]!r} is missing", f"add it, or name a material: {', '.join(self.known)}"
                )
            if self.grain:
                raise UnitError("an isotropic material has no grain", "leave it out, or add orthotropic")
        elif len(missing) < 2:
            raise UnitError("E and nu are of isotropic materials", "set orthotropic.E and orthotropic.nu instead")
        return self


class VibratingMaterial(ElasticMaterial):
    """As of `ElasticMaterial`, with what makes vibrations die away.

    Args:
        loss_factor: share of the strain energy that an oscillation loses, over 2 pi; modes and their frequencies do not
            depend on it, their sound does.
    """

    loss_factor: Annotated[number_of("number"), Field(ge=0, lt=1)] | None = None
