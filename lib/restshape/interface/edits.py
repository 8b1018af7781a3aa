"""The events of edit scripts as methods."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING

from restshape.interface.hand import Hand, Length

if TYPE_CHECKING:
    from restshape.interface.shown_frame import ShownFrame

Point = Sequence[Length]
"""(2,) or (3,) [m]."""
Pins = Sequence[str | Point]
"""Vertices, or places [m] on a curve."""


class Edits:
    """What can be done to a shape: an event of edit scripts a method, with its keys as docs/script-format.md has them.

    What is left out is as it is in scripts; places and lengths are in metres, angles in radians, or texts with a unit.
    All methods give the last frame of the event, but `press` and `pull`, which give a hand. All raise a `UserError`
    where the event is not valid, and what `do` raises.
    """

    @abstractmethod
    def do(self, do: str, /, **keys: object) -> ShownFrame:
        """Carries out an event; its last frame."""

    @abstractmethod
    def _grab(self, do: str, **keys: object) -> Hand:
        """Carries out an event by which a hand takes hold of something."""

    def press(
        self,
        on: str,
        at: Point | None = None,
        along: Sequence[float] | None = None,
        counted: Sequence[float] | None = None,
        mirror: Sequence[Point] | None = None,
        **keys: object,
    ) -> Hand:
        """A hand takes hold of an entity, a body or a support: `to` moves it.

        Args:
            on: name of what it holds; at: where the hand is.
            along: (2,) the one direction in which the entity goes; counted: (2,) that of the hand which counts for it.
            mirror: two points of a line, in which what the hand holds has mirror images that follow it.
            keys: further ones of an application of its own.
        """
        return self._grab("press", on=on, at=at, along=along, counted=counted, mirror=mirror, **keys)

    def pull(self, on: str, at: Point | None = None, pins: Pins | None = None) -> Hand:
        """A hand takes hold of a curve, which `to` bends between the pins.

        Args:
            on: name of the curve; at: where it takes hold; pins: what stays; left out, the curve's ends.
        """
        return self._grab("pull", on=on, at=at, pins=pins)

    def smooth(
        self, on: str, strength: float | None = None, pins: Pins | None = None, frames: int | None = None
    ) -> ShownFrame:
        """A curve is faired; `strength`, between 0 and 1, is the share of a zigzag that goes away."""
        return self.do("smooth", on=on, strength=strength, pins=pins, frames=frames)

    def rotate(self, on: str, by: Length, about: Point | str | None = None, frames: int | None = None) -> ShownFrame:
        """An entity turns by an angle [rad] about a point, or the axis that an application names."""
        return self.do("rotate", on=on, by=by, about=about, frames=frames)

    def scale(
        self, on: str, factor: float, about: Point | None = None, frames: int | None = None, **keys: object
    ) -> ShownFrame:
        """An entity grows by a factor about a point; `keys`: further ones of an application of its own."""
        return self.do("scale", on=on, factor=factor, about=about, frames=frames, **keys)

    def set(self, key: str, value: object, frames: int | None = None) -> ShownFrame:
        """A key of the scene, such as "material.steel.thickness", gets a value as it would stand in its file."""
        return self.do("set", key=key, value=value, frames=frames)

    def insert(self, on: str, name: str, at: Point | None = None, s: float | None = None) -> ShownFrame:
        """An edge gets a vertex, near a point or at a part 0 < s < 1 of its length."""
        return self.do("insert", on=on, name=name, at=at, s=s)

    def delete(self, on: str) -> ShownFrame:
        """A vertex, a hole, a region or a dart goes away."""
        return self.do("delete", on=on)

    def arc(
        self, on: str, through: Point | None = None, bulge: float | None = None, frames: int | None = None
    ) -> ShownFrame:
        """An edge becomes an arc, through a point or of a bulge tan(angle / 4)."""
        return self.do("arc", on=on, through=through, bulge=bulge, frames=frames)

    def hole(
        self,
        name: str,
        center: Point | None = None,
        radius: Length | None = None,
        polygon: Sequence[Point] | None = None,
    ) -> ShownFrame:
        """A new hole: a circle by centre and radius, or a polygon."""
        return self.do("hole", name=name, center=center, radius=radius, polygon=polygon)

    def dart(self, name: str, width: Length, **keys: object) -> ShownFrame:
        """A dart is drawn in a cloth: `start` and `to`, or `edge`, say where; other keys as of ``[darts.NAME]``."""
        return self.do("dart", name=name, width=width, **keys)

    def idle(self, frames: int = 1) -> ShownFrame:
        """Nothing happens for some frames, in which bodies move on and cloth comes to rest."""
        return self.do("idle", frames=frames)

    def analyse(self) -> ShownFrame:
        """One frame is analysed, also where the simulation was opened with analysis "on demand"."""
        return self.do("analyse")

    def undo(self) -> ShownFrame:
        """The last edit is taken back."""
        return self.do("undo")

    def redo(self) -> ShownFrame:
        """The last edit that was taken back is done again."""
        return self.do("redo")
