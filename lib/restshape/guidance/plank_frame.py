"""Frames of a session of furniture, and what it keeps between two of them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from restshape.guidance.design import Design, Way
from restshape.scene.model import Scene

State = tuple[Design, Scene]


@dataclass(slots=True)
class PlankFrame:
    """One frame of a session of furniture.

    Args:
        index: from 0.
        t: edit time [s].
        line: of the script, 0 for the start.
        do: the event's kind, "start" for frame 0.
        change: "start", "none", "move", "shape" (another set of planks, joints or loads) or "values".
        gesture: the parameter under the hand; None where there is none.
        c: how far it is from its start, and 0.
        scene: what else holds.
        refused: why the event changed nothing; None when it was carried out.
        analysed: whether the script asks for a solution of this frame.
        settled: no hand holds a plank, and the event is at its end.
        design: the piece that the edit began with; gamma: (n, 8) its design parameters now.
        note: what was left out of the edit, or came with it.
    """

    index: int
    t: float
    line: int
    do: str
    change: str
    gesture: Way | None
    c: tuple[float, float]
    scene: Scene
    refused: str | None
    analysed: bool
    settled: bool
    design: Design
    gamma: np.ndarray
    note: str = ""


@dataclass(slots=True)
class Step:
    """What one frame of an event did."""

    change: str
    refused: str | None = None
    note: str = ""


@dataclass(slots=True)
class Hold:
    """What the hand holds: a plank, or a parameter of it, from where, the state before, and ways that it has gone."""

    before: State
    plank: int
    number: int | None
    origin: np.ndarray
    cursor: np.ndarray
    free: np.ndarray
    ways: dict[bytes, Way] = field(default_factory=dict)
