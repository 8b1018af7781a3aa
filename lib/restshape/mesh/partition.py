"""Which rank owns which node: halves of halves, cut across their longer way."""

from __future__ import annotations

import numpy as np

from restshape.arrays import Indices, Reals

SLENDER = 0.1
"""Nodes whose spread in two directions differs by less than this share of both have no longer way: x is taken."""


def node_owners(X: Reals, ranks: int) -> Indices:
    """Rank (n,) that owns each node, the same at each call: as many nodes each, but for rounding, and short borders.

    Source: H. D. Simon, Partitioning of unstructured problems for parallel processing, Comput. Syst. Eng. 2 (1991)
    135-148: recursive inertial bisection.

    Args:
        X: (n, 2) positions [m]; ranks: number of parts.
    """
    owner = np.zeros(len(X), dtype=np.int32)
    parts = [(np.arange(len(X)), 0, ranks)]
    while parts:
        nodes, first, count = parts.pop()
        if count == 1 or not len(nodes):
            owner[nodes] = first
            continue
        below = count // 2
        cut = len(nodes) * below // count
        order = np.argpartition(_along(X[nodes]), cut)
        parts.append((nodes[order[:cut]], first, below))
        parts.append((nodes[order[cut:]], first + below, count - below))
    return owner


def _along(X: Reals) -> Reals:
    """Places (n,) of points (n, 2) along the direction in which they are spread most [m]."""
    x, y = (X - X.mean(axis=0)).T
    xx, yy, xy = (np.sum(product) for product in (x * x, y * y, x * y))
    if np.hypot(xx - yy, 2 * xy) <= SLENDER * (xx + yy):
        return x
    angle = 0.5 * np.arctan2(2 * xy, xx - yy)
    return np.cos(angle) * x + np.sin(angle) * y
