"""Hard cases of folds: a napkin folded in both directions, a skirt of twelve folds, strips without weight."""

from collections.abc import Iterator

import numpy as np
from restshape_studies.stability.case import Case, Statement, Trial, below, near, true
from restshape_studies.stability.known_bounds import Known
from restshape_studies.stability.scenery import block, meshed
from restshape_verification.couture.hard_scenes import (
    BALL,
    CONTACT,
    GRAVITY,
    HEAD,
    QUANTITIES,
    cloth,
    cotton,
    floor,
    outside,
    pinned,
    played,
    square,
    start,
)
from restshape_verification.couture.placed_strips import along, heights_at, rested

from restshape.physics.cloth.relaxation.saddle_escape import SaddleEscape
from restshape.replay.loop import Replay

NAPKIN, RADIUS, AROUND = 0.2, 6.3e-3, 22e-3
"""Side of a napkin, radius of its first fold, and of the second one about both layers of that, at first [m]."""
INSIDE = ((0.1, 0.1), (0.2, 0.2), (0.15, 0.25), (0.25, 0.1))
"""Places inside the folded napkin, over its side."""
HEM, WAIST, HIPS, SPREAD, FOLDS = 0.3, 0.1, 0.12, np.deg2rad(30.0), 12
"""Radii of a skirt's hem and waist, and of the ball below [m]; its angle to the vertical at first; its folds."""
STRIP, BROAD, SIZE = 0.3, 0.05, 0.02
"""Length and width of a strip, and size of its triangles [m]."""
SKIRT = f"""
[shape]
outline = ["lower", "upper"]

[shape.vertices]
west = [{-HEM}, 0]
east = [{HEM}, 0]

[shape.edges]
lower = {{ arc = ["west", "east"], bulge = 1 }}
upper = {{ arc = ["east", "west"], bulge = 1 }}

[shape.holes]
waist = {{ circle = {{ center = [0, 0], radius = {WAIST} }} }}
"""
PLATE = Known(0.05, "a strip is between a plate, which cannot get narrower across, and a beam: 1 - nu^2 is 0.91")
"""Bound of the energy of a buckled strip over the mean of both."""
FLAT = Known(1e-12, "a hundred millionth, the square of the tolerance, of the energy [J] that the jump has stored")
BRANCH = Known(1e-3, "both are at rest to a tolerance of 1e-4, without weight")


def settled_from(made: Replay, x: np.ndarray) -> Iterator[Statement]:
    """Let cloth come to rest from places x (corners, 3) [m]; the statements that it does, stably, uncrossed."""
    sheet = made.analysis.problem
    corners, report = rested(made.analysis, x)
    yield true("at rest", report.converged, report.why)
    yield true("stable", bool(SaddleEscape(made.analysis.state.solver).is_stable(made.analysis.x)))
    yield below("crossings", len(sheet.surface.crossed(corners)), 0)


def napkin(trial: Trial) -> Iterator[Statement]:
    """A napkin on a floor is folded in half, comes to rest, and is folded across: four layers, none through another."""
    text = square(
        0.01, floor(0.0), f"{CONTACT}self_friction = 0.3\n", start(move=(0, 0, 1e-3)), side=NAPKIN, bending=4e-6
    )
    made, _ = played(trial, text)
    sheet = made.analysis.problem
    bottom = sheet.corners(made.analysis.x)[:, 2].mean()
    flat = 0.5 * (NAPKIN - np.pi * RADIUS)
    folded = along([(flat, 0.0), (np.pi * RADIUS, 1.0 / RADIUS), (flat, 0.0)])(sheet.mesh.X[:, 1])
    yield from settled_from(made, np.column_stack([sheet.mesh.X[:, 0], folded[:, 0], folded[:, 1] + bottom]))
    y = sheet.corners(made.analysis.x)
    height, begin = y[:, 2] - bottom, 0.5 * (y[:, 0].min() + y[:, 0].max() - np.pi * AROUND)
    turn = np.clip((y[:, 0] - begin) / AROUND, 0.0, np.pi)
    beyond = np.maximum(y[:, 0] - begin - np.pi * AROUND, 0.0)
    along_x = np.minimum(y[:, 0], begin) + (AROUND - height) * np.sin(turn) - beyond
    yield from settled_from(
        made, np.column_stack([along_x, y[:, 1], bottom + AROUND - (AROUND - height) * np.cos(turn)])
    )
    y = sheet.corners(made.analysis.x)
    places = y[:, :2].min(axis=0) + NAPKIN * np.array(INSIDE)
    layers = [len(heights_at(sheet, y, (float(a), float(b)))) for a, b in places]
    yield true("four layers lie on each other", layers == [4] * len(layers), str(layers))
    yield outside(made, 1e-3)


