"""A hand that holds something of a shape."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Protocol, Self

if TYPE_CHECKING:
    from restshape.interface.shown_frame import ShownFrame

Length = float | str
"""A number of metres, or a text with a unit such as "12 mm"."""


class Doer(Protocol):
    """What carries out events: see `restshape.interface.simulation.Simulation`."""

    @property
    def closed(self) -> bool: ...
    @property
    def frame(self) -> ShownFrame: ...

    def do(self, do: str, /, **keys: object) -> ShownFrame:
        """Carries out an event; its last frame."""

    def move(self, to: list[object]) -> ShownFrame:
        """Moves what it holds to a place; the frame of that."""

    def each(self, do: str, /, **keys: object) -> Iterator[ShownFrame]:
        """Carries out an event; each of its frames."""


class Hand:
    """A hand that holds something, from a press or a pull until it lets go: at the end of a ``with`` block at latest.

    Args:
        sim: in which it holds it; frame: of the press.

    Attributes:
        frame: the last one that it has made.
    """

    def __init__(self, sim: Doer, frame: ShownFrame) -> None:
        self._sim, self._holds = sim, True
        self.frame = frame

    def to(self, x: Length, y: Length, z: Length | None = None, frames: int | None = None) -> ShownFrame:
        """Moves to a point; the last frame of the motion.

        Args:
            x, y: of the point [m]; z: likewise, where the hand holds something in space.
            frames: of the motion along a straight line; None: one.

        Raises:
            UserError: the place is not valid; RefusedFrame: it cannot be gone to, as of `Simulation.do`.
        """
        to: list[object] = [x, y] if z is None else [x, y, z]
        self.frame = self._sim.move(to) if frames is None else self._sim.do("drag", to=to, frames=frames)
        return self.frame

    def along(self, path: Sequence[Sequence[Length]], frames: int | None = None) -> Iterator[ShownFrame]:
        """Moves along a path; each frame as soon as it is computed.

        Args:
            path: (m, 2) or (m, 3) places [m], a frame each; frames: as many instead, evenly along the path.

        Raises:
            UserError: a place is not valid.
        """
        return map(self._took, self._sim.each("drag", path=path, frames=frames))

    def by(self, amount: Length, frames: int | None = None) -> ShownFrame:
        """Moves a number that it holds, such as a parameter of a part; errors as of `to`.

        Args:
            amount: [m] or [rad], or with a unit, from where the hand took hold; frames: of the motion; None: one.
        """
        return self._took(self._sim.do("drag", by=amount, frames=frames))

    def release(self) -> ShownFrame:
        """Lets go; the frame after it. The last one before it can be read for as long as there is any use for it."""
        self._holds = False
        if self.frame is self._sim.frame:
            self.frame.keep()
        return self._took(self._sim.do("release"))

    def _took(self, frame: ShownFrame) -> ShownFrame:
        self.frame = frame
        return frame

    def __enter__(self) -> Self:
        """The hand."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Lets go, if it has not; an error in a frame has closed the simulation, in which nothing is left to do."""
        if self._holds and not self._sim.closed:
            self.release()
