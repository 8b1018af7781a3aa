"""Frames of a session of furniture, and what it keeps between two of them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from restshape_apps.furniture.guidance.design import Design, DesignDirection

from restshape.scene.model import Scene
from restshape.shape.script_frame import ScriptFrame

State = tuple[Design, Scene]


# More than 15 attributes: those of a frame of any session, and the piece that it shows.
@dataclass(slots=True)
class PlankFrame(ScriptFrame):
    """One frame of a session of furniture; its gesture is the parameter under the hand, at c[0] from its start.

    Args:
        design: the piece that the edit began with; gamma: (n, 8) its design parameters now.
        note: what was left out of the edit, or came with it.
    """

    design: Design
    gamma: np.ndarray
    note: str = ""


@dataclass(slots=True)
class Grab:
    """What the hand holds: a plank, or a parameter of it, from where, the state before, and ways that it has gone."""

    before: State
    plank: int
    number: int | None
    origin: np.ndarray
    cursor: np.ndarray
    free: np.ndarray
    design_directions: dict[bytes, DesignDirection] = field(default_factory=dict)
