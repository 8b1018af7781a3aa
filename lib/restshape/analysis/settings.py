"""What analyses read of the settings of effects, whichever application declares them."""

from typing import Protocol, cast

from restshape.scene.plan import Plan


class ModalSettings(Protocol):
    """Of free vibrations.

    Attributes:
        modes: how many are wanted; in_plane: those mostly in the plane count too.
        a4: frequency of the tone A4 [Hz].
    """

    modes: int
    in_plane: bool
    a4: float


class BucklingSettings(Protocol):
    """Of buckling.

    Attributes:
        modes: how many load factors are wanted.
        load: "given" or "reversed".
    """

    modes: int
    load: str


class RelaxationSettings(Protocol):
    """Of cloth that comes to rest.

    Attributes:
        rest: residual over load at an equilibrium.
        way: name of the solution strategy; steps: the most of a frame.
        levels: nested meshes that a cold start runs through; None: all.
    """

    rest: float
    way: str
    steps: int
    levels: int | None


def modal_settings(plan: Plan) -> ModalSettings:
    """The settings of the effect `modal`, which is on."""
    return cast(ModalSettings, plan.settings("modal"))


def buckling_settings(plan: Plan) -> BucklingSettings:
    """The settings of the effect `buckling`, which is on."""
    return cast(BucklingSettings, plan.settings("buckling"))


def relaxation_settings(plan: Plan) -> RelaxationSettings:
    """The settings of the effect `drape`, which is on."""
    return cast(RelaxationSettings, plan.settings("drape"))
