"""Hard cases of what cloth is trusted for: openings that keep what is in them, ways that lead back, two rests."""

from collections.abc import Iterator

import numpy as np
from restshape_studies.bench.openings import borders, inside, kept, length
from restshape_studies.stability.case import Case, Row, Statement, Trial, above, below, near, true
from restshape_studies.stability.known_bounds import STATIONARY, Known
from restshape_studies.stability.scenery import block, meshed, set_value, write_scene
from restshape_verification.couture.drapes import drapes
from restshape_verification.couture.hard_scenes import (
    BALL,
    CONTACT,
    GRAVITY,
    HEAD,
    QUANTITIES,
    ball,
    cloth,
    cotton,
    depth,
    pinned,
    played,
    square,
)
from restshape_verification.couture.paths import SAME, compared

from restshape.physics.cloth.scene import cloth_arguments
from restshape.replay.loop import Replay

MOST_DEPTH = 1e-3
"""Depth [m] of a node in a body that is none to be seen."""
APART = Known(SAME, "loose cloth goes ten times as far as forces are balanced")
"""Bound of the distance over the size."""
MIRRORED = Known(1e-9, "energies differ by the square of the tolerance of forces")
TIGHT = 0.15
"""Height [m] of the middle of the head that is 60 mm larger than the hole."""
NECKLINE = Known(0.08, "an edge of the neckline bears much of the weight")
"""Bound of strains of ponchos whose hole the neck fits into."""
HAMMOCK = pinned("a", "b", "c", "d")
SMOOTH = BALL.format(x=0.15, y=0.15, z=-0.3, radius=0.1, friction=0.0)


def openings(made: Replay) -> tuple[dict[str, int], dict[str, int], np.ndarray]:
    """What was in the openings of a cloth at its start and is now, and places (k, 3) of its shortest border [m]."""
    state, mesh = made.analysis.state, made.analysis.space
    bodies, corners = dict(zip(state.scene.bodies, state.bodies)), state.problem.corners(state.x)
    start = cloth_arguments(state.scene, state.plan, mesh).start
    before, after = (inside(mesh.X, mesh.cells, x, bodies) for x in (start, corners))
    hole = min(borders(mesh.cells), key=lambda loop: length(mesh.X[loop]))
    return before, after, corners[hole]


def ponchos(trial: Trial) -> Iterator[Statement]:
    """Ponchos fall on bodies: necks stay in them, and one whose hole is 60 mm too small stays on the head."""
    known, size = drapes(), 0.03 / min(1.0, max(0.5, trial.share))
    for name in ("poncho", "poncho-sloping", "collar", "poncho-tight"):
        coarser = [] if name == "collar" else [f"mesh.size={size}"]
        made, (row,) = played(trial, str(known[name]), overrides=coarser)
        before, after, hole = openings(made)
        yield true(
            f"{name}: at rest, and stable", row["converged"] and row["tangent_positive_definite"] == 1, row["note"]
        )
        yield below(f"{name}: depth of a node in a body [m]", depth(made), MOST_DEPTH)
        if name == "poncho-tight":
            yield above(
                "poncho-tight: lowest place of its hole over the middle of the head [m]", hole[:, 2].min() - TIGHT, 0.0
            )
            yield from _said(name, row)
            continue
        yield true(f"{name}: the neck stays in it", kept(before, after) is True, ", ".join(after) or "nothing is in it")
        yield below(f"{name}: largest strain of an edge", row["max_strain"], NECKLINE)
        yield from _said(name, row)


def _said(name: str, row: Row) -> Iterator[Statement]:
    """The statement that a frame says so where an edge is stretched too far."""
    stretched = row["max_strain"] > 0.05
    yield true(f"{name}: stretched beyond 5 % or not, it says so", ("stretched" in row["untrusted"]) == stretched)


