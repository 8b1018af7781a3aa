"""What `restshape report` draws of furniture."""

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

from restshape.errors import UserError

MOVING = 24
"""Frames that are animated at most."""
FRAMES = 6
"""On a sheet where nobody says otherwise."""
SEARCHES = 3
"""Searches for suggestions that are drawn where nobody says otherwise."""


def arguments(parser: ArgumentParser) -> None:
    """Adds the options of furniture."""
    parser.add_argument(
        "--searches",
        metavar="N",
        type=int,
        default=SEARCHES,
        help=f"of furniture: searches for suggestions that are drawn, the last ones (default {SEARCHES})",
    )


def check(options: Namespace) -> None:
    """Makes sure that the options make sense.

    Raises:
        UserError: fewer than no searches.
    """
    if options.searches < 0:
        raise UserError("there are no fewer than 0", "--searches", "--searches 0 draws no suggestions")


def draw(recording: Any, folder: Path, options: Namespace) -> list[Path]:
    """Draws Characteristic frames, what guidance reported over all of them, suggestions, and an animation; their
    paths."""
    from restshape_apps.furniture.report.piece_animation import draw_piece_animation
    from restshape_apps.furniture.report.piece_frames import draw_piece_frames, telling_frames
    from restshape_apps.furniture.report.piece_ranges import draw_guidance
    from restshape_apps.furniture.report.piece_suggestions import draw_suggestions, searches

    from restshape.report.animation import animated_frames

    draw_piece_frames(recording, telling_frames(recording, options.frames), folder / "frames.png")
    draw_guidance(recording, folder / "guidance.png")
    pictures = [folder / "frames.png", folder / "guidance.png"]
    searched = searches(recording)
    for i in searched[max(len(searched) - options.searches, 0) :]:
        pictures.append(folder / f"suggestions-{i}.png")
        draw_suggestions(recording, int(i), pictures[-1])
    if options.animation != "none":
        pictures.append(folder / f"animation.{options.animation}")
        draw_piece_animation(recording, animated_frames(recording, MOVING), pictures[-1])
    return pictures


def draw_sheet(recording: Any, at: int | None, path: Path) -> None:
    """Draws the frame of a number into one PNG; without a number characteristic ones."""
    from restshape_apps.furniture.report.piece_frames import draw_piece_frames, telling_frames

    draw_piece_frames(recording, telling_frames(recording, FRAMES) if at is None else [at], path)
