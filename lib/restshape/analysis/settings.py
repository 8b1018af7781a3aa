"""What analyses read of the settings of effects, whichever application declares them."""

from collections.abc import Sequence
from typing import Protocol, cast

from restshape.scene.plan import Plan


class HangingSettings(Protocol):
    """Of hanging points; attributes as of `analysis.hanging.Hanging`."""

    @property
    def weights(self) -> Sequence[float]: ...
    @property
    def mode(self) -> int: ...
    @property
    def at(self) -> Sequence[str]: ...
    @property
    def apart(self) -> float | None: ...
    @property
    def margin(self) -> float: ...


class ModalSettings(Protocol):
    """Of free vibrations.

    Attributes:
        modes: how many are wanted; in_plane: those mostly in the plane count too.
        a4: frequency of the tone A4 [Hz].
        hanging: what is asked of hanging points; None: nothing.
    """

    modes: int
    in_plane: bool
    a4: float

    @property
    def hanging(self) -> HangingSettings | None: ...


class BucklingSettings(Protocol):
    """Of buckling.

    Attributes:
        modes: how many load factors are wanted.
        load: "given" or "reversed".
    """

    modes: int
    load: str


def modal_settings(plan: Plan) -> ModalSettings:
    """The settings of the effect `modal`, which is on."""
    return cast(ModalSettings, plan.settings("modal"))


def buckling_settings(plan: Plan) -> BucklingSettings:
    """The settings of the effect `buckling`, which is on."""
    return cast(BucklingSettings, plan.settings("buckling"))
