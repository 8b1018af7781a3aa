"""How long furniture takes: suggestions, equilibrium, ranges in a drag; and how many suggestions are missed."""

import argparse
import json
from dataclasses import asdict

from restshape_apps.furniture.analysis.plank_equilibrium import PlankEquilibrium
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_verification.furniture.misses import FIRST_ONLY, LARGER, POINTS, SMALL, UNLIMITED, Grid
from restshape_verification.furniture.times import (
    COLUMNS,
    Column,
    Time,
    all_suggestions,
    candidates,
    dragged,
    edited,
    large,
    renewed,
    timed,
)

from restshape.cli.options import add_json, write_json
from restshape.guidance.force_space import forecast

Numbers = dict[str, float | Time | tuple[int, ...]]


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
    """A search over all triples of a bookshelf with 224 freedoms."""
    piece = large()
    found, supports = all_suggestions(piece)
    return {
        "planks": len(piece.planks),
        "joints": len(piece.joints),
        "freedoms": len(found.modes),
        "tried": sum(found.tried),
        "suggestions": len(found.found),
        "support planks": supports,
        "candidates ms": timed(lambda: candidates(piece), 3),
        "suggestions ms": timed(lambda: all_suggestions(piece), 3),
    }


def shown(value: float | Time | tuple[int, ...]) -> str:
    """A number, numbers by how many modes there are, or a pair of times, for people."""
    if isinstance(value, Time):
        return f"{value.wall:.3g} ({value.own:.3g} own)"
    return " / ".join(map(str, value)) if isinstance(value, tuple) else f"{value:.4g}"


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Prints all numbers."""
    report: dict[str, Numbers] = {name: numbers_of(column) for name, column in COLUMNS.items()}
    report["a bookshelf with 224 freedoms"] = large_search()
    report["forecast of 4 of 224"] = vars(forecast(224, 4))
    report |= missed()
    for name, numbers in report.items():
        print(name)
        print("   ", ", ".join(f"{key} {shown(value)}" for key, value in numbers.items()))
    write_json(args, json.loads(json.dumps(report, default=asdict)))
    return 0


def missed() -> dict[str, Numbers]:
    """How many suggestions that a grid finds are missed by searches, by piece and search."""
    report: dict[str, Numbers] = {}
    for name, make in (SMALL | LARGER).items():
        grid = Grid.of(make(), POINTS if name in SMALL else POINTS[:2])
        searches = {
            "as shown": grid.as_shown(),
            "without limits": grid.beside(UNLIMITED),
            "first directions only": grid.beside(FIRST_ONLY),
        }
        for words, found in searches.items():
            report[f"grid: {name}, {words}"] = {"there": found.there, "missed": found.missed, "rate": found.rate}
    return report
