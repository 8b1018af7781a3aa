"""Effects of elastic solids that move: keys of ``[effects]`` for motion in time, ground acceleration and damping."""

from dataclasses import replace
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import ConfigDict, Field, model_validator

from restshape.errors import UserError
from restshape.physics.elasticity.solid_effects import ELASTICITY, GRAVITY, LARGE_DEFORMATION
from restshape.scene.effect import Effect, ResolvedSettings
from restshape.scene.model import Scene
from restshape.scene.units import UnitError
from restshape.scene.values import Length, Number, Strict, Whole, number_of, only_one

Frequency = Annotated[number_of("frequency"), Field(gt=0)]


class DynamicsKeys(Strict):
    """Keys of ``[effects.dynamics]``: Newmark's method.

    Args:
        time_step: [s].
        steps: time steps a frame.
        beta, gamma: the average acceleration by default; stable for any step where 2 beta >= gamma >= 1/2.
        mass: consistent, or lumped onto the diagonal.
    """

    model_config = ConfigDict(title="Dynamics")
    time_step: Annotated[number_of("time"), Field(ge=1e-15)] = 1e-3
    steps: Annotated[Whole, Field(ge=1)] = 20
    beta: Annotated[Number, Field(gt=0, le=0.5)] = 0.25
    gamma: Annotated[Number, Field(ge=0.5, le=1)] = 0.5
    mass: Literal["consistent", "lumped"] = "consistent"

    def resolve(self, scene: Scene) -> ResolvedSettings:
        """The keys as they are, with a warning where only short steps are stable.

        Source: T. J. R. Hughes, The Finite Element Method, 1987, section 9.1: omega dt <= (gamma / 2 - beta)^(-1/2).
        """
        if 2.0 * self.beta >= self.gamma:
            return ResolvedSettings(self)
        most = (self.gamma / 2.0 - self.beta) ** -0.5
        return ResolvedSettings(
            self,
            warns=f"with beta below gamma / 2 Newmark's method is stable only where time_step is at most {most:.3g} "
            "over the highest angular frequency of the mesh; 2 beta >= gamma is stable for any step",
        )


class GroundKeys(Strict):
    """Keys of ``[effects.ground]``: a harmonic motion, by its amplitude, or a record of accelerations.

    Args:
        direction: (x, y), of any length.
        displacement: amplitude [m].
        acceleration: amplitude [m/s^2].
        frequency: [Hz].
        file: of a record beside the scene, a ``.csv`` of times and accelerations with their units, or an ``.at2``.
        scale: of the accelerations of the record.
        start: simulated time at which the record begins [s].
    """

    model_config = ConfigDict(title="Ground")
    direction: tuple[Number, Number] = (1.0, 0.0)
    displacement: Length | None = None
    acceleration: number_of("acceleration") | None = None
    frequency: Frequency | None = None
    file: str | None = None
    scale: number_of("number") = 1.0
    start: number_of("time") = 0.0

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        only_one(self, ("displacement", "acceleration", "file"))
        if self.direction == (0.0, 0.0):
            raise UnitError("the direction has no length", "write for example direction = [1, 0]")
        if self.file is None and self.frequency is None:
            raise UnitError("the frequency of a harmonic motion is missing")
        if self.file is not None and self.frequency is not None:
            raise UnitError("a record has no frequency: leave out file or frequency")
        if self.file is None and (self.scale, self.start) != (1.0, 0.0):
            raise UnitError("scale and start are those of a record: name its file, or leave them out")
        return self

    def resolve(self, scene: Scene) -> ResolvedSettings:
        """The path of the record, as it is opened."""
        if self.file is None:
            return ResolvedSettings(self)
        why = f"the record {self.file}, linear between its samples"
        return ResolvedSettings(self.model_copy(update={"file": str(scene.folder / self.file)}), why)


class DampingKeys(Strict):
    """Keys of ``[effects.damping]``: Rayleigh's C = alpha M + beta K, by a damping ratio at two frequencies or itself.

    Args:
        ratio: of critical damping.
        frequencies: two [Hz] at which the ratio is met.
        alpha: [1/s].
        beta: [s].
    """

    model_config = ConfigDict(title="Damping")
    ratio: Annotated[number_of("number"), Field(ge=0, lt=1)] | None = None
    frequencies: tuple[Frequency, Frequency] | None = None
    alpha: Annotated[number_of("frequency"), Field(ge=0)] | None = None
    beta: Annotated[number_of("time"), Field(ge=0)] | None = None

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        by_ratio = self.ratio is not None and self.frequencies is not None
        itself = self.alpha is not None or self.beta is not None
        if by_ratio == itself or (self.ratio is None) != (self.frequencies is None):
            raise UnitError("either ratio with two frequencies, or alpha and beta, is wanted here")
        return self


class ModesBesideKeys(Strict):
    """Keys of ``[effects.modal]`` of what moves: the lowest eigenfrequencies of each frame's shape, small deformation.

    Args:
        modes: how many are computed.
    """

    model_config = ConfigDict(title="ModesBeside")
    modes: Annotated[Whole, Field(ge=1, le=20)] = 3

    def resolve(self, scene: Scene) -> ResolvedSettings:
        """The keys as they are.

        Raises:
            UserError: the law is not linear.
        """
        if "large_deformation" in scene.effects:
            raise UserError(
                "eigenfrequencies are those of a linear solid, and the scene asks for large deformation too",
                "effects.modal",
                "leave out one of [effects.modal] and [effects.large_deformation]",
            )
        return ResolvedSettings(self)


def motion_columns(scene: Scene) -> dict[str, Any]:
    """The columns that a replay with modes beside the motion has: frequencies, and shares of the mass."""
    if "modal" not in scene.effects:
        return {}
    modes = range(1, ModesBesideKeys.model_validate(scene.effects["modal"]).modes + 1)
    return {f"{name}_{k}": np.float64 for k in modes for name in ("f", "effective_mass")}


IN_MOTION = {
    "dynamics": Effect(
        DynamicsKeys,
        "motion in time by Newmark's method",
        required=True,
        transient=True,
        kernels=("mass_", "lumped_mass_"),
    ),
    "solid": ELASTICITY,
    "ground": Effect(GroundKeys, "base excitation at one frequency, or by a record", drives=True),
    "damping": Effect(DampingKeys, "Rayleigh damping"),
    "modal": Effect(ModesBesideKeys, "eigenfrequencies beside the motion", fixed=True, quantities=("frequency",)),
    "gravity": replace(GRAVITY, summary="weight of the body, which acts at once"),
    "large_deformation": LARGE_DEFORMATION,
}
"""Effects of solids that move."""
