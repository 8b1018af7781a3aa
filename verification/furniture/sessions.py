"""One design target tried by three strategies: with no feedback, with ranges alone, and with suggestions.

A designer wants a change of a piece that does not hold with it, and every strategy begins with that change. What counts
is the edits until the piece is valid, and how much of the wanted change is left. An illustration, no study of people.
"""

import argparse
from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np
from restshape_apps.furniture.guidance.suggestions import suggest
from restshape_apps.furniture.physics.furniture import LOST, OVERLAPPING, UNSTABLE, Furniture, TestResult
from restshape_apps.furniture.pieces import scales, shelf_1, shelf_2, table
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.shape.planks import FREEDOMS, Piece

from restshape.cli.options import add_json, write_json
from restshape.guidance.ranges import valid_ranges

LOOKS = 5
"""How often one without feedback may ask for a simulation, as in section 6.6.2 of the thesis."""
MOST = 60
"""Edits after which a strategy gives up."""
REACH = 0.25
"""Of one blind edit, in sizes of the piece or radians."""
INSIDE = 0.1
"""Where in a range a drag ends."""
TRIES = 25
"""Sessions without feedback, each with other chances."""


@dataclass(frozen=True)
class Target:
    """What a designer wants.

    Args:
        name: in words.
        piece: valid or not, before the wanted change.
        wanted: plank, number of the freedom and change [m or rad], one or several.
    """

    name: str
    piece: Piece
    wanted: tuple[tuple[str, str, float], ...]

    def begun(self) -> Piece:
        """The piece with the wanted change."""
        furniture, gamma = Furniture(self.piece), np.zeros((len(self.piece.planks), 8))
        for plank, freedom, change in self.wanted:
            gamma[self.piece.index(plank), FREEDOMS.index(freedom)] = change
        return furniture.moved(gamma)


@dataclass(frozen=True)
class Session:
    """What came of a strategy.

    Args:
        target, strategy: which.
        edits: until the piece is valid; those made where it never was.
        valid: whether it is.
        away: how far the piece ends from what was wanted: the mean way of the corners of planks, in parts of its size.
    """

    target: str
    strategy: str
    edits: float
    valid: float
    away: float


def distance(piece: Piece, other: Piece) -> float:
    """The mean way between corners of planks of two designs, in parts of the size."""
    ways = [np.linalg.norm(a.corners() - b.corners(), axis=1).mean() for a, b in zip(piece.planks, other.planks)]
    return float(np.mean(ways)) / piece.size


def blindly(wanted: Piece, seed: int) -> tuple[int, bool, Piece]:
    """Edits at random, of modes that keep joints closed; a simulation now and then shows whether it holds yet.

    What overlaps or comes apart is seen and not done. After each simulation but the last the last edits are kept.
    """
    rng, now, edits = np.random.default_rng(seed), wanted, 0
    for _ in range(LOOKS):
        for _ in range(MOST // LOOKS // 4):
            furniture = Furniture(now)
            modes = DesignModes.of(now, furniture.kernel.freedoms())
            step = modes.direction(np.array([rng.integers(len(modes))]), np.array([rng.uniform(-REACH, REACH)]))
            if not furniture.test(step, LOST | OVERLAPPING).flaws & (LOST | OVERLAPPING):
                now, edits = furniture.moved(step), edits + 1
        if Furniture(now).test().valid:
            return edits, True, now
    return edits, False, now


def with_ranges(wanted: Piece) -> tuple[int, bool, Piece]:
    """One freedom after the other is dragged to its valid range, if it has one; else to where utilisations are least.

    The range is shown while a freedom is dragged. Taking hold of one counts as an edit, whether it helps or not.
    """
    now, edits, k = wanted, 0, 0
    while edits < MOST:
        furniture = Furniture(now)
        modes = DesignModes.of(now, furniture.kernel.freedoms())
        direction = modes.direction(np.array([k % len(modes)]), np.array([1.0]))
        edits, k = edits + 1, k + 1
        intervals = valid_ranges(furniture.kernel, direction, -0.5, 0.5).intervals
        if len(intervals):
            low, high = intervals[np.argmin(np.abs(intervals).min(axis=1))]
            inside = low + INSIDE * (high - low) if low > 0.0 else high - INSIDE * (high - low)
            return edits, True, furniture.moved(inside * direction)
        now = furniture.moved(_better(furniture, direction) * direction)
    return edits, False, now


def _better(furniture: Furniture, direction: np.ndarray) -> float:
    """The step of a few at which the piece is nearest to holding; 0 where none is nearer than it is."""
    best, least = 0.0, 0.97 * _lack(furniture.test())
    for step in (-0.1, -0.05, 0.05, 0.1):
        result = furniture.test(step * direction)
        if not result.flaws & (LOST | OVERLAPPING) and _lack(result) < least:
            best, least = step, _lack(result)
    return best


def _lack(result: TestResult) -> float:
    """How far a piece is from holding: what contacts leave of the loads, then the largest utilisation of a joint."""
    return result.pull + (100.0 * result.unbalanced if result.flaws & UNSTABLE else 0.0)


def with_suggestions(wanted: Piece) -> tuple[int, bool, Piece]:
    """The suggestion that stays nearest to what was wanted is taken; again where it leaves a joint weak."""
    now = wanted
    for edits in range(1, MOST + 1):
        furniture = Furniture(now)
        if furniture.test().valid:
            return edits - 1, True, now
        found = suggest(furniture).found
        if not found:
            return edits - 1, False, now
        now = min((furniture.moved(one.gamma) for one in found), key=lambda piece: distance(piece, wanted))
    return MOST, False, now


TARGETS: tuple[Callable[[], Target], ...] = (
    lambda: Target("table with a leg that leans more", table(kilograms=30.0), (("leg-4", "turn y", -0.3),)),
    lambda: Target("shelf with a bracket of 30 kg", shelf_1(), ()),
    lambda: Target("shelf with three brackets on one side", shelf_2(), ()),
    lambda: Target("scales with two long arms", scales(), ()),
)
"""Designs that do not hold as they are wanted."""


def sessions() -> list[Session]:
    """The sessions of all targets and strategies; those without feedback are means of many."""
    rows = []
    for make in TARGETS:
        target = make()
        wanted = target.begun()
        blind = [blindly(wanted, seed) for seed in range(TRIES)]
        away = [distance(piece, wanted) for _, _, piece in blind]
        means = (float(np.mean([row[0] for row in blind])), float(np.mean([row[1] for row in blind])))
        rows.append(Session(target.name, "no feedback", *means, float(np.mean(away))))
        for name, strategy in (("ranges", with_ranges), ("suggestions", with_suggestions)):
            edits, valid, piece = strategy(wanted)
            rows.append(Session(target.name, name, float(edits), float(valid), distance(piece, wanted)))
    return rows


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Print the table; 0."""
    rows = sessions()
    print("| wanted | strategy | edits | valid in the end | away from what was wanted [%] |")
    print("| --- | --- | ---: | ---: | ---: |")
    for row in rows:
        print(f"| {row.target} | {row.strategy} | {row.edits:.3g} | {100 * row.valid:.0f} % | {100 * row.away:.2g} |")
    write_json(args, [asdict(row) for row in rows])
    return 0
