"""A picture of single frames of a recording of cloth: in perspective, from above, and as a flat pattern.

python -m restshape_apps.couture.picture RECORDING --frames 0 17 38 --out FILE
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from restshape.cli.options import refuse_overwriting
from restshape.errors import UserError
from restshape.outputs.kinds import PictureFile
from restshape.physics.cloth.pictures.drape import drape_scenery, shows_cloth
from restshape.physics.cloth.pictures.drape_frames import draw_drape_frames
from restshape.replay.recording import Recording


def draw(recording: Recording, frames: Sequence[int], path: Path) -> None:
    """Draw frames by their numbers; negative ones count from the end.

    Raises:
        UserError: the recording is not of cloth, or has no such frame.
    """
    if not shows_cloth(recording):
        raise UserError("this recording is not of cloth", str(recording.path), "restshape report draws it")
    missing = [i for i in frames if not -recording.n <= i < recording.n]
    if missing:
        raise UserError(f"there is no frame {missing[0]}", "--frames", f"choose from 0 to {recording.n - 1}")
    chosen = np.array(frames) % recording.n
    draw_drape_frames(recording, chosen, drape_scenery(recording, chosen), path)


def main(words: Sequence[str] | None = None) -> int:
    """Draw; 0 on success, 2 on bad input."""
    parser = argparse.ArgumentParser(prog="python -m restshape_apps.couture.picture", description=__doc__)
    parser.add_argument("recording", metavar="RECORDING", type=Path, help="recording (.vtkhdf) that replay --out wrote")
    parser.add_argument("--frames", metavar="N", type=int, nargs="+", default=[0, -1], help="default: first and last")
    parser.add_argument("--out", metavar="FILE", type=PictureFile, required=True, help="the picture (.png)")
    args = parser.parse_args(words)
    try:
        refuse_overwriting(args)
        with Recording(args.recording) as recording:
            draw(recording, args.frames, args.out)
    except UserError as error:
        print(f"picture: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"picture: {args.out} cannot be written: {error.strerror}", file=sys.stderr)
        return 2
    print(f"wrote {args.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
