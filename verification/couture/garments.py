"""Garments to measure on every mannequin: whether they rest, stay, and fit."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from time import process_time
from typing import Any

from restshape_verification.couture.garment_measures import dressed

from restshape.application import application
from restshape.cli.options import add_json, add_set, print_table, write_json
from restshape.cli.progress import progress
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.scene.body_sizes import BODIES
from restshape.scene.load import load_scene

COUTURE = application("couture").folder
FILES = {path.stem: path for path in sorted((COUTURE / "patterns").glob("*.toml"))} | {
    "shirt": COUTURE / "scenes" / "shirt.toml"
}
"""Garments by name."""
COARSE = {"shirt": ('mesh.size="30 mm"', "mesh.levels=1", "effects.drape.levels=1")}
"""What else is set of garments whose scenes have finer meshes."""
CLOSED = 1e-3
"""Of a seam up to which it is closed [m]."""
KEPT = ("converged", "tangent_positive_definite", "relaxation_steps", "factorisations", "max_strain", "seam_gap")
KEPT += ("max_penetration", "crossings", "untrusted", "note", "unknowns")


def drape(garment: str, body: str, overrides: Sequence[str] = ()) -> dict[str, Any]:
    """A garment that is cut for a body, at rest on it.

    Args:
        garment: of `FILES`; body: of `BODIES`.
        overrides: ``key=value`` as after --set.

    Returns: seconds of the processor, nodes, lowest and highest place of the cloth [m], and columns of the frame.
    """
    path, begun = FILES[garment], process_time()
    words = [*dressed(load_scene(path), body), *COARSE.get(garment, ()), *overrides]
    replay = first_frame(path, words)
    corners = replay.analysis.problem.corners(replay.analysis.x)
    found = {name: replay.row[name] for name in KEPT}
    ends = {"low": float(corners[:, 2].min()), "high": float(corners[:, 2].max())}
    return {"seconds": process_time() - begun, "nodes": len(corners), **ends, **found}


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    for option, known in (("garments", FILES), ("bodies", BODIES)):
        names = ",".join(known)
        parser.add_argument(
            f"--{option}", default=names, metavar="A,B", help=f"those of these names (default: {names})"
        )
    add_set(parser)
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Drape each garment on each body, and print how; 0, or 1 where one does not rest stably as it should."""
    garments, bodies = (_chosen(args, *one) for one in (("garments", FILES), ("bodies", BODIES)))
    found: dict[str, dict[str, Any]] = {}
    with progress(False, len(garments) * len(bodies)) as count:
        for garment in garments:
            for body in bodies:
                found[f"{garment}, {body}"] = drape(garment, body, args.set)
                count(1)
    heads = (
        "garment, body",
        "at rest",
        "stable",
        "longest stretch [%]",
        "widest seam [mm]",
        "inside [mm]",
        "crossings",
    )
    heads += ("from [m]", "to", "nodes", "steps", "seconds", "note")
    print_table("garments to measure", heads, [(name, *_cells(one)) for name, one in found.items()], heads[3:-1])
    write_json(args, found)
    return 0 if all(_fits(one) for one in found.values()) else 1


def _fits(one: dict[str, Any]) -> bool:
    rests = one["converged"] == 1 and one["tangent_positive_definite"] == 1 and not one["untrusted"]
    return rests and one["crossings"] == 0 and not one["seam_gap"] >= CLOSED


def _cells(one: dict[str, Any]) -> list[str]:
    words = ["yes" if one[name] == 1 else "no" for name in ("converged", "tangent_positive_definite")]
    words += [f"{100 * one['max_strain']:.1f}", f"{1e3 * one['seam_gap']:.2f}", f"{1e3 * one['max_penetration']:.2f}"]
    words += [str(one["crossings"]), f"{one['low']:.3f}", f"{one['high']:.3f}", f"{one['nodes']:,}"]
    words += [str(one["relaxation_steps"]), f"{one['seconds']:.1f}"]
    return [*words, "; ".join(filter(None, (one["note"], one["untrusted"])))]


def _chosen(args: argparse.Namespace, option: str, known: dict[str, Path] | dict[str, Any]) -> list[str]:
    """The names after an option.

    Raises:
        UserError: one is not known.
    """
    words = [word for word in map(str.strip, getattr(args, option).split(",")) if word]
    if not words:
        raise UserError(f"none of the {option} are named", f"--{option}", f"choose from {','.join(known)}")
    for word in words:
        if word not in known:
            raise UserError(f"{word!r} is none of the {option}", f"--{option}", f"choose from {','.join(known)}")
    return words
