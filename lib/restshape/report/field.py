"""The field that pictures show by colours: which one, and its values at the nodes of each cell."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from restshape.application import applications
from restshape.errors import UserError
from restshape.report.recorded_quantities import limits_of, quantity_specs
from restshape.scene.physics import OwnPictures, Physics, PictureField

if TYPE_CHECKING:
    from restshape.replay.recording.recording import Recording

IN_CELLS = "_in_cells"
"""End of the name of a field that each cell has at its own nodes, as it jumps between regions."""
NAMES = {"displacement": PictureField("size of the displacement", "m")}
"""Fields of every physics."""


@dataclass(frozen=True)
class ShownField:
    """A field of a recording, a number at each node of each cell.

    Args:
        name: in the recording, without `IN_CELLS`.
        look: label, unit and colours.
    """

    name: str
    look: PictureField

    def values(self, recording: Recording, i: int, cells: np.ndarray | None = None) -> np.ndarray:
        """Its values (ne, k) at the nodes of the cells (ne, k) of frame i; of a vector its size."""
        cells = recording.cells(i) if cells is None else cells
        name = self.name if self.name in recording.fields else self.name + IN_CELLS
        found, info = recording.field(i, name), recording.fields[name]
        if info.where == "point_data":
            return (np.linalg.norm(found, axis=1) if found.ndim == 2 else found)[cells]
        if found.ndim == 2:
            return found if found.shape == cells.shape else np.repeat(_size(found), cells.shape[1], axis=1)
        # A number a cell, as earlier recordings have it.
        return np.repeat(found[:, None], cells.shape[1], axis=1)

    def quantity_of(self, recording: Recording, name: str) -> bool:
        """Whether a quantity of the recorded scene is taken from this field."""
        spec, of = quantity_specs(recording.header).get(name, {}), self.look.quantity
        return of is not None and spec.get(of[0]) == of[1]


def _size(vectors: np.ndarray) -> np.ndarray:
    return np.linalg.norm(vectors, axis=1, keepdims=True)


def shown_field(recording: Recording, name: str | None = None) -> ShownField | None:
    """The field that pictures of a recording show; None where it has none.

    It is the one that is named, else that of the first quantity with a limit, or of the first quantity, that is taken
    from a field; else the first that the physics declare, or any.

    Raises:
        UserError: it has no field of that name.
    """
    recorded = [key.removesuffix(IN_CELLS) for key in recording.fields]
    looks = {key: look for one in physics_of(recording) for key, look in one.pictured.items()}
    if name is not None:
        if name not in recorded:
            what, known = f"the recording has no field {name!r}", ", ".join(dict.fromkeys(recorded)) or "none"
            raise UserError(what, "--field", f"use one of those that it has: {known}")
        return ShownField(name, looks.get(name) or NAMES.get(name) or PictureField(name, ""))
    cells = [key for key, info in recording.fields.items() if info.where == "cell_data" and not info.components]
    chosen = chosen_field(recorded, looks, quantity_specs(recording.header), set(limits_of(recording)), cells)
    return ShownField(chosen, looks.get(chosen) or PictureField(chosen, "")) if chosen else None


def chosen_field(
    names: Collection[str],
    looks: Mapping[str, PictureField],
    specs: Mapping[str, Mapping[str, object]],
    limited: Collection[str],
    cells: Sequence[str],
) -> str:
    """The name of the field that pictures show of some, as `shown_field` chooses it; empty where it is none.

    Args:
        names: of the fields; looks: those that the physics declare.
        specs: of the quantities by name; limited: those of them that have a limit.
        cells: fields that are a number a cell.
    """
    quantities = [*_from_fields(specs, looks)]
    quantities.sort(key=lambda found: found[0] not in limited)
    for candidate in [*(field for _, field in quantities), *looks]:
        if candidate in names:
            return candidate
    return cells[0] if cells else ""


def quantities_from(recording: Recording, looks: Mapping[str, PictureField]) -> Iterator[tuple[str, str]]:
    """Quantities of the recorded scene that are taken from one of these fields, each with the field's name."""
    yield from _from_fields(quantity_specs(recording.header), looks)


def _from_fields(
    specs: Mapping[str, Mapping[str, object]], looks: Mapping[str, PictureField]
) -> Iterator[tuple[str, str]]:
    """Quantities that are taken from one of these fields, each with the field's name."""
    for name, spec in specs.items():
        for field, look in looks.items():
            if look.quantity and spec.get(look.quantity[0]) == look.quantity[1]:
                yield name, field


def physics_of(recording: Recording) -> tuple[Physics, ...]:
    """The physics of the recorded application; none where it is not installed."""
    app = applications().get(recording.header.get("app", ""))
    return tuple(app.for_scene(recording.header.get("scene_values") or {}).physics) if app else ()


def own_pictures(recording: Recording) -> OwnPictures | None:
    """How a physics draws a recording that is not of a shape in the plane; None: no physics does."""
    offered = (one.pictures for one in physics_of(recording) if one.pictures)
    return next((pictures for pictures in offered if pictures.of(recording)), None)


def true_scale(recording: Recording) -> bool:
    """Whether the recorded deformation is shown as it is: large ones are not exaggerated."""
    scene = recording.header.get("scene_values")
    effects = scene.get("effects", {}) if isinstance(scene, dict) else {}
    return any(name in effects for one in physics_of(recording) for name in one.true_scale)
