"""Names of a scene from the layers, groups and labels of drawings."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping

from restshape.bounds import NAME_CHARACTERS
from restshape.errors import UserError, printable
from restshape.scene.values import PART, RESERVED

REGION = "region"
"""How names of regions begin, and the class of others in an SVG."""
LISTED = 12
"""Layers that a message lists."""


def name_of(text: str) -> str:
    """A text of a drawing as a name in a scene: other characters than letters, digits, - and _ become _.

    Empty for no text, and for keywords: `outline` and `all`.
    """
    if not text or text in RESERVED:
        return ""
    if len(text) <= NAME_CHARACTERS // 2 and PART.fullmatch(text):
        return text
    name = re.sub(r"[^A-Za-z0-9_-]+", "_", text)[: NAME_CHARACTERS // 2]
    return name if re.match(r"[A-Za-z_]", name) else f"layer_{name}"


def region_named(layer: str, name: str) -> bool:
    """Whether a loop is a region by its layer, as the file calls it or as the scene does: `region` at the beginning."""
    return any(text.lower().startswith(REGION) for text in (layer, name))


def refuse_layers(wanted: Mapping[str, str], there: Collection[str], where: str) -> None:
    """Refuses layers that a scene names and a drawing does not have.

    Args:
        wanted: `shape.layers` of a scene: names by layer.
        there: layers of the drawing.
        where: the file, for messages.

    Raises:
        UserError: the first of them.
    """
    missing = next((layer for layer in wanted if layer not in there), None)
    if missing is None:
        return
    some = ", ".join(repr(printable(layer)) for layer in list(there)[:LISTED])
    more = ", ..." if len(there) > LISTED else ""
    do = f"shape.layers: name some of {some}{more}" if there else "leave shape.layers out: this file has no layers"
    raise UserError(f"the drawing has no layer {missing!r}", where, do)
