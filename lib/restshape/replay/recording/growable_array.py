"""Arrays of a recording that grow with each frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

import h5py
import numpy as np

from restshape.arrays import AnyArray

if TYPE_CHECKING:
    import numpy.typing as npt


class Growing:
    """A dataset that is appended to: rows wait in memory until `write`."""

    def __init__(self, group: h5py.Group, name: str, dtype: npt.DTypeLike, width: int = 0, chunk: int = 1024) -> None:
        shape = (0, width) if width else (0,)
        limit = (None, width) if width else (None,)
        chunks = (chunk, width) if width else (chunk,)
        self.dataset = group.create_dataset(name, shape, dtype=dtype, maxshape=limit, chunks=chunks)
        self.width = width
        self.length = 0
        self._pending: list[AnyArray] = []
        self._last: tuple[int, bytes] | None = None

    @property
    def pending_bytes(self) -> int:
        """Bytes that wait for `write`."""
        return sum(rows.nbytes for rows in self._pending)

    def add(self, rows: AnyArray) -> int:
        """The place of the rows, which are kept as they are until written."""
        start = self.length
        self._pending.append(rows)
        self.length += len(rows)
        return start

    def add_changed(self, rows: AnyArray) -> int:
        """The place of the rows: that of the last ones where these repeat them bit for bit."""
        data = rows.tobytes()
        if self._last is None or self._last[1] != data:
            self._last = (self.add(rows), data)
        return self._last[0]

    def write(self) -> None:
        """Writes what waits."""
        if self._pending:
            rows = self._pending[0] if len(self._pending) == 1 else np.concatenate(self._pending)
            self.dataset.resize(self.length, axis=0)
            self.dataset[self.length - len(rows) :] = rows
            self._pending.clear()
