"""The sound of one blow: a sum of damped modes."""

import numpy as np
from restshape_apps.metallophone.sounding.mallet import excitation, pole
from restshape_apps.metallophone.sounding.wav import RATE, normalised


def struck(
    frequencies: np.ndarray,
    deflections: np.ndarray,
    damping: np.ndarray | float,
    seconds: float,
    contact: float = 0.0,
    rate: int = RATE,
) -> np.ndarray:
    """The sound (n,), its largest size 1, of a blow: each mode sounds as it moves where it is struck.

    A blow of unit impulse gives mode k the speed phi_k at the point that it hits; the air hears the acceleration there,
    f_k phi_k^2 times a sine that dies away with exp(-damping 2 pi f_k t). A mallet that touches for a time gives many
    small blows, one after the other (`mallet.excitation`). Modes that the rate cannot hold are left out.

    Args:
        frequencies: (k,) [Hz]; deflections: (k,) of the modes where they are struck, each of unit modal mass.
        damping: (k,), or one of all: share of critical damping.
        seconds: how long; contact: time [s] for which the mallet touches.
        rate: samples a second.
    """
    t = np.arange(round(seconds * rate)) / rate
    sound = np.zeros_like(t)
    for f, phi, share in zip(frequencies, deflections, np.broadcast_to(damping, np.shape(frequencies))):
        if f < 0.5 * rate:
            s = pole(f, share)
            sound += phi**2 * f * np.imag(excitation(s, contact, t) * np.exp(s * t))
    return normalised(sound)


def partials(
    frequencies: np.ndarray, deflections: np.ndarray, damping: np.ndarray, contact: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """The sizes (k,), the largest 1, and rates (k,) [1/s] of decay of what `struck` adds up, once the mallet is off.

    Sizes are those that sines which die away from the blow on would have had at it; arguments as of `struck`.
    """
    poles = [pole(float(f), float(share)) for f, share in zip(frequencies, damping)]
    pushed = np.array([abs(excitation(s, contact, np.array([contact]))[0]) for s in poles])
    sizes = frequencies * deflections**2 * pushed
    return sizes / max(float(sizes.max(initial=0.0)), 1e-300), 2.0 * np.pi * frequencies * damping
