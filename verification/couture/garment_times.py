"""How long a shirt takes: to rest from flat panels, after edits, and a step of its motion, beside the thesis."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from restshape_verification.couture.thesis import ALONE, HINGE, LENGTHS, STEP_TOLERANCES, Stepped

import restshape
from restshape.application import application
from restshape.cli.options import add_json, add_set, print_table, write_json
from restshape.interface.first_frame import first_frame
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

COUTURE = application("couture").folder
SCENE, EDITS = COUTURE / "scenes" / "shirt.toml", COUTURE / "edits" / "shirt.jsonl"
NEVER = "never: cycles at 0.5 to 2.5 m/s"
SIZES = {"coarse": ("24.6 mm", 2, "17.4 to 25.1", "125 to 200"), "fine": ("9.6 mm", 4, "2.4 to 3.1", "11 to 27")}
"""Mesh sizes of the shirt for about 1,650 and 10,000 nodes, nested meshes that lead to rest, and steps a second: of the
thesis, and of its author's released program today."""
LEAN = np.radians(2.0)
"""Angle by which gravity is turned, so that a garment at rest swings."""
REST = "effects.drape.tolerance=0.01"


def frames(
    scene: Path, edits: Path | None, overrides: Sequence[str] = (), predict: str = "none"
) -> list[dict[str, Any]]:
    """Columns of each frame of a replay, with `own`, its seconds of the processor."""
    read = load_scene(scene, overrides)
    script = load_script(edits, read) if edits else None
    run = restshape.replay(read, script, predict=predict)
    found, begun = [], process_time()
    for row in run.rows():
        found.append({**row, "own": process_time() - begun, "nodes": len(run.replay.analysis.space.X)})
        begun = process_time()
    return found


def swinging(size: str, levels: int) -> Stepped:
    """The shirt as it rests nearly, and then leans: its seams and its body take part in each step.

    Args:
        size: of the mesh; levels: nested meshes that lead to rest.
    """
    words = (HINGE, ALONE, REST, f'mesh.size="{size}"', f"mesh.levels={levels}", f"effects.drape.levels={levels}")
    analysis = first_frame(SCENE, words).analysis
    sheet, g = analysis.problem, analysis.problem.g
    turned = np.array([g[0] - g[2] * np.sin(LEAN), g[1], g[2] * np.cos(LEAN)])
    sheet.set_values(sheet.fabric, sheet.supports, turned)
    return Stepped(sheet, analysis.x.copy(), checked=True)


def step_rates(steps: int = 20) -> list[dict[str, Any]]:
    """Implicit steps a second of the shirt, by mesh, length of steps and tolerance of their systems.

    Steps that gain energy are taken back, and the next ones are shorter: in time that counts as well.
    """
    found = []
    for name, (size, levels, thesis, author) in SIZES.items():
        garment = swinging(size, levels)
        for words, length in LENGTHS.items():
            for tolerance in STEP_TOLERANCES:
                quantity = f"{name} steps of up to {words} s a second, {garment.nodes:,} nodes, solved to {tolerance:g}"
                rate = garment.stepped(length, tolerance, steps)
                found.append({"quantity": quantity, "thesis": thesis, "author": author, "ours": f"{rate:.0f}"})
    return found


def rest_rows(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """What there is to say of the first frame and of the edits of a replay."""
    first, later = rows[0], [row for row in rows[1:] if row["relaxation_steps"] or row["predicted"]]
    stays = (
        "at rest and stable" if first["converged"] == 1 and first["tangent_positive_definite"] == 1 else "NOT AT REST"
    )
    size = f"{first['nodes']:,} nodes, {first['unknowns']:,} unknowns"
    found = [
        {"quantity": f"flat panels to rest, {size} [s]", "thesis": "", "author": NEVER, "ours": f"{first['own']:.1f}"},
        {"quantity": "the same: it is", "thesis": "", "author": "", "ours": stays},
        {"quantity": "longest stretch [%]", "thesis": "", "author": "", "ours": f"{100 * first['max_strain']:.1f}"},
    ]
    for row in later:
        what = f"frame {row['index']}, {row['event']}, {'predicted' if row['predicted'] else 'to rest'} [s]"
        found.append({"quantity": what, "thesis": "", "author": "", "ours": f"{row['own']:.2f}"})
    return found


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    what = "what is timed: rest, edits, steps (default: all)"
    parser.add_argument("--of", choices=("rest", "edits", "steps"), help=what)
    add_set(parser)
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Measure, and print the table; 0, or 1 where the garment does not come to rest."""
    found, code = [], 0
    if args.of != "steps":
        rows = frames(SCENE, None if args.of == "rest" else EDITS, args.set)
        found += rest_rows(rows)
        code = 0 if all(row["converged"] for row in rows) else 1
    if args.of in (None, "steps"):
        found += step_rates()
    heads = ("quantity", "thesis", "author", "ours")
    cells = [tuple(one[head] for head in heads) for one in found]
    print_table("a shirt", ("quantity", "thesis", "its author's program today", "ours"), cells, ())
    write_json(args, found)
    return code
