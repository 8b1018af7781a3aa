"""Prints how long furniture takes: suggestions, equilibrium, ranges in a drag; and how many suggestions are missed.

python scripts/furniture_times.py [--json FILE]
"""

import argparse
import json
import time
from collections.abc import Callable
from itertools import combinations as choose

import numpy as np
from restshape_apps.furniture.pieces import bookshelf_20, cantilever, piece_28, scales, shelf_1, shelf_2

from restshape.analysis.plank_equilibrium import PlankEquilibrium
from restshape.guidance.force_space import LONGEST, ForceSpace, combinations, durability_space, forecast
from restshape.guidance.ranges import predicted_ends, valid_ranges
from restshape.guidance.suggestions import Suggestions, suggest
from restshape.guidance.support_planks import support_planks
from restshape.physics.furniture import ALL, Furniture
from restshape.shape.design_modes import DesignModes
from restshape.shape.planks import Piece

Numbers = dict[str, float | tuple[float, float]]

COLUMNS = {"shelf-1": (shelf_1, 8, 110), "shelf-2": (shelf_2, 10, 123), "bookshelf": (bookshelf_20, 60, 880)}
COLUMNS |= {"piece-28": (piece_28, 200, 2420)}
"""Pieces of table 6.1 in kind: what is aimed at and what the thesis took [ms]."""


def median(work: Callable[[], object], times: int = 9) -> tuple[float, float]:
    """The median wall-clock time of a piece of work, and the least processor time [ms]."""
    wall, own = [], []
    for _ in range(times):
        start, used = time.perf_counter(), time.process_time()
        work()
        wall.append(1e3 * (time.perf_counter() - start))
        own.append(1e3 * (time.process_time() - used))
    return float(np.median(wall)), min(own)


def all_suggestions(piece: Piece) -> tuple[Suggestions, int]:
    """Suggestions and the number of support planks of a piece, from its data on."""
    furniture = Furniture(piece)
    found = suggest(furniture)
    return found, len(support_planks(furniture))


def column(make: Callable[[], Piece]) -> Numbers:
    """The numbers of one column of table 6.1."""
    piece = make()
    furniture = Furniture(piece)
    furniture.test()
    found, supports = all_suggestions(piece)
    solver = PlankEquilibrium(furniture)
    numbers = {
        "planks": len(piece.planks),
        "joints": len(piece.joints),
        "freedoms": len(found.modes),
        "tried": sum(found.tried),
        "tested": found.tested,
        "suggestions": len(found.found),
        "support planks": supports,
        "suggestions ms": median(lambda: all_suggestions(piece)),
        "equilibrium ms": median(solver.solve, 21),
        "edit ms": median(lambda: edited(furniture, solver), 21),
        "new piece ms": median(lambda: renewed(piece), 11),
        "full test ms": median(furniture.test, 21),
        "range ms": dragged(piece, found),
    }
    solver.destroy()
    return numbers


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


def dragged(piece: Piece, found: Suggestions) -> tuple[float, float]:
    """The times of a range in a drag [ms]: derivative, prediction, samples and bisection."""
    direction = found.found[0].direction if found.found else found.modes.direction(np.array([0]), np.array([1.0]))
    part = np.zeros(len(found.modes))
    if found.found:
        part[list(found.found[0].modes)] = found.found[0].parts
    furniture = Furniture(piece)

    def frame() -> None:
        furniture.test()
        modes = DesignModes(piece, found.modes.freedoms[part != 0.0], found.modes.unit)
        hints = predicted_ends(durability_space(furniture, modes), part[part != 0.0]) if len(modes) else None
        valid_ranges(furniture, direction, -0.5, 0.5, hints=hints)

    return median(frame, 11)


def large_search() -> Numbers:
    """A search over all triples of 224 freedoms for 49 joints."""
    rng = np.random.default_rng(1)
    K = rng.normal(size=(224, 49)) * rng.random((224, 1)) * (rng.random((224, 49)) < 0.3)
    h = 0.3 * rng.normal(size=49)
    h[:6] = [1.2, -1.3, 1.1, 1.15, -1.4, 1.2]
    space = ForceSpace(K, h, h, -np.ones(49), np.ones(49))
    tried = sum(combinations(space, keep=2).tried)
    return {"tried": tried, "ms": median(lambda: combinations(space, keep=2), 3)}


def missed(piece: Piece, points: int = 13) -> Numbers:
    """How many single modes and pairs a grid of the full test finds that the rays do not lead to, and the reverse."""
    furniture = Furniture(piece)
    furniture.test()
    modes = DesignModes.of(piece, furniture.kernel.freedoms())
    found = {tuple(one.modes) for one in suggest(furniture, most=2, shown=10**6, trials=10**6, kept=0).found}
    grid = np.linspace(-LONGEST, LONGEST, points)
    alone = {(k,) for k in range(len(modes)) if valid_somewhere(furniture, modes, (k,), [1.0], grid)}
    pairs = {
        pair
        for pair in choose(range(len(modes)), 2)
        if not {(k,) for k in pair} & alone
        and any(valid_somewhere(furniture, modes, pair, [1.0, t], grid) for t in grid)
    }
    return {
        "modes": len(modes),
        "single by grid": len(alone),
        "single missed": len(alone - found),
        "pairs by grid": len(pairs),
        "pairs missed": len(pairs - found),
        "found that the grid has not": len(found - alone - pairs),
    }


def valid_somewhere(
    furniture: Furniture, modes: DesignModes, chosen: tuple[int, ...], parts: list[float], grid: np.ndarray
) -> bool:
    """Whether the full test holds at a point of the grid along a combination."""
    direction = modes.direction(np.array(chosen), np.array(parts))
    return bool((furniture.kernel.scan(direction, grid, ALL)[0] == 0).any())


def shown(value: float | tuple[float, float]) -> str:
    """A number, or a pair of times, for people."""
    return f"{value[0]:.3g} ({value[1]:.3g} own)" if isinstance(value, tuple) else f"{value:.4g}"


def main() -> None:
    """Prints all numbers."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", help="write the numbers to this file too")
    arguments = parser.parse_args()
    report: dict[str, Numbers] = {}
    for name, (make, aim, thesis) in COLUMNS.items():
        report[name] = column(make) | {"aim ms": aim, "thesis ms": thesis}
    report["224 freedoms"] = large_search()
    report["forecast of 4 of 224"] = vars(forecast(224, 4))
    for name, piece in {
        "grid: cantilever": cantilever(kilograms=1.8),
        "grid: long cantilever": cantilever(width=0.1, arm=0.3, kilograms=1.3),
        "grid: scales": scales(),
    }.items():
        report[name] = missed(piece)
    for name, numbers in report.items():
        print(name)
        print("   ", ", ".join(f"{key} {shown(value)}" for key, value in numbers.items()))
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump(report, file, indent=1)


if __name__ == "__main__":
    main()
