"""The table row of a frame: one packed record, the same bytes in the ring and in the file."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from restshape.analysis.analysis import RowValues


TEXT_BYTES = 480
_CODES = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "i8": "q", "u8": "Q", "f4": "f", "f8": "d"}


def row_dtype(columns: Mapping[str, npt.DTypeLike]) -> np.dtype[np.void]:
    """The packed little-endian record type of a row; ``str`` becomes UTF-8 text of at most 480 bytes.

    Args:
        columns: name -> numpy type (integers, floats, bool, ``"S<n>"``) or ``str``.
    """
    return np.dtype([(name, _column_dtype(name, kind)) for name, kind in columns.items()])


def _column_dtype(name: str, kind: npt.DTypeLike) -> np.dtype[np.generic]:
    if kind is str or kind == "str":
        return np.dtype(f"S{TEXT_BYTES}")
    dtype = np.dtype(kind).newbyteorder("<")
    if dtype.kind == "b":
        dtype = np.dtype("u1")
    if (dtype.kind == "S" and dtype.itemsize) or dtype.str[1:] in _CODES:
        return dtype
    raise ValueError(f"column {name!r}: a row cannot hold {kind!r}")


def encode_text(text: str, size: int) -> bytes:
    """The text in UTF-8, cut between characters and ended by an ellipsis where it is longer than ``size`` bytes."""
    data = text.encode()
    if len(data) <= size:
        return data
    return data[: max(size - 3, 0)].decode(errors="ignore").encode() + "\u2026".encode()[:size]


class RowPacker:
    """Packs a dict into the bytes of one row; absent numbers become NaN or -1, absent texts empty.

    Args:
        dtype: as `row_dtype` gives it.
    """

    def __init__(self, dtype: np.dtype[np.void]) -> None:
        self.size = dtype.itemsize
        self._names = set(dtype.names or ())
        self._defaults = [(name, self._default(dtype[name])) for name in dtype.names or ()]
        kinds = [dtype[name] for name in dtype.names or ()]
        self._texts = [(i, kind.itemsize) for i, kind in enumerate(kinds) if kind.kind == "S"]
        codes = [f"{kind.itemsize}s" if kind.kind == "S" else _CODES[kind.str[1:]] for kind in kinds]
        self._struct = struct.Struct("<" + "".join(codes))

    @staticmethod
    def _default(dtype: np.dtype[np.generic]) -> str | float:
        if dtype.kind == "S":
            return ""
        return float("nan") if dtype.kind == "f" else (-1 if dtype.kind == "i" else 0)

    def pack_into(self, buffer: memoryview, offset: int, row: RowValues) -> None:
        """Writes the row's bytes at ``offset``.

        Raises:
            ValueError: the row has a key that is no column, or a value that its column cannot hold.
        """
        if not row.keys() <= self._names:
            raise ValueError(f"no column is named {', '.join(sorted(row.keys() - self._names))}")
        get = row.get
        values: list[object] = [default if (value := get(name)) is None else value for name, default in self._defaults]
        for i, size in self._texts:
            text = values[i]
            if not isinstance(text, str):
                raise ValueError(f"a row value does not fit its column: {text!r} is no text")
            values[i] = encode_text(text, size) if len(text) * 4 > size else text.encode()
        try:
            self._struct.pack_into(buffer, offset, *values)
        except struct.error as error:
            raise ValueError(f"a row value does not fit its column: {error}") from error
