"""Where a measured outline is placed on the shadow of a drape: how it is turned, and where its middle is."""

from __future__ import annotations

import numpy as np
from restshape_apps.couture.fitting.measured_outline import middle_of_area
from restshape_apps.couture.fitting.outline_distance import Distances, Place, distances

from restshape.physics.cloth.drape_shadow import DIRECTIONS, ShadowEdge, reach

PEAKS = 4
"""Turns that are tried: the best ones of the correlation of radii."""
STEPS = 30
"""Most Gauss-Newton steps."""
STILL = 1e-6
"""Change of the misfit, as a share, below which it is found."""
DAMPING = 1e-3
"""First damping of Levenberg and Marquardt, over the diagonal."""


def aligned(measured: np.ndarray, edge: ShadowEdge, last: Place | None = None) -> tuple[Place, Distances]:
    """The place with the least misfit of a measured outline, and its distances there.

    Args:
        measured: (m, 2) places along the outline from its middle [m].
        edge: of the shadow.
        last: a place to begin from as well, with the best of those that the correlation of radii gives.
    """
    starts = [] if last is None else [last]
    starts += _correlated(measured, edge)
    tried = [(place, distances(measured, place, edge)) for place in starts]
    tried.sort(key=lambda one: one[1].rms)
    found = [_refined(measured, edge, *one) for one in tried[: 1 if last else 2]]
    return min(found, key=lambda one: one[1].rms)


def _refined(measured: np.ndarray, edge: ShadowEdge, place: Place, here: Distances) -> tuple[Place, Distances]:
    """The place with the least misfit near one, by Levenberg and Marquardt's steps."""
    damping, scale = DAMPING, 1.0 / max(float(np.hypot(*measured.T).max()), 1e-12)
    units = np.array([scale, 1.0, 1.0])
    for _ in range(STEPS):
        weights = here.weights
        J, r = weights[:, None] * here.by_place * units, weights * here.values
        JJ = J.T @ J
        step = -units * np.linalg.lstsq(JJ + damping * np.diag(np.diag(JJ) + 1e-9), J.T @ r, rcond=None)[0]
        moved = Place(place.turn + step[0], place.x + step[1], place.y + step[2])
        there = distances(measured, moved, edge)
        if there.rms < here.rms:
            gain = 1.0 - there.rms / here.rms
            place, here, damping = moved, there, 0.2 * damping
            if gain < STILL:
                break
        else:
            damping *= 10.0
            if damping > 1e6 * DAMPING:
                break
    return place, here


def _correlated(measured: np.ndarray, edge: ShadowEdge) -> list[Place]:
    """Places whose turn correlates the radii of both best, about the middles of both areas."""
    points = edge.points()
    shadow_middle = middle_of_area(points)
    own = reach(measured, np.roll(measured, -1, axis=0))
    centred = points - shadow_middle
    theirs = reach(centred, np.roll(centred, -1, axis=0))
    product = np.fft.rfft(theirs - theirs.mean()) * np.conj(np.fft.rfft(own - own.mean()))
    found = np.fft.irfft(product, DIRECTIONS)
    peaks = np.flatnonzero((found >= np.roll(found, 1)) & (found > np.roll(found, -1)))
    best = peaks[np.argsort(-found[peaks])][:PEAKS] if len(peaks) else np.zeros(1)
    return [Place(2.0 * np.pi / DIRECTIONS * float(k), *map(float, shadow_middle)) for k in best]
