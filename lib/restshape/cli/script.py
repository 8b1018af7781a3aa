"""`restshape script`: an edit script from short lines of text."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from restshape.application import application_of, applications
from restshape.cli.options import add_scene, read_scene, write_json
from restshape.errors import UserError
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import ScriptFile, signed
from restshape.outputs.si_numbers import counted

if TYPE_CHECKING:
    from restshape.scene.model import Scene
    from restshape.shape.outline import Outline
    from restshape.shape.script_language import InterpretedLines

SUMMARY = "write an edit script from lines such as 'hole window by 0.8 0 in 160 frames, hand-like'"


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments of this command."""
    from restshape.shape.script_language import GRAMMAR

    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    own = [f"of {name}:\n{app.lines.grammar}" for name, app in applications().items() if app.lines]
    grammars = "\n\n".join([GRAMMAR, *own])
    parser.description = f"{SUMMARY}\n\n{grammars}\n\n60 frames are a second of edit time."
    add_scene(parser)
    parser.add_argument("lines", metavar="LINE", nargs="+", help="what to do, one edit an argument, in order")
    parser.add_argument(
        "--out", metavar="FILE", type=ScriptFile, help="edit script to write (default: standard output)"
    )
    parser.add_argument("--seed", type=int, default=0, help="of hand-like paths (default: 0)")


def run(args: argparse.Namespace) -> int:
    """Writes the script and shows how many frames it has and what of it will be refused; the exit code."""
    scene = read_scene(args)
    made = _composed(scene, args)
    text = signed(made.text())
    if args.out is None:
        sys.stdout.write(text)
    else:
        try:
            write_whole(args.out, text)
        except OSError as error:
            what = f"{args.out} cannot be written: {(error.strerror or str(error)).lower()}"
            raise UserError(what, "--out", "name another file") from error
        print(f"{args.out}: {counted(len(made.lines) - 1, 'event')}, {counted(made.frames, 'frame')}")
    for text, frames, why in made.refused:
        print(f"{text!r}: {counted(frames, 'frame')} will be refused: {why}", file=sys.stderr)
    refused = [{"line": text, "frames": frames, "why": why} for text, frames, why in made.refused]
    write_json(args, {"events": len(made.lines) - 1, "frames": made.frames, "refused": refused})
    return 0


def _composed(scene: Scene, args: argparse.Namespace) -> InterpretedLines:
    """The script that the lines describe."""
    from restshape.shape.script_language import interpreted, script_from_lines

    app = application_of(scene)
    if app.lines:
        return interpreted(app.interpreter()(scene), args.lines)
    return script_from_lines(scene, args.lines, args.seed, _imported_outline(scene))


def _imported_outline(scene: Scene) -> Outline | None:
    """The outline of the scene's mesh file, if its shape comes from there."""
    if scene.mesh.file is None:
        return None
    from restshape.mesh.importer import read_mesh

    return read_mesh(scene.folder / scene.mesh.file, scene.mesh.unit)[1]
