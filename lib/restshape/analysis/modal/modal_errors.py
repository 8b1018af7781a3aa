"""How far modes are from those of their matrices, and from those of a finer mesh."""

from collections.abc import Iterable

import numpy as np

from restshape.analysis.modal.modal_matrices import products
from restshape.analysis.modal.modal_state import ModalState, Modes
from restshape.analysis.modal.tone_quantities import TONES, tone_error
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
        self._known: tuple[Modes | None, np.ndarray] = (None, np.empty(0))

    def __call__(self, state: ModalState) -> np.ndarray:
        """The estimated relative errors (modes,) of the frequencies that the scene asks for: those of the mesh."""
        if self._known[0] is state.modes:
            return self._known[1]
        modes = state.modes
        if self._estimate is None or self._estimate.body is not state.body:
            self._estimate = state.body.error_estimate()
        found = 0.5 * self._estimate(modes.vectors[modes.chosen]) / modes.values[modes.chosen]
        self._known = (modes, found)
        return found

    def of_quantities(self, state: ModalState, names: Iterable[str]) -> dict[str, float]:
        """The estimated errors of quantities, in their units; not numbers of a prediction, and of areas."""
        if state.predicted:
            return dict.fromkeys(names, np.nan)
        relative, quantities = self(state), state.scene.quantities
        errors, found = relative * state.frequencies, {}
        for name in names:
            if quantities[name].kind in TONES:
                found[name] = tone_error(quantities[name], relative, state.frequencies, state.ids)
                continue
            rank, mode = quantities[name].number("frequency"), quantities[name].number("mode")
            known = errors[rank - 1 : rank] if rank is not None else errors[state.ids == mode]
            found[name] = float(next(iter(known), np.nan))
        return found
