"""The picture of a scene of furniture before any edit: the piece with its joints, forces and names."""

# More than 15 modules: the heading says all that is known of a piece.

from __future__ import annotations

from pathlib import Path
from textwrap import shorten, wrap

from restshape_apps.furniture.guidance.doubts import judged
from restshape_apps.furniture.physics.furniture import LOST, Furniture
from restshape_apps.furniture.physics.plank_phrases import phrases
from restshape_apps.furniture.physics.worst_load_case import worst_case
from restshape_apps.furniture.report.furniture import bounds, draw_piece, marks_redundant, slenderness
from restshape_apps.furniture.report.piece_frames import FEW, REDUNDANT
from restshape_apps.furniture.report.piece_sheet import BAR, finish_sheet
from restshape_apps.furniture.report.status_colour import BEYOND, DOUBT
from restshape_apps.furniture.shape.plank_scene import piece_of

from restshape.application import application_of
from restshape.outputs.picture_files import save_picture
from restshape.replay.constraints import LIMIT
from restshape.report.style import INK, REFUSED, new_figure
from restshape.scene.model import Scene
from restshape.scene.plan import plan

WIDE = 7.0
"""Width of the picture [inch]."""
LETTERS, LINES = 85, 3
"""Letters of a line, and lines of what is wrong."""
MEANING = "Joints in colour, by their largest utilisation under any load case; blue: forces of feet, black: loads"


def draw_scene(scene: Scene, path: Path) -> None:
    """Writes the picture of the piece of a scene, in the format that the path's suffix names.

    Args:
        scene: of furniture.
        path: of the picture.

    Raises:
        UserError: planks make no piece, or a file is there that restshape has not drawn.
        OSError: it cannot be written.
    """
    furniture = Furniture(Furniture(piece_of(scene)).moved())
    bending = plan(scene, application_of(scene)).on("bending")
    result, found = furniture.test(), judged(furniture.piece, scene.quantities, bending)
    case = 0 if result.flaws & LOST else worst_case(furniture)
    words = "; ".join(phrases(found)) or "holds"
    kinds = {one.kind for one in found}
    colour = REFUSED if not result.valid else BEYOND if kinds == {LIMIT} else DOUBT if kinds else INK
    if result.valid and found:
        words = f"holds, but {words}"
    pushed = f"loads: the weights, and the push {furniture.piece.pushes[case - 1].name}" if case else ""
    title = "\n".join(filter(None, [*wrap(words, LETTERS, max_lines=LINES, placeholder=" …"), pushed]))
    box = bounds(furniture.piece)
    figure = new_figure(WIDE, 1.0 + (WIDE - BAR) * slenderness(*box))
    axes = figure.subplots()
    names = {plank.name for plank in furniture.piece.planks}
    draw_piece(axes, furniture, title, None, case, len(names) <= FEW, box, names)
    axes.set_title(title, fontsize=8.5, loc="left", color=colour)
    meaning = [MEANING, *([REDUNDANT] if marks_redundant([axes]) else [])]
    name = shorten(scene.title or scene.path.stem, LETTERS, placeholder=" …")
    finish_sheet(figure, [axes], 1, 1, "\n".join([name, *wrap(". ".join(meaning), LETTERS)]))
    save_picture(figure, path)
