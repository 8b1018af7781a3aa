"""The bars of an instrument, each with its modes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from restshape.analysis.modal.pitch import note
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.scene.load import load_scene

if TYPE_CHECKING:
    from restshape.analysis.modal.modal import ModalAnalysis


@dataclass(frozen=True)
class Bar:
    """One of them.

    Args:
        path: of its scene.
        analysis: solved on its shape.
    """

    path: Path
    analysis: ModalAnalysis

    @property
    def frequencies(self) -> np.ndarray:
        """Frequencies (modes,) [Hz], ascending."""
        return self.analysis.frequencies

    @property
    def tone(self) -> tuple[str, float]:
        """The nearest tone to the first frequency, tuned as the scene says, and how many cents it lies above it."""
        return note(float(self.frequencies[0]), self.analysis.state.plan.settings("modal").a4)

    @property
    def title(self) -> str:
        """The tone's name, and the cents where they are not none."""
        name, cents = self.tone
        rounded = round(cents)
        return f"{name} {rounded:+d} cents".replace("-", "\N{MINUS SIGN}") if rounded else name

    def plain(self) -> dict[str, Any]:
        """What JSON holds of it: lengths in metres, frequencies in Hz."""
        name, cents = self.tone
        size = np.ptp(self.analysis.space.X, axis=0).tolist()
        found = {"scene": str(self.path), "tone": name, "cents": cents, "frequencies": self.frequencies.tolist()}
        return found | {"length": size[0], "width": size[1]}


def bars_of(paths: Sequence[Path], overrides: Sequence[str] = ()) -> list[Bar]:
    """The bars of scenes, in their order.

    Args:
        paths: scene files of metallophones; overrides: ``key=value`` of each, as after --set.

    Raises:
        UserError: a scene that is none of a metallophone, or has no solution.
    """
    for path in paths:
        app = load_scene(path, overrides).app
        if app != "metallophone":
            raise UserError(f"the scene is one of {app!r}", str(path), 'use scenes with app = "metallophone"')
    return [Bar(path, first_frame(path, overrides).analysis) for path in paths]
