"""What is shown of buckling: quantities, columns of a row, modes, and how far they are from solving their equation."""

from collections.abc import Mapping

import numpy as np

from restshape.algebra.eigenproblems.buckling_solver import BucklingSolver
from restshape.analysis.analysis import RowValues
from restshape.analysis.buckling.buckling_matrices import products
from restshape.analysis.buckling.buckling_state import BucklingState
from restshape.fem.observer import Function, Observer
from restshape.scene.model import Quantity


def observer(quantities: Mapping[str, Quantity]) -> Observer:
    """What evaluates the quantities that are load factors, of a state; infinite where there is no such factor."""
    ranks = {name: quantity.number("load_factor") for name, quantity in quantities.items()}
    return Observer({name: _factor(rank) for name, rank in ranks.items() if rank is not None})


def _factor(number: int) -> Function:
    return lambda state: state.load_factor(number)


def row(state: BucklingState, modes_shown: int, solver: BucklingSolver) -> RowValues:
    """Columns of a frame's row that only buckling has.

    Args:
        state: of the frame.
        modes_shown: load factors that have a column.
        solver: with its tolerance, and what residuals it has come to.
    """
    row: RowValues = {f"mu_{k}": state.load_factor(k) for k in range(1, modes_shown + 1)}
    count = len(state.modes.load_factors)
    row["mode_ids"] = " ".join(map(str, state.modes.ids.ids[:count]))
    row["inertia_checked"], row["missed_modes"] = int(state.report.inertia_checked), state.report.missed_modes
    if not count and not state.predicted:
        reach = f"up to {state.most:.3g}, where the mean strain is 1" if np.isfinite(state.most) else "without a load"
        row["note"] = f"nothing buckles: no load factor {reach}"
    elif not state.predicted and solver.left > solver.tolerance:
        row["note"] = f"rounding keeps residuals of modes above a tolerance of {solver.tolerance:g}"
    return row


def fields(state: BucklingState, modes_shown: int) -> dict[str, np.ndarray]:
    """Fields (n, 2) of the nodes: the modes, the largest displacement of each 1; NaN where there are not so many."""
    found, modes = {}, state.modes.vectors
    for k in range(1, modes_shown + 1):
        shape = np.full_like(state.prebuckling.x, np.nan)
        if k <= len(modes):
            shape = modes[k - 1].reshape(shape.shape)
            shape = shape / np.linalg.norm(shape, axis=1).max()
        found[f"buckling_mode_{k}"] = shape
    return found


def residual_norm(state: BucklingState) -> float:
    """The largest |K phi + mu G phi| / |K phi| of the modes, element by element; 0 where there are none."""
    worst, modes = 0.0, state.modes
    stiff, loaded = products(state.prebuckling.problem, modes.vectors, state.prebuckling.x, state.sign)
    for factor, force, load in zip(modes.load_factors, stiff, loaded):
        worst = max(worst, float(np.linalg.norm(force - factor * load) / np.linalg.norm(force)))
    return worst
