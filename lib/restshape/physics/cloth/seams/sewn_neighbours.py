"""Which nodes seams make neighbours, that do not push each other away: those of three edges in one seam too."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import coo_matrix


def clusters(pairs: np.ndarray, n: int) -> np.ndarray:
    """The smallest number (n,) int32 of those that pairs (k, 2) join each one with."""
    number = np.arange(n, dtype=np.int32)
    while True:
        low = np.minimum(number[pairs[:, 0]], number[pairs[:, 1]])
        found = number.copy()
        for side in range(2):
            np.minimum.at(found, pairs[:, side], low)
        if np.array_equal(found, number):
            return number
        number = found


def shared_nodes(lines: Sequence[np.ndarray]) -> np.ndarray:
    """Nodes of edges that are in more than one of the lines of nodes (p,) of the mesh."""
    edges = [np.unique(np.sort(np.column_stack([nodes[:-1], nodes[1:]])), axis=0) for nodes in lines]
    both, count = np.unique(np.vstack([np.zeros((0, 2), np.int64), *edges]), axis=0, return_counts=True)
    return np.unique(both[count > 1]).astype(np.int64)


def with_shared(pairs: np.ndarray, shared: np.ndarray, n: int) -> np.ndarray:
    """Pairs (k, 2) int32 of numbers below n, and those of numbers that are both paired with a shared one (m,)."""
    both = np.vstack([pairs, pairs[:, ::-1]])
    through = both[np.isin(both[:, 1], shared)]
    graph = coo_matrix((np.ones(len(through)), through.T), shape=(n, n)).tocsr()
    product = (graph @ graph.T).tocoo()
    found = np.vstack([pairs, np.column_stack([product.row, product.col])])
    found = np.sort(found[found[:, 0] != found[:, 1]], axis=1)
    return np.unique(found, axis=0).astype(np.int32)
