"""`restshape instrument`: several bars beside each other, in a table, in a picture and as a scale that is heard."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from restshape.cli.options import add_json, add_set, print_table, write_json
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import PictureFile, SoundFile

if TYPE_CHECKING:
    from restshape_apps.metallophone.instrument.bars import Bar

EVERY = 0.6
"""Time [s] from the blow on a bar to that on the next one."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("scenes", type=Path, nargs="+", metavar="SCENE", help="scene files (.toml) of metallophones")
    parser.add_argument(
        "--out", type=PictureFile, metavar="FILE", help="outlines above, first modes below (.png, .svg)"
    )
    parser.add_argument("--wav", type=SoundFile, metavar="FILE", help="the bars struck one after the other (.wav)")
    what = f"with --wav: from blow to blow (default: {EVERY})"
    parser.add_argument("--every", type=float, metavar="SECONDS", help=what)
    add_set(parser, what="change one key of all scenes (may be given several times)")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Print, draw and sound the bars; 0."""
    if args.every is not None and not (args.wav and 0.0 < args.every <= 60.0):
        raise UserError("the time between blows is of a sound, and positive", "--every", "--wav scale.wav --every 0.6")
    from restshape_apps.metallophone.instrument.bars import bars_of
    from restshape_apps.metallophone.stage import refuse_ranks

    refuse_ranks()

    bars = bars_of(args.scenes, args.set)
    _print(bars)
    if args.out:
        from restshape_apps.metallophone.instrument.picture import draw

        draw(bars, args.out)
        print(f"wrote {one_line(args.out)}")
    if args.wav:
        from restshape_apps.metallophone.instrument.scale_sound import struck_in_turn
        from restshape_apps.metallophone.sounding.wav import write_wav

        write_wav(args.wav, struck_in_turn(bars, EVERY if args.every is None else args.every))
        print(f"wrote {one_line(args.wav)}")
    write_json(args, [bar.plain() for bar in bars])
    return 0


def _print(bars: "list[Bar]") -> None:
    """Print each bar with its tone, and its next two modes over the first."""
    heads = ("bar", "f_1 [Hz]", "tone", "cents", "f_2/f_1", "f_3/f_1", "length [mm]", "width [mm]")
    rows = []
    for bar in bars:
        (name, cents), size = bar.tone, bar.plain()
        ratios = [f"{f / bar.frequencies[0]:.3f}" for f in bar.frequencies[1:3]]
        sides = [f"{1e3 * size[side]:.1f}" for side in ("length", "width")]
        sounding = (f"{bar.frequencies[0]:.2f}", name, f"{cents:+.2f}", *ratios, *[""] * (2 - len(ratios)))
        rows.append((one_line(bar.path.stem), *sounding, *sides))
    print_table("", heads, rows, right=tuple(head for head in heads if head not in ("bar", "tone")))
