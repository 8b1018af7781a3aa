"""Which pictures `restshape report` draws of a recording."""

# More than 15 modules: each kind of picture has a module of its own, which is imported where it is drawn.

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from restshape.application import SHAPES, Application
from restshape.cli.report_looks import Looks
from restshape.errors import UserError

if TYPE_CHECKING:
    from restshape.replay.recording.recording import Recording
    from restshape.scene.physics import OwnPictures


def draw_report(
    recording: Recording, folder: Path, args: argparse.Namespace, looks: Looks, application: Application | None
) -> list[Path]:
    """Draws all pictures; their paths.

    Raises:
        UserError: an option does not suit the recording, or a picture cannot be written.
    """
    from restshape.cli.progress import progress
    from restshape.outputs.picture_files import counting, drawn_from
    from restshape.report.field import own_pictures, shown_field
    from restshape.report.style import resolution

    special, own = own_pictures(recording), application.report if application else None
    if (drawn := special or own) and args.scale is not None:
        raise UserError(f"{drawn.true_scale}, not exaggerated", "--scale", "leave --scale out")
    if looks.of_plane and (special or own or recording.dimension != 2):
        what = "this is an option of pictures of shapes in the plane"
        raise UserError(what, looks.of_plane[0], f"leave {' and '.join(looks.of_plane)} out")
    if own and looks.suffix != ".png":
        raise UserError("pictures of this application are PNG", "--format", "--format png")
    if looks.field:
        shown_field(recording, looks.field)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with (
            resolution(looks.dpi),
            drawn_from(recording.fingerprint),
            progress(False, 0, "pictures drawn") as count,
            counting(count),
        ):
            return _draw(recording, folder, args, looks, application, special)
    except OSError as error:
        raise UserError(f"pictures cannot be written: {error.strerror}", str(folder), "choose another --out") from error


def _draw(
    recording: Recording,
    folder: Path,
    args: argparse.Namespace,
    looks: Looks,
    application: Application | None,
    special: OwnPictures | None,
) -> list[Path]:
    from restshape.report.quantity_panels import draw_quantities
    from restshape.report.time_history import draw_history
    from restshape.report.timeline import draw_timeline

    own, reuse = (application.report, application.editing.mesh) if application else (None, SHAPES.mesh)
    frames, levels, quantities, timeline, history = (
        folder / f"{name}{looks.suffix}" for name in ("frames", "levels", "quantities", "timeline", "history")
    )
    # A single frame goes on nowhere: it has no course, and nothing of it moves.
    pictures = [timeline] if recording.n > 1 else []
    if pictures:
        draw_timeline(recording, timeline, iterations=reuse is not None)
    if draw_history(recording, history):
        pictures.insert(0, history)
    if draw_quantities(recording, quantities):
        pictures.insert(0, quantities)
    # Without a mesh there is none to reuse; where bodies move, and the pattern stays, there are no levels.
    if recording.n > 1 and reuse and not (special and not recording.table["level"][1:].any()):
        pictures.insert(0, levels)
        reuse.draw_levels(recording, levels)
    if recording.dimension == 2:
        moving = None if args.animation == "none" or recording.n == 1 else folder / f"animation.{args.animation}"
        if special:
            special.drawn(recording, args, frames, moving)
        else:
            _draw_plane(recording, args, looks, frames, moving)
        return [frames, *pictures, *filter(None, [moving])]
    return [*own.draw(recording, folder, args), *pictures] if own else pictures


def _draw_plane(recording: Recording, args: argparse.Namespace, looks: Looks, still: Path, moving: Path | None) -> None:
    """Draws a shape in the plane: some frames, and an animation if it has a path."""
    import numpy as np

    from restshape.report.animation import animated_frames, draw_animation
    from restshape.report.frames import draw_frames
    from restshape.report.happenings import chosen_frames
    from restshape.report.overlay import FOR_ARROWS
    from restshape.report.scenery import MARGIN, scenery

    room = FOR_ARROWS if "loads" in looks.things else MARGIN
    common = scenery(recording, args.scale, looks.field, looks.ends, room, looks.view, args.at)
    chosen = np.array(args.at) if args.at else chosen_frames(recording, args.frames)
    draw_frames(recording, chosen, common, still, looks.things)
    if moving:
        draw_animation(recording, animated_frames(recording), common, moving, looks.things)
