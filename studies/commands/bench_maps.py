"""The study `restshape bench maps`: how far a mesh bears a drag under each linear map of its nodes."""

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import Kind, unchecked

from restshape.cli.options import print_table
from restshape.outputs.kinds import PictureFile

PANEL = "a skirt's panel"
"""The study's own shape."""


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--picture", type=PictureFile, metavar="FILE", help="the meshes after the drag (.png)")


def own(_: argparse.Namespace) -> list[Case]:
    """The study's own shape, which has no file."""
    return [Case(PANEL, Path(), None)]


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """A record of the start, and one for each map, alone and with flips."""
    from restshape_studies.bench.maps import compared, panel, scripted

    from restshape.scene.edit_script import load_script
    from restshape.scene.load import load_scene

    if case.edits is None:
        return compared(panel())
    scene = load_scene(case.scene, args.set)
    announce(f"{case.name}: the first drag of {case.edits}")
    return compared(scripted(scene, load_script(case.edits, scene)))


def show(_: argparse.Namespace, name: str, found: Mapping[str, Any]) -> None:
    """Print the table of a shape."""
    heads = ("map", "mesh", "least quality", "inverted triangles", "flips", "way of the hand until level 3 [mm]")
    rows = []
    for kind, ways in found["kinds"].items():
        for way, one in ways.items():
            until = f"none in {1e3 * found['ways'][-1]:.3g}" if one["way"] is None else f"{1e3 * one['way']:.3g}"
            rows.append((kind, way, f"{one['quality']:.3f}", str(one["inverted"]), str(one["flips"]), until))
    many = f"{len(found['cells'].split()):,} triangles, least quality {found['quality']:.3f}"
    print_table(f"{name}: {found['on']} dragged by {1e3 * found['ways'][-1]:.3g} mm, {many}", heads, rows, heads[2:])


def draw(found: dict[str, Any], _: argparse.Namespace, path: Path) -> None:
    """Draw the meshes after the drag."""
    from restshape_studies.pictures.maps import draw_maps

    ((name, one),) = found.items()
    while "kinds" not in one:
        ((name, one),) = one.items()
    draw_maps(name, one, path)


KINDS = (
    Kind(
        "maps",
        "how far a mesh bears the first drag of a script under each linear map of its nodes",
        declare,
        unchecked,
        measure,
        show,
        about="maps of nodes are about one",
        own=own,
        draw=draw,
    ),
)
