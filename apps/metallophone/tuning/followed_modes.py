"""Modes of a bar that are followed while it changes, by their shapes, with what is in their clusters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from restshape_apps.metallophone.tuning.bar import Bar

from restshape.algebra.eigenproblems.clusters import clusters

ALIKE = 0.5
"""Modal assurance criterion (MAC) of a mode before and of a cluster now below which the mode counts as lost."""


@dataclass(frozen=True, eq=False)
class FollowedModes:
    """The modes that are tuned, at one state of a bar.

    Args:
        groups: of each mode all modes of its cluster, among those that are known, itself first.
        frequencies: (m,) [Hz]; of a cluster the root of the mean of its eigenvalues.
        ids: (m,) of the modes; shapes: (m, n f) theirs.
    """

    groups: tuple[np.ndarray, ...]
    frequencies: np.ndarray
    ids: np.ndarray
    shapes: np.ndarray


def followed(bar: Bar, ids: Sequence[int] | np.ndarray, shapes: np.ndarray | None = None) -> FollowedModes | None:
    """The modes in the last solve of a bar; None where one of them is lost.

    Args:
        bar: that has been solved.
        ids: (m,) of the modes in the last solve that was kept.
        shapes: (m, n f) theirs there: on the same nodes they count, and ids across meshes.
    """
    modes = bar.analysis.state.modes
    groups, found = clusters(modes.values), []
    same = shapes is not None and bar.level < 3 and shapes.shape[1] == modes.mass_products.shape[1]
    if same:
        # Of another thickness they are not of unit mass any more.
        shapes = shapes / np.sqrt(bar.analysis.solver.pencil.norms(shapes))[:, None]
    for k, number in enumerate(ids):
        group = _like(bar, shapes[k], groups) if same else _of_id(bar, number, groups)
        if group is None:
            return None
        found.append(group)
    means = np.array([modes.values[group].mean() for group in found])
    first = [group[0] for group in found]
    frequencies = np.sqrt(np.maximum(means, 0.0)) / (2.0 * np.pi)
    return FollowedModes(tuple(found), frequencies, modes.ids.ids[first], modes.vectors[first])


def _of_id(bar: Bar, number: int, groups: list[np.ndarray]) -> np.ndarray | None:
    """The cluster of the mode of an id; first in it that mode."""
    places = np.flatnonzero(bar.analysis.state.modes.ids.ids == number)
    if not len(places):
        return None
    return next(_first(group, places[0]) for group in groups if places[0] in group)


def _like(bar: Bar, shape: np.ndarray, groups: list[np.ndarray]) -> np.ndarray | None:
    """The cluster that looks most like a mode before; first in it the mode that does."""
    shares = (bar.analysis.state.modes.mass_products @ shape) ** 2
    sums = [shares[group].sum() for group in groups]
    best = int(np.argmax(sums))
    if sums[best] < ALIKE:
        return None
    return _first(groups[best], groups[best][np.argmax(shares[groups[best]])])


def _first(group: np.ndarray, mode: int) -> np.ndarray:
    """A cluster with one of its modes before the others."""
    return np.concatenate([[mode], group[group != mode]])
