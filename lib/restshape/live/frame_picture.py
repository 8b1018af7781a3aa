"""The picture of the last frame of a simulation: its parts, and what can be taken hold of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

import numpy as np

from restshape.application import application_of
from restshape.errors import UserError
from restshape.live.body_parts import BodyParts, pin_part, things_in_space
from restshape.live.frame_arrays import PicturePart
from restshape.live.grab_parts import OutlineParts, Thing, things_of
from restshape.live.shape_surface import Colours, ShapeSurface, mode_of
from restshape.live.shown_colours import FieldChoice, colours_of, field_choice
from restshape.scene.bodies import bodies_of, pins_of

if TYPE_CHECKING:
    from restshape.arrays import Reals
    from restshape.interface.simulation import Simulation


class FramePicture:
    """The parts of the picture of each frame of a simulation.

    Args:
        sim: whose frames are shown.

    Attributes:
        choice: the fields that may be shown; field: name of the one that gives the colours.
        mode: number of the mode that is drawn where there are some; in_space: the shape is drawn in space.
    """

    def __init__(self, sim: Simulation) -> None:
        self._sim = sim
        self._surface, self._outline, self._bodies = ShapeSurface(), OutlineParts(), BodyParts()
        at_nodes, in_cells = sim.replay.analysis.fields()
        self.choice: FieldChoice = field_choice(sim.scene, at_nodes, in_cells)
        self._colours: Colours | None = None
        self._looked: tuple[object, bool] = (None, False)
        self._choose(self.choice.first)
        deep = any(values.ndim == 2 and values.shape[1] == 3 for values in at_nodes.values())
        self.in_space = deep or sim.replay.solver.space.X.shape[1] == 3

    def follow(self, sim: Simulation) -> None:
        """Goes on with another simulation of the same scene."""
        self._sim = sim

    def show(self, field: str) -> None:
        """Takes the colours from another field.

        Raises:
            UserError: there is none of that name.
        """
        if field not in self.choice.looks:
            known = ", ".join(self.choice.looks) or "none, for there are no fields"
            raise UserError(f"there is no field {field!r}", do=f"use one of: {known}")
        self._choose(field)

    def _choose(self, field: str) -> None:
        self.field, self.mode = field, mode_of(field)

    def parts(self) -> list[PicturePart]:
        """The parts of the last frame."""
        replay = self._sim.replay
        session, space = replay.session, replay.solver.space
        at_nodes, in_cells = self._sim.frame.fields_apart
        colours = self._colours
        if colours is None or colours.name != self.field or colours.in_cells or in_cells or self.field not in at_nodes:
            colours = self._colours = colours_of(self.field, at_nodes, in_cells)
        found = [self._surface(space, at_nodes, in_cells, colours), *self._outline(session.outline)]
        scene = session.scene
        if self._looked[0] is not scene:
            self._looked = scene, bool(bodies_of(scene) or pins_of(scene))
        if self._looked[1]:
            places = _deformed(space.X, at_nodes.get("displacement"))
            found += self._bodies(scene, places)
            pins = pin_part(scene, space, places)
            found += [pins] if pins is not None else []
        return found

    def things(self) -> list[Thing]:
        """What can be taken hold of."""
        scene, outline = self._sim.scene, self._sim.replay.session.outline
        own = application_of(scene).editing.things(self._sim)
        if own is not None:
            return [*cast("Sequence[Thing]", own)]
        parts = things_of(outline)
        return [*parts, *things_in_space(scene, {part.name for part in parts})]


def _deformed(X: Reals, displacement: Reals | None) -> Reals:
    """Places (n, 3) [m] of nodes, where they are known."""
    found = np.zeros((len(X), 3))
    found[:, : X.shape[1]] = X
    if displacement is not None:
        found[:, : displacement.shape[1]] += np.nan_to_num(displacement)
    return found
