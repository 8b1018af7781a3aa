"""What a board between two brackets as weak as each other takes off their joints, in the bookshelf of 20 planks.

Both brackets turn alike under their loads, so that the board can only turn with them.
"""

import argparse
from dataclasses import asdict, dataclass, replace

import numpy as np
from restshape_apps.furniture.physics.furniture import LOST, OVERLAPPING, Furniture
from restshape_apps.furniture.pieces import bookshelf_20
from restshape_apps.furniture.shape.planks import Piece, Plank, joints_near

from restshape.cli.options import add_json, write_json

BRACKETS = ("bracket-1", "bracket-3")
"""The lower and the upper one, on one side of an upright board."""
WIDTHS = (0.05, 0.1, 0.15, 0.2)
"""Of the board [m]."""
PLACES = 12
"""Along the brackets."""
CLEAR = 1e-3
"""Least distance of the board from the upright one [m]."""


@dataclass(frozen=True)
class Board:
    """A board between the brackets.

    Args:
        width: of it [m].
        along: its width runs along the brackets; else across them.
        place: of its middle, from the face that holds the brackets [m].
        utilisations: of the lower and the upper bracket's joint, in parts of its strength.
    """

    width: float
    along: bool
    place: float
    utilisations: tuple[float, float]


def utilisations(piece: Piece) -> tuple[float, float] | None:
    """The utilisations of the two brackets' joints; None where planks overlap or joints do not close."""
    furniture = Furniture(piece)
    if furniture.test().flaws & (LOST | OVERLAPPING):
        return None
    forces = furniture.forces()
    utilisation = np.maximum(forces.pull_utilisation, forces.shear_utilisation)
    numbers = [[piece.planks[joint.i].name for joint in piece.joints].index(name) for name in BRACKETS]
    return float(utilisation[numbers[0]]), float(utilisation[numbers[1]])


def with_board(piece: Piece, width: float, along: bool, place: float) -> Piece:
    """The piece with a board more, `place` [m] from the ends that hold the brackets."""
    low, high = (piece.planks[piece.index(name)] for name in BRACKETS)
    out = low.axes[:, 0]
    middle = low.end(0) + place * out
    levels = low.centre[2] + low.size[2] / 2, high.centre[2] - high.size[2] / 2
    bottom, top = (np.array([*middle[:2], level]) for level in levels)
    board = Plank.between("board", bottom, top, width * (out if along else low.axes[:, 1]), low.size[2], wood=low.wood)
    planks = (*piece.planks, board)
    near = joints_near(planks, among=[len(piece.planks)], fastener=piece.joints[0].fastener)
    # Its ends alone: were it joined to the upright board too, it would be another piece.
    new = [joint for joint in near if joint.i == len(piece.planks) and joint.side < 2]
    return replace(piece, planks=planks, joints=(*piece.joints, *new))


def boards(piece: Piece) -> list[Board]:
    """Boards of all widths, both ways, at places from the upright board to the brackets' free ends."""
    bracket = piece.planks[piece.index(BRACKETS[0])]
    rows = []
    for width in WIDTHS:
        for along in (False, True):
            half = 0.5 * (width if along else bracket.size[2])
            for place in np.linspace(half + CLEAR, bracket.size[0] - half, PLACES):
                found = utilisations(with_board(piece, width, along, place))
                if found:
                    rows.append(Board(width, along, float(place), found))
    return rows


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Print the utilisations without a board, and with that which leaves least, by its width; 0."""
    piece = bookshelf_20()
    rows = boards(piece)
    print("utilisation of the joints of", " and ".join(BRACKETS))
    print("without a board:", " and ".join(f"{utilisation:.3f}" for utilisation in utilisations(piece)))
    for width in WIDTHS:
        best = min((row for row in rows if row.width == width), key=lambda row: max(row.utilisations))
        both = " and ".join(f"{utilisation:.3f}" for utilisation in best.utilisations)
        print(f"with the best of {width * 1e3:g} mm, {best.place * 1e3:.0f} mm from the upright board: {both}")
    write_json(args, [asdict(row) for row in rows])
    return 0
