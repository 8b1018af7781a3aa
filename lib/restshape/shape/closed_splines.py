"""Splines that end where they begin, cut in two: an edge has two ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from restshape.bounds import SPLINE_POINTS
from restshape.shape.bsplines import cubic_of, edges_of_cubic
from restshape.shape.curves import chord_parameters
from restshape.shape.gaps import JOIN, Gap
from restshape.shape.loose_curve import Curve


def cut_closed(loose_curves: list[Curve], size: float, tolerance: float) -> tuple[list[Curve], list[Gap]]:
    """The curves with those splines in two edges whose ends meet; gaps between these ends are closed half-way.

    Args:
        loose_curves: the curves.
        size: of the drawing [m]; ends closer than `gaps.JOIN` of it meet.
        tolerance: the largest gap that is closed [m].

    Returns:
        The curves, and the gaps that were closed.
    """
    found: list[Curve] = []
    gaps: list[Gap] = []
    for curve in loose_curves:
        apart = float(np.hypot(*(curve.points[0] - curve.points[-1])))
        parts = _halves(curve) if curve.kind == "spline" and apart <= max(tolerance, JOIN * size) else []
        found += parts or [curve]
        if parts and apart > JOIN * size:
            x, y = parts[0].points[0]
            gaps.append(Gap((float(x), float(y)), apart, (curve.source, curve.source)))
    return found, gaps


def _halves(curve: Curve) -> list[Curve]:
    """The two edges of a spline whose ends go half-way to each other; none where its points are too few or too many."""
    if not 3 <= len(curve.points) <= SPLINE_POINTS:
        return []
    whole = cubic_of(curve.points, curve.knots or chord_parameters(curve.points), curve.ends)
    controls = whole.c.copy()
    controls[[0, -1]] = 0.5 * (controls[0] + controls[-1])
    parts = edges_of_cubic(whole.t, controls)
    return [replace(curve, points=points, knots=knots, ends=ends) for points, knots, ends in parts]
