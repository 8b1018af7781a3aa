"""Arrays of the picture of a frame as they travel, and the parts of the picture that they make."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from restshape import _kernels
from restshape.arrays import AnyArray

ALIGNED = 8
"""Arrays begin at multiples of so many bytes."""
FLOAT = np.dtype("<f4")
SHORT, LONG = np.dtype("<u2"), np.dtype("<u4")
TYPES = {one.char: ("f4", 4) for one in map(np.dtype, "efdg")} | {SHORT.char: ("u2", 2)}
"""What the header calls the types in which arrays travel, and how long their numbers are, by NumPy's letters."""
INTEGERS = "u4", 4
"""The same of all others, which are converted."""
Kind = Literal["surface", "lines", "dots"]


@dataclass(eq=False, slots=True)
class PicturePart:
    """A part of the picture of a frame, as `Part` of `page/src/protocol.ts`; nobody changes one.

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


def sent_points(points: AnyArray) -> AnyArray:
    """A copy of points (m, 2) or (m, 3) in f4, as they travel; the page adds z = 0 to those in the plane."""
    return points.astype(FLOAT, order="C")


def sent_indices(indices: AnyArray, count: int) -> AnyArray:
    """A copy of indices of so many things as they travel: in u2 where there are few enough."""
    return indices.astype(SHORT if count <= 1 << 16 else LONG, order="C")


def same_bytes(one: AnyArray, other: AnyArray) -> bool:
    """Whether two arrays would travel as the same bytes, as numbers that are none do, too."""
    return one.shape == other.shape and one.dtype == other.dtype and one.tobytes() == other.tobytes()


class MessageBody:
    """The arrays of a message, one after the other.

    Attributes:
        size: of all [bytes].
    """

    def __init__(self) -> None:
        self.size = 0
        self._arrays: list[AnyArray] = []

    def add(self, values: AnyArray) -> dict[str, object]:
        """Adds an array; where it is, as the header says it. It must not be written to before `packed`."""
        kind, length = TYPES.get(values.dtype.char, INTEGERS)
        place = {"at": self.size, "type": kind, "shape": values.shape}
        self._arrays.append(values)
        self.size += -(-values.size * length // ALIGNED) * ALIGNED
        return place

    def packed(self) -> bytes:
        """The bytes, which are written in one pass."""
        return _kernels.packed(self._arrays, self.size)
