"""Prints how long furniture takes: suggestions, equilibrium, ranges in a drag; and how many suggestions are missed.

python scripts/furniture_times.py [--json FILE]
"""

import argparse
import json
from dataclasses import asdict

import numpy as np
from restshape_apps.furniture.misses import misses
from restshape_apps.furniture.pieces import cantilever, scales
from restshape_apps.furniture.small_pieces import toppling
from restshape_apps.furniture.times import COLUMNS, Column, Time, all_suggestions, dragged, edited, renewed, timed

from restshape.analysis.plank_equilibrium import PlankEquilibrium
from restshape.guidance.force_space import ForceSpace, combinations, forecast
from restshape.physics.furniture import Furniture

Numbers = dict[str, float | Time]


def numbers_of(column: Column) -> Numbers:
    """The numbers of one column of table 6.1."""
    piece = column.make()
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
        "mended": found.mended,
        "suggestions": len(found.found),
        "support planks": supports,
        "suggestions ms": timed(lambda: all_suggestions(piece)),
        "equilibrium ms": timed(solver.solve, 21),
        "edit ms": timed(lambda: edited(furniture, solver), 21),
        "new piece ms": timed(lambda: renewed(piece), 11),
        "full test ms": timed(furniture.test, 21),
        "range ms": dragged(piece, found),
        "aim ms": column.aim,
        "thesis ms": column.total,
    }
    solver.destroy()
    return numbers


def large_search() -> Numbers:
    """A search over all triples of 224 freedoms for 49 joints."""
    rng = np.random.default_rng(1)
    K = rng.normal(size=(224, 49)) * rng.random((224, 1)) * (rng.random((224, 49)) < 0.3)
    h = 0.3 * rng.normal(size=49)
    h[:6] = [1.2, -1.3, 1.1, 1.15, -1.4, 1.2]
    space = ForceSpace(K, h, h, -np.ones(49), np.ones(49))
    tried = sum(combinations(space, keep=2).tried)
    return {"tried": tried, "ms": timed(lambda: combinations(space, keep=2), 3)}


def shown(value: float | Time) -> str:
    """A number, or a pair of times, for people."""
    return f"{value.wall:.3g} ({value.own:.3g} own)" if isinstance(value, Time) else f"{value:.4g}"


def main() -> None:
    """Prints all numbers."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", help="write the numbers to this file too")
    arguments = parser.parse_args()
    report: dict[str, Numbers] = {name: numbers_of(column) for name, column in COLUMNS.items()}
    report["224 freedoms"] = large_search()
    report["forecast of 4 of 224"] = vars(forecast(224, 4))
    pieces = {
        "cantilever": cantilever(kilograms=1.8),
        "long cantilever": cantilever(width=0.1, arm=0.3, kilograms=1.3),
        "scales": scales(),
        "toppling": toppling(),
    }
    for name, piece in pieces.items():
        for words, mended in (("", 10**6), (", first directions only", 0)):
            found = misses(piece, mended=mended)
            report[f"grid: {name}{words}"] = asdict(found) | {"rate": found.rate}
    for name, numbers in report.items():
        print(name)
        print("   ", ", ".join(f"{key} {shown(value)}" for key, value in numbers.items()))
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump(report, file, indent=1, default=asdict)


if __name__ == "__main__":
    main()
