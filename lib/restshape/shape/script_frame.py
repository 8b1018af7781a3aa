"""One frame of a session, whatever it edits."""

from __future__ import annotations

from dataclasses import dataclass, field

from restshape.scene.model import Scene
from restshape.shape.hand.gesture import Gesture
from restshape.shape.outline import Outline


@dataclass(slots=True)
class ScriptFrame:
    """One frame of a session.

    Args:
        index: from 0.
        t: edit time [s].
        line: of the script, 0 for the start.
        do: the event's kind, "start" for frame 0.
        change: "start", "none", "move" (along the gesture), "shape" (another layout, or other parts), "values"
            (materials, loads, ...) or "mesh" (mesh settings).
        gesture: the motion of a "move", given already at the press; None where there is none.
        c: its coefficients.
        scene: what else holds.
        refused: why the event changed nothing; None when it was carried out.
        outline: the valid shape of this frame; None where what is edited has no outline.
        analysed: whether the script asks for a solution of this frame.
        edit_ended: nothing moves in it, or it is the last one of an event while no hand holds the shape.
        hand: what the hand holds of an outline or beside it, and where it is [m]; None where it holds nothing there.
    """

    index: int
    t: float
    line: int
    do: str
    change: str
    gesture: Gesture | None
    c: tuple[float, float]
    scene: Scene
    refused: str | None
    outline: Outline | None = field(default=None, kw_only=True)
    analysed: bool = field(default=True, kw_only=True)
    edit_ended: bool = field(default=False, kw_only=True)
    hand: tuple[str, tuple[float, float]] | None = field(default=None, kw_only=True)
