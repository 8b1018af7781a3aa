"""`restshape pitches`: the first tone of a recorded edit over its time, with the shapes that have it."""

import argparse
from pathlib import Path

from restshape.cli.options import add_json, write_json
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import PictureFile

MOST = 10
"""Shapes at most."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("recording", metavar="RECORDING", type=Path, help="recording (.vtkhdf) of a bar that is edited")
    parser.add_argument("--out", type=PictureFile, required=True, metavar="FILE", help="picture (.png, .svg)")
    parser.add_argument("--at", metavar="I,J", help="frames whose shapes are drawn (default: where gestures end)")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Draw and write; 0."""
    from restshape_apps.metallophone.pitches_picture import draw_pitches, pitches_of

    from restshape.cli.report import refuse_damage
    from restshape.replay.recording.recording import Recording

    with Recording(args.recording) as recording:
        if not recording.n or "f_1" not in recording.table:
            what = "the recording has no frames of a bar that vibrates"
            raise UserError(what, str(args.recording), 'replay a scene with app = "metallophone"')
        refuse_damage(recording)
        found = pitches_of(recording, _frames(args.at, recording.n), MOST)
        draw_pitches(args.out, recording, found)
    print(f"wrote {one_line(args.out)}: {found.frequencies[0]:.1f} to {found.frequencies[-1]:.1f} Hz")
    shown = [
        {"frame": k, "t": found.times[k], "frequency": found.frequencies[k], "tone": found.words(k)}
        for k in found.shown
    ]
    write_json(args, {"frames": len(found.times), "shown": shown})
    return 0


def _frames(text: str | None, count: int) -> list[int]:
    """The frames that an option names; none where it is not given.

    Raises:
        UserError: they are no numbers of frames, or too many.
    """
    if text is None:
        return []
    words = [word.strip() for word in text.split(",")]
    if not all(word.isdecimal() and int(word) < count for word in words) or len(words) > MOST:
        what = f"frames are numbers from 0 to {count - 1}, with commas, at most {MOST}"
        raise UserError(what, f"--at {text}", f"--at 0,{count - 1}")
    return sorted({int(word) for word in words})
