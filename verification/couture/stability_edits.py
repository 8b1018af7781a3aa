"""Hard edits of cloth that is draped: its mesh refined, its outline changed, and undone far from where it was done."""

from collections.abc import Iterator

import numpy as np
from restshape_studies.stability.case import Case, Statement, Trial, near, true
from restshape_studies.stability.known_bounds import STATIONARY
from restshape_studies.stability.scenery import across, drag, meshed, set_value
from restshape_verification.couture.hard_scenes import (
    CONTACT,
    ball,
    floor,
    outside,
    pinned,
    played,
    resting,
    square,
    start,
)

PINS = pinned("c", "d")
STICKY = ball(0.15, 0.15, friction=0.8)
HANGING = -500 * 0.3e-3 * 0.3**2 * 0.15
"""Energy [J] over the acceleration of gravity: a square of cotton of 0.3 m hangs down by half of its side."""
TURNED = ("material.cotton.bending=1e-3 N m", "effects.gravity.g=[1.0, 0.0, 9.81]")
"""What is set before a corner is dragged."""


def nested(trial: Trial) -> Iterator[Statement]:
    """Cloth from nodes at random through three nested meshes, pinned and on a ball: at rest on the finest."""
    levels = "\n[mesh]\nsize = 0.0125\nlevels = 3\n"
    for kind in ("morley", "hinge"):
        made, rows = played(trial, square(0.0125, PINS, start(0.3), kind=kind).replace(meshed(0.0125), levels))
        yield from resting(made, rows)
        _, flat = played(trial, square(0.0125, PINS, kind=kind))
        yield near("energy is that from flat on one mesh", rows[0]["q_potential"], flat[0]["q_potential"], 0.05)
    made, rows = played(trial, square(0.0125, STICKY, CONTACT).replace(meshed(0.0125), levels))
    yield from resting(made, rows)
    yield outside(made, 2e-3)


def remeshed(trial: Trial) -> Iterator[Statement]:
    """The mesh of cloth that lies on a ball is made finer and coarser: it stays where it lies."""
    made, rows = played(trial, square(0.04, STICKY, CONTACT), set_value("mesh.size", 0.025, 0.015, 0.03, 0.04))
    yield from resting(made, rows)
    yield near("potential energy on all meshes", [row["q_potential"] for row in rows], rows[0]["q_potential"], 0.1)
    yield true("each mesh is another one", [row["level"] for row in rows[1:]] == [3] * 4)


def outline(trial: Trial) -> Iterator[Statement]:
    """A corner of cloth on a ball is dragged in, far out, and back: triangles flip, and meshes are rebuilt."""
    places, frames = ((0.3, 0.3), (0.1, 0.15), (0.5, 0.5), (0.3, 0.3)), trial.count(8, 4)
    path = [place for k in range(3) for place in across(*places[k : k + 2], frames)]
    made, rows = played(trial, square(0.03, STICKY, CONTACT, floor(-0.4)), drag("c", places[0], path))
    yield from resting(made, rows)
    yield outside(made, 2e-3)
    levels = {row["level"] for row in rows[1:]}
    yield true("triangles flipped, and meshes rebuilt", {2, 3} <= levels, str(sorted(levels)))


def holes(trial: Trial) -> Iterator[Statement]:
    """Holes are cut into cloth on two pins, dragged through it, and undone: at rest, and as it was at the end."""
    events = [
        {"do": "hole", "name": "w", "center": [0.1, 0.1], "radius": 0.03},
        *drag("w", (0.1, 0.1), across((0.1, 0.1), (0.22, 0.22), trial.count(4, 2))),
        {"do": "delete", "on": "w"},
        *[{"do": "undo"}] * 3,
    ]
    made, rows = played(trial, square(0.025, PINS), events)
    yield from resting(made, rows)
    yield near("energy at the end is the first one", rows[-1]["q_potential"], rows[0]["q_potential"], STATIONARY)


def far_apart(trial: Trial) -> Iterator[Statement]:
    """Undo and redo, far apart, of cloth with one stable rest: it is found, or the frame says that it is unstable."""
    events = [
        *set_value("material.cotton.bending", "1e-3 N m"),
        *set_value("effects.gravity.g", [1.0, 0.0, 9.81]),
        *drag("a", (0.0, 0.0), [(-0.2, -0.3)]),
        *[{"do": "undo"}] * 3,
        *[{"do": "redo"}] * 3,
        *[{"do": "undo"}] * 3,
    ]
    made, rows = played(trial, square(0.03, pinned("top")), events)
    yield from resting(made, rows)
    stable = ["unstable" not in row["note"] for row in rows]
    # Motion alone leaves no saddle: cloth that is turned over stays above its pins, and the frame says so.
    yield true("no frame but of motion alone is unstable", all(stable) or trial.policy == "thesis")
    first = rows[0]["q_potential"]
    undone = [row["q_potential"] for row in rows if row["event"] in ("undo", "redo")]
    yield true("energy once all is undone is the first one", undone[2] == undone[8] == first)
    # A square hangs straight down from its upper edge, and with g turned straight up and to the side.
    down, up = HANGING * 9.81, HANGING * (9.81 + 1.0)
    (dragged,) = trial.rows(square(0.03, pinned("top")).replace("a = [0, 0]", "a = [-0.2, -0.3]"), overrides=TURNED)
    turned = dragged["q_potential"]
    rests = np.array([down, down, up, up, turned, turned, up, down, down, down, up, turned, up, down, down])
    found = np.array([row["q_potential"] for row in rows])
    yield near("energy of stable frames is that of the one rest", found[stable], rests[stable], 5e-3)
    unstable = ~np.array(stable)
    yield true("unstable frames are above it", bool((found[unstable] > rests[unstable] * (1 - 5e-3)).all()))


def other_kinds(trial: Trial) -> Iterator[Statement]:
    """Kinds of bending and of membrane are changed under a cloth that hangs, a hundred times as stiff as a shirt."""
    kinds = set_value("effects.cloth.bending", "morley", "nonlinear", "none", "hinge")
    laws = set_value("effects.cloth.membrane", "corotated", "stvk")
    made, rows = played(trial, square(0.03, pinned("left"), bending=5e-4), [*kinds, *laws])
    yield from resting(made, rows)
    yield near("energy at the end is the first one", rows[-1]["q_potential"], rows[0]["q_potential"], STATIONARY)


CASES = {
    "nested": Case(nested, exempt={"thesis": "motion alone rests in other folds, after minutes"}, weekly=("auto",)),
    "remeshed": Case(remeshed),
    "outline": Case(
        outline, exempt={"rebuild": "all meshes are rebuilt, and nothing flips"}, share=0.5, weekly=("auto",)
    ),
    "holes": Case(holes, share=0.5),
    "far_apart": Case(far_apart, ("auto",), exempt={"thesis": "on some machines motion alone rests in other folds"}),
    "other_kinds": Case(other_kinds),
}
