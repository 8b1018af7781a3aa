"""Eigenvalues that belong together."""

import numpy as np

from restshape.arrays import Integers, Reals

CLUSTER = 1e-3
"""Eigenvalues that differ by less than this share of themselves belong together: they are solved for, and followed
along a change of the shape, all or none."""


def clusters(values: Reals, width: float = CLUSTER) -> list[Integers]:
    """Indices of values (k,), ascending, in groups whose neighbours differ by less than a share `width`."""
    cuts = np.flatnonzero(np.diff(values) > width * np.abs(values[1:])) + 1
    return np.split(np.arange(len(values)), cuts)


def cluster_end(values: Reals, k: int) -> int:
    """How many of values (m,), ascending, there are up to the last one of the cluster of the k-th, from 0."""
    gaps = np.flatnonzero(np.diff(values[k:]) > CLUSTER * np.abs(values[k + 1 :]))
    return k + 1 + int(gaps[0]) if len(gaps) else len(values)
