"""Whether the fields of an analysis are those that its physics declare, looked at once a replay."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from restshape.errors import UserError

if TYPE_CHECKING:
    from restshape.analysis.analysis import Analysis
    from restshape.fem.problem import Fields, Problem
    from restshape.fem.space import Space
    from restshape.scene.physics import Physics

MOST_CELLS = 20_000
"""Cells up to which fields are looked at: names and shapes hang on no mesh, and recovered stresses of a large one take
as long as a frame, and memory for what recovers them."""


def check_field_names(analysis: Analysis[Problem], space: Space, physics: Sequence[Physics]) -> None:
    """Makes sure that a solution has the fields that frames without one have, and those that pictures show.

    Nothing is looked at on more than `MOST_CELLS` cells.

    Args:
        analysis: with a solution; space: that it lives on.
        physics: of the application.

    Raises:
        UserError: a field is missing, or one has a name or a shape that is not declared.
    """
    if len(space.cells) > MOST_CELLS:
        return
    given, declared = _shapes(analysis.fields()), _shapes(analysis.blank_fields(space))
    # Some fields are in recordings where a scene asks for them alone.
    asked = any(one.requested for one in physics)
    if {name: given.get(name) for name in (declared if asked else given | declared)} != declared:
        names = ", ".join(one.name for one in physics)
        what = f"the problem of {names} gives the fields {_listed(given)}, and declares {_listed(declared)}"
        raise UserError(what, do="let its unknowns and `cell_scalars`, or its `blank_fields`, name what `fields` gives")
    if asked:
        return
    for one in physics:
        for field in one.pictured:
            if field not in given:
                what = f"{one.name!r} declares pictures of the field {field!r}, and its problem has {', '.join(given)}"
                raise UserError(what, do="let `Physics.pictured` name fields of the problem")


def _shapes(fields: Fields) -> dict[str, tuple[int, ...]]:
    """The shape of each field of nodes and of cells, by name."""
    return {name: values.shape for both in fields for name, values in both.items()}


def _listed(shapes: dict[str, tuple[int, ...]]) -> str:
    """Fields with their shapes, for people."""
    return ", ".join(f"{name} {shape}" for name, shape in shapes.items()) or "none"
