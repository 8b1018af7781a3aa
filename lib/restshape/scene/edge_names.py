"""What may have been meant by an edge that is not there."""

from __future__ import annotations

from collections.abc import Sequence

from restshape.scene.dart_keys import IMAGE
from restshape.scene.source import suggestion

LISTED = 12
"""Names that a message lists, at most."""


def edge_suggestion(word: str, edges: Sequence[str]) -> str:
    """What to do about an edge that is not there: those that end so in a panel, the nearest one, or the first of them.

    Args:
        word: the name; edges: those that there are, of panels PANEL.EDGE.
    """
    own = [edge for edge in edges if edge.endswith(f".{word}") and f".{IMAGE}." not in edge]
    if own:
        return f"did you mean {' or '.join(map(repr, own[:LISTED]))}?"
    found = suggestion(word, edges)
    if found.startswith("did") or len(edges) <= LISTED:
        return found.replace("use one of:", "name one of the edges:")
    return f"name one of the edges: {', '.join(edges[:LISTED])} and {len(edges) - LISTED} more"
