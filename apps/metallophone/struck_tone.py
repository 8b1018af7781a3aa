"""The tone of a plate that is struck in a live session."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

import numpy as np
from restshape_apps.metallophone.sound_command import CONTACT
from restshape_apps.metallophone.sounding.blow import partials
from restshape_apps.metallophone.sounding.damping import damping_of
from restshape_apps.metallophone.sounding.place import on_plate, struck_place

from restshape.analysis.modal.pitch import tone_words
from restshape.live.shown_marks import Tone

if TYPE_CHECKING:
    from restshape.analysis.modal.modal import ModalAnalysis
    from restshape.fem.space import Space
    from restshape.interface.simulation import Simulation

NEAR = 0.25
"""Share of the plate's size by which a blow may miss it."""


def struck_tone(simulation: Simulation, at: Sequence[float] | None = None) -> Tone:
    """The tone of a plate struck by a mallet at a place [m]; None: where mode 1 moves most.

    A blow that just misses the plate strikes the place of it that is nearest.

    Raises:
        UserError: the place is far off the plate.
    """
    analysis = cast("ModalAnalysis", simulation.replay.analysis)
    place, deflections = struck_place(analysis, None if at is None else _on_the_plate(analysis.space, at[:2]))
    frequencies = analysis.frequencies
    sizes, decays = partials(frequencies, deflections, damping_of(analysis).shares, CONTACT)
    row = simulation.frame.row
    name = tone_words(str(row["tone"]), float(row["cents"]))
    return Tone(frequencies.tolist(), decays.tolist(), sizes.tolist(), name, place.tolist())


def _on_the_plate(space: Space, at: Sequence[float]) -> Sequence[float]:
    """A place (2,) [m]; the nearest node where it lies a little off the plate, or in a hole."""
    place = np.array(at, dtype=float)
    if on_plate(space.X[space.cells[:, :3]], place):
        return at
    apart = np.linalg.norm(space.X - place, axis=1)
    node = int(apart.argmin())
    missed = apart[node] > NEAR * np.linalg.norm(np.ptp(space.X, axis=0))
    return at if missed else space.X[node].tolist()
