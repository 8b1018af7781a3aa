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
TYPES = {"f": ("f4", FLOAT), "i": ("u4", np.dtype("<u4")), "u": ("u4", np.dtype("<u4"))}
"""Type of the arrays of a message by the kind of NumPy's."""
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
    wanted = TYPES[values.dtype.kind][1]
    if values.dtype is wanted and values.flags.c_contiguous:
        return values
    return np.ascontiguousarray(values, dtype=wanted)


def in_space(points: AnyArray) -> AnyArray:
    """Points (m, 2) or (m, 3) as (m, 3) f4, as they travel."""
    found = np.zeros((len(points), 3), dtype=FLOAT)
    found[:, : points.shape[1]] = points
    return found


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
        place = {"at": self._at, "type": TYPES[values.dtype.kind][0], "shape": list(found.shape)}
        room = -found.nbytes % ALIGNED
        self.pieces.append(found.reshape(-1).view(np.uint8).data)
        if room:
            self.pieces.append(PADDING[:room])
        self._at += found.nbytes + room
        return place
