"""What is shown of modes: quantities of interest, columns of a row, fields that are not known yet."""

from collections.abc import Mapping

import numpy as np

from restshape.analysis.analysis import RowValues
from restshape.analysis.modal_state import ModalState
from restshape.analysis.pitch import note
from restshape.analysis.settings import modal_settings
from restshape.errors import UserError
from restshape.fem.observer import Function, Observer, area_at
from restshape.fem.problem import Fields
from restshape.fem.space import Space
from restshape.outputs.si_numbers import counted_are
from restshape.scene.model import Quantity


def observer(quantities: Mapping[str, Quantity], space: Space, modes: int) -> Observer:
    """What evaluates quantities of frequencies (modes,) [Hz], ascending, and the ids (modes,) of their modes.

    Args:
        quantities: of the scene, by name.
        space: the plane mesh.
        modes: how many the plan asks for.

    Raises:
        UserError: so many modes are not computed, or modes have no such quantity.
    """
    return Observer({name: _function(name, quantity, space, modes) for name, quantity in quantities.items()})


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


def _function(name: str, quantity: Quantity, space: Space, modes: int) -> Function:
    """The function of frequencies and ids that a quantity is; not a number of a mode that is not among those found."""
    if quantity.area:
        return area_at(space, name, quantity)
    frequency, mode = quantity.number("frequency"), quantity.number("mode")
    if frequency is not None:
        if frequency > modes:
            raise UserError(
                f"only {counted_are(modes, 'mode')} computed",
                f"quantities.{name}.frequency",
                f"set effects.modal.modes to {frequency} or more",
            )
        rank = frequency - 1
        return lambda frequencies, ids: frequencies[rank] if rank < len(frequencies) else np.nan
    if mode is not None:
        return lambda frequencies, ids: next(iter(frequencies[ids == mode]), np.nan)
    raise UserError(
        f"modes have no {quantity.kind}: their size means nothing",
        f"quantities.{name}.{quantity.kind}",
        "ask for frequency = 1, mode = 1 or area = true",
    )
