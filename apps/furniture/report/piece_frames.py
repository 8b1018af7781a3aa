"""The contact sheet of furniture: Characteristic frames of a recording, each with its joints, its forces and its
range."""

# More than 15 modules: all that a frame of furniture shows meets here.

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import ceil
from pathlib import Path
from textwrap import shorten, wrap
from typing import Any

import numpy as np
from restshape_apps.furniture.guidance.amounts import UNITS
from restshape_apps.furniture.physics.furniture import LOST, Furniture
from restshape_apps.furniture.physics.plank_findings import DEPENDS, DOUBTFUL
from restshape_apps.furniture.physics.plank_phrases import phrases
from restshape_apps.furniture.physics.worst_load_case import worst_case
from restshape_apps.furniture.report.furniture import (
    DesignDirectionView,
    bounds,
    draw_piece,
    marks_redundant,
    slenderness,
)
from restshape_apps.furniture.report.guided import (
    CAUSES,
    doubt_causes,
    findings_of,
    grabbed,
    only_limits,
    runs,
    said,
)
from restshape_apps.furniture.report.piece_sheet import ACROSS, EACH, finish_sheet, width_of
from restshape_apps.furniture.report.status_colour import status_colour
from restshape_apps.furniture.session.plank_session import PlankFrame

from restshape.errors import UserError
from restshape.guidance.ranges import Ranges
from restshape.outputs.picture_files import save_picture
from restshape.replay.constraints import HOLDS, LIMIT
from restshape.replay.recording.frame_recording import FrameRecording
from restshape.replay.recording.recording import Recording
from restshape.replay.sessions import session_of
from restshape.report.frames import scene_name
from restshape.report.style import new_figure
from restshape.report.tables import column, refused, row_of, rows_of
from restshape.scene.edit_script import Script, read_script
from restshape.scene.load import recorded_scene

LETTERS, LINES = 46, 3
"""Room in a title: letters a line, and lines for what is wrong."""
MOST_LINES = LINES + 3
"""Of a title in all."""
FEW = 10
"""Planks up to which forces are written beside their arrows."""
DEPENDING = "depends on joints"
SAID = (DEPENDING, f"holds, but {DEPENDING}")
"""How a heading begins that says so without more."""
SAME = 1e-6
"""How far corners of a piece that is made again may be from those of the recording, in parts of its size."""
MEANING = (
    "joints in colour, by their largest utilisation under any load case; blue: forces of feet, black: loads, of one "
    "case. Planks are named where they are seen first"
)
REDUNDANT = "Numbers joined by a dash: utilisation of a redundant joint over the ratios of compliance"
RANGES = (
    "Thin dashed line: the way of what is under the hand, as far as it was looked at; thick line with ends: its valid "
    "range, without one nothing of it is valid. Black where the piece holds, red where not; circle: the piece as it is"
)
DOUBTS = "Amber: the piece holds, but {}"
MOMENTS = "The number of an amber joint is its utilisation by moments that do not count"
LIMITS = "Purple heading: the piece holds, but a quantity is beyond its limit; ranges are of the piece alone"


def badness(recording: Recording) -> np.ndarray:
    """How far each frame (n,) is from holding: above 1 where a joint breaks or the piece falls; nan: not judged."""
    tips = 1.0 - column(recording, "stability_margin")
    worst = np.fmax(column(recording, "utilisation"), tips)
    judged = np.array([bool(word) for word in recording.table["constraint_status"]]) & ~refused(recording)
    # What has lost a joint has no forces, and a part without feet no margin.
    fails = np.array([word not in ("", HOLDS) for word in recording.table["constraint_status"]])
    return np.where(judged, np.where(fails, np.fmax(worst, 1.0), worst), np.nan)


def telling_frames(recording: Recording, count: int) -> np.ndarray:
    """Indices of at most `count` frames: the first and the last that were judged, the worst, those in which a status
    begins, and others spread over the rest."""
    bad = badness(recording)
    judged = np.flatnonzero(np.isfinite(bad))
    if not len(judged):
        return np.array([0])
    turns = [int(first["index"]) for first, _, _ in runs(rows_of(recording))]
    spread = judged[np.linspace(0, len(judged) - 1, max(count, 2)).round().astype(int)]
    wanted = [int(judged[0]), int(judged[-1]), int(np.nanargmax(bad)), *turns, *spread.tolist()]
    good = [i for i in dict.fromkeys(wanted) if np.isfinite(bad[i])]
    return np.array(sorted(good[:count]))


def pieces(recording: Recording, wanted: Sequence[int]) -> Iterator[PlankFrame]:
    """The frames of the recording's session of these numbers, which are in order, each with its piece.

    Raises:
        UserError: the recording's scene and script make other pieces now.
    """
    if isinstance(recording, FrameRecording):
        assert isinstance(recording.edit, PlankFrame), "it is of furniture"
        yield replace(recording.edit, index=0)
        return
    header, path = recording.header, recording.path
    scene = recorded_scene(header["scene_values"], path.with_name(Path(header["scene"]).name or "scene"))
    if "planks" not in scene.sections:
        raise UserError(f"its frames are of planks, its scene of {scene.app!r}", str(path), "record it again")
    text, name = header["script_text"], path.with_name(Path(header["script"]).name or "script")
    script = read_script(text, name, scene, keep_good=True) if text else Script.empty(scene)
    session, left = session_of(scene, script), list(map(int, wanted))
    stopped = refused(recording)
    for frame in session.frames():
        if not left or frame.index >= recording.n:
            return
        if stopped[frame.index] and not frame.refused and frame.change != "none":
            # It had no solution.
            session.rollback()
        if frame.index == left[0]:
            left.pop(0)
            _compare(recording, frame)
            yield frame


