"""Numbers of each frame as field data of VTKHDF, which ParaView plots over time: quantities and flags."""

import h5py
import numpy as np

from restshape.arrays import Records
from restshape.replay.columns import jump_column, quantity_names
from restshape.replay.recording.growable_array import Growing

STATUS = "constraint_status"
STATUSES = (b"holds", b"uncertain", b"fails")
"""What the constraint status may be, by its number in the field data; -1 where a frame has none."""
LEFT_OUT = frozenset(
    (
        *("index", "line", "t", "pc_age", "pc_rebuilt", "iterations", "newton", "unknowns", "elements"),
        *("flips", "min_quality", "mesh_area", "residual", "prediction_error", "estimate_time", "checksum"),
    )
)
"""Columns about the work of a frame, which the table of the recording has alone."""
CHUNK = 128


def plotted(row: np.dtype[np.void]) -> list[str]:
    """The columns of a row that are field data: numbers of what is simulated, and flags."""
    names = [name for name in row.names or () if row[name].kind in "iuf" and name not in LEFT_OUT]
    jumps = set(map(jump_column, quantity_names(names)))
    found = [name for name in names if not name.startswith("ms") and name not in jumps]
    return [*found, STATUS] if STATUS in (row.names or ()) else found


class FrameData:
    """Writes a number a frame of each of these columns.

    Args:
        root, steps: the groups of the file.
        row: type of the rows of the table.

    Source: VTKHDF file format, "Temporal data": `Steps/FieldDataOffsets`.
    """

    def __init__(self, root: h5py.Group, steps: h5py.Group, row: np.dtype[np.void]) -> None:
        data, offsets = root.create_group("FieldData"), steps.create_group("FieldDataOffsets")
        self._values = {
            name: Growing(data, name, "f8" if row[name].kind == "f" else "i8", chunk=CHUNK) for name in plotted(row)
        }
        # Each frame has one value of each: the frame's number is the place of all of them, stored once.
        self._frames: Growing | None = None
        for name in self._values:
            if self._frames is None:
                self._frames = Growing(offsets, name, "i8", chunk=CHUNK)
            else:
                offsets[name] = self._frames.dataset

    @property
    def datasets(self) -> list[Growing]:
        """All arrays that grow."""
        return [*self._values.values(), *filter(None, [self._frames])]

    def add(self, row: Records, frame: int) -> None:
        """Take the values of a frame from its row (1,)."""
        for name, values in self._values.items():
            values.add(np.array([_status(row[name][0])]) if name == STATUS else row[name].astype(values.dataset.dtype))
        if self._frames is not None:
            self._frames.add(np.array([frame], dtype="i8"))


def _status(text: bytes) -> int:
    return STATUSES.index(text) if text in STATUSES else -1
