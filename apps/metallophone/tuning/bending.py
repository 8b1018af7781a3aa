"""Which modes of a bar are bending modes: their deflection depends on the place along the bar alone."""

import numpy as np

from restshape.analysis.modal.modal import ModalAnalysis

DEGREE = 12
"""Of the polynomial along the bar that a bending mode is nearly."""
BENDS = 0.5
"""Share of a mode's squared deflection that such a polynomial has, above which it is a bending mode."""


def bending_modes(analysis: ModalAnalysis) -> list[int]:
    """Indices of the bending modes among all that are known, ascending in frequency.

    A torsion is odd across the bar, and has no such part; a bending mode has little else. The bar lies along the longer
    principal axis of its nodes.
    """
    state = analysis.state
    X = analysis.space.X[:, :2]
    middle = X - X.mean(axis=0)
    along = np.linalg.svd(middle, full_matrices=False)[2][0]
    s = middle @ along
    powers = np.polynomial.legendre.legvander(2.0 * (s - s.min()) / np.ptp(s) - 1.0, DEGREE)
    basis = np.linalg.qr(powers)[0]
    deflections = state.body.shapes(state.modes.vectors)[:, :, -1]
    sizes = (state.body.shapes(state.modes.vectors) ** 2).sum(axis=(1, 2))
    return [k for k, w in enumerate(deflections) if ((basis.T @ w) ** 2).sum() > BENDS * sizes[k]]
