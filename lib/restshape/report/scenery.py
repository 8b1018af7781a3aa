"""What all pictures of one recording have in common: extent, exaggeration, colours, units."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import floor, log10

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize

from restshape.errors import UserError
from restshape.outputs.si_numbers import length_unit, scaled_unit, si
from restshape.replay.recording.recording import Recording
from restshape.report.field import ShownField, shown_field, true_scale
from restshape.report.goal_curves import goals_of
from restshape.report.style import BODY, COLOURS, SIGNED
from restshape.report.survey import Survey, colour_range, known_displacement, survey

SHARE = 0.08
PURE = ("", "1")
"""Units of pure numbers."""
SMALL, LARGE = 1e-2, 1e4
"""Sizes of pure numbers that colour bars show as they are; others have a power of ten in the label."""
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
MARGIN = 0.02
"""Room around all, over its size."""


@dataclass(frozen=True)
class Scenery:
    """Common to all frames of a recording.

    Args:
        scale: exaggeration of the displacement; exact: it may be no other.
        extent: xmin, xmax, ymin, ymax of all frames, and goals [m].
        field: that gives the colour, or None.
        bottom, top: values [field's unit] at the ends of the colours.
        seen: what the frames hold.
        goals: curves (m, 2) [m] that the deformed shape should meet; drawn as they are.
        deforms: a displacement is recorded.
    """

    scale: float
    exact: bool
    extent: tuple[float, float, float, float]
    field: ShownField | None
    bottom: float
    top: float
    seen: Survey
    goals: tuple[np.ndarray, ...] = ()
    deforms: bool = True

    @property
    def largest(self) -> float:
        """The largest displacement of all frames [m]."""
        return float(np.nanmax(np.nan_to_num(self.seen.largest), initial=0.0))

    @property
    def unit(self) -> tuple[float, str]:
        """Factor and unit of lengths on the axes."""
        return length_unit(max(self.extent[1] - self.extent[0], self.extent[3] - self.extent[2]))

    @cached_property
    def colour(self) -> tuple[float, str]:
        """Factor of the field's values and the label of the colour bar."""
        if self.field is None:
            return 1.0, ""
        look, size = self.field.look, max(abs(self.bottom), abs(self.top))
        factor, shown = scaled_unit(size, look.unit)
        if look.unit in PURE and size and not SMALL <= size < LARGE:
            # Numbers of as many digits would push the label out of the picture.
            power = 3 * floor(log10(size) / 3)
            factor, shown = 10.0**-power, f"10{str(power).translate(RAISED)}"
        return factor, f"{look.label} [{shown}]" if shown else look.label

    @property
    def colours(self) -> Colormap:
        """Of the field; grey where it is not known."""
        signed = self.field is not None and self.field.look.signed
        return colormaps[SIGNED if signed else COLOURS].with_extremes(bad=BODY)

    @property
    def bar(self) -> ScalarMappable:
        """What a colour bar shows: the field in its scaled unit."""
        factor, _ = self.colour
        return ScalarMappable(Normalize(factor * self.bottom, factor * self.top), self.colours)

    @property
    def beyond(self) -> str:
        """At which ends of the colours there are values beyond, as matplotlib names them."""
        low = np.nanmin(self.seen.bottom, initial=self.bottom) < self.bottom
        high = np.nanmax(self.seen.top, initial=self.top) > self.top
        return {(True, True): "both", (True, False): "min", (False, True): "max"}.get(
            (bool(low), bool(high)), "neither"
        )

    @property
    def deformation(self) -> str:
        """What the title says of the deformed shape; empty where there is no displacement in the recording."""
        if not self.deforms:
            return ""
        if not self.largest:
            return "no displacement"
        size = f"largest displacement {si(self.largest, 'm')}"
        return f"true deformation, {size}" if self.scale == 1.0 else f"deformation ×{scale_text(self.scale)}, {size}"


def scale_text(scale: float) -> str:
    """A scale, without a power of ten where it is large."""
    return f"{scale:,.0f}" if scale >= 1000.0 else f"{scale:.3g}"


def scenery(
    recording: Recording,
    scale: float | None = None,
    field: str | None = None,
    limits: tuple[float, float] | None = None,
    room: float = MARGIN,
    view: tuple[float, float, float, float] | None = None,
    frames: Sequence[int] = (),
) -> Scenery:
    """What the pictures of a recording have in common, from all its frames.

    Args:
        recording: two-dimensional.
        scale: exaggeration; default: the largest displacement becomes 8 % of the size, but 1 where there is a goal or
            the deformation is a large one.
        field: name of the field that gives the colour; default: see `shown_field`.
        limits: values at the ends of the colours in the field's SI unit; default: those of all frames.
        room: around all, over its size.
        view: xmin, xmax, ymin, ymax [m] of the part that is shown; None: all.
        frames: of these alone colours have the values; by default of all.

    Raises:
        UserError: the recording is not of a shape in the plane, lacks the field, or a scale but 1 is given for a large
            deformation.
    """
    if recording.dimension != 2:
        raise UserError("pictures can be drawn of shapes in the plane only", str(recording.path), "open it in ParaView")
    shown, exact, goals = shown_field(recording, field), true_scale(recording), goals_of(recording)
    if exact and scale not in (None, 1.0):
        raise UserError("large deformations are drawn as they are, not exaggerated", "--scale", "leave --scale out")
    seen = survey(recording, shown)
    size = float(np.max(seen.high.max(axis=0) - seen.low.min(axis=0)))
    largest = float(np.nanmax(np.nan_to_num(seen.largest), initial=0.0))
    if scale is None:
        scale = 1.0 if exact or goals or not largest else float(f"{SHARE * size / largest:.2g}")
    low, high = [seen.low, *(goal for goal in goals)], [seen.high, *(goal for goal in goals)]
    for i in np.flatnonzero(seen.solved) if largest else ():
        x = recording.points(i) + scale * known_displacement(recording, i)
        low.append(x.min(axis=0, keepdims=True))
        high.append(x.max(axis=0, keepdims=True))
    (xmin, ymin), (xmax, ymax) = np.vstack(low).min(axis=0) - room * size, np.vstack(high).max(axis=0) + room * size
    known = shown if np.isfinite(seen.top).any() else None
    bottom, top = limits or (colour_range(known, seen, frames) if known else (0.0, 1.0))
    deforms = "displacement" in recording.fields
    extent = view or (float(xmin), float(xmax), float(ymin), float(ymax))
    return Scenery(scale, exact, extent, known, bottom, top, seen, goals, deforms)
