"""Valid ranges of what is under the hand, as recordings have them."""

import json
from typing import NamedTuple

from restshape_apps.furniture.scene.furniture import RANGES_BYTES

LETTERS = 80
"""Of the name of what is under the hand at most."""


class ValidRange(NamedTuple):
    """Where a piece is valid [m or rad]; `below`, `above`: it may go on past that end, where sampling ended."""

    low: float
    high: float
    below: bool
    above: bool


class Grabbed(NamedTuple):
    """What is under the hand, its unit ("m" or "rad"), and its valid ranges; None where none were looked for.

    `doubtful`: the parts of these ranges where the piece holds in doubt only.
    """

    subject: str
    unit: str
    ranges: tuple[ValidRange, ...] | None
    doubtful: tuple[tuple[float, float], ...] = ()


def encode_ranges(grabbed: Grabbed, size: int = RANGES_BYTES) -> str:
    """JSON text, numbers to six digits; where there are more ranges than fit, those farthest along are left out.

    Args:
        grabbed: what is to be recorded.
        size: of the text at most [bytes of UTF-8].
    """
    ranges = grabbed.ranges
    rounded = None if ranges is None else [[_rounded(r.low), _rounded(r.high), r.below, r.above] for r in ranges]
    doubtful = [[_rounded(end) for end in one] for one in grabbed.doubtful]
    whole = [grabbed.subject[:LETTERS], grabbed.unit, rounded]
    while len((text := _json([*whole, doubtful] if doubtful else whole)).encode()) > size and (rounded or doubtful):
        (rounded if len(rounded or ()) > len(doubtful) else doubtful).pop()
    return text


def decode_ranges(text: str) -> Grabbed | None:
    """What `encode_ranges` has written; None where nothing was under the hand."""
    if not text:
        return None
    subject, unit, ranges, *doubtful = json.loads(text)
    parts = tuple((low, high) for low, high in doubtful[0]) if doubtful else ()
    return Grabbed(subject, unit, None if ranges is None else tuple(ValidRange(*one) for one in ranges), parts)


def _rounded(value: float) -> float:
    return float(f"{value:.6g}")


def _json(value: list) -> str:
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))
