"""Hard cases of darts: nearly as wide as their edge, as sharp as a needle, slid to the corner, drawn and undone."""

from collections.abc import Iterator

from restshape_studies.stability.case import Case, Statement, Trial, below, near, true
from restshape_studies.stability.known_bounds import STATIONARY
from restshape_studies.stability.scenery import across, drag, set_value
from restshape_verification.couture.hard_scenes import pinned, played, resting, square

SIDE, AREA_WEIGHT = 0.3, 500 * 0.3e-3 * 9.81
"""Side of the cloth [m], and its weight by area [N/m^2]."""
DART = """
[darts.dart]
edge = "bottom"
length = {length}
width = {width}
"""
GAP = 1e-4
"""Largest distance [m] between the legs of a sewn dart."""


def dart(length: float, width: float) -> str:
    """A dart in the middle of the lower side, of a length and a width [m]."""
    return DART.format(length=length, width=width)


def wide_dart(trial: Trial) -> Iterator[Statement]:
    """A dart is made as wide as its edge but for 1 mm on each side, and undone: it is sewn, and all is as before."""
    events = [*set_value("darts.dart.width", 0.2, 0.298), *[{"do": "undo"}] * 2]
    made, rows = played(trial, square(0.06, pinned("c", "d"), dart(0.15, 0.05)), events)
    yield from resting(made, rows)
    yield below("largest distance between the legs [m]", max(row["seam_gap"] for row in rows), GAP)
    yield near("energy at the end is the first one", rows[-1]["q_potential"], rows[0]["q_potential"], STATIONARY)


def needle_dart(trial: Trial) -> Iterator[Statement]:
    """A dart of 3 mm nearly as long as the cloth: it hangs as the cloth that is left, without the triangle."""
    length, width = 0.29, 0.003
    made, rows = played(trial, square(0.06, pinned("top"), dart(length, width)))
    yield from resting(made, rows)
    yield below("largest distance between the legs [m]", rows[0]["seam_gap"], GAP)
    hanging = -AREA_WEIGHT * (SIDE**3 / 2 - 0.5 * length * width * (SIDE - length / 3))
    yield near("energy over that of a flat cloth without the triangle", rows[0]["q_potential"] / hanging, 1.0, 3e-3)


def sliding_dart(trial: Trial) -> Iterator[Statement]:
    """A slanting dart slides to its edge's end, into the corner, to where it has no room, and back; all is undone."""
    events = [*set_value("darts.dart.at", 0.9, 1.0, 0.99, 0.5), *[{"do": "undo"}] * 3]
    made, rows = played(trial, square(0.05, pinned("top"), dart(0.1, 0.03) + 'angle = "45 deg"\n'), events)
    refused = [k for k, row in enumerate(rows) if row["refused"]]
    yield true("only that without room is refused, with the room", refused == [3] and "3 mm" in rows[3]["refused"])
    kept = [row for row in rows if not row["refused"]]
    yield from resting(made, kept)
    yield below("largest distance between the legs [m]", max(row["seam_gap"] for row in kept), GAP)
    # A new solve after an undo begins at the last rest, and may end in other folds.
    bound = 3e-3 if trial.policy == "rebuild" else STATIONARY
    yield near("energy at the end is the first one", rows[-1]["q_potential"], rows[0]["q_potential"], bound)


def drawn_dart(trial: Trial) -> Iterator[Statement]:
    """A dart is drawn into hanging cloth, its tip dragged to the other side, deleted, and all of it undone."""
    events = [
        {"do": "dart", "name": "dart", "from": [0.1, -0.05], "to": [0.1, 0.1], "width": 0.04},
        *drag("dart.tip", (0.1, 0.1), across((0.1, 0.1), (0.25, 0.2), trial.count(8, 2))),
        {"do": "delete", "on": "dart"},
        *[{"do": "undo"}] * 3,
    ]
    made, rows = played(trial, square(0.05, pinned("top")), events)
    yield from resting(made, rows)
    yield near("energy at the end is the first one", rows[-1]["q_potential"], rows[0]["q_potential"], STATIONARY)


CASES = {
    "needle_dart": Case(needle_dart),
    "wide_dart": Case(wide_dart),
    "sliding_dart": Case(sliding_dart, weekly=("auto",)),
    "drawn_dart": Case(drawn_dart, weekly=("auto",)),
}
