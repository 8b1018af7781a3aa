"""Strips across a bar's lower face on which rasping moves the first tone one way."""

from dataclasses import dataclass

import numpy as np
from restshape_apps.metallophone.rasping.densities import Densities
from restshape_apps.metallophone.rasping.outline_places import corner_thickness
from restshape_apps.metallophone.rasping.places import SHORTEST, Place, profile, profile_words, stretches
from restshape_apps.metallophone.rasping.tolerances import CENTS

from restshape.analysis.modal.modal import ModalAnalysis

SHARE = 1.0 / 3.0
"""Of the least thickness, which comes off underneath at most."""
WHOLE = "whole face underneath"
"""What strips are part of."""


def underneath_places(analysis: ModalAnalysis, densities: Densities) -> list[Place]:
    """Strips over the whole width, one after the other along the bar, and the whole face; or spots.

    Spots are where the density has a sign that no strip has as a whole: deepest where it is strongest.

    Args:
        analysis: solved on the mesh as it lies.
        densities: of the modes whose cents are wanted; of a plane solid there is no place.
    """
    if not densities.underneath:
        return []
    mesh, first = analysis.state.space.mesh, densities.underneath[0]
    axis, middle = long_axis(mesh.X, first.area)
    u = (mesh.X - middle) @ axis
    begin, end = float(u.min()), float(u.max())
    # A strip is no shorter than the mesh shows.
    size = 1.2 * float(np.sqrt(first.area.mean()))
    bounds = np.linspace(begin, end, max(4, int((end - begin) / size)) + 1)
    strip = np.clip(np.searchsorted(bounds, u, side="right") - 1, 0, len(bounds) - 2)
    sums = np.bincount(strip, first.gradient, len(bounds) - 1)
    middles = np.concatenate([[begin], 0.5 * (bounds[1:] + bounds[:-1])[1:-1], [end]])
    spans = [span for span in stretches(middles, sums) if span[1] - span[0] >= SHORTEST * size]
    if len(spans) != 1:
        spans.append((begin, end))
    bar, found = _Underside(analysis, densities), []
    for low, high in spans:
        over = low == begin, high == end
        ends = np.array([middle + low * axis, middle + high * axis])
        found.append(
            bar.place(WHOLE if all(over) else "underneath", profile(u, low, high, over), ends, profile_words(over))
        )
    for sign in (1.0, -1.0):
        off = np.maximum(sign * first.density, 0.0)
        if off.any() and not any(place.cents[0] * sign < 0.0 for place in found):
            along = u[off > 0.0]
            ends = np.array([middle + along.min() * axis, middle + along.max() * axis])
            found.append(bar.place("spots underneath", off / off.max(), ends, "as the map"))
    return found


def long_axis(X: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The direction (2,) in which places X (n, 2) of weights (n,) extend most, and their mean (2,).

    Of a body that extends alike in all directions x; the direction goes with x, or with y.
    """
    middle = weights @ X / weights.sum()
    values, vectors = np.linalg.eigh((X - middle).T @ ((X - middle) * weights[:, None]))
    axis = np.array([1.0, 0.0]) if values[0] > 0.99 * values[1] else vectors[:, 1]
    return axis * (1.0 if axis[np.argmax(np.abs(axis))] > 0.0 else -1.0), middle


@dataclass(frozen=True, eq=False)
class _Underside:
    """The lower face of a bar, with densities of modes."""

    analysis: ModalAnalysis
    densities: Densities

    def place(self, where: str, off: np.ndarray, ends: np.ndarray, words: str) -> Place:
        """A place with depths `off` (n,) at the corners of the mesh a unit of its own; others as of `Place`."""
        f = self.analysis.frequencies[self.densities.ranks]
        cents = -CENTS * np.array([one.gradient @ off for one in self.densities.underneath]) / f
        volume, length = float(self.densities.underneath[0].area @ off), float(np.linalg.norm(ends[1] - ends[0]))
        limit = SHARE * float(corner_thickness(self.analysis).min())
        still = np.zeros_like(self.analysis.state.space.mesh.X)
        mass = off * self.densities.underneath[0].area
        mark = np.array([mass @ self.analysis.state.space.mesh.X / mass.sum(), np.zeros(2)])
        return Place(where, True, ends, mark, length, words, still, off, volume, cents, limit)
