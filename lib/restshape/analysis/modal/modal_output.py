"""What is shown of modes: quantities of interest, columns of a row, fields that are not known yet."""

from collections.abc import Mapping
from functools import partial
from typing import cast

import numpy as np

from restshape.analysis.analysis import RowValues
from restshape.analysis.modal.hanging import HangingColumns
from restshape.analysis.modal.modal_state import ModalState
from restshape.analysis.modal.pitch import note
from restshape.analysis.modal.tone_quantities import TONES, frequency_of_mode, named_mode, tone_value
from restshape.analysis.settings import ModalSettings, modal_settings
from restshape.errors import UserError
from restshape.fem.observer import Function, Observer, area_at
from restshape.fem.problem import Fields
from restshape.fem.space import Space
from restshape.outputs.si_numbers import counted_are
from restshape.scene.model import Quantity


def observer(quantities: Mapping[str, Quantity], space: Space, settings: ModalSettings) -> Observer:
    """What evaluates quantities of frequencies (modes,) [Hz], ascending, and the ids (modes,) of their modes.

    Args:
        quantities: of the scene, by name.
        space: the plane mesh.
        settings: of the plan.

    Raises:
        UserError: so many modes are not computed, or modes have no such quantity.
    """
    return Observer({name: _function(name, quantity, space, settings) for name, quantity in quantities.items()})


def row(state: ModalState, hanging: HangingColumns) -> RowValues:
    """Columns of a frame's row that only modes have; of hanging points as `hanging` has them."""
    frequencies, settings = state.frequencies, modal_settings(state.plan)
    heard = [note(float(f), settings.a4) for f in frequencies]
    tone, cents = heard[0]
    return {
        **{f"f_{k}": float(f) for k, f in enumerate(frequencies, 1)},
        "tone": tone,
        "cents": cents,
        **{f"tone_{k}": tone for k, (tone, _) in enumerate(heard, 1)},
        **{f"cents_{k}": cents for k, (_, cents) in enumerate(heard, 1)},
        "mode_ids": " ".join(map(str, state.ids)),
        "inertia_checked": int(state.report.inertia_checked),
        "missed_modes": state.report.missed_modes,
        "elements": len(state.body.space.cells),
        **(hanging(state, settings.hanging, settings.modes) if settings.hanging else {}),
    }


def blank_fields(space: Space, count: int) -> Fields:
    """Fields of `count` modes without any number, on a mesh that has not been solved on."""
    blank = {f"mode_{k + 1}": np.full((len(space.X), 3), np.nan) for k in range(count)}
    return blank, {"size_of_mode_1": np.full(len(space.cells), np.nan)}


def _function(name: str, quantity: Quantity, space: Space, settings: ModalSettings) -> Function:
    """The function of frequencies and ids that a quantity is; not a number of a mode that is not among those found."""
    if quantity.area:
        return area_at(space, name, quantity)
    frequency, mode = quantity.number("frequency"), quantity.number("mode")
    if quantity.kind in TONES:
        _refuse_beyond(settings.modes, f"quantities.{name}", quantity.number("ratio") or named_mode(quantity))
        return partial(tone_value, quantity, settings.a4)
    if frequency is not None:
        _refuse_beyond(settings.modes, f"quantities.{name}.frequency", frequency)
        rank = frequency - 1
        return lambda frequencies, ids: frequencies[rank] if rank < len(frequencies) else np.nan
    return partial(frequency_of_mode, cast(int, mode))


def _refuse_beyond(modes: int, where: str, wanted: int) -> None:
    """Refuses a quantity of a mode beyond those that are computed."""
    if wanted > modes:
        do = f"set effects.modal.modes to {wanted} or more"
        raise UserError(f"only {counted_are(modes, 'mode')} computed", where, do)
