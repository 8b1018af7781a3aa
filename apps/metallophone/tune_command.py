"""`restshape tune`: the smallest change of a bar that brings it to a tone, or where to rasp it."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from restshape_apps.metallophone.rasping import command as rasping
from restshape_apps.metallophone.stage import add_frame, metallophone

from restshape.cli.options import add_json, print_table, write_json
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import TunedFile

if TYPE_CHECKING:
    from restshape_apps.metallophone.tuning.tuning import Tuning

    from restshape.scene.model import Scene


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_frame(parser, "rasped, with --rasp,")
    parser.add_argument("--to", required=True, metavar="TONE", help="wanted tone of the first mode, such as C5")
    parser.add_argument("--overtones", metavar="RATIOS", help="wanted frequencies of bending modes, such as 1:4:10")
    parser.add_argument("--modes", metavar="RANKS", help="modes that are tuned, by rank, instead: such as 1:3:6")
    what = "what may change: a vertex, spline, hole, parameter or key (several times; default: the outline)"
    parser.add_argument("--by", action="append", default=[], metavar="KEY", help=what)
    what = "least and most that a freedom may become (may be given several times)"
    parser.add_argument("--bound", action="append", default=[], metavar="KEY=LOW:HIGH", help=what)
    parser.add_argument("--out", type=TunedFile, metavar="FILE", help="the tuned scene (.toml)")
    rasping.arguments(parser)
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Tune, print, and write what is asked for, or hand on to rasping; 0, or 1 out of tune."""
    if args.scene.suffix.lower() in (".vtkhdf", ".h5", ".hdf"):
        what = "this is a recording: it has no scene that could be changed"
        raise UserError(what, str(args.scene), "name the scene that it was made from")
    scene = metallophone(args)
    if args.rasp:
        return rasping.run(scene, args)
    if args.edits or args.frame is not None:
        remedy = "write the scene of the frame (restshape export SCENE EDITS --frame N --as toml), and tune that"
        raise UserError("what is tuned is a scene, no frame of edits", "EDITS" if args.edits else "--frame", remedy)
    if args.measured or args.keep or args.picture:
        option = "--measured" if args.measured else "--keep" if args.keep else "--picture"
        raise UserError(f"{option} is of a bar that is there, and rasped", option, "add --rasp, or leave it out")
    if args.out and args.out.suffix.lower() != ".toml":
        raise UserError(f"{one_line(args.out.name)} is no .toml file", "--out", "--out tuned.toml")
    return _tune(scene, args)


def _tune(scene: Scene, args: argparse.Namespace) -> int:
    from restshape_apps.metallophone.rasping.tolerances import print_tolerances
    from restshape_apps.metallophone.tuning.report import TuningReport
    from restshape_apps.metallophone.tuning.tuning import tuned
    from restshape_apps.metallophone.tuning.wanted import wanted_tones

    from restshape.physics.elasticity.modal_effect import modal_keys

    a4 = modal_keys(scene).a4
    wanted = wanted_tones(args.to, args.overtones, a4)
    tuning = tuned(scene, wanted, args.by, args.bound, _ranks(args.modes))
    report = TuningReport(tuning, a4)
    for title, (heads, rows) in (("steps", report.steps()), ("freedoms", report.freedoms())):
        print_table(title, heads, rows, right=heads[1:])
    print_tolerances(tuning.tolerances)
    print(report.summary())
    for note in report.notes():
        print(f"note: {note}")
    if args.out:
        _write(scene, tuning, args)
    write_json(args, report.plain())
    return 0 if tuning.found.in_tune else 1


def _ranks(text: str | None) -> list[int]:
    """The ranks of modes."""
    words = text.split(":") if text else []
    if not all(word.isdigit() and int(word) > 0 for word in words) or len(set(words)) < len(words):
        raise UserError("these are no ranks of modes", f"--modes {text}", "count from 1, such as 1:3:6")
    return [int(word) for word in words]


def _write(scene: Scene, tuning: Tuning, args: argparse.Namespace) -> None:
    """Write the scene with what was found, and with what --set gives."""
    from restshape.outputs.atomic_files import write_whole
    from restshape.outputs.kinds import TUNED_MARK
    from restshape.scene.overrides import parse_override
    from restshape.scene.rewritten import rewritten

    changes: list[tuple[tuple[str, ...], Any]] = [parse_override(word) for word in args.set]
    text = rewritten(scene.path, [*changes, *tuning.changes()], args.out)
    try:
        write_whole(args.out, TUNED_MARK + text.removeprefix(TUNED_MARK))
    except OSError as error:
        raise UserError(f"cannot be written: {error.strerror}", f"--out {args.out}", "name another file") from error
    print(f"wrote {one_line(args.out)}")
