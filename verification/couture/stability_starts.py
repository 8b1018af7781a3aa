"""Hard starts of cloth: triangles turned over and crossed, nodes anywhere, and a fall that nothing ends."""

from collections.abc import Iterator

import numpy as np
from restshape_studies.stability.case import Case, Statement, Trial, above, below, near, true, valid
from restshape_studies.stability.known_bounds import EXACT, STATIONARY
from restshape_studies.stability.scenery import set_value
from restshape_verification.couture.hard_scenes import (
    CONTACT,
    GRAVITY,
    ball,
    floor,
    outside,
    pinned,
    played,
    resting,
    square,
    start,
    turned_over,
)

PINS = pinned("c", "d")
ANYWHERE = 0.3
"""Scatter [m] as large as the cloth: nodes lie anywhere in a box."""
FOLDED = "motion alone comes to rest in other folds"
KINDS = ("morley", "hinge", "nonlinear")


def scattered(trial: Trial) -> Iterator[Statement]:
    """Cloth on two pins from nodes anywhere in a box, half of the triangles turned over: stable, as from flat."""
    for kind in KINDS:
        flat, _ = played(trial, square(0.025, PINS, kind=kind))
        lowest = flat.analysis.problem.energy(flat.analysis.x)
        ends = []
        for seed in range(trial.count(9, 3)):
            made, rows = played(trial, square(0.025, PINS, start(ANYWHERE, seed), kind=kind))
            yield above("part of the triangles that is turned over at first", turned_over(made), 0.3)
            yield from resting(made, rows)
            ends.append(rows[0]["q_potential"])
            yield true("the equilibrium is stable", made.analysis.state.report.stable is True, rows[0]["note"])
        yield near(f"all potential energies are that from flat ({kind})", ends, lowest, STATIONARY)


def crumpled_on_a_ball(trial: Trial) -> Iterator[Statement]:
    """Cloth above a ball and a floor from nodes that lie crossed, some below others: at rest outside of both."""
    above_all = start(0.06, move=(0, 0, 0.1))
    for kind in KINDS[:2]:
        made, rows = played(trial, square(0.025, ball(0.15, 0.15), floor(-0.25), CONTACT, above_all, kind=kind))
        yield from resting(made, rows)
        yield outside(made, 2e-3)


def textile(trial: Trial) -> Iterator[Statement]:
    """3,000 triangles of a textile from random places to rest, as in the thesis's figure 5.16."""
    made, rows = played(trial, square(0.0193, PINS, start(0.7), side=0.7))
    yield near("triangles", rows[0]["elements"], 3000, 0.1)
    yield above("part of the triangles that is turned over at first", turned_over(made), 0.3)
    yield from resting(made, rows)
    yield below("steps", rows[0]["relaxation_steps"], 1000)


def thin_plate(trial: Trial) -> Iterator[Statement]:
    """2,000 triangles of a plate 100 times stiffer from random places to rest, as in the thesis's figure 5.16."""
    clamp = pinned("left", fix='["x", "y", "z", "slope"]')
    made, rows = played(trial, square(0.025, clamp, start(0.35), side=0.7, bending=5e-4))
    yield near("triangles", rows[0]["elements"], 2000, 0.1)
    yield above("part of the triangles that is turned over at first", turned_over(made), 0.3)
    yield from resting(made, rows)
    yield below("steps", rows[0]["relaxation_steps"], 1500)


def endless_fall(trial: Trial) -> Iterator[Statement]:
    """Cloth beside the only ball falls for ever: not at rest, in words, soon; and a floor put there catches it."""
    missed = square(0.025, ball(2.0, 2.0), CONTACT)
    for kind in KINDS:
        rows = trial.rows(missed.replace('"hinge"', f'"{kind}"'))
        note = rows[0]["note"]
        yield true("says that nothing catches it", "not converged" in note and "nothing catches" in note, note)
        yield above("residual over weight", rows[0]["residual"], 0.5)
        yield below("steps until it is noticed", rows[0]["relaxation_steps"], 200)
        yield from valid(rows)
    for way in ("kinetic", "stabilised"):
        rows = trial.rows(missed, overrides=[f"effects.drape.strategy={way}"])
        yield true(f"the way {way} says so, too", "nothing catches" in rows[0]["note"], rows[0]["note"])
    places = [[0.15, 0.15, -0.102], [2.0, 2.0, -0.102], [0.15, 0.15, -0.102]]
    made, rows = played(trial, missed, set_value("bodies.ball.sphere.center", *places))
    # Cloth goes along with the only body that it lies on.
    yield true("in equilibrium where a ball is put below it", [row["converged"] for row in rows] == [0, 1, 1, 1])
    yield near("as it was before the ball jumped", rows[3]["q_potential"], rows[1]["q_potential"], STATIONARY)
    yield outside(made, 2e-3)


def without_weight(trial: Trial) -> Iterator[Statement]:
    """Cloth without gravity: flat it stays so, crumpled it comes to rest where nothing pulls, and drawn it is flat."""
    free = square(0.025, PINS).replace(GRAVITY, "")
    made, rows = played(trial, free)
    yield from valid(rows)
    yield true(
        "flat cloth is in equilibrium at once",
        rows[0]["converged"] == 1 and rows[0]["relaxation_steps"] == 0,
        rows[0]["note"],
    )
    yield below("largest displacement [m]", float(np.abs(made.analysis.fields()[0]["displacement"]).max()), EXACT)
    for kind in KINDS[:2]:
        made, rows = played(trial, square(0.025, PINS, start(0.02), kind=kind).replace(GRAVITY, ""))
        # Residuals are measured against the small forces of pins.
        yield from resting(made, rows, way=1e-9)
    drawn = '\n[supports.right]\non = "right"\nfix = { x = "3 mm", y = 0, z = 0 }\n'
    made, rows = played(trial, square(0.025, pinned("left"), drawn, start(0.02)).replace(GRAVITY, ""))
    yield from resting(made, rows)
    x = made.analysis.problem.corners(made.analysis.x)
    yield below("out of plane [m]", float(np.abs(x[:, 2]).max()), 1e-6)


CASES = {
    "scattered": Case(scattered, exempt={"thesis": FOLDED}, share=0.34, weekly=("auto",)),
    "crumpled_on_a_ball": Case(crumpled_on_a_ball),
    "textile": Case(textile, weekly=("auto",)),
    "thin_plate": Case(thin_plate),
    "endless_fall": Case(endless_fall),
    "without_weight": Case(without_weight),
}