def _compare(recording: Recording, frame: PlankFrame) -> None:
    piece = frame.design.furniture.moved(frame.gamma)
    here, there = np.concatenate([plank.corners() for plank in piece.planks]), recording.points(frame.index)
    if here.shape != there.shape or np.abs(here - there).max() > SAME * piece.size:
        what = f"its script makes another piece in frame {frame.index} than was recorded"
        raise UserError(what, str(recording.path), "record it again with this version of the program")


def shown_piece(recording: Recording, frame: PlankFrame) -> tuple[Furniture, DesignDirectionView | None, int]:
    """The model of a frame's piece, the range of what is under the hand, and the case of the loads that is worst."""
    furniture = Furniture(frame.design.furniture.moved(frame.gamma))
    result, direction_view = furniture.test(), None
    hand, gesture = grabbed(row_of(recording, frame.index)), frame.gesture
    if gesture is not None and hand and hand.ranges is not None:
        found = np.array([(one.low, one.high) for one in hand.ranges]).reshape(-1, 2)
        ranges, doubts = Ranges(found, np.zeros(0), np.zeros(0), 0), np.array(hand.doubtful).reshape(-1, 2)
        factor, unit = UNITS[hand.unit]
        unit = factor, "°" if unit == "deg" else f" {unit}"
        direction_view = DesignDirectionView(
            gesture.direction,
            0.0,
            ranges,
            gesture.low,
            gesture.high,
            result.valid,
            frame.c[0],
            unit=unit,
            doubts=doubts,
        )
    return furniture, direction_view, 0 if result.flaws & LOST else worst_case(furniture)


def caption(recording: Recording, i: int, case: str = "") -> tuple[str, str]:
    """What a frame is, in lines, and their colour, which shows whether it holds."""
    row = row_of(recording, i)
    lines = [f"frame {recording.number(i)}, t = {recording.times[i]:.2f} s: {row['event']} (line {row['line']})"]
    if hand := grabbed(row):
        factor, unit = UNITS[hand.unit]
        far = f"{factor * float(row['at']):+.4g} {unit}".replace("-", "\N{MINUS SIGN}")
        lines += wrap(f"{row['parameter']} {far}", LETTERS, max_lines=1, placeholder=" …")
    lines += wrap(heading(row), LETTERS, max_lines=LINES, placeholder=" …")
    words = "\n".join(lines + ([f"loads: the weights, and the push {case}"] if case else []))
    return words, status_colour(row)


def heading(row: Mapping[str, Any]) -> str:
    """What a heading says of the piece of a frame, what must not be cut off first: whether it depends on joints, and of
    a piece that holds quantities beyond their limits."""
    findings, words = findings_of(row), row["violated_constraints"]
    limits = "; ".join(phrases([one for one in findings if one.kind == LIMIT]))
    if only_limits(row) and words.endswith(f"; {limits}"):
        words = f"{limits}; {words.removesuffix(f'; {limits}')}"
    words = said(row, words) or "not judged"
    if not any(one.kind == DEPENDS for one in findings) or words.startswith(SAID):
        return words
    # The joints have their ranges beside them.
    return "; ".join([DEPENDING, *(part for part in words.split("; ") if not part.startswith(DEPENDING))])


def meaning(recording: Recording, chosen: Sequence[int], ranges: bool, numbers: bool) -> str:
    """What colours and lines in pictures of these frames stand for.

    Args:
        recording: of furniture.
        chosen: frames that are shown.
        ranges: some of them have a range.
        numbers: some of them have a range of the utilisation of a redundant joint.
    """
    rows = [row_of(recording, i) for i in chosen]
    limits, causes = any(map(only_limits, rows)), doubt_causes(rows)
    parts = [
        MEANING,
        *([REDUNDANT] if numbers else []),
        *([RANGES] if ranges else []),
        *([LIMITS] if limits else []),
    ]
    parts += [DOUBTS.format(causes)] if causes else []
    parts += [MOMENTS] if CAUSES[DOUBTFUL] in causes else []
    return ". ".join(parts)


def draw_piece_frames(recording: Recording, chosen: np.ndarray | Sequence[int], path: Path) -> None:
    """Writes the contact sheet as a PNG.

    Args:
        recording: of furniture.
        chosen: frames to show, in order.
        path: of the picture.
    """
    frames = list(pieces(recording, chosen))
    made = [shown_piece(recording, frame) for frame in frames]
    box = bounds(*(furniture.piece for furniture, _, _ in made))
    across = min(ACROSS, len(frames))
    down = ceil(len(frames) / across)
    figure = new_figure(width_of(across), EACH * (1.0 + slenderness(*box)) * down)
    panels = figure.subplots(down, across, squeeze=False).ravel()
    named: set[str] = set()
    for axes, frame, (furniture, direction_view, case) in zip(panels, frames, made):
        few = len(furniture.piece.planks) <= FEW
        # Each name once, where its plank is seen first.
        fresh = {plank.name for plank in furniture.piece.planks if few} - named
        named |= fresh
        push = furniture.piece.pushes[case - 1].name if case else ""
        words, colour = caption(recording, frame.index, push)
        draw_piece(axes, furniture, words, direction_view, case, few, box, fresh)
        axes.set_title(words, fontsize=8.5, loc="left", color=colour)
    name = shorten(scene_name(recording), 80, placeholder=" …")
    ranges = any(direction_view for _, direction_view, _ in made)
    explanation = meaning(recording, chosen, ranges, marks_redundant(panels[: len(frames)]))
    lines = wrap(explanation, int(14 * figure.get_figwidth()))
    finish_sheet(figure, panels, len(frames), across, "\n".join([name, *lines]))
    save_picture(figure, path)
