"""The measures of a mannequin, those that are left out by its height, and what they may be."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from restshape.errors import UserError

RANGES = {
    "bust": (0.40, 0.85),
    "waist": (0.30, 0.85),
    "hip": (0.42, 0.85),
    "shoulder": (0.18, 0.30),
    "neck": (0.15, 0.30),
    "upper_arm": (0.11, 0.26),
    "thigh": (0.24, 0.48),
}
"""Least and largest measure over the height."""
HEIGHTS = (0.5, 2.5)
"""Least and largest height [m]."""


@dataclass(frozen=True)
class Sizes:
    """Measures of a body [m]; those of 0 are filled in by `completed`.

    Args:
        height: from the floor to the top of the head.
        bust, waist, hip: girths at these levels.
        shoulder: width at the level of the shoulders, over the roots of both arms.
        neck, upper_arm, thigh: girths.
    """

    height: float = 1.68
    bust: float = 0.88
    waist: float = 0.72
    hip: float = 0.96
    shoulder: float = 0.40
    neck: float = 0.0
    upper_arm: float = 0.0
    thigh: float = 0.0

    def completed(self) -> Sizes:
        """All of them, those left out from the others.

        Raises:
            UserError: a measure that no body has; the message names the option.
        """
        least, most = HEIGHTS
        if not least <= self.height <= most:
            raise _refused("height", self.height, least, most, "")
        found = replace(
            self,
            neck=self.neck or 0.11 * self.height + 0.19 * self.bust,
            upper_arm=self.upper_arm or 0.075 * self.height + 0.17 * self.bust,
            thigh=self.thigh or 0.575 * self.hip,
        )
        for name, (low, high) in RANGES.items():
            value = getattr(found, name)
            if not low * self.height <= value <= high * self.height:
                raise _refused(name, value, low * self.height, high * self.height, f" of {_cm(self.height)}")
        return found

    @property
    def names(self) -> list[str]:
        """Of all measures, in order."""
        return [one.name for one in fields(self)]


BODIES = {
    "standard": Sizes(),
    "broad": Sizes(height=1.86, bust=1.18, waist=1.14, hip=1.12, shoulder=0.49),
}
"""Two bodies of unlike proportions, by name."""


def option(name: str) -> str:
    """The option of the command that gives a measure."""
    return f"--{name.replace('_', '-')}"


def _cm(value: float) -> str:
    return f"{100 * value:.4g} cm"


def _refused(name: str, value: float, low: float, high: float, of: str) -> UserError:
    what = f"a body{of} with {name.replace('_', ' ')} {_cm(value)} cannot be made"
    return UserError(what, option(name), f"give one from {_cm(low)} to {_cm(high)}")
