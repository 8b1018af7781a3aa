"""Arrays of the picture of a frame as they travel, and the parts of the picture that they make."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from restshape.arrays import AnyArray
from restshape.live.link import Buffer

ALIGNED = 8
"""Arrays begin at multiples of so many bytes."""
PADDING = bytes(ALIGNED)
FLOAT = np.dtype("<f4")
SHORT, LONG = np.dtype("<u2"), np.dtype("<u4")
TYPES = {FLOAT: "f4", SHORT: "u2", LONG: "u4"}
"""What the header calls the types in which arrays travel."""
Kind = Literal["surface", "lines", "dots"]


@dataclass(frozen=True, eq=False)
class PicturePart:
    """A part of the picture of a frame, as `Part` of `page/src/protocol.ts`.

    Args:
        name: of the part.
        kind: how it is drawn; role: what it is.
        arrays: by name; one that has not changed is the same object as in the frame before.
        said: what else the header says of it.
    """

    name: str
    kind: Kind
    role: str
    arrays: Mapping[str, AnyArray]
    said: Mapping[str, object] = field(default_factory=dict)


def shortened(values: AnyArray) -> AnyArray:
    """An array in the type in which it travels, contiguous; indices are no longer signed."""
    if values.dtype in TYPES and values.flags.c_contiguous:
        return values
    return np.ascontiguousarray(values, dtype=FLOAT if values.dtype.kind == "f" else LONG)


def sent_points(points: AnyArray) -> AnyArray:
    """A copy of points (m, 2) or (m, 3) in f4, as they travel; the page adds z = 0 to those in the plane."""
    return points.astype(FLOAT, order="C")


def sent_indices(indices: AnyArray, count: int) -> AnyArray:
    """A copy of indices of so many things as they travel: in u2 where there are few enough."""
    return indices.astype(SHORT if count <= 1 << 16 else LONG, order="C")


class MessageBody:
    """The arrays of a message, one after the other.

    Attributes:
        pieces: the bytes.
    """

    def __init__(self) -> None:
        self.pieces: list[Buffer] = []
        self._at = 0

    def add(self, values: AnyArray) -> dict[str, object]:
        """Adds an array; where it is, as the header says it."""
        found = shortened(values)
        place = {"at": self._at, "type": TYPES[found.dtype], "shape": list(found.shape)}
        size = found.nbytes
        self.pieces.append(found.data)
        if room := -size % ALIGNED:
            self.pieces.append(PADDING[:room])
        self._at += size + room
        return place
