"""A picture of single frames of a recording of cloth: in perspective, from above, and as a flat pattern."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from restshape.errors import UserError
from restshape.physics.cloth.pictures.drape import drape_scenery, shows_cloth
from restshape.physics.cloth.pictures.drape_frames import draw_drape_frames
from restshape.physics.cloth.pictures.pattern_beside_drape import WIDTH, draw_beside
from restshape.replay.recording.recording import Recording


def draw(recording: Recording, frames: Sequence[int], path: Path) -> None:
    """Draw frames by their numbers; negative ones count from the end, and one named twice is drawn once.

    Raises:
        UserError: the recording is not of cloth, or has no such frame.
    """
    _refuse(recording, frames)
    chosen = np.array(list(dict.fromkeys(i % recording.n for i in frames)))
    draw_drape_frames(recording, chosen, drape_scenery(recording, chosen), path)


def draw_beside_pattern(recording: Recording, frame: int, what: str, width: int | None, path: Path) -> None:
    """Draw one frame beside its pattern: "strain" or "pattern", as wide as given [pixels].

    Raises:
        UserError: as of `draw`; or the scene takes its shape from a file.
    """
    _refuse(recording, [frame])
    draw_beside(recording, frame % recording.n, what, width or WIDTH, path)


def _refuse(recording: Recording, frames: Sequence[int]) -> None:
    if not shows_cloth(recording):
        raise UserError("this recording is not of cloth", str(recording.path), "restshape report draws it")
    missing = [i for i in frames if not -recording.n <= i < recording.n]
    if missing:
        raise UserError(f"there is no frame {missing[0]}", "--frames", f"choose from 0 to {recording.n - 1}")
