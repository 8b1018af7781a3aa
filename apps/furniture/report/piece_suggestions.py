"""Pictures of suggestions: the piece that was let go, and beside it the piece that each suggestion makes."""

from __future__ import annotations

from math import ceil
from pathlib import Path
from textwrap import shorten, wrap

import numpy as np
from restshape_apps.furniture.guidance.suggested import Suggestion
from restshape_apps.furniture.physics.furniture import LOST, Furniture
from restshape_apps.furniture.physics.worst_load_case import worst_case
from restshape_apps.furniture.report import guided
from restshape_apps.furniture.report.furniture import (
    DesignDirectionView,
    bounds,
    draw_piece,
    marks_redundant,
    slenderness,
)
from restshape_apps.furniture.report.piece_frames import (
    FEW,
    LETTERS,
    REDUNDANT,
    caption,
    pieces,
    shown_piece,
)
from restshape_apps.furniture.report.piece_sheet import ACROSS, EACH, finish_sheet, width_of
from restshape_apps.furniture.report.status_colour import BEYOND, DOUBT
from restshape_apps.furniture.session.plank_session import PlankFrame

from restshape.outputs.picture_files import save_picture
from restshape.replay.recording.recording import Recording
from restshape.report.frames import scene_name
from restshape.report.style import INK, REFUSED, new_figure
from restshape.report.tables import rows_of

LINES = 4
"""Lines of a title for what a suggestion does."""
MEANING = (
    "First the piece as it is, then what each suggestion makes of it, with loads and forces of feet of the case that "
    "the constraint status is of, and joints by their largest utilisation under any. Orange: what is moved, longer or "
    "added; arrows: which way, short ones drawn longer"
)
BREAKS = "Red: a joint that breaks, with its utilisation, and headings of what does not hold"
DOUBTS = "Amber heading: it holds, but what follows is doubtful, or a quantity beyond its limit"
LIMITS = "Purple heading: the piece holds, but a quantity is beyond its limit"
MOMENTS = "Amber joint: overloaded by moments that do not count, with its utilisation by them"


def searches(recording: Recording) -> np.ndarray:
    """Indices of the frames in which suggestions were found, of those that report the same the first."""
    searched = [same[0] for same in guided.searches(rows_of(recording))]
    return np.array([row["index"] for row in searched if row["suggestions"]], dtype=int)


def draw_suggestions(recording: Recording, i: int, path: Path) -> None:
    """Writes the suggestions of a frame as a PNG.

    Args:
        recording: of furniture.
        i: a frame in which suggestions were found.
        path: of the picture.
    """
    (frame,) = pieces(recording, [i])
    furniture, _, case = shown_piece(recording, frame)
    suggestion_list = frame.design.suggestion_list.found
    direction_views = [_direction_view(suggestion, frame) for suggestion in suggestion_list]
    ends = [end for direction_view in direction_views if (end := direction_view.end(furniture))]
    box = bounds(furniture.moved(), *ends)
    across, count = min(ACROSS, 1 + len(suggestion_list)), 1 + len(suggestion_list)
    down = ceil(count / across)
    figure = new_figure(width_of(across), EACH * (1.0 + slenderness(*box)) * down)
    panels = figure.subplots(down, across, squeeze=False).ravel()
    push = furniture.piece.pushes[case - 1].name if case else ""
    words, colour = caption(recording, i, push)
    few = len(furniture.piece.planks) <= FEW
    names = [plank.name for plank in furniture.piece.planks if few]
    draw_piece(panels[0], furniture, words, None, case, few, box, names)
    panels[0].set_title(words, fontsize=8.5, loc="left", color=colour)
    moments = bool(furniture.test().doubts)
    for number, (axes, suggestion, direction_view) in enumerate(zip(panels[1:], suggestion_list, direction_views), 1):
        made, worst = _made(furniture, direction_view)
        moments |= bool(made.test().doubts)
        draw_piece(axes, furniture, "", direction_view, worst, False, box)
        own = REFUSED if not suggestion.valid else DOUBT if suggestion.doubt else INK
        axes.set_title(_title(number, suggestion), fontsize=8.5, loc="left", color=own)
    parts = [
        MEANING,
        *([REDUNDANT] if marks_redundant(panels[:1]) else []),
        BREAKS,
        *([DOUBTS] if colour == DOUBT or any(one.doubt for one in suggestion_list) else []),
        *([LIMITS] if colour == BEYOND else []),
    ]
    meaning = ". ".join([*parts, *([MOMENTS] if moments else [])])
    name = shorten(scene_name(recording), 80, placeholder=" …")
    lines = wrap(meaning, int(14 * figure.get_figwidth()))
    finish_sheet(figure, panels, count, across, "\n".join([f"{name}: suggestions in frame {i}", *lines]))
    save_picture(figure, path)


def _made(furniture: Furniture, direction_view: DesignDirectionView) -> tuple[Furniture, int]:
    """The model of the piece that a suggestion makes, and the case of the loads that is worst there."""
    made = Furniture(direction_view.end(furniture) or furniture.piece)
    return made, 0 if made.test().flaws & LOST else worst_case(made)


def _direction_view(suggestion: Suggestion, frame: PlankFrame) -> DesignDirectionView:
    """What is drawn of a suggestion."""
    if suggestion.piece is not None:
        return DesignDirectionView(np.zeros((len(frame.design.piece.planks), 8)), piece=suggestion.piece)
    return DesignDirectionView(suggestion.direction, suggestion.t)


def _title(number: int, suggestion: Suggestion) -> str:
    """What a suggestion does, its range, and whether something else is still wrong with it."""
    lines = wrap(f"{number}: {suggestion.words}", LETTERS, max_lines=LINES, placeholder=" …")
    if suggestion.range_words:
        lines += wrap(suggestion.range_words, LETTERS, max_lines=2, placeholder=" …")
    if not suggestion.valid:
        lines += wrap(f"in part; still {suggestion.rest}", LETTERS, max_lines=2, placeholder=" …")
    if suggestion.doubt:
        lines += wrap(f"holds, but {suggestion.doubt}", LETTERS, max_lines=2, placeholder=" …")
    return "\n".join(lines)
