"""Pictures: whole or not at all, and over no others."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from restshape.outputs.claims import refuse_foreign
from restshape.outputs.kinds import PictureFile
from restshape.outputs.whole import replacing

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def save_picture(figure: Figure, path: Path) -> None:
    """Writes a figure, in the format that the path's suffix names.

    Raises:
        UserError: a file is there that restshape has not drawn.
        OSError: it cannot be written.
    """
    refuse_foreign(PictureFile(path), str(path))
    plain_texts(figure)
    with replacing(path) as part:
        figure.savefig(part)


def plain_texts(figure: Figure) -> None:
    """Has all texts of a figure drawn as they are, whatever mathematics they look like, but for logarithmic ticks."""
    from matplotlib.text import Text

    scales = [axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis) if axis.get_scale() == "log"]
    powers = {id(text) for axis in scales for text in axis.findobj(Text) if text is not axis.label}
    for text in figure.findobj(Text):
        if id(text) not in powers:
            text.set_parse_math(False)