def skirt(trial: Trial) -> Iterator[Statement]:
    """A skirt of twelve folds on a ball keeps all of them, and does not come through itself."""
    ball = BALL.format(x=0, y=0, z=-0.15, radius=HIPS, friction=0.3)
    head = HEAD + SKIRT + cotton(1e-6) + cloth() + GRAVITY + meshed(0.02) + QUANTITIES
    made, _ = played(trial, head + ball + CONTACT + pinned("waist"))
    X = made.analysis.problem.mesh.X
    radius, angle = np.hypot(*X.T), np.arctan2(X[:, 1], X[:, 0])
    length = radius - WAIST
    mean = WAIST + length * np.sin(SPREAD)
    # Waves as long, around, as the circle was in the pattern.
    waves = mean / FOLDS * 2.0 * np.sqrt(np.maximum(radius / mean - 1.0, 0.0))
    out = mean + waves * np.cos(FOLDS * angle)
    yield from settled_from(made, np.column_stack([out * np.cos(angle), out * np.sin(angle), -length * np.cos(SPREAD)]))
    y = made.analysis.problem.corners(made.analysis.x)
    hem = np.flatnonzero(radius > HEM - 1e-6)
    away = np.hypot(*y[hem[np.argsort(angle[hem])], :2].T) - np.hypot(*y[hem, :2].T).mean()
    yield near("folds of the hem", np.count_nonzero((away < 0.0) & (np.roll(away, -1) >= 0.0)), FOLDS, 0.0)
    yield outside(made, 1e-3)


def weightless(trial: Trial) -> Iterator[Statement]:
    """A strip without weight whose clamped end jumps by a triangle in one frame, and back: flat at the end."""
    ends = pinned("left", fix='["x", "y", "z", "slope"]')
    ends += '[supports.right]\non = "right"\nfix = { x = 0, y = 0, z = 0, slope = 0 }\n'
    text = HEAD + block(STRIP, BROAD) + cotton(1e-4) + cloth("morley") + meshed(SIZE) + QUANTITIES + ends
    for axis, way in (("x", -SIZE), ("y", SIZE), ("z", SIZE)):
        key = f"supports.right.fix.{axis}"
        there, back = ({"do": "set", "key": key, "value": value, "frames": 1} for value in (way, 0.0))
        _, rows = played(trial, text, [there, back])
        resting = all(row["converged"] and row["tangent_positive_definite"] == 1 for row in rows)
        yield true(f"{axis}: at rest, and stable", resting, "; ".join(row["note"] for row in rows if row["note"]))
        yield below(f"{axis}: crossings", max(row["crossings"] for row in rows), 0)
        yield below(f"{axis}: energy at the end [J]", rows[-1]["q_potential"], FLAT)
        if axis == "x":
            # Euler's load over the way, and its first correction for the elastica, 1 + s/4L.
            euler = 4.0 * np.pi**2 * 1e-4 * BROAD / STRIP**2 * SIZE * (1.0 + SIZE / (4.0 * STRIP))
            yield near("x: energy over that of a buckled elastica", rows[1]["q_potential"], 0.955 * euler, PLATE)
            _, slow = played(trial, text, [{**there, "frames": 20}])
            yield near("x: energy over that by small steps", rows[1]["q_potential"], slow[-1]["q_potential"], BRANCH)


CASES = {"napkin": Case(napkin, weekly=("auto",)), "skirt": Case(skirt), "weightless": Case(weightless)}
