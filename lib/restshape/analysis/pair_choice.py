"""The cheapest two of many places that hold a body between them."""

import numpy as np


def hold(place: np.ndarray, other: np.ndarray, apart: float) -> bool:
    """Whether two places (2,), from the centre of mass, will do: see `best_pair`."""
    return bool(place @ other <= 0.0 and np.hypot(*(other - place)) >= apart)


def best_pair(places: np.ndarray, cost: np.ndarray, apart: float) -> tuple[int, int] | None:
    """Indices of the two places whose costs add up to the least, the left one first; None where no two will do.

    Two will do that are at least `apart` from each other and at least 90 degrees apart seen from the centre of mass.

    Args:
        places: (m, 2) from the centre of mass.
        cost: (m,), none negative.
    """
    order = np.argsort(cost, kind="stable")
    places, cost = places[order], cost[order]
    least, found = np.inf, None
    for i, (place, own) in enumerate(zip(places, cost)):
        if 2.0 * own >= least:
            break
        later = slice(i + 1, None)
        fits = (places[later] @ place <= 0.0) & (np.hypot(*(places[later] - place).T) >= apart)
        if fits.any():
            k = i + 1 + int(fits.argmax())
            if own + cost[k] < least:
                least, found = own + cost[k], (int(order[i]), int(order[k]))
                ends = (place, places[k])
    if found is None:
        return None
    left, right = sorted(zip(map(tuple, ends), found))
    return left[1], right[1]
