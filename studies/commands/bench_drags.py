"""The study `restshape bench drags`: what frames of drags of cloth take of the processor."""

import argparse
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import Kind
from restshape_studies.verification import verifications

from restshape.cli.options import print_table
from restshape.errors import UserError


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    what = f"those of these names (default: all {len(_known())}: {'; '.join(_known())})"
    parser.add_argument("--scenes", dest="among", default="", metavar="A;B", help=what)


def check(args: argparse.Namespace) -> None:
    """Refuse names that are not known, and scenes of the user's."""
    if args.scenes:
        raise UserError("it has scenes and edits of its own", "SCENE", "leave it out, or see --scenes")
    for name in _chosen(args):
        if name not in _known():
            raise UserError(f"{name!r} is none of them", "--scenes", f"choose from {'; '.join(_known())}")


def _known() -> dict[str, tuple[str, list[dict[str, Any]]]]:
    """The study's scenes and edits by name."""
    return {name: one for each in verifications().values() for name, one in each.load_drags().items()}


def _chosen(args: argparse.Namespace) -> list[str]:
    """The names of the scenes that are wanted."""
    return [word for word in map(str.strip, args.among.split(";")) if word] or list(_known())


def own(args: argparse.Namespace) -> list[Case]:
    """The study's scenes, which have no files."""
    return [Case(name, Path(), None) for name in _chosen(args)]


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """A record with contact of the cloth with itself, and one without."""
    from restshape_studies.bench.drags import drag_times

    with tempfile.TemporaryDirectory(prefix="restshape-drags-") as folder:
        return drag_times(case.name, *_known()[case.name], Path(folder), announce)


def show(_: argparse.Namespace, name: str, found: Mapping[str, Any]) -> None:
    """Print the table of a scene."""
    heads = ("contact with itself", "triangles", "first [s]", "frames", "p50 [s]", "worst [s]", "steps", "factors")
    heads += ("by Newton alone", "jumps", "stable")
    rows = []
    for way, one in found.items():
        seconds = ["-" if one[key] is None else f"{one[key]:.3f}" for key in ("median", "worst")]
        work = ["-" if one[key] is None else f"{one[key]:g}" for key in ("steps", "factors")]
        counts = [str(one[key]) for key in ("newton", "jumps", "at_rest")]
        rows.append((way, f"{one['elements']:,}", f"{one['first']:.2f}", str(one["frames"]), *seconds, *work, *counts))
    print_table(name, heads, rows, heads[1:])


KINDS = (
    Kind(
        "drags",
        "seconds of the processor of frames of drags of cloth, with contact with itself and without",
        declare,
        check,
        measure,
        show,
        scenes="still",
        about="frames of drags of cloth are about one",
        own=own,
        times="whole frames, of the processor, with their residual and estimates; steps and factors are medians",
    ),
)
