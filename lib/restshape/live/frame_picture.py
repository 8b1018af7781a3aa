"""The picture of the last frame of a simulation: its parts, and what can be taken hold of."""

from __future__ import annotations

from typing import TYPE_CHECKING

from restshape.live.frame_arrays import PicturePart
from restshape.live.grab_parts import OutlineParts, Thing, things_of
from restshape.live.shape_surface import ShapeSurface
from restshape.live.shown_colours import FieldChoice, colours_of, field_choice

if TYPE_CHECKING:
    from restshape.replay.loop import Replay


class FramePicture:
    """The parts of the picture of each frame of a replay.

    Args:
        replay: whose frames are shown; the first one has been computed.

    Attributes:
        choice: the fields that may be shown; field: name of the one that gives the colours.
    """

    def __init__(self, replay: Replay) -> None:
        self._replay = replay
        self._surface, self._outline = ShapeSurface(), OutlineParts()
        self.choice: FieldChoice = field_choice(replay.session.scene, *replay.analysis.fields())
        self.field = self.choice.first

    @property
    def in_space(self) -> bool:
        """Whether the shape is drawn in space."""
        replay = self._replay
        if replay.solver.space.X.shape[1] == 3:
            return True
        return any(len(values.T) == 3 for values in replay.analysis.fields()[0].values() if values.ndim == 2)

    def parts(self) -> list[PicturePart]:
        """The parts of the last frame."""
        replay = self._replay
        space, known = replay.solver.space, replay.solver.known
        at_nodes, in_cells = replay.analysis.fields() if known else replay.analysis.blank_fields(space)
        colours = colours_of(self.field, at_nodes, in_cells)
        found = [self._surface(space, at_nodes, in_cells, colours)]
        return [*found, *self._outline(replay.session.outline)]

    def things(self) -> list[Thing]:
        """What can be taken hold of."""
        return things_of(self._replay.session.outline)
