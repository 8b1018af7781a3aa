"""What is shown of modes: quantities of interest, columns of a row, fields that are not known yet."""

import numpy as np

from restshape.analysis.analysis import RowValues
from restshape.analysis.modal_state import ModalState
from restshape.analysis.pitch import note
from restshape.analysis.settings import modal_settings
from restshape.errors import UserError
from restshape.fem.problem import Fields
from restshape.fem.quantity import area
from restshape.fem.space import Space
from restshape.scene.model import Quantity


def quantities(state: ModalState) -> dict[str, float]:
    """The scene's quantities of interest, by name.

    Raises:
        UserError: a quantity that modes do not have, or of a mode that is not computed.
    """
    found = state.space, state.frequencies, state.ids
    return {name: modal_quantity(name, quantity, *found) for name, quantity in state.scene.quantities.items()}


def row(state: ModalState) -> RowValues:
    """Columns of a frame's row that only modes have."""
    frequencies, settings = state.frequencies, modal_settings(state.plan)
    tone, cents = note(float(frequencies[0]), settings.a4)
    return {
        **{f"f_{k + 1}": float(f) for k, f in enumerate(frequencies)},
        "tone": tone,
        "cents": cents,
        "mode_ids": " ".join(map(str, state.ids)),
        "inertia_checked": int(state.report.inertia_checked),
        "missed_modes": state.report.missed_modes,
        "elements": len(state.body.space.cells),
    }


def blank_fields(space: Space, count: int) -> Fields:
    """Fields of `count` modes without any number, on a mesh that has not been solved on."""
    blank = {f"mode_{k + 1}": np.full((len(space.X), 3), np.nan) for k in range(count)}
    return blank, {"size_of_mode_1": np.full(len(space.cells), np.nan)}


def modal_quantity(name: str, quantity: Quantity, space: Space, frequencies: np.ndarray, ids: np.ndarray) -> float:
    """The value of a quantity of interest; not a number of a mode that is not among those computed.

    Args:
        name: of the quantity in the scene.
        quantity: what is asked for.
        space: the plane mesh.
        frequencies: (modes,) [Hz], ascending.
        ids: (modes,) by which they are tracked.

    Raises:
        UserError: so many modes are not computed, or modes have no such quantity.
    """
    if quantity.area:
        return area(space, space.cells_of(quantity.at) if quantity.at else slice(None))
    if quantity.frequency is not None:
        if quantity.frequency > len(frequencies):
            raise UserError(
                f"only {len(frequencies)} modes are computed",
                f"quantities.{name}.frequency",
                f"set effects.modal.modes to {quantity.frequency} or more",
            )
        return float(frequencies[quantity.frequency - 1])
    if quantity.mode is not None:
        at = np.flatnonzero(ids == quantity.mode)
        return float(frequencies[at[0]]) if len(at) else float("nan")
    raise UserError(
        f"modes have no {quantity.kind}: their size means nothing",
        f"quantities.{name}.{quantity.kind}",
        "ask for frequency = 1, mode = 1 or area = true",
    )
