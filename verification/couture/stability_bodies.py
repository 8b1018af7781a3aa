"""Hard bodies under cloth: they come from deep within, are gone at once, are thin, or smooth."""

from collections.abc import Iterator

from restshape_studies.stability.case import Case, Statement, Trial, above, below, near, true
from restshape_studies.stability.known_bounds import STATIONARY
from restshape_studies.stability.scenery import across, drag, set_value
from restshape_verification.couture.hard_scenes import (
    BALL,
    CONTACT,
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

THICKNESS = 2e-3
"""Distance [m] at which contact begins: cloth is to be no deeper in a body than that."""
HAMMOCK = pinned("a", "b", "c", "d")
CENTRE = "bodies.ball.sphere.center"
BAR = """
[bodies.bar]
capsule = {{ start = [0.15, -0.1, {z}], end = [0.15, 0.3, {z}], radius = {radius} }}
friction = 0.3
"""


def deep(trial: Trial) -> Iterator[Statement]:
    """A ball below a cloth held at four corners is deep in it in one frame, and gone in the next, again and again."""
    far = BALL.format(x=0.15, y=0.15, z=-0.5, radius=0.1, friction=0.3)
    places = [[0.15, 0.15, -0.04], [0.15, 0.15, -0.5], [0.2, 0.1, -0.06], [0.15, 0.15, -0.5]]
    for kind in ("morley", "hinge"):
        text = square(0.025, far, CONTACT, HAMMOCK, kind=kind)
        run, seen = trial.replay(text, set_value(CENTRE, *places)), []
        made = run.replay
        rows = []
        for row in run.rows():
            rows.append(dict(row))
            seen.append(depth(made))
        yield from resting(made, rows)
        # Drawn over the ball it presses on it with more than its weight.
        yield below("depth of a node in the ball [m]", max(seen), 1.5 * THICKNESS)
        yield above("lift of the cloth by the ball [m]", min(rows[k]["q_highest"] for k in (1, 3)), 0.03)
        lost = [rows[k]["q_potential"] for k in (2, 4)]
        yield near("energy once the ball is gone is the first one", lost, rows[0]["q_potential"], STATIONARY)


def swollen(trial: Trial) -> Iterator[Statement]:
    """The ball that cloth lies on is twice as large in one frame, half in the next, and as at first."""
    text = square(0.025, ball(0.15, 0.15), CONTACT, floor(-0.3))
    run = trial.replay(text, set_value("bodies.ball.sphere.radius", 0.2, 0.1, 0.05, 0.1))
    made = run.replay
    rows, most = [], 0.0
    for row in run.rows():
        rows.append(dict(row))
        most = max(most, depth(made))
    yield from resting(made, rows)
    yield below("depth of a node in a body [m]", most, THICKNESS)


def gone(trial: Trial) -> Iterator[Statement]:
    """One of two balls under a cloth jumps away and back: the cloth finds equilibrium on what is left."""
    other = ball(0.22, 0.15, 0.07).replace("bodies.ball", "bodies.other")
    text = square(0.025, ball(0.08, 0.15, 0.07), other, CONTACT, floor(-0.3))
    made, rows = played(trial, text, [*drag("ball", (0.08, 0.15), [(0.08, 1.15)]), {"do": "undo"}])
    yield from resting(made, rows)
    yield below("energy without the ball, less than before [J]", rows[2]["q_potential"] - rows[0]["q_potential"], 0.0)
    yield outside(made, THICKNESS)


def thin_bar(trial: Trial) -> Iterator[Statement]:
    """Cloth falls across bars thinner than its mesh is fine: it hangs on them, and does not come through."""
    for radius, size, height in ((0.002, 0.008, -0.006), (0.002, 0.008, -0.25), (0.005, 0.01, -0.1)):
        text = square(size, BAR.format(z=height, radius=radius), CONTACT, floor(-0.6), height=0.06)
        made, rows = played(trial, text)
        yield from resting(made, rows)
        above_bar = abs(rows[0]["q_highest"] - height - radius)
        # Stiff cloth whose layers touch below the bar hangs in a loop, which is highest beside the bar.
        yield below("distance of the highest place from the top of the bar [m]", above_bar, 2.0 * THICKNESS)
        yield outside(made, THICKNESS)


def wire(trial: Trial) -> Iterator[Statement]:
    """A wire of 1 mm under triangles of 40 mm: the cloth hangs on it, and it does not come through between nodes."""
    text = square(0.04, BAR.format(z=-0.006, radius=0.0005), CONTACT, floor(-0.3))
    made, rows = played(trial, text)
    yield from resting(made, rows)
    yield outside(made, 0.5e-3)
    yield above("height of the highest place [m]", float(samples(made)[:, 2].max()), -0.0055)


def slippery(trial: Trial) -> Iterator[Statement]:
    """Cloth without friction on top of a ball: it slides off onto the floor, or, without one, falls in words."""
    for kind in ("morley", "hinge")[: trial.count(2)]:
        smooth = ball(0.15, 0.15, friction=0.0)
        made, rows = played(trial, square(0.025, smooth, CONTACT, floor(-0.4), kind=kind))
        yield from resting(made, rows)
        yield outside(made, THICKNESS)
        rows = trial.rows(square(0.025, ball(0.17, 0.15, friction=0.0), CONTACT, kind=kind))
        note = rows[0]["note"]
        yield true(
            "it rests on the ball, or falls from it", bool(rows[0]["converged"]) or "nothing catches" in note, note
        )
        yield below("steps", rows[0]["relaxation_steps"], 1500)


def dragged_far(trial: Trial) -> Iterator[Statement]:
    """The ball is dragged below a cloth held along an edge and out at the other side in ten frames: no frame cycles."""
    text = square(0.025, BALL.format(x=-0.3, y=0.15, z=-0.1, radius=0.06, friction=0.3), CONTACT, pinned("left"))
    path = across((-0.3, 0.15), (0.7, 0.15), trial.count(10, 5))
    made, rows = played(trial, text, drag("ball", (-0.3, 0.15), path))
    yield from resting(made, rows)
    yield near("energy at the end is the first one", rows[-1]["q_potential"], rows[0]["q_potential"], STATIONARY)


def crumpled_among_bodies(trial: Trial) -> Iterator[Statement]:
    """Cloth from nodes at random above a box, a bar and a ball, which touch each other: at rest outside of all."""
    box = "\n[bodies.box]\nbox = { center = [0.05, 0.15, -0.1], half = [0.08, 0.08, 0.08] }\nfriction = 0.3\n"
    bodies = box + BAR.format(z=-0.05, radius=0.02) + ball(0.26, 0.15, 0.08)
    for seed in range(trial.count(2)):
        made, rows = played(trial, square(0.025, bodies, floor(-0.2), CONTACT, start(0.1, seed, (0, 0, 0.15))))
        yield from resting(made, rows)
        yield outside(made, THICKNESS)


def sharp_rim(trial: Trial) -> Iterator[Statement]:
    """Cloth falls over the sharp rim of a drum that stands, of one that lies across its middle, and of a pole."""
    upright = "cylinder = { start = [0.15, 0.15, -0.2], end = [0.15, 0.15, -0.002], radius = 0.08 }"
    lying = "cylinder = { start = [0.15, 0.15, -0.082], end = [0.15, 0.6, -0.082], radius = 0.08 }"
    pole = "cylinder = { start = [0.15, 0.15, -0.5], end = [0.15, 0.15, -0.002], radius = 0.03 }"
    for form, height in ((upright, -0.2), (lying, -0.4), (pole, -0.5))[: trial.count(3)]:
        drum = f"\n[bodies.drum]\n{form}\nfriction = 0.3\n"
        made, rows = played(trial, square(0.02, drum, CONTACT, floor(height)))
        yield from resting(made, rows)
        yield outside(made, THICKNESS)


CASES = {
    "deep": Case(deep),
    "swollen": Case(swollen, weekly=("auto",)),
    "gone": Case(gone, weekly=("auto",)),
    "thin_bar": Case(thin_bar, weekly=("auto",)),
    "wire": Case(wire),
    "sharp_rim": Case(sharp_rim, share=0.34),
    "slippery": Case(slippery, share=0.5),
    "dragged_far": Case(dragged_far, share=0.5, weekly=("auto",)),
    "crumpled_among_bodies": Case(crumpled_among_bodies, share=0.5),
}
