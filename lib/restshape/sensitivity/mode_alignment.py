"""Modes of several solutions in one basis, so that they can be mixed."""

from __future__ import annotations

import numpy as np

from restshape.arrays import Reals

ALIKE = 0.5
"""Cosine between two spaces of modes below which one has a mode that the other one lacks."""


def turning(weighted: Reals, before: Reals) -> Reals | None:
    """The orthogonal matrix (k, k) that brings modes of before closest to others, by Procrustes in the mass.

    It has the signs of modes that stand alone, the turn of those in a cluster, and the order of those that have changed
    places. All of them are one cluster here, as they are to `frequency_derivative.modal_derivative`, whose derivatives
    of modes leave their turning among each other out.

    Args:
        weighted: (k, n) products M phi of the others.
        before: (k, n) modes.

    Returns:
        None where a mode of before is hardly among the others.

    Source: P. H. Schoenemann, A generalized solution of the orthogonal Procrustes problem, Psychometrika 31 (1966) 1.
    """
    if weighted.shape != before.shape:
        return None
    left, cosines, right = np.linalg.svd(weighted @ before.T)
    return left @ right if cosines.size and cosines[-1] > ALIKE else None
