"""How far modes are from those of their matrices, and from those of a finer mesh."""

import numpy as np

from restshape.analysis.modal_matrices import products
from restshape.analysis.modal_state import ModalState
from restshape.fem.eigenproblem import ModeEstimate


def residual_norm(state: ModalState) -> float:
    """The largest |K phi - lambda M phi| / |lambda M phi| of the modes that the scene asks for, element by element."""
    body, modes = state.body, state.modes
    worst, free = 0.0, body.boundary.mask.ravel() == 0
    for k in modes.chosen:
        force, weight = products(body, modes.vectors[k : k + 1])[:, 0]
        error = np.linalg.norm((force - modes.values[k] * weight)[free])
        worst = max(worst, float(error / (abs(modes.values[k]) * np.linalg.norm(weight[free]))))
    return worst


class FrequencyEstimate:
    """The estimated errors of frequencies, with what the estimate keeps for as long as the body stays."""

    def __init__(self) -> None:
        self._estimate: ModeEstimate | None = None

    def __call__(self, state: ModalState) -> float:
        """The largest estimated relative error of the frequencies that the scene asks for: that of the mesh."""
        modes = state.modes
        if self._estimate is None or self._estimate.body is not state.body:
            self._estimate = state.body.error_estimate()
        return float(np.max(0.5 * self._estimate(modes.vectors[modes.chosen]) / modes.values[modes.chosen]))
