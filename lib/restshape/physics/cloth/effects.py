"""Effects of cloth: keys of ``[effects]``, what they settle for a scene, and its columns."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import ConfigDict, Field

from restshape.bounds import TOLERANCE
from restshape.errors import UserError
from restshape.physics.cloth.contact.body_columns import body_columns
from restshape.physics.cloth.contact.thin_bodies import borne
from restshape.physics.cloth.self_contact.touching_itself import FINE, layer_thickness
from restshape.scene.effect import Effect, ResolvedSettings
from restshape.scene.held_point import hold_of
from restshape.scene.model import Scene
from restshape.scene.values import Strict, Whole, number_of

REST = 1e-4
"""Tolerance of a scene that names none."""
STANDARD_GRAVITY = 9.81
"""Acceleration [m/s^2] that the default of [effects.gravity] has, downwards."""


class ClothKeys(Strict):
    """Keys of ``[effects.cloth]``: how the sheet stretches and bends.

    Args:
        bending: "morley", which converges to a plate on any mesh; "hinge", quadratic, and "nonlinear", of the angles
            between triangles, which depend on the mesh; "none".
        hinges: hinges stand for the stiffness of a wide "plate", or of a narrow "strip" with free sides.
        membrane: the law of St. Venant and Kirchhoff, "stvk", or Hooke's law of the stretch, "corotated".
        trusted_strain: cloth with an edge that is stretched by more is not trusted, and says so.
    """

    model_config = ConfigDict(title="Cloth")
    bending: Literal["morley", "hinge", "nonlinear", "none"] = "morley"
    hinges: Literal["plate", "strip"] = "plate"
    membrane: Literal["stvk", "corotated"] = "stvk"
    trusted_strain: Annotated[number_of("number"), Field(gt=0)] = 0.05

    def resolve(self, scene: Scene) -> ResolvedSettings:
        """The same keys, with a warning where bodies are there that nothing touches.

        Morley's triangles of cloth that does not resist bending would have slopes that nothing holds: it has none.

        Raises:
            UserError: the cloth would fall for ever; a part of it alone does not resist bending.
        """
        names = ", ".join(f"bodies.{name}" for name in scene.bodies) if "contact" not in scene.effects else ""
        through = f"falls through {names}: there is no [effects.contact]" if names else ""
        hangs = scene.supports or hold_of(scene) is not None
        if not hangs and "gravity" in scene.effects and (through or not scene.bodies):
            what = f"it {through}" if through else "nothing catches it: it falls for ever"
            do = "add [effects.contact]" if through else "add [supports.NAME], or [bodies.NAME] and [effects.contact]"
            raise UserError(f"nothing holds the cloth, and {what}", "effects.gravity", do)
        limp = [name for name, material in scene.material.items() if material.bending in (0.0, (0.0, 0.0))]
        if self.bending != "morley" or not limp:
            return ResolvedSettings(self, warns=through and f"cloth {through}")
        if len(limp) < len(scene.material):
            raise UserError(
                "one part of the cloth does not resist bending, and others do",
                f"material.{limp[0]}.bending",
                'give it a little, such as bending = "1e-12 N m", or set effects.cloth.bending = "hinge"',
            )
        why = "nothing bends, for no material has a bending stiffness"
        return ResolvedSettings(self.model_copy(update={"bending": "none"}), why, warns=through and f"cloth {through}")


class SpaceGravityKeys(Strict):
    """Keys of ``[effects.gravity]``: the acceleration g [m/s^2] in space.

    Args:
        g: acceleration (x, y, z).
    """

    model_config = ConfigDict(title="Gravity")
    g: Annotated[list[number_of("acceleration")], Field(min_length=3, max_length=3)] = [0.0, 0.0, -STANDARD_GRAVITY]

    @property
    def size(self) -> float:
        """The length of g [m/s^2]."""
        return sum(component**2 for component in self.g) ** 0.5


class ContactKeys(Strict):
    """Keys of ``[effects.contact]``: bodies push cloth away along the gradient of their distance, and so does cloth.

    Args:
        thickness: distance from a body at which it begins [m].
        stiffness: pressure by depth [N/m^3]; left out, it is decided from the weight of the cloth.
        slip: way along a surface at which friction is all there [m].
        self: whether the cloth touches itself; left out, it does unless its outline is held all around.
        self_thickness: distance between parts of the cloth at which their contact begins [m]; left out, `thickness`,
            or a tenth of mesh.size where that is less.
        self_friction: Coulomb's coefficient between parts of the cloth.
    """

    model_config = ConfigDict(title="Contact")
    thickness: Annotated[number_of("length"), Field(gt=0)] = 2e-3
    stiffness: Annotated[number_of("body force"), Field(gt=0)] | None = None
    slip: Annotated[number_of("length"), Field(gt=0)] = 1e-4
    self: bool | None = None
    self_thickness: Annotated[number_of("length"), Field(gt=0)] | None = None
    self_friction: Annotated[number_of("number"), Field(ge=0)] = 0.0

    def resolve(self, scene: Scene) -> ResolvedSettings:
        """The stiffness, where the scene names none: half of the thickness bears ten times the cloth's weight, or more.

        Raises:
            UserError: there is no body, or no weight to decide the stiffness from.
        """
        if not scene.bodies and self.self is None:
            raise UserError(
                "there is contact, but no body that could be touched",
                "effects.contact",
                "add [bodies.NAME], or self = true for cloth that touches itself, or leave out [effects.contact]",
            )
        warning = self._coarse(scene) or self._catching(scene)
        if not scene.bodies:
            return ResolvedSettings(self, warns=warning)
        if self.stiffness is not None:
            return ResolvedSettings(self, warns=warning)
        gravity = SpaceGravityKeys.model_validate(scene.effects["gravity"]).size if "gravity" in scene.effects else 0.0
        weight = gravity * max(material.rho * material.thickness for material in scene.material.values())
        if weight == 0.0:
            raise UserError(
                "the stiffness of contact comes from the weight of the cloth, which has none",
                "effects.contact.stiffness",
                'give it, such as stiffness = "50 kN/m^3", or add [effects.gravity] and material.NAME.rho',
            )
        # At a depth s within the thickness t the pressure is k s^2 / (2 t).
        times, cause = borne(scene, self.thickness)
        stiffness = 8.0 * times * weight / self.thickness
        why = (
            f"stiffness {stiffness:.3g} N/m^3, so that cloth pressed everywhere through half of contact.thickness "
            f"({1e3 * self.thickness:.3g} mm) is pushed back by {times:.3g} times its weight"
        )
        why = "; ".join(filter(None, (why, cause)))
        return ResolvedSettings(self.model_copy(update={"stiffness": stiffness}), why, warns=warning)

    def _coarse(self, scene: Scene) -> str:
        """A warning where the cloth is to touch itself on a mesh that is too coarse for that; empty elsewhere."""
        size, thickness = scene.mesh.size or 0.0, layer_thickness(scene, self)
        if not self.self or size <= (1.0 + TOLERANCE) * FINE * thickness:
            return ""
        return (
            f"the cloth touches itself from {1e3 * thickness:.3g} mm on, which a mesh of {1e3 * size:.3g} mm is too "
            f'coarse for: set mesh.size to "{1e3 * FINE * thickness:.3g} mm", or effects.contact.self_thickness to '
            f'"{1e3 * size / FINE:.3g} mm"'
        )

    def _catching(self, scene: Scene) -> str:
        """A warning where layers with friction catch on each other's nodes and edges; empty elsewhere."""
        size, thickness = scene.mesh.size or 0.0, layer_thickness(scene, self)
        if not self.self_friction or not size or FINE * thickness <= (1.0 + TOLERANCE) * size:
            return ""
        return (
            f"contact of the cloth with itself begins at {1e3 * thickness:.3g} mm on a mesh of {1e3 * size:.3g} mm: "
            f"layers catch on each other, and slip up to 5 % later than effects.contact.self_friction says; set "
            f'effects.contact.self_thickness to "{1e3 * size / FINE:.3g} mm" or less'
        )


