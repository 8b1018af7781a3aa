"""Hard cases of bridges: nearly cut through, windows that touch, a weight that no bridge bears, a thin deck."""

from collections.abc import Iterator

import numpy as np
from restshape_studies.stability.case import Case, Statement, Trial, above, below, near, refused_for, true, valid
from restshape_studies.stability.known_bounds import DIRECT
from restshape_studies.stability.scenery import across, drag

from restshape.application import application

SCENE = application("bridge").folder / "scenes" / "bridge.toml"
COARSE = ['mesh.size="600 mm"']
LARGE = "effects.large_deformation={}"
WEIGHT = 2e6


def balanced(rows: list, weight: float = WEIGHT) -> Statement:
    """The statement that the banks bear the weight and the bridge's own, in each frame that is shown."""
    wanted = [weight + 500 * 9.81 * row["q_score"] for row in rows if not row["refused"]]
    return near("the banks bear all weight", [r["q_bank_force"] for r in rows if not r["refused"]], wanted, 1e-5)


def nearly_cut(trial: Trial) -> Iterator[Statement]:
    """A hole is dragged from below up to 5 cm from the deck: it bears less and less, and the status says so."""
    hole = {"do": "hole", "name": "h", "center": [10, 2.3], "radius": 0.3}
    path = [*across((10, 2.3), (10, 2.6), 6), (10, 2.64), (10, 2.65)]
    rows = trial.rows(SCENE, [hole, *drag("h", (10, 2.3), path)], overrides=COARSE)
    yield balanced(rows)
    yield below("sag when nearly cut over the first", rows[0]["q_sag"] / rows[-1]["q_sag"], 0.999)
    yield true("the status fails at the end", rows[-1]["constraint_status"] == "fails", rows[-1]["constraint_status"])
    yield from valid(rows)


def touching(trial: Trial) -> Iterator[Statement]:
    """Two windows are dragged into each other and into the deck: refused, and the drag goes on."""
    holes = [{"do": "hole", "name": name, "center": [x, 2.3], "radius": 0.3} for name, x in (("h", 8), ("k", 12))]
    path = [*across((8, 2.3), (12, 2.3), 8), *across((12, 2.3), (8, 3.2), 8), (8, 2.3)]
    rows = trial.rows(SCENE, [*holes, *drag("h", (8, 2.3), path)], overrides=COARSE)
    yield refused_for(rows, "cross", "closer", "inside", "outside")
    yield near("sag where the window was at first", rows[-1]["q_sag"], rows[2]["q_sag"], trial.solved(DIRECT))
    yield balanced(rows)
    yield from valid(rows, None)


def overloaded(trial: Trial) -> Iterator[Statement]:
    """Weights up to a million times too heavy, of large deformation, then the right one: as at first."""
    events = [{"do": "set", "key": "loads.weight.force", "value": [0, -w]} for w in (2e7, 2e9, 2e12, WEIGHT)]
    rows = trial.rows(SCENE, events, overrides=[*COARSE, LARGE])
    yield near("sag as at first", rows[-1]["q_sag"], rows[0]["q_sag"], 1e-5)
    yield true("2 TN are refused", bool(rows[3]["refused"]))
    yield from valid(rows, None)


def lifted(trial: Trial) -> Iterator[Statement]:
    """The underside is pulled up to a thin deck in single jumps, and back."""
    events = [{"do": "pull", "on": "underside", "at": [10.0, 1.6], "pins": [[2.5, 1.2], [17.5, 1.2]]}]
    events += [{"do": "drag", "path": [[10.0, y] for y in (2.8, 1.0, 2.9, 1.6)]}, {"do": "release"}]
    rows = trial.rows(SCENE, events, overrides=COARSE)
    yield near("sag as at first", rows[-1]["q_sag"], rows[0]["q_sag"], trial.solved(DIRECT))
    yield above("frames shown", sum(not row["refused"] for row in rows), 5)
    yield balanced(rows)
    yield from valid(rows, None)


def long_replay(trial: Trial) -> Iterator[Statement]:
    """10,000 frames of a window that goes to and fro under the deck: the same after each turn."""
    frames = trial.count(10_000, 100)
    path = [(10 + 4 * np.sin(2 * np.pi * k / 100), 2.3) for k in range(1, frames + 1)]
    hole = {"do": "hole", "name": "h", "center": [10, 2.3], "radius": 0.3}
    rows = trial.rows(SCENE, [hole, *drag("h", (10, 2.3), path)], overrides=['mesh.size="900 mm"'])
    again = [row["q_sag"] for row in rows[102:-1:100]]
    yield near("sag after each turn", again, rows[1]["q_sag"], 1e-2)
    yield balanced(rows)
    yield from valid(rows)


CASES: dict[str, Case] = {
    "nearly_cut": Case(nearly_cut),
    "touching": Case(touching),
    "overloaded": Case(overloaded),
    "lifted": Case(lifted),
    "long_replay": Case(long_replay, share=0.01, weekly=("auto",)),
}
