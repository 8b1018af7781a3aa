"""Hard bodies of triangles: sharp edges, holes, bodies that touch, sizes far apart, narrow bands, new measures."""

from collections.abc import Iterator

from restshape_studies.stability.case import Case, Statement, Trial, above, below, true
from restshape_studies.stability.scenery import set_value
from restshape_verification.couture.body_files import ball, joined, slab, without_top
from restshape_verification.couture.hard_scenes import (
    CONTACT,
    depth,
    floor,
    outside,
    pinned,
    played,
    resting,
    square,
)
from restshape_verification.couture.stability_bodies import THICKNESS

from restshape.application import application

GROWING = application("couture").folder / "scenes" / "growing.toml"
COARSE = ("mesh.size=0.06", 'bodies.body.mannequin.spacing="15 mm"', 'bodies.body.mannequin.band="15 mm"')
TOP = (0.15, 0.15, -2e-3)
"""Where the middle of a body's top is [m]: the cloth begins above it."""


def body(trial: Trial, obj: str, more: str, move: tuple[float, float, float] = TOP, name: str = "body") -> str:
    """The table of a rough body of a surface, which is written beside the scene."""
    (trial.folder / f"{name}.obj").write_text(obj)
    form = f'mesh = {{ file = "{name}.obj", unit = "m", move = {list(move)}, {more} }}'
    return f"\n[bodies.{name}]\n{form}\nfriction = 0.3\n"


def mesh_edge(trial: Trial) -> Iterator[Statement]:
    """Cloth falls over the sharp edges and corners of a block of twelve triangles: at rest, and not cut through."""
    block = body(trial, slab(0.08, 0.08, 0.1), "spacing = 0.005")
    made, rows = played(trial, square(0.025, block, CONTACT, floor(-0.3)))
    yield from resting(made, rows)
    yield outside(made, THICKNESS)
    yield above("height of the highest place [m]", rows[0]["q_highest"], TOP[2])


def mesh_hole(trial: Trial) -> Iterator[Statement]:
    """Cloth falls on a ball whose mesh has a hole at its top: it is closed, and the cloth rests across it."""
    round_, found = ball(0.1, 12), []
    for obj in (round_, without_top(round_, 0.012)):
        bodies = body(trial, obj, "spacing = 0.01", (0.15, 0.15, -0.102))
        found.append(played(trial, square(0.03, bodies, CONTACT, floor(-0.3))))
    (_, whole), (made, rows) = found
    yield from resting(made, rows)
    yield outside(made, THICKNESS)
    # What closes it lies up to 0.7 mm below the ball.
    lower = whole[0]["q_highest"] - rows[0]["q_highest"]
    yield below("how much lower it lies than on the whole ball [m]", abs(lower), 3e-3)


def mesh_touching(trial: Trial) -> Iterator[Statement]:
    """Cloth lies on two blocks that share a face, in one file and in two: at rest alike, and outside of both."""
    block = slab(0.05, 0.1, 0.08)
    ways = [(0.1, 0.15, TOP[2]), (0.2, 0.15, TOP[2])]
    one = body(trial, joined(block, block, (0.1, 0.0, 0.0)), "spacing = 0.008", ways[0], "pair")
    apart = [body(trial, block, "spacing = 0.008", way, name) for way, name in zip(ways, ("near", "far"))]
    highest = []
    for bodies in (one, "".join(apart)):
        made, rows = played(trial, square(0.03, bodies, CONTACT, floor(-0.3)))
        yield from resting(made, rows)
        yield outside(made, THICKNESS)
        highest.append(rows[0]["q_highest"])
    yield below("difference of their heights [m]", abs(highest[0] - highest[1]), THICKNESS)


def mesh_sizes(trial: Trial) -> Iterator[Statement]:
    """Cloth lies on a block of 100 m, and hangs over a ball of 1 cm: at rest on both."""
    large = body(trial, slab(50.0, 50.0, 100.0), "spacing = 2.0")
    made, rows = played(trial, square(0.03, large, CONTACT))
    yield from resting(made, rows)
    yield outside(made, THICKNESS)
    yield below("how far the cloth has sunk [m]", -rows[0]["q_lowest"], 2.0 * THICKNESS)
    small = body(trial, ball(0.005, 8), "spacing = 0.0005, band = 0.003", (0.02, 0.02, -0.007))
    made, rows = played(trial, square(0.004, small, CONTACT, floor(-0.1), side=0.04))
    yield from resting(made, rows)
    yield outside(made, THICKNESS)


def mesh_band(trial: Trial) -> Iterator[Statement]:
    """A ball whose grid ends 3 mm from its surface is deep in a cloth in one frame, and gone in the next."""
    far, deep = [0.15, 0.15, -0.5], [0.15, 0.15, -0.04]
    narrow = body(trial, ball(0.1, 10), "spacing = 0.01, band = 0.003", tuple(far))
    run = trial.replay(
        square(0.03, narrow, CONTACT, pinned("a", "b", "c", "d")), set_value("bodies.body.mesh.move", deep, far)
    )
    made = run.replay
    rows, seen = [], []
    for row in run.rows():
        rows.append(dict(row))
        seen.append(depth(made))
    yield from resting(made, rows)
    yield below("depth of a place in the ball [m]", max(seen), 1.5 * THICKNESS)
    yield above("lift of the cloth by the ball [m]", rows[1]["q_highest"], 0.03)


def growing(trial: Trial) -> Iterator[Statement]:
    """The hips of a mannequin grow under a skirt, and an undo takes them back: at rest, outside, and as it was."""
    wider = {"do": "set", "key": "parameters.hip", "value": "104 cm", "frames": 1}
    run = trial.replay(GROWING, [wider, {"do": "undo"}], COARSE)
    made = run.replay
    rows, seen = [], []
    for row in run.rows():
        rows.append(dict(row))
        seen.append(depth(made))
    yield from resting(made, rows)
    yield below("depth of a place in the body [m]", max(seen), THICKNESS)
    yield true("the new sizes are noted", "new sizes" in rows[1]["note"], rows[1]["note"])
    risen = rows[1]["q_potential"] - rows[0]["q_potential"]
    yield above("energy by which the hips stretch and lift the skirt [J]", risen, 0.05)
    yield true("the undo brings the same drape back, to the last bit", rows[2]["q_potential"] == rows[0]["q_potential"])


CASES = {
    "mesh_edge": Case(mesh_edge, weekly=("auto",)),
    "mesh_hole": Case(mesh_hole, weekly=("auto",)),
    "mesh_touching": Case(mesh_touching, weekly=("auto",)),
    "mesh_sizes": Case(mesh_sizes, weekly=("auto",)),
    "mesh_band": Case(mesh_band, weekly=("auto",)),
    "growing": Case(growing, weekly=("auto",)),
}