class DrapeKeys(Strict):
    """Keys of ``[effects.drape]``: the solution strategy.

    Args:
        tolerance: cloth is in equilibrium where the norm of the residual is at most so much of that of its weight,
            both over free nodes: another name of solve.tolerance, which it is where left out, or 1e-4 without either.
        strategy: "kinetic", steps in time that restart at each peak of the kinetic energy; "rayleigh", steps with
            Rayleigh damping; "newton", with a line search on the energy; "stabilised", the same with the stabilised
            tangent; "cg", nonlinear conjugate gradients. The default, "auto", lets cloth fall in
            implicit steps where it restarts, then takes quasi-Newton steps, then Newton's method.
        steps: most steps in a frame.
        levels: how many of the nested meshes of mesh.levels, the finest among them, lead a cold start to
            equilibrium, from coarse to fine; left out, 1: the finest alone.
    """

    model_config = ConfigDict(title="Drape")

    renamed = {"tolerance": "rest", "strategy": "way"}

    tolerance: Annotated[number_of("number"), Field(ge=TOLERANCE, lt=1)] | None = None
    strategy: Literal["auto", "kinetic", "rayleigh", "newton", "stabilised", "cg"] = "auto"
    steps: Annotated[Whole, Field(ge=1)] = 3_000
    levels: Annotated[Whole, Field(ge=1)] | None = None

    def resolve(self, scene: Scene) -> ResolvedSettings:
        """The same keys with the tolerance and the number of nested meshes filled in.

        Raises:
            UserError: there are fewer of them, or two tolerances.
        """
        named = scene.solve.tolerance if "tolerance" in scene.solve.model_fields_set else None
        rest = self.tolerance or named or REST
        if named is not None and named != rest:
            raise UserError(
                f"cloth is to rest at {rest:g} of its weight, and the solver to end at {named:g}: both are one number",
                "effects.drape.tolerance",
                "leave it out, and set solve.tolerance",
            )
        there = scene.mesh.levels
        if self.levels is not None and self.levels > there:
            raise UserError(
                f"the mesh has {there} level{'s' * (there > 1)}, and {self.levels} are asked for",
                "effects.drape.levels",
                f"set mesh.levels to {self.levels} or more",
            )
        settings = self.model_copy(update={"levels": self.levels or 1, "tolerance": rest})
        return ResolvedSettings(settings, tolerance=rest)


def cloth_columns(scene: Scene) -> dict[str, Any]:
    """The columns that a replay of cloth has besides: rest, stability, trust, steps, factors, friction, bodies."""
    own = {
        "converged": np.int64,
        "tangent_positive_definite": np.int64,
        "relaxation_steps": np.int64,
        "factorisations": np.int64,
        "slip_distance": np.float64,
        "max_penetration": np.float64,
        "crossings": np.int64,
        "max_strain": np.float64,
        "untrusted": str,
    }
    # In scenes without seams too: an edit may add them.
    seams = {"seam_gap": np.float64, "seam_energy": np.float64}
    return own | seams | body_columns(scene.bodies)


EFFECTS = {
    "cloth": Effect(ClothKeys, "a sheet that stretches and bends", required=True),
    "gravity": Effect(SpaceGravityKeys, "weight of the cloth", drives=True, acceleration="g"),
    "contact": Effect(ContactKeys, "bodies that cloth lies on"),
    "drape": Effect(DrapeKeys, "the solution strategy", required=True),
}
