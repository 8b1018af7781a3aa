"""Formulas of x and y that have no number on the outline, which `check` finds before anything is solved."""

from collections.abc import Iterator

import numpy as np

from restshape.application import application_of
from restshape.errors import ReplayProblem, UserError
from restshape.fem.nodal_values import Nodal
from restshape.mesh.entity_area import signed_loops
from restshape.mesh.regions import contains, loop_polygon
from restshape.scene.formula_checks import formulas
from restshape.scene.model import Scene
from restshape.scene.plan import plan
from restshape.shape.outline import Outline

ALONG = (np.arange(64) + 0.5) / 64
"""Where edges are looked at."""
WITH_ENDS = np.concatenate([[0.0], ALONG, [1.0]])
"""Where those are whose ends count: of loads on first-order elements."""
INTEGRATED = ("loads", "heat_flux")
"""Parts of keys of what is integrated along edges; other values at an end may be those of the edge beside it."""
ACROSS = 24
"""Rows, and columns, of places in the box around an area."""


def refuse_without_number(scene: Scene, outline: Outline) -> None:
    """Refuses formulas of places that are not finite on the part of the shape that they are for.

    Those that name the time are left out. Gaps between the places that are looked at may be missed. Second-order
    elements integrate loads by points within each side, so that these need no number at the ends of edges.

    Raises:
        UserError: the first such formula, with a place where it has no number.
    """
    placed = [(key, one) for key, one in formulas(scene) if one.names_places and "t" not in one.names]
    first_order = bool(placed) and plan(scene, application_of(scene)).order == 1
    for key, formula in placed:
        along = WITH_ENDS if first_order and any(part in INTEGRATED for part in key) else ALONG
        where = ".".join(key)
        for name in _part_of(scene, key):
            try:
                Nodal(formula, scene.parameters, where)(_places(outline, name, along))
            except ReplayProblem as problem:
                what = str(problem).removeprefix(f"{where}: ")
                do = f"change {formula.text!r}, so that it has a number all over {name!r}"
                raise UserError(what, where, do) from problem


def _part_of(scene: Scene, key: tuple[str, ...]) -> list[str]:
    """Names of what the table of a key is for; empty where nothing is known of that."""
    table = getattr(scene, key[0], None)
    if not isinstance(table, dict) or len(key) < 2:
        return []
    on = getattr(table.get(key[1]), "on", None)
    return [on] if isinstance(on, str) else [name for name in on or () if isinstance(name, str)]


def _places(outline: Outline, name: str, along: np.ndarray) -> np.ndarray:
    """Places (m, 2) [m] of an entity: vertices, those along edges (k,), 0 to 1, or those inside of an area."""
    entity = outline.entity(name)
    found = [outline.points[list(entity.vertices)], *_inside(outline, name)]
    if len(found) == 1:
        found += [outline.point(edge, along) for edge in entity.edges]
    return np.concatenate(found)


def _inside(outline: Outline, name: str) -> Iterator[np.ndarray]:
    """Places (m, 2) [m] inside of what an entity fills; nothing of one without an inside."""
    loops = [outline.loops[i] for i, _ in signed_loops(outline, name)]
    if not loops:
        return
    polygons = [loop_polygon(outline, loop) for loop in loops]
    low, high = np.min([p.min(axis=0) for p in polygons], axis=0), np.max([p.max(axis=0) for p in polygons], axis=0)
    steps = (np.arange(ACROSS) + 0.5) / ACROSS
    box = low + (high - low) * np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    yield box[np.count_nonzero([contains(polygon, box) for polygon in polygons], axis=0) % 2 == 1]
