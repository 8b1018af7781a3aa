"""Modes that coincide, or that only the mesh parts."""

from __future__ import annotations

import numpy as np

from restshape.algebra.eigenproblems.clusters import CLUSTER, clusters
from restshape.analysis.modal.modal_state import ModalState, frequencies

WIDEST = 0.02
"""Share of themselves by which eigenvalues differ that no mesh is held to have parted: 17 cents."""


def coinciding(state: ModalState, count: int) -> list[np.ndarray]:
    """Ranks of the lowest `count` modes in groups of those that coincide, as far as their mesh can tell.

    Symmetry makes pairs, and a mesh without it parts them: neighbours belong together, too, whose eigenvalues differ by
    less than the estimated error of one of them, and by less than `WIDEST`.
    """
    values = state.modes.values[:count]
    wide = clusters(values, WIDEST)
    if len(wide) == len(clusters(values, CLUSTER)):
        return wide
    near = np.concatenate([group for group in wide if len(group) > 1])
    errors = np.zeros(count)
    errors[near] = state.body.error_estimate()(state.modes.vectors[near])
    allowed = np.maximum(
        CLUSTER * np.abs(values[1:]), np.minimum(np.maximum(errors[1:], errors[:-1]), WIDEST * values[1:])
    )
    return np.split(np.arange(count), np.flatnonzero(np.diff(values) > allowed) + 1)


def pair_words(values: np.ndarray) -> str:
    """How many modes with eigenvalues (k,) [1/s^2] coincide, at which frequency, and whether a mesh parts them."""
    within = ", as far as this mesh shows" if len(clusters(values, CLUSTER)) > 1 else ""
    return f"{len(values)} modes at {frequencies(values[:1])[0]:.4g} Hz{within}"
