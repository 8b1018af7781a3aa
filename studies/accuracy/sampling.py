"""Which frames of a script a study looks at."""

from itertools import islice

import numpy as np

from restshape.errors import UserError
from restshape.replay.chosen_frames import MOVING
from restshape.replay.sessions import session_of
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene


def changing(scene: Scene, script: Script, frames: int | None) -> tuple[list[int], int]:
    """Indices of the frames that change shape or values, without the first one, and the number of all frames.

    Args:
        scene: with its shape.
        script: of edits.
        frames: to look at, the first shape included; None for all.
    """
    found, count = [], 0
    for frame in islice(session_of(scene, script).frames(), frames):
        count += 1
        if frame.index and frame.refused is None and frame.change in MOVING and frame.analysed:
            found.append(frame.index)
    return found, count


def begun(scene: Scene, script: Script, frames: int) -> int:
    """Number of frames until as many have passed as `frames`, counted from the first that changes anything."""
    moving, total = changing(scene, script, None)
    return min(total, moving[0] + frames) if moving else total


def sampled(scene: Scene, script: Script, frames: int | None, count: int, motion: bool) -> tuple[list[int], int]:
    """Indices of the frames at which errors are taken, ascending, and the number of all frames.

    The first shape, the first and the last frame that change anything, and others evenly between. Of motion, which
    begins at rest and never stops, the first shape is none of them. A static scene without a script is its first shape.

    Raises:
        UserError: the script changes nothing, or a motion has none.
    """
    if script.path is None and not motion:
        return [0], 1
    moving, total = changing(scene, script, frames)
    if not moving:
        later, _ = changing(scene, script, None)
        what = f"none of the first {total} frames" if later else "no frame of the script"
        do = (
            f"more frames: the first that does is {later[0]} (--frames {later[0] + total})"
            if later
            else "drag something in it; without --edits, and no script beside the scene, the first shape is studied"
        )
        raise UserError(
            f"{what} changes the shape or a value, so that there is nothing to study",
            str(script.path or scene.path),
            do,
        )
    if script.header.analysis != "every frame":
        raise UserError(
            "the script has its frames analysed on demand only, so that they have no time to report",
            str(script.path),
            "name a script that has every frame analysed: --edits FILE",
        )
    places = np.linspace(0, len(moving) - 1, min(max(1, count - 1 + motion), len(moving)))
    return sorted({*([] if motion else [0]), *(moving[round(place)] for place in places)}), total


def spread(moving: list[int], least: list[int], count: int) -> list[int]:
    """About `count` of the moving frames, evenly, with those of `least` among them."""
    places = np.linspace(0, len(moving) - 1, min(count, len(moving)))
    return sorted({*least, *(moving[round(place)] for place in places)})
