"""Where the sheets of a scene lie before any load: one in the plane where it was cut, or panels, each where it says."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape.arrays import Indices, Reals
from restshape.scene.bodies import Start, start_of
from restshape.scene.model import Scene
from restshape.scene.panels import frames_of, panels_of
from restshape.scene.pattern_packing import PanelFrame
from restshape.scene.space_values import evaluated
from restshape.shape.panels.wrapping import Wrapping, wrapping_of
from restshape.shape.placement import placed, rotation


@dataclass(frozen=True)
class SheetPlacement:
    """Where one sheet lies: its own coordinates in the pattern plane, and these in space.

    Args:
        frame: of its own coordinates in the pattern plane; None: they are those of the plane.
        own: where it lies by itself; None: in the plane z = 0.
        whole: where all sheets are moved to.
        wrapping: the cylinder that it lies on before it is turned; None: it is flat.
    """

    frame: PanelFrame | None
    own: Start | None
    whole: Start
    wrapping: Wrapping | None = None

    def coordinates(self, X: Reals) -> Reals:
        """Own coordinates (n, 2) [m] of places X (n, 2) [m] in the pattern plane."""
        return X if self.frame is None else (X - (self.frame.x, self.frame.y)) @ self._axes

    def places(self, X: Reals) -> Reals:
        """Places (n, 3) [m] in space of places X (n, 2) [m] in the pattern plane."""
        own = self.coordinates(X)
        own = self.wrapping.places(own) if self.wrapping else own
        return placed(self.whole, own if self.own is None else placed(self.own, own))

    def directions(self, d: Reals, X: Reals) -> Reals:
        """Directions (n, 3) in space of directions d (n, 2) in the pattern plane, at places X (n, 2) [m]."""
        if self.own is None:
            return d @ rotation(self.whole.turn)[:, :2].T
        own = d if self.frame is None else d @ self._axes
        turn = rotation(self.whole.turn) @ rotation(self.own.turn)
        if self.wrapping:
            return self.wrapping.directions(self.coordinates(X), own) @ turn.T
        return own @ turn[:, :2].T

    @property
    def _axes(self) -> Reals:
        """The matrix (2, 2) whose columns are its own axes in the pattern plane."""
        return plane_axes(self.frame) if self.frame else np.eye(2)


def plane_axes(frame: PanelFrame) -> Reals:
    """The matrix (2, 2) whose columns are the axes of a frame in the pattern plane."""
    c, s = np.cos(frame.angle), np.sin(frame.angle)
    return np.array([[c, -s], [s, c]])


class PatternPlacement:
    """Where all sheets of a scene lie at first.

    Args:
        scene: of cloth.
    """

    def __init__(self, scene: Scene) -> None:
        self.start = evaluated(start_of(scene) or Start(), scene.parameters)
        panels, frames = panels_of(scene), frames_of(scene)
        self.sheets = [SheetPlacement(None, None, self.start)]
        if panels:
            self.sheets = [_sheet(scene, name, frames[name], self.start) for name in panels]

    def coordinates(self, X: Reals, pieces: Indices) -> Reals:
        """Own coordinates (n, 2) [m] of places X (n, 2) [m] in the pattern plane, each of a piece by its number."""
        return self._each("coordinates", pieces, X)

    def places(self, X: Reals, pieces: Indices) -> Reals:
        """Places (n, 3) [m] in space of places X (n, 2) [m] in the pattern plane, each of a piece by its number."""
        return self._each("places", pieces, X)

    def directions(self, d: Reals, X: Reals, pieces: Indices) -> Reals:
        """Directions (n, 3) in space of directions d (n, 2) at places X (n, 2) [m], each of a piece by its number."""
        return self._each("directions", pieces, d, X)

    def _each(self, what: str, pieces: Indices, *values: Reals) -> Reals:
        if len(self.sheets) == 1:
            return np.asarray(getattr(self.sheets[0], what)(*values))
        found = np.empty((len(pieces), 2 if what == "coordinates" else 3))
        for k, sheet in enumerate(self.sheets):
            own = pieces == k
            found[own] = getattr(sheet, what)(*(each[own] for each in values))
        return found


def _sheet(scene: Scene, name: str, frame: PanelFrame, whole: Start) -> SheetPlacement:
    """Where a panel lies; one that is wrapped turns about the point that it is wrapped about."""
    panel = panels_of(scene)[name]
    wrapping = wrapping_of(scene, name, panel)
    about = wrapping.centre.tolist() if wrapping else panel.about
    own = Start.model_construct(turn=panel.turn, about=tuple(about), move=panel.move)
    return SheetPlacement(frame, evaluated(own, scene.parameters), whole, wrapping)
