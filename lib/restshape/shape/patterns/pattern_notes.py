"""What drawings of patterns keep besides their curves, as texts in JSON that other programs leave alone.

A DXF has it as extended data of its entities, an SVG as metadata.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from restshape.scene.plain_values import Table
from restshape.shape.patterns.pattern import PatternPiece, Triple
from restshape.shape.patterns.seam_parts import SIDES, SeamPart

APPLICATION = "RESTSHAPE"
"""Of the extended data of a DXF."""
METADATA = "restshape-pattern"
"""The id of the metadata of an SVG."""
ORIGIN = "origin"
"""Key of the place of a piece's own origin in an SVG [m], for its axes are not those of the drawing."""
PLACES = ("vertices", "points", "through", "polygon", "center")
"""Keys of shapes that hold places."""
TEXT = 1000
"""Code of a text in extended data, which has at most 255 characters."""
LONGEST = 250


def keep(entity: Any, table: Mapping[str, object]) -> None:
    """Has an entity of a DXF keep a table."""
    text = json.dumps(table)
    entity.set_xdata(APPLICATION, [(TEXT, text[k : k + LONGEST]) for k in range(0, len(text), LONGEST)])


def kept(entity: Any) -> Table:
    """The table that an entity of a DXF keeps; empty where it keeps none, or another program has changed it."""
    if not entity.has_xdata(APPLICATION):
        return {}
    return table_of("".join(str(tag.value) for tag in entity.get_xdata(APPLICATION) if tag.code == TEXT))


def table_of(text: str) -> Table:
    """The table that a text in JSON is; empty where it is none."""
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}


def parts_in(table: Mapping[str, object]) -> list[SeamPart]:
    """What an edge is in seams, as ``seams`` of its table says it: a list of name, side and place."""
    listed = table.get("seams")
    found = []
    for one in listed if isinstance(listed, list) else []:
        whole = isinstance(one, list) and len(one) == 3
        if whole and isinstance(one[0], str) and one[1] in SIDES and type(one[2]) is int:
            found.append(SeamPart(one[0], one[1], one[2]))
    return found


def place_of(piece: PatternPiece) -> Table:
    """Where a piece lies in space, as a table."""
    return {"move": list(piece.move), "turn": list(piece.turn)} if any((*piece.move, *piece.turn)) else {}


def placed_by(piece: PatternPiece, table: Mapping[str, object]) -> PatternPiece:
    """A piece where a table says that it lies in space, by ``move`` and ``turn``, with the ``grain`` of the table."""
    grain = table.get("grain")
    angle = float(grain) if type(grain) in (int, float) and isinstance(grain, float | int) else piece.grain
    move, turn = _triple(table.get("move"), piece.move), _triple(table.get("turn"), piece.turn)
    return replace(piece, move=move, turn=turn, grain=angle if angle is None or math.isfinite(angle) else piece.grain)


def in_own_axes(piece: PatternPiece, table: Mapping[str, object]) -> PatternPiece:
    """A piece in its own axes, from those of a drawing where its table says that its origin is at ``origin``."""
    place = table.get(ORIGIN)
    if not isinstance(place, list) or len(place) != 2 or not _finite(place):
        return piece
    shape = _shifted(piece.shape, -float(place[0]), -float(place[1]), False)
    assert isinstance(shape, dict), "of a table"
    return replace(piece, shape=shape)


def _shifted(value: object, x: float, y: float, of_places: bool) -> object:
    """What a shape holds, with all places moved."""
    if isinstance(value, dict):
        return {key: _shifted(one, x, y, of_places or key in PLACES) for key, one in value.items()}
    if not of_places or not isinstance(value, list):
        return value
    if len(value) == 2 and not any(isinstance(one, list) for one in value):
        return [value[0] + x, value[1] + y]
    return [_shifted(one, x, y, True) for one in value]


def _finite(values: list[object]) -> bool:
    return all(type(x) in (int, float) and isinstance(x, int | float) and math.isfinite(x) for x in values)


def _triple(value: object, otherwise: Triple) -> Triple:
    """Three finite numbers of a list; `otherwise` where it is none."""
    if not isinstance(value, list) or len(value) != 3 or not all(type(x) in (int, float) for x in value):
        return otherwise
    x, y, z = map(float, value)
    return (x, y, z) if all(map(math.isfinite, (x, y, z))) else otherwise
