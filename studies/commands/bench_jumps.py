"""The study `restshape bench jumps`: how far quantities jump where the mesh changes."""

import argparse
from typing import Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import Kind, unchecked

from restshape.cli.options import print_table
from restshape.errors import UserError


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare no arguments."""


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """The largest jumps of a scene and its script; or why there are none."""
    from restshape_studies.bench.jumps import study

    announce(f"{case.name}: replay")
    try:
        return study(case.scene, case.edits, args.set)
    except UserError as error:
        # Of many scenes some have none.
        if len(args.scenes) == 1:
            raise
        return {"problem": error.what}


def show(args: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
    """Print the table of a scene."""
    from restshape_studies.bench.jumps import MOST

    if "problem" in found:
        print(f"{name}: no jumps: {found['problem']}")
        return
    frames = found["frames"]
    title = f"{name}: {frames['2']} frames of level 2, {frames['3']} of level 3, {frames['without']} without comparison"
    heads = ("quantity", "level 2", "frame", "level 3", "frame", "")
    cells = []
    for quantity, levels in found["jumps"].items():
        known = [levels.get(level) for level in ("2", "3")]
        shown = [text for one in known for text in ((_percent(one["share"]), one["frame"]) if one else ("-", "-"))]
        large = any(one and one["share"] > MOST for one in known)
        status = "singular" if quantity in found["singular"] else "large" if large else ""
        cells.append((quantity, *shown, status))
    print_table(title, heads, cells, right=heads[1:5])


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %"


KINDS = (
    Kind(
        "jumps",
        "how far quantities jump where flips or new meshes change the mesh",
        declare,
        unchecked,
        measure,
        show,
        scenes="several",
        about="jumps are those of one",
    ),
)
