"""The sheet of a bar: one page with its drawing, tones, places, material, rasping map and tolerances."""

from __future__ import annotations

import argparse
from pathlib import Path

import matplotlib
from restshape_apps.metallophone.workshop.bar import bar_of
from restshape_apps.metallophone.workshop.engraving import notes_on
from restshape_apps.metallophone.workshop.rasping_map import draw_map
from restshape_apps.metallophone.workshop.sheet_drawing import draw_bar
from restshape_apps.metallophone.workshop.sheet_page import STYLE, SheetPage
from restshape_apps.metallophone.workshop.sheet_tables import write_head, write_tables

from restshape.export.edited_frame import EditedFrame
from restshape.outputs.kinds import SHEET_MARK
from restshape.outputs.picture_files import save_pages


def write_sheet(frame: EditedFrame, args: argparse.Namespace, path: Path) -> list[str]:
    """Write the sheet of the bar of a frame as a PDF; what there is to note.

    Raises:
        UserError: as of `bar_of`.
        OSError: it cannot be written.
    """
    bar = bar_of(frame, args)
    title = frame.scene.title or frame.scene.path.stem
    about = {"Creator": SHEET_MARK, "Title": f"{title}, {bar.target}", "CreationDate": None}
    with matplotlib.rc_context(STYLE):
        page = SheetPage()
        write_head(page, bar, title)
        below = draw_bar(page, bar) - 6.0
        write_tables(page, bar, draw_map(page, bar, below))
        save_pages([page.figure], path, about)
    return notes_on(bar)
