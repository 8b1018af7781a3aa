"""The cheapest two of many places that hold a body between them."""

import numpy as np


def hold(place: np.ndarray, other: np.ndarray, apart: float) -> bool:
    """Whether two places (2,), from the centre of mass, will do: see `best_pair`."""
    return bool(place @ other <= 0.0 and np.hypot(*(other - place)) >= apart)


def best_pair(places: np.ndarray, cost: np.ndarray, apart: float, level: float) -> tuple[int, int] | None:
    """Indices of the two places whose costs add up to the least, the left one first; None where no two will do.

    Two will do that are at least `apart` from each other and at least 90 degrees apart seen from the centre of mass.

    Args:
        places: (m, 2) from the centre of mass.
        cost: (m,), none negative.
        level: cost of a squared distance of the centre of mass from the line through both.
    """
    order = np.argsort(cost, kind="stable")
    places, cost = places[order], cost[order]
    least, found = np.inf, None
    for i, (place, own) in enumerate(zip(places, cost)):
        # From here on no two can cost less.
        if 2.0 * own >= least:
            break
        others = slice(i + 1, int(np.searchsorted(cost, least - own)))
        to, between = places[others] - place, places[others] @ place
        length = np.hypot(*to.T)
        fits = np.flatnonzero((between <= 0.0) & (length >= apart) & (length > 0.0))
        if not len(fits):
            continue
        offset = (to[fits, 0] * place[1] - to[fits, 1] * place[0]) / length[fits]
        both = own + cost[others][fits] + level * offset**2
        best = int(both.argmin())
        if both[best] < least:
            least, found = float(both[best]), (i, i + 1 + int(fits[best]))
    if found is None:
        return None
    left, right = sorted(found, key=lambda k: tuple(places[k]))
    return int(order[left]), int(order[right])
