"""`restshape salvage`: the good frames of a damaged recording in a new one."""

import argparse
from pathlib import Path

from restshape.cli.options import add_json, write_json
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import RecordingFile
from restshape.outputs.si_numbers import counted

SUMMARY = "write the good frames of a damaged recording into a new one"


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what this command takes."""
    parser.add_argument("recording", metavar="RECORDING", type=Path, help="recording (.vtkhdf), damaged or cut off")
    parser.add_argument("--out", metavar="FILE", type=RecordingFile, required=True, help="new recording (.vtkhdf)")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Writes what is good and says what it is; the exit code."""
    from restshape.replay.recording.good_frames import salvage
    from restshape.replay.recording.recording import ranges

    if args.out.suffix != ".vtkhdf":
        do = f"--out {args.out.with_suffix('.vtkhdf')}"
        raise UserError("a recording's name ends in .vtkhdf", f"--out {args.out}", do)
    good, count = salvage(args.recording, args.out)
    are = "is" if len(good) == 1 else "are"
    print(f"wrote {one_line(args.out)}: {len(good)} of {counted(count, 'frame')} {are} good: {ranges(good)}")
    write_json(args, {"frames": count, "good": good})
    return 0
