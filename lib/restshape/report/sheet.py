"""The contact sheet of a recording as bytes, for notebooks: the one that `restshape report` draws into a file."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from restshape.application import applications
from restshape.replay.recording.recording import Recording
from restshape.report.field import own_pictures
from restshape.report.frames import draw_frames
from restshape.report.happenings import chosen_frames
from restshape.report.scenery import scenery
from restshape.report.style import resolution

DPI = 96
"""Pixels an inch: a sheet is at most as wide as the text of a notebook."""
FRAMES = 6
"""On a sheet at most, as on that of a report."""


def sheet(recording: Recording, at: int | None = None) -> bytes | None:
    """A PNG of frames of a recording, in the colours that they have in its report.

    Args:
        recording: any that has frames.
        at: the number of the one frame to show; None: those that a report shows.

    Returns:
        The picture; None where no sheet is drawn of such recordings.
    """
    app, special = applications().get(str(recording.header.get("app", ""))), own_pictures(recording)
    own = app.report if app else None
    if not recording.n or not (special or own or recording.dimension == 2):
        return None
    with TemporaryDirectory() as folder, resolution(DPI):
        path = Path(folder) / "frames.png"
        if special:
            special.drawn(recording, Namespace(frames=FRAMES, at=() if at is None else (at,)), path, None)
            return path.read_bytes()
        if own:
            own.draw_sheet(recording, at, path)
        else:
            chosen = chosen_frames(recording, FRAMES) if at is None else np.array([at])
            draw_frames(recording, chosen, scenery(recording), path)
        return path.read_bytes()
