"""`restshape report`: tables and pictures of a recording."""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from restshape.application import applications
from restshape.cli.options import add_json, write_json
from restshape.cli.report_looks import add_looks, read_looks
from restshape.cli.report_pictures import draw_report
from restshape.cli.report_tables import print_tables
from restshape.errors import UserError, one_line
from restshape.outputs.claims import refuse_foreign
from restshape.outputs.kinds import AnimationFile, PictureFile
from restshape.outputs.si_numbers import counted

if TYPE_CHECKING:
    from restshape.replay.recording.recording import Recording

SUMMARY = "tables and pictures of a recording"
_FORMATS = ("gif", "mp4", "none")


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what this command takes."""
    parser.add_argument("recording", metavar="RECORDING", type=Path, help="recording (.vtkhdf) that replay --out wrote")
    parser.add_argument("--out", metavar="DIR", type=Path, help="folder for pictures (default: beside the recording)")
    parser.add_argument("--frames", metavar="N", type=int, default=6, help="frames on the contact sheet (default 6)")
    parser.add_argument("--at", metavar="I,J", help="frames on the contact sheet, by their numbers")
    parser.add_argument("--animation", choices=_FORMATS, default="gif", help="kind of animation (default gif)")
    parser.add_argument("--scale", metavar="S", type=float, help="exaggeration (default: 8 %% of the size)")
    add_looks(parser)
    for app in applications().values():
        if app.report:
            app.report.add_arguments(parser)
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Prints the tables and draws the pictures."""
    args.at = _numbers(args.at)
    if args.frames < 1:
        raise UserError("at least one frame must be shown", "--frames", "--frames 6")
    for app in applications().values():
        if app.report:
            app.report.check_arguments(args)
    if args.scale is not None and not 0.0 < args.scale < float("inf"):
        raise UserError("the exaggeration must be greater than 0", "--scale", "--scale 1 draws true displacements")
    if args.recording.is_dir():
        raise UserError("this is a folder", str(args.recording), "name a recording (.vtkhdf) in it")
    from restshape.replay.recording.recording import Recording

    if args.animation == "mp4" and shutil.which("ffmpeg") is None:
        print("note: MP4 needs ffmpeg, which is not installed: the animation is a GIF", file=sys.stderr)
        args.animation = "gif"
    looks = read_looks(args)
    with Recording(args.recording) as recording:
        if not recording.n:
            raise UserError("the recording holds no frames", str(args.recording), "run the replay again")
        folder = args.out or args.recording.with_name(f"{args.recording.stem}-report")
        if folder.exists() and not folder.is_dir():
            raise UserError("this is a file, and pictures need a folder", str(folder), "choose another --out")
        if args.at and args.at[-1] >= recording.n:
            what = f"there is no frame {args.at[-1]}: the recording holds {counted(recording.n, 'frame')}"
            raise UserError(what, "--at", f"the last one is {recording.n - 1}")
        refuse_damage(recording)
        refuse_pictures(folder, looks.suffix)
        # A recording opens also where its application is not installed.
        application = applications().get(recording.header.get("app", ""))
        data = print_tables(recording, application)
        pictures = draw_report(recording, folder, args, looks, application)
    print()
    for picture in pictures:
        print(f"wrote {one_line(picture)}")
    write_json(args, {**data, "pictures": [str(picture) for picture in pictures]})
    return 0


def _numbers(text: str | None) -> tuple[int, ...]:
    """The numbers of frames that an option names, rising; none where it is not given.

    Raises:
        UserError: it names none.
    """
    try:
        found = tuple(sorted({int(word) for word in (text or "").split(",") if word.strip()}))
    except ValueError:
        found = ()
    if text is not None and (not found or found[0] < 0):
        raise UserError("numbers of frames are 0, 1, ..., with commas", f"--at {text}", "--at 0,20,40")
    return found


def refuse_damage(recording: Recording) -> None:
    """Makes sure that all frames match their checksums.

    Raises:
        UserError: some do not; says which do.
    """
    from restshape.replay.recording.recording import ranges

    if damaged := recording.verify():
        good = sorted(set(range(recording.n)) - set(damaged))
        are = "is" if len(damaged) == 1 else "are"
        what = f"{len(damaged)} of {counted(recording.n, 'frame')} {are} damaged: {ranges(damaged)}"
        what += f"; good: {ranges(good) or 'none'}"
        do = f"restshape salvage {recording.path} --out FILE.vtkhdf writes the good ones"
        raise UserError(what, str(recording.path), do if good else "record it again")


def refuse_pictures(folder: Path, suffix: str = ".png") -> None:
    """Makes sure that what a report draws into a folder replaces nothing but its own pictures.

    Raises:
        UserError: naming the first other file.
    """
    named = [
        PictureFile(folder / f"{name}{suffix}") for name in ("frames", "levels", "quantities", "timeline", "history")
    ]
    for path in (*named, *(AnimationFile(folder / f"animation.{kind}") for kind in _FORMATS[:2])):
        refuse_foreign(path, str(path))
