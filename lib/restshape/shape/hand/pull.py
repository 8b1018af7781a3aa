"""Pin-and-pull of a curve: the hand moves one point of it, pinned points stay, what is between follows smoothly."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.shape.chain import Chain, chain_of, control_of, place_on
from restshape.shape.hand.gesture import Gesture, extend_to_controls
from restshape.shape.outline import Outline
from restshape.shape.topology_edits import nearest

WEAKEST = 0.05
"""Least share of the hand's way that the curve's own points may make where it pulls: below, they would fly off."""


def pull(
    outline: Outline, on: str, at: tuple[float, float] | None, pins: Sequence[str | tuple[float, float]] | None
) -> tuple[Gesture, tuple[float, float]]:
    """The gesture of a pull, c being the displacement of the cursor [m], and the place (x, y) that the hand holds.

    Between the hand and the nearest pin on each side, control points follow by 1 - 3 r^2 + 2 r^3 at the share r of the
    length of the curve; beyond a pin nothing moves. On a side without a pin the curve goes with the hand. All is scaled
    so that the point under the hand moves with it exactly.

    Args:
        outline: the shape.
        on: an edge, hole, or group of edges that join.
        at: the hand takes the nearest point of the curve [m]; default: the middle of its length.
        pins: vertices by name, or places [m] of which the nearest control point is pinned; default: the ends of the
            curve, but not the end that the hand takes itself.

    Raises:
        UserError: not a curve, a pin that is not on it, or nothing between the pins that could follow.
    """
    chain = chain_of(outline, on)
    edge, s = _grabbed_point(outline, on, chain, at)
    hand = place_on(outline, chain, edge, s)
    pinned = _pinned(outline, chain, hand, pins)
    weights = np.zeros(len(outline.points))
    weights[chain.controls] = _weights(chain, hand, chain.places[pinned])
    weights[chain.controls[pinned]] = 0.0
    # A point of an edge is linear in its control points, so that one number shows how far it goes with them.
    share = outline.point(edge, s, np.column_stack([weights, np.zeros_like(weights)]))[0, 0]
    if share < WEAKEST:
        raise UserError(
            f"{on} has no control point between its pins that could follow a pull there",
            do="insert a vertex, take a spline or a polyline with points there, or make it an arc",
        )
    weights /= share
    chosen = np.zeros(len(weights), dtype=bool)
    chosen[chain.controls] = True
    basis = np.stack([extend_to_controls(outline, chosen, weights[:, None] * unit) for unit in np.eye(2)])
    gesture = Gesture("pull", basis, True, outline.points, np.zeros(len(weights), dtype=bool))
    x, y = outline.point(edge, s)[0].tolist()
    return gesture, (x, y)


def _grabbed_point(outline: Outline, on: str, chain: Chain, at: tuple[float, float] | None) -> tuple[int, float]:
    """Edge and parameter of the point that the hand takes."""
    if at is not None:
        return nearest(outline, outline.entity(on), np.array(at))
    k = int(np.searchsorted(chain.begins, 0.5 * chain.length, side="right")) - 1
    edge = chain.edges[k][0]
    fine = np.linspace(0.0, 1.0, 257)
    places = [place_on(outline, chain, edge, s) for s in fine]
    return edge, float(fine[int(np.abs(np.array(places) - 0.5 * chain.length).argmin())])


def _pinned(outline: Outline, chain: Chain, hand: float, pins: Sequence[str | tuple[float, float]] | None) -> Reals:
    """Indices into `chain.controls` of what stays."""
    if chain.closed and not pins:
        raise UserError(f"{chain.name} is closed: a pull on it needs a pin", do="pin something, or drag it as a whole")
    if pins is None:
        near = 1e-6 * chain.length
        ends = [(0, hand), (len(chain.controls) - 1, chain.length - hand)]
        return np.array([i for i, gap in ends if gap > near], dtype=int)
    return np.array(sorted({control_of(outline, chain, pin) for pin in pins}), dtype=int)


def _weights(chain: Chain, hand: float, pins: Reals) -> Reals:
    """The share (n,) of the hand's way that each control point of the chain goes, before scaling."""
    weights = np.zeros(len(chain.places))
    for sign in (1.0, -1.0):
        gaps, to_pins = chain.gaps(hand, chain.places, sign), chain.gaps(hand, pins, sign)
        reach = min((gap for gap in to_pins if gap >= 0.0), default=np.inf)
        side = (gaps >= 0.0) & (gaps < reach)
        r = gaps[side] / reach
        weights[side] = 1.0 - r**2 * (3.0 - 2.0 * r)
    return weights