def there_and_back(trial: Trial) -> Iterator[Statement]:
    """A smooth ball lifts a cloth on four pins and leaves it, 1,000 frames: the energy at the end is the first one."""
    count = trial.count(1000, 40)
    period = min(100, count)
    heights = -0.3 + 0.35 * 0.5 * (1.0 - np.cos(2.0 * np.pi * np.arange(1, count + 1) / period))
    heights[-1] = -0.3
    text = square(0.05, SMOOTH, CONTACT, HAMMOCK)
    _, rows = played(trial, text, set_value("bodies.ball.sphere.center.2", *heights.tolist()))
    still = [row["note"] for row in rows if not row["converged"]]
    yield true(f"{count} frames in equilibrium", not still, still[0] if still else "yes")
    yield near("energy at the end", rows[-1]["q_potential"], rows[0]["q_potential"], STATIONARY)
    # Each time round it is lifted alike: folds may go to either side.
    lifted = [row["q_highest"] for row in rows[period // 2 :: period]]
    yield near("lift by the ball each time", lifted, lifted[0], Known(0.02, "folds may go to either side"))


def two_rests(trial: Trial) -> Iterator[Statement]:
    """A strip pushed together buckles up or down and loses its weight: both rests have one energy; undo keeps one."""
    ends = pinned("left", fix='["x", "y", "z", "slope"]')
    ends += '[supports.right]\non = "right"\nfix = { x = 0, y = 0, z = 0, slope = 0 }\n'
    strip = block(0.3, 0.05) + cotton(1e-4) + cloth("morley") + meshed(0.02) + QUANTITIES + ends
    # No farther in a frame than a tenth of a triangle.
    push = {"do": "set", "key": "supports.right.fix.x", "value": -0.02, "frames": 10}
    found = {}
    for lean in (-1e-3, 1e-3):
        weight = f"{GRAVITY}g = [0, 0, {lean}]\n"
        light = {"do": "set", "key": "effects.gravity.g", "value": [0.0, 0.0, 0.0]}
        _, rows = played(trial, HEAD + strip + weight, [push, light, {"do": "undo"}, {"do": "redo"}])
        pushed, again = rows[11], rows[13]
        yield true(
            f"{lean:+g} m/s^2: converged and stable", pushed["converged"] and pushed["tangent_positive_definite"] == 1
        )
        side = 1 if pushed["q_highest"] > -pushed["q_lowest"] else -1
        found[side] = pushed["q_bent"] + pushed["q_stretched"]
        same = pushed["q_potential"] == again["q_potential"] and pushed["q_highest"] == again["q_highest"]
        yield true(f"{lean:+g} m/s^2: redo brings back the rest that was, to the last bit", same)
    yield true("starts buckle to both sides", set(found) == {1, -1}, str(sorted(found)))
    yield near("energies of both sides", found.get(1, 0.0), found.get(-1, 0.0), MIRRORED)


def _path_scenes() -> dict[str, tuple[str, list[dict[str, object]], bool]]:
    """By name a scene, edits, and whether the energy has one minimum near."""
    ramp = [{"do": "set", "key": "bodies.ball.sphere.center.2", "value": -0.1, "frames": 8}]
    strip = HEAD + block(0.5, 0.05) + cotton(1e-4) + cloth() + GRAVITY + meshed(0.025) + QUANTITIES
    pins = strip + pinned("left") + '[supports.right]\non = "right"\nfix = { x = 0, y = 0, z = 0 }\n'
    curtain = square(0.04, pinned("top"))
    return {
        "hammock on a smooth ball": (square(0.04, SMOOTH, CONTACT, HAMMOCK), ramp, True),
        "strip whose ends come nearer": (
            pins,
            [{"do": "set", "key": "supports.right.fix.x", "value": -0.1, "frames": 8}],
            True,
        ),
        "cantilever that gets softer": (
            strip + pinned("left", fix='["x", "y", "z", "slope"]'),
            [{"do": "set", "key": "material.cotton.rho", "value": 1500, "frames": 8}],
            True,
        ),
        "curtain cut longer": (
            curtain,
            [
                {"do": "press", "on": "bottom"},
                {"do": "drag", "to": [0.15, -0.1], "frames": 8},
                {"do": "release"},
            ],
            True,
        ),
        "sheet on pins that part": (
            square(0.04, HAMMOCK),
            [{"do": "set", "key": "material.cotton.E", "value": 1e5, "frames": 8}],
            True,
        ),
        "cloth that a rough ball drags": (
            square(0.04, ball(0.15, 0.15, friction=0.8), CONTACT),
            [{"do": "set", "key": "bodies.ball.sphere.radius", "value": 0.06, "frames": 8}],
            False,
        ),
    }


def paths(trial: Trial) -> Iterator[Statement]:
    """The same edits in half as many frames end in one drape where there is one near; else two are reported."""
    for name, (text, events, one) in _path_scenes().items():
        ends = compared(write_scene(trial.folder, text), events, trial.policy)
        yield true(f"{name}: all frames converged", all(ends.converged))
        report = ends.report()
        if one:
            yield below(
                f"{name}: distance over size", (np.inf if ends.distance is None else ends.distance) / ends.size, APART
            )
        else:
            yield true(
                f"{name}: it says which", report.startswith("the same drape" if ends.same else "two rests"), report
            )


CASES = {
    "ponchos": Case(ponchos, share=0.5),
    "there_and_back": Case(there_and_back, share=0.04),
    "two_rests": Case(two_rests),
    "paths": Case(paths, weekly=("auto",)),
}
