"""Hard cases of beams that meet a goal: raised gravity, folds, a gale, a tip pulled out, 10,000 frames."""

from collections.abc import Iterator

import numpy as np
from restshape_studies.stability.case import Case, Statement, Trial, above, below, near, refused_for, valid
from restshape_studies.stability.known_bounds import SOLVED, TOLERANCE
from restshape_studies.stability.scenery import across, drag, set_value

from restshape.application import application

SCENE = application("cantilever").folder / "scenes" / "cantilever.toml"
COARSE = ['mesh.size="90 mm"']


def gravity_raised(trial: Trial) -> Iterator[Statement]:
    """Gravity is raised to a thousand times its value, where no equilibrium is near, and lowered again."""
    events = set_value("effects.gravity.g", *([0, -9.81 * factor] for factor in (2, 10, 100, 1000, 1)))
    rows = trial.rows(SCENE, events, overrides=COARSE)
    yield refused_for(rows, "no equilibrium found beyond")
    yield near("distance from the goal as at first", rows[-1]["q_miss"], rows[0]["q_miss"], trial.solved(SOLVED))
    yield below("frames refused", sum(bool(row["refused"]) for row in rows), 3)
    yield from valid(rows, None, 1e-6)


def gale(trial: Trial) -> Iterator[Statement]:
    """The wind, which follows the underside, blows up to a thousandfold, from both sides: rolled up, or refused."""
    events = set_value("loads.wind.pressure", *(250.0 * factor for factor in (3, 30, 1000, -3, -1000, 1)))
    rows = trial.rows(SCENE, events, overrides=COARSE)
    yield near("distance from the goal as at first", rows[-1]["q_miss"], rows[0]["q_miss"], trial.solved(1e-7))
    yield above("frames shown", sum(not row["refused"] for row in rows), 4)
    yield from valid(rows, None, 1e-6)


def fold(trial: Trial) -> Iterator[Statement]:
    """The lower corner of the tip is pulled through the beam to its other side, and back: refused while it folds."""
    path = [*across((2, 0), (1.2, 0.7), 12), *across((1.2, 0.7), (2, 0), 12)]
    rows = trial.rows(SCENE, drag("b", (2, 0), path), overrides=COARSE)
    yield refused_for(rows, "cross", "closer")
    # The mesh, coarse and of the first order, is another one by then.
    yield near("tip sag as at first", rows[-1]["q_tip_sag"], rows[0]["q_tip_sag"], 0.1)
    yield from valid(rows, None, 1e-6)


def pulled_out(trial: Trial) -> Iterator[Statement]:
    """The tip is pulled out to twice the length in jumps, and back: it hangs far deeper, or is refused."""
    path = [(x, 0.125) for x in (2.5, 3.0, 4.0, 3.0, 2.5, 2.0)]
    rows = trial.rows(SCENE, drag("tip", (2.0, 0.125), path), overrides=COARSE)
    yield near("tip sag as at first", rows[-1]["q_tip_sag"], rows[0]["q_tip_sag"], trial.solved(TOLERANCE))
    yield from valid(rows, None, 1e-6)


def long_replay(trial: Trial) -> Iterator[Statement]:
    """10,000 frames of a tip that goes round: solved again in each, the same after each turn."""
    frames = trial.count(10_000, 100)
    turn = 2 * np.pi / 100
    path = [(2.0 + 0.1 * np.sin(k * turn), 0.125 + 0.05 * (1 - np.cos(k * turn))) for k in range(1, frames + 1)]
    rows = trial.rows(SCENE, drag("tip", (2.0, 0.125), path), overrides=['mesh.size="120 mm"'])
    again = [row["q_miss"] for row in rows[101:-1:100]]
    yield near("distance from the goal after each turn", again, rows[0]["q_miss"], 1e-6)
    yield from valid(rows, 0, 1e-6)


CASES: dict[str, Case] = {
    "gravity_raised": Case(gravity_raised),
    "gale": Case(gale),
    "fold": Case(fold),
    "pulled_out": Case(pulled_out),
    "long_replay": Case(long_replay, share=0.01),
}
