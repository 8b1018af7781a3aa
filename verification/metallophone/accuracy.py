"""How far models of a free bar are from three-dimensional elasticity, and what a frame of each costs."""

import argparse
import sys
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np
from restshape_studies.bench.job import Job, Outcome, run

from restshape.application import application
from restshape.cli.options import add_json, print_table, write_json
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import PictureFile

FOLDER = application("metallophone").folder
BARS = {
    100: (2089.35, 4008.1, 5737.3, 8358.8, 11128.5),
    200: (523.31, 1443.0, 1984.5, 2828.2, 4027.2),
}
"""Length [mm] -> the lowest frequencies [Hz] out of the plane of bars of aluminium L x 30 x 4 mm: p-FEM of
three-dimensional elasticity."""

THIN = 1e-3
"""The part of its thickness to which a plate is thinned, its frequencies scaled back: Kirchhoff's limit."""


@dataclass(frozen=True)
class Family:
    """Bodies of one kind, by the size of their triangles.

    Args:
        name: for people.
        overrides: ``key=value`` as after --set.
        sizes: of the triangles [mm].
    """

    name: str
    overrides: tuple[str, ...]
    sizes: tuple[float, ...]


def solid(order: int, layers: int, sizes: tuple[float, ...]) -> Family:
    """Tetrahedra of an order in layers."""
    words = {1: "first", 2: "second"}[order]
    name = f"tetrahedra of {words} order, {layers} layer{'s' if layers > 1 else ''}"
    return Family(name, ("effects.modal.model=solid", f"mesh.order={order}", f"mesh.layers={layers}"), sizes)


FAMILIES = (
    solid(1, 1, (8.0, 5.0, 3.0)),
    solid(1, 2, (8.0, 4.4, 3.0)),
    solid(1, 3, (8.0, 5.0, 3.0)),
    solid(2, 1, (15.0, 10.0, 6.0)),
    solid(2, 2, (10.0, 6.0)),
    Family("plate with shear", ("effects.modal.model=plate", "mesh.order=1"), (12.0, 8.0, 5.0, 3.0)),
)


def study(
    frames: int, on_run: Callable[[str], None] = lambda words: None, play: Callable[[Job], Outcome] = run
) -> list[dict[str, Any]]:
    """A record a bar: its points, and the error of Kirchhoff's limit.

    Args:
        frames: of the edit that each point is timed on.
        on_run: called with what is run.
        play: runs jobs.

    Raises:
        UserError: a bar cannot be replayed.
    """
    records = []
    for length in BARS:
        points = []
        for family in FAMILIES:
            for size in family.sizes:
                on_run(f"bar of {length} mm: {family.name}, {size:g} mm")
                points.append({"family": family.name, "size": size, **point(length, family, size, frames, play)})
        records.append({"length": length, "points": points, "kirchhoff": kirchhoff(length, play)})
    return records


def point(length: int, family: Family, size: float, frames: int, play: Callable[[Job], Outcome]) -> dict[str, Any]:
    """Errors of the five lowest frequencies on the first shape, and the median time [ms] of frames of the edit."""
    rows = replayed(length, (*family.overrides, f'mesh.size="{size} mm"'), frames, play)
    found = np.array([rows[0][f"f_{k}"] for k in range(1, 6)])
    return {
        "frequencies": found.tolist(),
        "error": float(np.abs(found / BARS[length] - 1.0).max()),
        "first": float(found[0] / BARS[length][0] - 1.0),
        "ms": median(row["ms"] for row in rows[1:] if row["level"]),
        "unknowns": rows[0]["unknowns"],
        "elements": rows[0]["elements"],
    }


def kirchhoff(length: int, play: Callable[[Job], Outcome]) -> dict[str, Any]:
    """The errors of a plate without shear and rotary inertia: a very thin one, scaled back to the thickness."""
    thin = ("effects.modal.model=plate", "mesh.order=1", 'mesh.size="3 mm"')
    rows = replayed(length, (*thin, f'material.aluminium.thickness="{4.0 * THIN} mm"'), 1, play)
    found = np.array([rows[0][f"f_{k}"] for k in range(1, 6)]) / THIN
    errors = found / BARS[length] - 1.0
    return {"frequencies": found.tolist(), "errors": errors.tolist(), "error": float(np.abs(errors).max())}


def replayed(
    length: int, overrides: tuple[str, ...], frames: int, play: Callable[[Job], Outcome]
) -> list[dict[str, Any]]:
    """The rows of the bar's edit, in a process of its own.

    Raises:
        UserError: there are none.
    """
    files = (str(FOLDER / part / f"bar_{length}.{end}") for part, end in (("scenes", "toml"), ("edits", "jsonl")))
    job = Job(*files, "auto", ("effects.modal.modes=5", *overrides), frames=frames)
    outcome = play(job)
    if outcome.problem or not outcome.rows:
        raise UserError(f"the bar {outcome.problem or 'gave no frames'}", job.scene, "see restshape replay on it")
    return outcome.rows


def print_records(records: list[dict[str, Any]]) -> None:
    """Print a table a bar."""
    heads = ("model", "triangles [mm]", "elements", "unknowns", "ms a frame, p50", "frames/s")
    heads += ("first mode, error", "five modes, largest error")
    for record in records:
        rows = [
            (
                p["family"],
                f"{p['size']:g}",
                p["elements"],
                p["unknowns"],
                f"{p['ms']:.2f}",
                f"{1e3 / p['ms']:.0f}",
                f"{100 * p['first']:+.2f} %",
                f"{100 * p['error']:.2f} %",
            )
            for p in record["points"]
        ]
        print_table(f"free bar of {record['length']} x 30 x 4 mm, five modes", heads, rows, right=heads[1:])
        thin = ", ".join(f"{100 * error:+.2f} %" for error in record["kirchhoff"]["errors"])
        print(f"Kirchhoff's limit, errors of the five: {thin}\n")


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--picture", type=PictureFile, metavar="FILE", help="error against time (.png)")
    parser.add_argument("--frames", type=int, default=60, metavar="N", help="of each edit (default: %(default)s)")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Measure, print and draw; 0, or a `UserError`."""
    if args.frames < 5:
        raise UserError(f"{args.frames} frames measure nothing", "--frames", "at least 5")
    records = study(args.frames, lambda line: print(line, file=sys.stderr))
    print_records(records)
    write_json(args, records)
    if args.picture:
        from restshape_studies.pictures.accuracy import draw_accuracy

        draw_accuracy(records, args.picture)
        print(f"wrote {one_line(args.picture)}")
    return 0
