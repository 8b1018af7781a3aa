"""Effects of elastic solids in the plane: keys of ``[effects]``, and what they settle for a scene."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import ConfigDict, Field

from restshape.errors import UserError
from restshape.scene.effect import Effect, ResolvedSettings
from restshape.scene.key_descriptions import Described
from restshape.scene.model import Scene
from restshape.scene.values import Strict, Whole, number_of

NEARLY_INCOMPRESSIBLE = 0.49
"""Poisson's ratio above which displacement elements lock."""


class SolidKeys(Described):
    """Keys of ``[effects.solid]``.

    Args:
        model: what is assumed across the plane.
        element: "displacement", or "mean_dilatation" on second-order triangles, which does not lock where a material
            hardly changes its volume; "auto" takes that one where Poisson's ratio is above 0.49 in plane strain.
    """

    model_config = ConfigDict(extra="forbid", title="Solid")
    model: Literal["plane_stress", "plane_strain"] = "plane_stress"
    element: Literal["auto", "displacement", "mean_dilatation"] = "auto"

    def resolve(self, scene: Scene) -> ResolvedSettings:
        """The element for a scene, and its order; why, where the material is nearly incompressible.

        Raises:
            UserError: the mean dilatation is asked for where it has no element or no use.
        """
        order, asked = scene.mesh.order, self.element
        if asked == "mean_dilatation":
            self._refuse_senseless(order)
        name, nu = max(((name, material.nu) for name, material in scene.material.items()), key=lambda pair: pair[1])
        stiff = self.model == "plane_strain" and nu > NEARLY_INCOMPRESSIBLE
        mean = asked == "mean_dilatation" or (stiff and asked == "auto" and order != 1)
        settings = self.model_copy(update={"element": "mean_dilatation" if mean else "displacement"})
        cause = f"nu = {nu:g} of material.{name} is above {NEARLY_INCOMPRESSIBLE} in plane strain"
        if mean:
            why = f"mean dilatation on second-order triangles, for {cause if stiff else 'the scene asks for it'}"
            return ResolvedSettings(settings, why, 2)
        if not stiff:
            return ResolvedSettings(settings)
        if order == 1:
            why = f"first-order triangles lock, for {cause}: leave out mesh.order, or set it to 2"
            return ResolvedSettings(settings, why, warns=True)
        return ResolvedSettings(settings, f"displacement elements as the scene asks, slow to converge, for {cause}", 2)

    def _refuse_senseless(self, order: int | None) -> None:
        if self.model == "plane_stress":
            raise UserError(
                "in plane stress nothing locks, for the thickness gives way",
                "effects.solid.element",
                'use element = "displacement", or model = "plane_strain"',
            )
        if order == 1:
            raise UserError(
                "the mean dilatation needs second-order triangles",
                "effects.solid.element",
                "leave out mesh.order, or set it to 2",
            )


class PlaneGravityKeys(Described):
    """Keys of ``[effects.gravity]``: the acceleration of all bodies.

    Args:
        g: acceleration (x, y) [m/s^2].
    """

    model_config = ConfigDict(extra="forbid", title="Gravity")
    g: Annotated[list[number_of("acceleration")], Field(min_length=2, max_length=2)] = [0.0, -9.81]


class LargeDeformationKeys(Described):
    """Keys of ``[effects.large_deformation]``: the law of St. Venant and Kirchhoff; pressures follow the boundary.

    Args:
        load_steps: most steps in which the load of a frame is brought up where one is too long.
    """

    model_config = ConfigDict(extra="forbid", title="LargeDeformation")
    load_steps: Annotated[Whole, Field(ge=1)] = 60


class BucklingKeys(Strict):
    """Keys of ``[effects.buckling]``: the multiples of all loads at which the body, linear until then, buckles.

    Args:
        modes: how many critical load factors are wanted, from the lowest on.
        load: "given", or "reversed" for the factors of the same loads turned round.
    """

    model_config = ConfigDict(title="Buckling")
    modes: Annotated[Whole, Field(ge=1, le=20)] = 3
    load: Literal["given", "reversed"] = "given"

    def resolve(self, scene: Scene) -> ResolvedSettings:
        """The order of the elements: the second, where the scene names none, for the first bend too stiffly.

        Raises:
            UserError: there is nothing that could buckle the body, or large deformation finds its own limit.
        """
        if "large_deformation" in scene.effects:
            raise UserError(
                "load factors are those of a linear solid, and the scene asks for large deformation too",
                "effects.buckling",
                "leave out one of [effects.buckling] and [effects.large_deformation]",
            )
        prescribed = [value for support in scene.supports.values() for value in support.fix.values()]
        if not (scene.loads or "gravity" in scene.effects or any(value != 0 for value in prescribed)):
            raise UserError(
                "nothing loads the body, so that nothing buckles it",
                "effects.buckling",
                "add [loads.NAME], [effects.gravity] or a support that moves the body",
            )
        if scene.mesh.order == 1:
            why = "first-order triangles bend too stiffly: load factors come out too large; leave out mesh.order"
            return ResolvedSettings(self, why, 2, warns=True)
        return ResolvedSettings(
            self, "" if scene.mesh.order else "second-order elements, for the first bend too stiffly", 2
        )


def buckling_columns(scene: Scene) -> dict[str, Any]:
    """The columns that a replay with buckling has besides: load factors, the numbers of their modes, counts."""
    if "buckling" not in scene.effects:
        return {}
    modes = BucklingKeys.model_validate(scene.effects["buckling"]).modes
    factors = {f"mu_{k}": np.float64 for k in range(1, modes + 1)}
    return {**factors, "mode_ids": "S80", "inertia_checked": np.int64, "missed_modes": np.int64}


ELASTICITY = Effect(SolidKeys, "elasticity", required=True)
GRAVITY = Effect(PlaneGravityKeys, "weight of the body", drives=True, acceleration="g")
LARGE_DEFORMATION = Effect(LargeDeformationKeys, "large displacements and rotations, follower loads", fixed=True)
BUCKLING = Effect(BucklingKeys, "critical load factors and modes of buckling", fixed=True, quantities=("load_factor",))
STATIC = {"solid": ELASTICITY, "gravity": GRAVITY, "large_deformation": LARGE_DEFORMATION, "buckling": BUCKLING}
"""Effects of static solids."""
