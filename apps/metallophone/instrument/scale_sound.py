"""The sound of bars that are struck one after the other."""

from collections.abc import Sequence

import numpy as np
from restshape_apps.metallophone.instrument.bars import Bar
from restshape_apps.metallophone.sounding.blow import struck
from restshape_apps.metallophone.sounding.damping import damping_of
from restshape_apps.metallophone.sounding.place import struck_place
from restshape_apps.metallophone.sounding.wav import RATE, normalised

LAST = 2.0
"""Time [s] for which the last bar is heard; all others sound on as long after their blow."""
CONTACT = 5e-4
"""Time [s] for which the mallet touches."""


def struck_in_turn(bars: Sequence[Bar], every: float, rate: int = RATE) -> np.ndarray:
    """The sound (n,), its largest size 1: each bar struck where its first mode moves most, all with the same size.

    Args:
        bars: in the order of the blows; every: time [s] from blow to blow; rate: samples a second.
    """
    starts = [round(k * every * rate) for k in range(len(bars))]
    sound = np.zeros(starts[-1] + round(LAST * rate))
    for bar, start in zip(bars, starts):
        _, deflections = struck_place(bar.analysis, None)
        shares = damping_of(bar.analysis).shares
        own = struck(bar.frequencies, deflections, shares, LAST, CONTACT, rate)
        sound[start : start + len(own)] += own
    return normalised(sound)
