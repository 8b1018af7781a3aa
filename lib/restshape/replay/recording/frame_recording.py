"""One frame of a replay as a recording in memory, for what draws and lists recordings."""

from __future__ import annotations

import json
from collections.abc import Mapping
from hashlib import sha256

import numpy as np

from restshape.analysis.row_values import RowValues
from restshape.arrays import Indices, Reals
from restshape.replay.columns import columns_of
from restshape.replay.recording.cell_types import CELL_TYPES
from restshape.replay.recording.recording import FieldInfo, Recording, cleaned, columns_in
from restshape.replay.recording.rows import RowPacker, row_dtype
from restshape.replay.request import Request
from restshape.shape.script_frame import ScriptFrame


# More than 15 attributes: those of a recording, and the arrays of the frame.
class FrameRecording(Recording):
    """A recording of one frame, which is in no file.

    Args:
        request: what is replayed; extra: what its header holds besides.
        edit: the frame of the session; row: its values.
        points: (n, dim) rest positions [m]; cells: (ne, k).
        at_nodes, in_cells: fields by name, in their order.
    """

    def __init__(
        self,
        request: Request,
        extra: Mapping[str, object],
        edit: ScriptFrame,
        row: RowValues,
        points: Reals,
        cells: Indices,
        at_nodes: Mapping[str, Reals],
        in_cells: Mapping[str, Reals],
    ) -> None:
        self.path, self.edit = request.scene.path.with_suffix(".vtkhdf"), edit
        self.n, self.status, self.old_names, self.writer = 1, "done", {}, {}
        header = cleaned(json.loads(json.dumps(request.header() | dict(extra), allow_nan=False)))
        assert isinstance(header, dict), "the header is a table"
        self.header, self.dimension = header, points.shape[1]
        columns = columns_of(request.scene, request.application, request.predict)
        dtype = row_dtype(columns)
        packed = bytearray(dtype.itemsize)
        # A parity check adds values to a row, which no recording has.
        known = {name: value for name, value in row.items() if name in columns}
        RowPacker(dtype).pack_into(memoryview(packed), 0, known)
        self._rows = np.frombuffer(bytes(packed), dtype=dtype)
        self.table = columns_in(self._rows)
        self._points, self._cells = points, cells
        self._arrays = dict(at_nodes) | dict(in_cells)
        self.fields = {
            name: FieldInfo(where, array.shape[1] if array.ndim == 2 else 0, 0)
            for where, fields in (("point_data", at_nodes), ("cell_data", in_cells))
            for name, array in fields.items()
        }

    @property
    def fingerprint(self) -> str:
        """The hash of its header and its row."""
        header = json.dumps(self.header, sort_keys=True).encode()
        return f"sha256:{sha256(header + self._rows.tobytes()).hexdigest()}"

    @property
    def times(self) -> Reals:
        """Its edit time (1,) [s]."""
        return np.array([self.edit.t])

    def number(self, i: int) -> int:
        """The number of the frame in its replay."""
        return self.edit.index

    def topology(self, i: int) -> int:
        """0: there is one topology."""
        return 0 * self._frame(i)

    def cells(self, i: int) -> Indices:
        """The (ne, k) cells."""
        return self._cells

    def cell_type(self, i: int) -> int:
        """VTK's number for the cells."""
        return CELL_TYPES[self._cells.shape[1]]

    def points(self, i: int) -> Reals:
        """The (n, dimension) rest positions [m]."""
        return self._points

    def field(self, i: int, name: str) -> Reals:
        """A field, as of `Recording`."""
        return self._arrays[name]

    def verify(self) -> list[int]:
        """None is damaged."""
        return []

    def close(self) -> None:
        """There is no file to close."""
