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
    with replacing(path) as part:
        figure.savefig(part)
