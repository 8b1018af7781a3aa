"""How long furniture takes: all suggestions of a piece, its equilibrium after an edit, its range in a drag."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

import numpy as np
from restshape_apps.furniture.analysis.plank_equilibrium import PlankEquilibrium
from restshape_apps.furniture.guidance.force_space import durability_space, stability_space
from restshape_apps.furniture.guidance.suggestions import Combinations, suggest
from restshape_apps.furniture.guidance.support_planks import support_planks
from restshape_apps.furniture.physics.furniture import UNSTABLE, Furniture
from restshape_apps.furniture.pieces import bookshelf, bookshelf_20, piece_28, shelf_1, shelf_2
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.shape.planks import Piece

from restshape.guidance.combination_search import Limits
from restshape.guidance.force_space import combinations
from restshape.guidance.ranges import predicted_ends, valid_ranges


@dataclass(frozen=True)
class Column:
    """A column of table 6.1 of the thesis.

    Args:
        where: the thesis's figure.
        make: our piece in kind.
        planks, joints, continuous, discrete: its counts.
        candidates, search, supports, total: its times [ms].
        aim: at our total [ms].
    """

    where: str
    make: Callable[[], Piece]
    planks: int
    joints: int
    continuous: int
    discrete: int
    candidates: float
    search: float
    supports: float
    total: float
    aim: float


COLUMNS = {
    "shelf-1": Column("figure 6.19 right", shelf_1, 9, 13, 8, 1, 13.2, 92.3, 3.8, 110.0, 8.0),
    "shelf-2": Column("figure 6.18 right", shelf_2, 10, 13, 8, 1, 22.3, 83.1, 5.6, 123.0, 10.0),
    "bookshelf": Column("figure 6.18 middle", bookshelf_20, 20, 33, 8, 2, 160.0, 670.0, 48.0, 880.0, 60.0),
    "piece-28": Column("figure 6.2", piece_28, 28, 49, 6, 1, 758.0, 1512.0, 52.0, 2420.0, 200.0),
}
"""Pieces of table 6.1 by name."""


def large() -> Piece:
    """A bookshelf with as many design freedoms as 28 planks with 8 each have: 224, of 51 planks."""
    return bookshelf((11, 11, 11), dividers=11, brackets=3, kilograms=1.0, heavy=40.0)


@dataclass(frozen=True)
class Time:
    """Times of a piece of work [ms]: the median on the wall clock, and the least of the processor's."""

    wall: float
    own: float


def timed(work: Callable[[], object], times: int = 9) -> Time:
    """How long a piece of work takes."""
    wall, own = [], []
    for _ in range(times):
        start, used = time.perf_counter(), time.process_time()
        work()
        wall.append(1e3 * (time.perf_counter() - start))
        own.append(1e3 * (time.process_time() - used))
    return Time(median(wall), min(own))


def all_suggestions(piece: Piece) -> tuple[Combinations, int]:
    """Suggestions and the number of support planks of a piece, from its data on."""
    furniture = Furniture(piece)
    found = suggest(furniture)
    return found, len(support_planks(furniture))


def candidates(piece: Piece) -> int:
    """The combinations that lead into the box of a piece, from its data on, with nothing tested in full but itself."""
    furniture = Furniture(piece)
    unstable = furniture.test().flaws & UNSTABLE
    modes = DesignModes.of(piece, furniture.kernel.freedoms())
    space = (stability_space if unstable else durability_space)(furniture, modes)
    return len(combinations(space, most=1).modes) + len(combinations(space, least=2, keep=Limits().kept).modes)


def edited(furniture: Furniture, solver: PlankEquilibrium) -> None:
    """The equilibrium after a plank has moved: geometry, and SNES on the same pattern."""
    gamma = np.zeros((furniture.count, 8))
    gamma[0, 0] = 1e-3
    furniture.geometry(gamma)
    solver.solve()
    furniture.geometry()


def renewed(piece: Piece) -> None:
    """The equilibrium after a plank or a joint was added: a new model and a new solver."""
    solver = PlankEquilibrium(Furniture(piece))
    solver.solve()
    solver.destroy()


def dragged(piece: Piece, found: Combinations) -> Time:
    """The time of a range in a drag: derivative, prediction, samples and bisection."""
    direction = found.found[0].direction if found.found else found.modes.direction(np.array([0]), np.array([1.0]))
    part = np.zeros(len(found.modes))
    if found.found:
        part[list(found.found[0].modes)] = found.found[0].parts
    furniture = Furniture(piece)

    def frame() -> None:
        furniture.test()
        modes = DesignModes(piece, found.modes.freedoms[part != 0.0], found.modes.unit)
        hints = predicted_ends(durability_space(furniture, modes), part[part != 0.0]) if len(modes) else None
        valid_ranges(furniture.kernel, direction, -0.5, 0.5, hints=hints)

    return timed(frame, 11)
