"""Splines that end where they begin, cut in two: an edge has two ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from restshape.bounds import SPLINE_POINTS
from restshape.shape.curves import chord_parameters
from restshape.shape.drawings.bsplines import cubic_of, edges_of_cubic
from restshape.shape.drawings.gaps import JOIN, Gap, Joints, joints
from restshape.shape.drawings.loose_curve import Curve


def cut_closed(loose_curves: list[Curve], size: float, tolerance: float) -> tuple[list[Curve], list[Gap]]:
    """The curves with those splines in two edges whose ends meet; gaps between these ends are closed half-way.

    A spline with an end that meets another curve, or is nearer to another's open end than to its own, stays whole.

    Args:
        loose_curves: the curves.
        size: of the drawing [m]; ends closer than `gaps.JOIN` of it meet.
        tolerance: the largest gap that is closed [m].

    Returns:
        The curves, and the gaps that were closed.
    """
    found: list[Curve] = []
    gaps: list[Gap] = []
    near = max(tolerance, JOIN * size)
    starts, stops = (np.array([curve.points[end] for curve in loose_curves]) for end in (0, -1))
    ends = joints(starts, stops, size)
    loose = ends.open_ends()
    for k, curve in enumerate(loose_curves):
        apart = float(np.hypot(*(starts[k] - stops[k])))
        closes = curve.kind == "spline" and apart <= near and _meets_itself(ends, loose, k, apart)
        parts = _halves(curve) if closes else []
        found += parts or [curve]
        if parts and apart > JOIN * size:
            x, y = parts[0].points[0]
            gaps.append(Gap((float(x), float(y)), apart, (curve.source, curve.source)))
    return found, gaps


def _meets_itself(ends: Joints, loose: dict[int, int], curve: int, apart: float) -> bool:
    """Whether a curve's ends are one, or both are open and nearer to each other than to another curve's open end."""
    pair = ends.ends[curve]
    if pair[0] == pair[1]:
        return True
    if not loose.keys() >= set(pair):
        return False
    others = [vertex for vertex, of in loose.items() if of != curve]
    far = np.hypot(*(ends.corners[others][:, None] - ends.corners[list(pair)]).T)
    return bool(far.min(initial=np.inf) >= apart)


def _halves(curve: Curve) -> list[Curve]:
    """The two edges of a spline whose ends go half-way to each other; none where its points are too few or too many."""
    if not 3 <= len(curve.points) <= SPLINE_POINTS:
        return []
    whole = cubic_of(curve.points, curve.knots or chord_parameters(curve.points), curve.ends)
    controls = whole.c.copy()
    controls[[0, -1]] = 0.5 * (controls[0] + controls[-1])
    parts = edges_of_cubic(whole.t, controls)
    return [replace(curve, points=points, knots=knots, ends=ends) for points, knots, ends in parts]
