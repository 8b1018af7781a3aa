"""Which case of the loads the constraint status of a piece is of."""

from collections.abc import Sequence

import numpy as np
from restshape_apps.furniture.physics.furniture import Forces, Furniture


def worst_case(furniture: Furniture) -> int:
    """The case that `worst_of` names, at the last test of a model."""
    return worst_of([furniture.forces(case) for case in range(len(furniture.cases))])


def worst_of(every: Sequence[Forces]) -> int:
    """The case of the loads that the constraint status is of: in which most is missing of what could balance them, else
    a joint is used most, by moments that do not count where these make it doubtful."""
    unbalanced = np.array([one.unbalanced for one in every])
    # Rounding decides nothing.
    if unbalanced.max() > 1e-6:
        return int(np.argmax(unbalanced))
    most = [one.utilisation.max(initial=0.0) for one in every]
    moments = [one.moment_utilisation.max(initial=0.0) for one in every]
    return int(np.argmax(moments if max(most) <= 1.0 < max(moments) else most))
