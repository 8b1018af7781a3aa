"""Loose curves, as drawing files hold them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass
class Curve:
    """A loose curve.

    Args:
        points: (n, 2) [m]: start, what it interpolates, end.
        bulge: of an arc of two points; kind: "line", "arc", "spline" or "polyline".
        label: name of its layer or Physical group; "" for none.
        source: what it is in the file, for messages.
        region: the name of the region that it bounds, if any.
        loop: the name that a loop of such curves alone has; "": none.
        knots, ends: of a spline, see `restshape.shape.outline.Edge`; no knots: by the lengths of its chords.
    """

    points: np.ndarray
    kind: str
    label: str = ""
    bulge: float = 0.0
    source: str = ""
    region: str | None = None
    loop: str = ""
    knots: tuple[float, ...] = ()
    ends: tuple[str, str] = ("natural", "natural")


@dataclass
class LooseCurves:
    """What a reader finds in a file.

    Args:
        curves: in metres.
        notes: what was chosen of the file.
        doubt: what the file does not say of its unit, and what is taken; "": it says its unit.
    """

    curves: list[Curve]
    notes: tuple[str, ...] = ()
    doubt: str = ""
