"""The tone of a plate that is struck in a live session."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

from restshape_apps.metallophone.sound_command import CONTACT
from restshape_apps.metallophone.sounding.blow import partials
from restshape_apps.metallophone.sounding.damping import damping_of
from restshape_apps.metallophone.sounding.place import struck_place

from restshape.analysis.pitch import tone_words
from restshape.live.shown_marks import Tone

if TYPE_CHECKING:
    from restshape.analysis.modal import ModalAnalysis
    from restshape.interface.simulation import Simulation


def struck_tone(simulation: Simulation, at: Sequence[float] | None = None) -> Tone:
    """The tone of a plate struck by a mallet at a place [m]; None: where mode 1 moves most.

    Raises:
        UserError: the place is off the plate.
    """
    analysis = cast("ModalAnalysis", simulation.replay.analysis)
    _, deflections = struck_place(analysis, None if at is None else at[:2])
    frequencies = analysis.frequencies
    sizes, decays = partials(frequencies, deflections, damping_of(analysis).shares, CONTACT)
    row = simulation.frame.row
    name = tone_words(str(row["tone"]), float(row["cents"]))
    return Tone(frequencies.tolist(), decays.tolist(), sizes.tolist(), name)
