"""The sound of a bar that is struck, as a file that is exported."""

from __future__ import annotations

import argparse
from pathlib import Path

from restshape_apps.metallophone.sounding.blow import struck
from restshape_apps.metallophone.sounding.damping import damping_of
from restshape_apps.metallophone.sounding.place import struck_place
from restshape_apps.metallophone.sounding.wav import write_wav
from restshape_apps.metallophone.workshop.bar import bar_of

from restshape.export.edited_frame import EditedFrame

SECONDS, CONTACT = 2.0, 5e-4
"""How long it is heard, and for which the mallet touches [s]."""


def write_blow(frame: EditedFrame, args: argparse.Namespace, path: Path) -> list[str]:
    """Write what is heard of one blow, between the hanging points; what there is to note.

    Raises:
        UserError: as of `bar_of`, or the file cannot be written.
    """
    bar = bar_of(frame, args)
    analysis = bar.analysis
    (x, y), deflections = struck_place(analysis, bar.strike)
    shares = damping_of(analysis).shares
    write_wav(path, struck(analysis.frequencies, deflections, shares, SECONDS, CONTACT))
    tones = ", ".join(f"{f:.1f}" for f in analysis.frequencies)
    return [f"struck at ({x:.4g}, {y:.4g}) m, {tones} Hz; restshape sound has more choices"]
