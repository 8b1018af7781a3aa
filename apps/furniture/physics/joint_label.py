"""What is written beside a joint that breaks."""

import numpy as np
from restshape_apps.furniture.physics.plank_findings import MOST_UTILISATION


def joint_label(utilisation: float) -> str:
    """The utilisation of a joint that breaks, or what breaks it where no amount is borne: one fastener bears no twist.

    Args:
        utilisation: above 1; infinite of that.
    """
    if utilisation > MOST_UTILISATION:
        return "twist"
    return f"{np.ceil(100.0 * utilisation) / 100.0:.2f}" if utilisation < 100.0 else f"{utilisation:.3g}"


def utilisation_words(utilisation: float, digits: str) -> str:
    """A utilisation for tables, with digits such as ``.3g``; one fastener bears no twist."""
    return "infinite" if utilisation >= MOST_UTILISATION else format(utilisation, digits)
