"""Hard cases of contact: bodies that move far, close upon cloth or gather it in a ring; needles; friction 0 and 2."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from restshape_studies.stability.case import Case, Row, Statement, Trial, above, below, near, true, valid
from restshape_studies.stability.known_bounds import STATIONARY
from restshape_studies.stability.scenery import set_value
from restshape_verification.couture.hard_scenes import (
    BALL,
    CONTACT,
    REST,
    ball,
    depth,
    floor,
    outside,
    pinned,
    played,
    resting,
    samples,
    square,
    start,
)

from restshape.replay.loop import Replay

HALF = 1e-3
"""Half of the distance [m] at which contact begins: no place of a triangle is to be deeper in a body."""
RING, TUBE, SEGMENTS = 0.04, 0.005, 12
"""Radii [m] of a ring and of its tube; capsules that it is made of."""
PRESS = """
[bodies.low]
box = { center = [0.15, 0.15, -0.052], half = [0.1, 0.1, 0.05], radius = 0.005 }
friction = 0.3

[bodies.high]
box = { center = [0.15, 0.15, 0.152], half = [0.1, 0.1, 0.05], radius = 0.005 }
friction = 0.3
"""
NEEDLE = """
[bodies.needle]
capsule = {{ start = [{x}, -0.1, {z}], end = [{x}, 0.4, {z}], radius = 0.0005 }}
friction = 0.3
"""


def dragged(x: float, *ends: float) -> list[dict[str, object]]:
    """Events that drag the ball along x, from one place to others, each in one frame."""
    events: list[dict[str, object]] = [{"do": "press", "on": "ball", "at": [x, 0.15]}]
    return [*events, *({"do": "drag", "to": [end, 0.15], "frames": 1} for end in ends), {"do": "release"}]


def any_speed(trial: Trial) -> Iterator[Statement]:
    """A ball crosses a hanging cloth by 0.25 m in one frame, in two and in five: the cloth is before it each time."""
    for frames in (1, 2, 5)[: trial.count(3, 2)]:
        ways = [-0.2 + 0.25 * (k + 1) / frames for k in range(frames)]
        text = square(0.03, BALL.format(x=-0.2, y=0.15, z=-0.12, radius=0.05, friction=0.3), CONTACT, pinned("left"))
        made, rows = played(trial, text, dragged(-0.2, *ways))
        yield from resting(made, rows)
        yield outside(made, HALF)
        places = samples(made)
        beside = places[(np.abs(places[:, 1] - 0.15) < 0.02) & (np.abs(places[:, 2] + 0.12) < 0.02)]
        yield above(f"cloth before the ball, in {frames} frames [m]", float(beside[:, 0].min()), 0.05)


def ten_metres(trial: Trial) -> Iterator[Statement]:
    """A ball goes 10 m past the end of a hanging cloth in one frame, and back: the energy at the end is the first."""
    text = square(0.04, BALL.format(x=-5.0, y=0.15, z=-0.12, radius=0.05, friction=0.3), CONTACT, pinned("left"))
    made, rows = played(trial, text, dragged(-5.0, 5.0, -5.0))
    yield from resting(made, rows)
    yield true("its way was gone in parts, which a note says", "parts" in rows[2]["note"], rows[2]["note"])
    yield near("energy over the first one", rows[-1]["q_potential"] / rows[0]["q_potential"], 1.0, STATIONARY)


def closing(trial: Trial) -> Iterator[Statement]:
    """Two boxes close upon cloth to 1.5 thicknesses of contact in one frame, and open again."""
    text = square(0.025, PRESS, CONTACT, floor(-0.2))
    run = trial.replay(text, set_value("bodies.high.box.center", [0.15, 0.15, 0.051], [0.15, 0.15, 0.15]))
    made = run.replay
    rows, most = [], 0.0
    for row in run.rows():
        rows.append(dict(row))
        most = max(most, depth(made))
    yield from resting(made, rows)
    yield below("depth of a triangle in a body [m]", most, HALF)


def needle(trial: Trial) -> Iterator[Statement]:
    """A needle of 1 mm rises by 60 mm through where a cloth hangs that is held at its corners, in one frame."""
    text = square(0.03, NEEDLE.format(x=0.16, z=-0.08), CONTACT, pinned("a", "b", "c", "d"))
    ends = [{"start": [0.16, -0.1, z], "end": [0.16, 0.4, z], "radius": 0.0005} for z in (-0.02,)]
    run = trial.replay(text, set_value("bodies.needle.capsule", *ends))
    made = run.replay
    rows: list[Row] = [dict(row) for row in run.rows()]
    yield from resting(made, rows)
    yield outside(made, 0.5e-3)
    yield above("height of the cloth over the needle [m]", _over(made, 0.16), -0.02)


def _over(made: Replay, x: float) -> float:
    """The lowest place [m] of the cloth above a line along y."""
    places = samples(made)
    return float(places[np.abs(places[:, 0] - x) < 5e-4, 2].min())


def ring() -> str:
    """Capsules that make a ring about the z axis, at the height of a parameter."""
    angles = 2 * np.pi * np.arange(SEGMENTS + 1) / SEGMENTS
    ends = [f'[{RING * np.cos(a):.6f}, {RING * np.sin(a):.6f}, "ring"]' for a in angles]
    return "".join(
        f"\n[bodies.ring{k}]\ncapsule = {{ start = {one}, end = {two}, radius = {TUBE} }}\nfriction = 0.1\n"
        for k, (one, two) in enumerate(pairwise(ends))
    )


def through_a_ring(trial: Trial) -> Iterator[Statement]:
    """A handkerchief hangs from a corner, and a ring goes down over it: all that is at its level is gathered in it."""
    hung = f"\n[start]\nturn = [{-np.pi / 2}, {np.pi / 4}, 0]\n[parameters]\nring = -0.02\n"
    text = square(0.012, ring(), CONTACT, pinned("a"), hung, side=0.15, bending=1e-6)
    run = trial.replay(text, set_value("parameters.ring", -0.06, -0.1))
    made = run.replay
    rows: list[Row] = []
    for row in run.rows():
        rows.append(dict(row))
        places, level = samples(made), made.analysis.state.bodies[0].form.start[2]
        away = np.hypot(places[:, 0], places[:, 1])[np.abs(places[:, 2] - level) < 1e-3]
        yield below("distance of cloth at the ring's level from its axis [m]", float(away.max()), RING - TUBE + HALF)
        yield outside(made, HALF)
    yield from valid(rows)
    yield below("residual over weight", max(row["residual"] for row in rows), REST)


def frictions(trial: Trial) -> Iterator[Statement]:
    """Cloth that lies beside the middle of a ball slides off without friction, and stays at a coefficient of 2."""
    heights = {}
    for friction in (0.0, 2.0):
        text = square(0.025, ball(0.12, 0.15, friction=friction), CONTACT, floor(-0.4), start(move=(0, 0, 0.002)))
        made, rows = played(trial, text)
        yield from resting(made, rows)
        yield outside(made, HALF)
        heights[friction] = float(samples(made)[:, 2].max())
    yield below("highest place without friction [m]", heights[0.0], -0.3)
    yield above("highest place with a coefficient of 2 [m]", heights[2.0], -0.01)


CASES = {
    "any_speed": Case(any_speed, share=0.5),
    "ten_metres": Case(ten_metres, share=0.5, weekly=("auto",)),
    "closing": Case(closing),
    "needle": Case(needle),
    "frictions": Case(frictions),
    "through_a_ring": Case(through_a_ring),
}
