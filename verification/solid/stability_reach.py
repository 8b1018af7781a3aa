"""Hard cases of drags with a reach: far beyond it, shorter than an element, unlike things in turn, back and forth."""

from collections.abc import Iterator

from restshape_studies.stability.case import Case, Row, Statement, Trial, equal, true, valid
from restshape_studies.stability.scenery import across, drag, rows_of
from restshape_verification.solid.hard_scenes import plate

from restshape.replay.parity import Parity

REACH = "mesh.reach=0.15"


def _checked(trial: Trial, events: list[dict], *overrides: str) -> tuple[list[Row], Parity]:
    """The rows of a plate under edits, each compared with a cold solve of the whole."""
    run = trial.replay(plate(0.1), events, [REACH, *overrides])
    made = run.replay
    check = Parity(made)
    return rows_of(run, lambda row: check()), check


def beyond(trial: Trial) -> Iterator[Statement]:
    """A hole goes four times as far as its reach, and back: flips and new meshes follow, and the rest is right."""
    path = [*across((0.5, 0.5), (1.1, 0.5), 20), *across((1.1, 0.5), (0.5, 0.5), 10)]
    rows, check = _checked(trial, drag("window", (0.5, 0.5), path))
    yield from (*equal(check), *valid(rows))
    levels = {row["level"] for row in rows[1:]}
    yield true("all levels are met", {1, 3} <= levels, str(sorted(levels)))


def short(trial: Trial) -> Iterator[Statement]:
    """A reach shorter than a side of an element moves the outline alone, in steps of an element and more."""
    rows, check = _checked(
        trial, drag("window", (0.5, 0.5), [(0.51, 0.5), (0.6, 0.55), (0.9, 0.5)]), "mesh.reach=0.001"
    )
    yield from (*equal(check), *valid(rows))


def in_turn(trial: Trial) -> Iterator[Statement]:
    """A supported corner, a loaded one, a loaded side and a hole in turn, undone, done again and undone in part."""
    events = [
        *drag("d", (0.0, 1.0), across((0.0, 1.0), (0.05, 1.05), 3)),
        *drag("c", (2.0, 1.0), across((2.0, 1.0), (2.05, 0.95), 3)),
        *drag("right", (2.0, 0.5), across((2.0, 0.5), (2.1, 0.5), 3)),
        *drag("window", (0.5, 0.5), across((0.5, 0.5), (0.56, 0.52), 3)),
        *({"do": "undo"} for _ in range(3)),
        *({"do": "redo"} for _ in range(2)),
        *drag("window", (0.5, 0.5), [(0.52, 0.5)]),
    ]
    rows, check = _checked(trial, events)
    yield from (*equal(check), *valid(rows))


def everything(trial: Trial) -> Iterator[Statement]:
    """A hand that holds the whole outline, and one with a reach beyond the body: the whole is solved for."""
    rows, check = _checked(trial, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.6, 0.5), 3)), "mesh.reach=50")
    yield from (*equal(check), *valid(rows))
    rows, check = _checked(trial, drag("outline", (1.0, 0.5), across((1.0, 0.5), (1.1, 0.5), 3)))
    yield from (*equal(check), *valid(rows))


CASES: dict[str, Case] = {
    "beyond": Case(beyond, ("auto", "refactor"), share=0.4),
    "short": Case(short),
    "in_turn": Case(in_turn, ("auto", "thesis")),
    "everything": Case(everything),
}
