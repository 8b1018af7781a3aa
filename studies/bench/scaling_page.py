"""Tables of `restshape bench scaling`, for the terminal and as a page in Markdown."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from restshape_studies.bench.scaling import LEVELS, PARTS, WEAK
from restshape_studies.peers.page import table

from restshape.outputs.atomic_files import write_whole
from restshape.replay.level_names import LEVEL_NAMES

Found = Mapping[str, Any]
QUIET = 0.5
"""The most load of the machine beside which times of ranks count."""


class Table(NamedTuple):
    """A table: its title, heads, and rows of cells."""

    title: str
    heads: tuple[str, ...]
    rows: list[tuple[str, ...]]


def tables(found: Found) -> list[Table]:
    """All tables of a scene: of the machine, and for each mesh of levels, stages, memory and the model."""
    shown = [machine_table(found["machine"])]
    for run in found["runs"]:
        shown += [level_table(run), stage_table(run), memory_table(run)]
        shown += [model_table(run)] if run["model"] else []
    return shown


def name_of(run: Found) -> str:
    """Which mesh and which kind of scaling."""
    first, last = run["entries"][0]["elements"], run["entries"][-1]["elements"]
    return f"{run['mode']}, {first:,} elements" + (f" to {last:,}" if last != first else "")


def machine_table(machine: Mapping[str, Found]) -> Table:
    """What the machine gives ranks at once."""
    first = next(iter(machine.values()))["bandwidth"]
    rows = [
        (
            ranks,
            f"{one['bandwidth'] / 1e9:.1f}",
            f"{one['bandwidth'] / first:.2f}",
            *((f"{1e6 * one['latency_s']:.1f}", f"{1e6 * one['message_s']:.1f}") if one["latency_s"] else ("", "")),
            f"{one['message_bandwidth'] / 1e9:.1f}" if one["message_bandwidth"] else "",
        )
        for ranks, one in machine.items()
    ]
    heads = ("ranks", "triad [GB/s]", "over the first", "sum over ranks [µs]", "message [µs]", "messages [GB/s]")
    return Table("machine: STREAM's triad on 400 MB, all ranks at once, and messages between ranks", heads, rows)


def level_table(run: Found) -> Table:
    """Each level's time, speed-up and part of the limit."""
    weak = run["mode"] == WEAK
    rows = []
    for level in LEVELS:
        for one in run["entries"]:
            if entry := one["levels"][level]:
                parts = ("speed_up", "efficiency", "of_limit")
                gains = ["" if entry[key] is None else f"{entry[key]:.2f}" for key in parts]
                limit = f"{one['limit']:.2f}"
                rows.append(
                    (
                        LEVEL_NAMES[level],
                        str(one["ranks"]),
                        f"{one['unknowns']:,}",
                        one["preconditioner"],
                        str(entry["frames"]),
                        f"{entry['ms']:.4g}",
                        f"{entry['iterations']:.1f}",
                        str(entry["refreshes"]),
                        *gains[:2],
                        limit,
                        gains[2],
                    )
                )
    gain = "time of the first over it" if weak else "speed-up"
    heads = ("level", "ranks", "unknowns", "preconditioner", "frames", "p50 [ms]", "iterations", "refreshes", gain)
    return Table(name_of(run), (*heads, "efficiency", "limit by memory", "of the limit"), rows)


def stage_table(run: Found) -> Table:
    """Medians of the stages, of the slowest rank in each frame."""
    rows = []
    for level in LEVELS:
        for one in run["entries"]:
            if entry := one["levels"][level]:
                rows.append(
                    (LEVEL_NAMES[level], str(one["ranks"]), *(f"{entry['stages'][part]:.3g}" for part in PARTS))
                )
    return Table(f"{name_of(run)}: stages, p50 in ms, each of the slowest rank", ("level", "ranks", *PARTS), rows)


def memory_table(run: Found) -> Table:
    """Memory of the rank that has most of it, and how evenly work is shared."""
    rows = []
    first = max(run["entries"][0]["peak_mb"])
    for one in run["entries"]:
        most, base, stored = (max(one[key]) for key in ("peak_mb", "base_mb", "stored_mb"))
        beside = f"{(most - base) / stored:.1f}" if stored else ""
        own = max(one["cells"])
        cells = (f"{most:.0f}", f"{base:.0f}", f"{stored:.1f}", beside, f"{most / first:.2f}", f"{own:,}")
        rows.append((str(one["ranks"]), *cells, f"{own * one['ranks'] / one['all_cells']:.3f}"))
    heads = ("ranks", "peak [MB]", "libraries [MB]", "matrix and preconditioner [MB]", "rest of the peak over these")
    heads += ("peak over the first", "cells", "over an even share")
    return Table(f"{name_of(run)}: memory and work of the rank with most of it", heads, rows)


def model_table(run: Found) -> Table:
    """The model beside what was run, and beyond."""
    model, base = run["model"], run["entries"][0]["levels"]["1"]["ms"]
    rows = [
        (
            str(one["ranks"]),
            f"{one['ms']:.4g}",
            f"{base / one['ms']:.2f}",
            f"{one['measured_ms']:.4g}" if "error" in one else "",
            f"{100 * one['error']:+.0f} %" if "error" in one else "beyond what was run",
        )
        for one in (*model["checked"], *model["beyond"])
    ]
    gain = "time of the first over it" if run["mode"] == WEAK else "speed-up"
    heads = ("ranks", "model [ms]", gain, "measured [ms]", "error of the model")
    return Table(f"{name_of(run)}: a model of level 1, not a measurement", heads, rows)


def remarks(found: Found) -> list[str]:
    """What belongs beside the tables."""
    said = [f"{found['cores']} cores are what there is here, at load {found['load']:.1f} before."]
    if found["load"] > QUIET:
        said.append("Other work took cores from the ranks: these times are doubtful.")
    if found["oversubscribed"]:
        said.append("Ranks shared cores: no time of more ranks than cores says anything about speed.")
    said += [f"The model: {run['model']['assumed']}." for run in found["runs"][:1] if run["model"]]
    return said


INTRODUCTION = """\
The same edits on more and more ranks. `limit by memory` is the bandwidth of STREAM's triad on so many ranks over that
on the first number of them, at the working set of matrix and preconditioner: solves that move these cannot gain more.
Of weak scaling it is the part of its bandwidth that a rank keeps. `of the limit` is what was gained, over it.
"""


def page(name: str, found: Found) -> str:
    """The page in Markdown."""
    parts = [f"# {name} on ranks of MPI\n", f"```sh\n{found['command']}\n```\n", f"{found['machine_name']}.\n"]
    parts += [INTRODUCTION, "\n".join(remarks(found)) + "\n", "![speed-up and stages](scaling.png)\n"]
    parts += ["`scaling.sbatch` measures the same on a cluster with Slurm: `sbatch scaling.sbatch`.\n"]
    for one in tables(found):
        parts += [f"## {one.title[:1].upper()}{one.title[1:]}\n", table(one.heads, one.rows)]
    return "\n".join(parts)


def write_page(name: str, found: Found, path: Path) -> None:
    """Writes the page."""
    write_whole(path, page(name, found))
