"""The field that gives the colours of frames in the page: chosen as for pictures of recordings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from restshape.application import Application, application_of
from restshape.live.shape_surface import MODE, Colours
from restshape.report.field import IN_CELLS, NAMES, chosen_field
from restshape.scene.physics import PictureField

if TYPE_CHECKING:
    from restshape.arrays import Reals
    from restshape.scene.model import Scene

Fields = Mapping[str, "Reals"]


@dataclass(frozen=True)
class FieldChoice:
    """The fields that may be shown, and the one that is at first.

    Args:
        looks: of each, by name.
        first: name of the one at first; empty: there is none.
    """

    looks: Mapping[str, PictureField]
    first: str


def field_choice(scene: Scene, at_nodes: Fields, in_cells: Fields) -> FieldChoice:
    """What of the fields of a scene's frames may be shown.

    Args:
        scene: of them; at_nodes, in_cells: as `Analysis.fields` gives them.
    """
    app: Application = application_of(scene)
    pictured = {name: look for one in app.physics for name, look in one.pictured.items()}
    names = list(dict.fromkeys(name.removesuffix(IN_CELLS) for name in (*in_cells, *at_nodes)))
    limited = {name for name, one in scene.quantities.items() if one.min is not None or one.max is not None}
    plain_cells = [name for name, values in in_cells.items() if values.ndim == 1]
    specs = {name: {one.kind: getattr(one, one.kind)} for name, one in scene.quantities.items()}
    found = chosen_field(names, pictured, specs, limited, plain_cells)
    known = {**{name: look for one in app.physics for name, look in one.vectors.items()}, **NAMES, **pictured}
    units = {one.name: one.unit for one in app.shown_columns(scene)}
    looks = {name: known.get(name) or PictureField(_label(name), units.get(name, "")) for name in names}
    ranks = {name: rank for rank, name in enumerate(pictured)}
    order = sorted(names, key=lambda name: (ranks.get(name, len(ranks)), name.startswith(MODE)))
    first = found or next((name for name in order if name in at_nodes), "")
    # Of two that show the same, such as a mode at nodes and its size in cells, people need one.
    labels = {looks[name].label: name for name in reversed(order)}
    return FieldChoice({name: looks[name] for name in order if labels[looks[name].label] == name}, first)


def colours_of(name: str, at_nodes: Fields, in_cells: Fields) -> Colours | None:
    """Where a field is among those of a frame; None where the frame has none of that name."""
    if name in in_cells or name + IN_CELLS in in_cells:
        return Colours(name, name if name in in_cells else name + IN_CELLS, True)
    return Colours(name, name, False) if name in at_nodes else None


def _label(name: str) -> str:
    return f"size of {name.replace('_', ' ')}, amplitude arbitrary" if name.startswith(MODE) else name.replace("_", " ")
