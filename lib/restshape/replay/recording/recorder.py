"""The solver's side of a recording: hands frames to a process of its own that writes them.

Import and start this before MPI starts: the recorder process must be no child of an MPI process. It imports no PETSc,
no MPI, no HDF5.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from restshape.arrays import Indices, Reals
from restshape.errors import UserError
from restshape.outputs.claims import refuse_foreign
from restshape.outputs.kinds import RecordingFile
from restshape.replay.recording import ring as rings
from restshape.replay.recording.cell_types import CELL_TYPES
from restshape.replay.recording.recorder_start import RING_BYTES, Begun, Copy, begun
from restshape.replay.recording.rows import RowPacker, row_dtype

if TYPE_CHECKING:
    import subprocess

    import numpy.typing as npt

    from restshape.analysis.analysis import RowValues

_CHECK_EVERY = 64


class FrameShape(NamedTuple):
    """Names of the fields of nodes and of cells, and the shapes of the positions and of all these fields."""

    points: tuple[str, ...]
    cells: tuple[str, ...]
    shapes: tuple[tuple[int, ...], ...]


# More than 15 attributes: the process, its pipes, the ring in shared memory, and the layout of the next frame.
class Recorder:
    """A recording that is being written; made by `Recorder.start`, closed by `close` or at the end of a ``with`` block.

    Attributes:
        frames: frames handed over.
        stalls: times that a frame waited because the ring was full.
        stalled_s: how long those waits took [s].
        process_id: of the process that writes.
        result: after `close`: frames, bytes, status, cpu_s, lag_s, batches, stalls.
    """

    def __init__(
        self, path: Path, ring: rings.Ring, process: Copy | subprocess.Popen[bytes], pipes: tuple[int, int, int]
    ) -> None:
        self.path = path
        self.frames = self.stalls = 0
        self.stalled_s = 0.0
        self.result: dict[str, object] = {}
        self.process_id = process.pid
        self._ring, self._process = ring, process
        self._commands, self._control, self._answers = pipes
        self._packer = RowPacker(np.dtype([]))
        self._inbox = b""
        self._state = "starting"
        self._shape: FrameShape | None = None
        self._components: dict[str, tuple[int, ...]] = {}
        self._cells = -1

    @classmethod
    def start(
        cls,
        path: str | Path,
        header: Mapping[str, object],
        columns: Mapping[str, npt.DTypeLike],
        wait: bool = True,
        process: Begun | None = None,
    ) -> Recorder:
        """A recorder whose process runs and, with ``wait``, has opened the file.

        Args:
            path: of the recording; one that is there is replaced when the first frames are safe.
            header: JSON-like; more can follow by `add_header`.
            columns: name -> numpy type or ``str`` of the table's columns.
            wait: False returns at once; `ready` waits, as does the first frame.
            process: that has begun to wait for this; None begins one.

        Raises:
            UserError: the file cannot be written.
        """
        path = Path(path)
        refuse_other_files(path)
        dtype = row_dtype(columns)
        opening = {
            "path": str(path.resolve()),
            "header": dict(header),
            "columns": [[name, dtype[name].str] for name in columns],
        }
        data = json.dumps(opening, allow_nan=False).encode()
        recorder = cls(path, *(process or begun(max(RING_BYTES, 4 * len(data)))))
        recorder._packer = RowPacker(dtype)
        recorder._send(rings.HEADER, data)
        recorder._wake()
        if wait:
            recorder.ready()
        return recorder

    @property
    def outlet(self) -> tuple[int, int]:
        """The file descriptor at whose end the process finishes the recording, and its process id."""
        return self._control, self.process_id

    @property
    def failed(self) -> bool:
        """Whether the file could not be written any further: it has said so, and takes no more."""
        return self._state == "failed"

    def ready(self) -> None:
        """Returns once the file is open.

        Raises:
            UserError: it cannot be written.
        """
        if self._state == "starting":
            self._answer("ready")
            self._state = "open"

    def add_header(self, extra: Mapping[str, object]) -> None:
        """Merges more keys into the header, such as versions that are known after MPI has started."""
        self.ready()
        self._send(rings.NOTE, json.dumps(dict(extra), allow_nan=False).encode())

    def topology(self, cells: Indices) -> None:
        """Cells that hold from the next frame on.

        Args:
            cells: (ne, nodes an element) node indices; the node count is one of `CELL_TYPES`.
        """
        self.ready()
        cells = np.ascontiguousarray(cells, dtype=np.int32)
        self._send(rings.TOPOLOGY, cells.data, cells.shape[1], CELL_TYPES[cells.shape[1]])
        if len(cells) != self._cells:
            self._cells = len(cells)
            self._shape = None

    def frame(
        self,
        t: float,
        X: Reals,
        point_data: Mapping[str, Reals],
        cell_data: Mapping[str, Reals],
        row: RowValues,
    ) -> None:
        """Hands over one frame: a copy into shared memory.

        Args:
            t: edit time [s].
            X: (n, dim) rest positions [m].
            point_data: name -> (n,) or (n, components).
            cell_data: name -> (ne,) or (ne, components).
            row: values of the table's columns; what is left out becomes NaN, -1 or "".

        Raises:
            UserError: the file can no longer be written; says how many frames are safe.
        """
        arrays = [X, *point_data.values(), *cell_data.values()]
        shape = FrameShape(tuple(point_data), tuple(cell_data), tuple(array.shape for array in arrays))
        if shape != self._shape:
            self._new_shape(shape)
        at = self._begin(rings.FRAME, self._frame_bytes, t, time.monotonic())
        memory = self._ring.memory
        self._packer.pack_into(memory, at, row)
        at += self._row_bytes
        for array in arrays:
            if array.dtype != np.float64 or not array.flags.c_contiguous:
                array = np.ascontiguousarray(array, dtype=np.float64)
            memory[at : at + array.nbytes] = array.data.cast("B")
            at += array.nbytes
        self._publish()
        self.frames += 1
        if self.frames == 1:
            # Written at once: from then on there is a recording to keep.
            self._wake()
        if self._ring.counters[rings.FAILED] or self.frames % _CHECK_EVERY == 0:
            self._check_alive()

    def _new_shape(self, shape: FrameShape) -> None:
        """Reports the process how the frames that follow are laid out.

        Raises:
            ValueError: arrays do not fit the mesh.
            UserError: a field has another number of values at a node or a cell than in frames before.
        """
        self.ready()
        points, cells, (positions, *fields) = shape
        if self._cells < 0:
            raise ValueError("a frame needs a topology first")
        for name, field in zip((*points, *cells), fields):
            expected = positions[0] if name in points else self._cells
            if field[0] != expected or len(field) > 2:
                raise ValueError(f"field {name!r} has shape {field}, expected {expected} rows of numbers or components")
            kept, new = self._components.setdefault(name, field[1:]), field[1:]
            if new != kept:
                place, (old, now) = "node" if name in points else "cell", (one[0] if one else 1 for one in (kept, new))
                raise UserError(
                    f"one number of values is recorded of {name} at a {place}, {old} so far, and here there are {now}",
                    str(self.path),
                    "leave out the edit that changes the elements, such as mesh.order, or replay without --out",
                )
        layout = {"point_data": points, "cell_data": cells, "shapes": [positions, *fields]}
        self._send(rings.LAYOUT, json.dumps(layout).encode())
        self._shape = shape
        self._row_bytes = (self._packer.size + 7) & ~7
        self._frame_bytes = self._row_bytes + 8 * sum(int(np.prod(s)) for s in (positions, *fields))

    def _begin(self, kind: int, length: int, a: float = 0.0, b: float = 0.0) -> int:
        at = self._ring.begin(kind, length, a, b) if 4 * length < self._ring.capacity else None
        if at is None:
            at = self._wait_for_room(kind, length, a, b)
        return at

    def _wait_for_room(self, kind: int, length: int, a: float, b: float) -> int:
        """The place for a record in a ring that is full, or too small and then enlarged once it is empty."""
        grow = 4 * length >= self._ring.capacity
        started = time.monotonic()
        self.stalls += not grow
        while True:
            if grow and self._ring.counters[rings.TAIL] == self._ring.position:
                self._ring.grow(8 * length)
                grow = False
            at = None if grow else self._ring.begin(kind, length, a, b)
            if at is not None:
                break
            self._wake()
            self._check_alive()
            time.sleep(0.0005)
        self.stalled_s += time.monotonic() - started
        return at

    def _send(self, kind: int, data: bytes | memoryview, a: float = 0.0, b: float = 0.0) -> None:
        view = memoryview(data).cast("B") if len(data) else memoryview(b"")
        at = self._begin(kind, len(view), a, b)
        self._ring.memory[at : at + len(view)] = view
        self._publish()

    def _publish(self) -> None:
        try:
            os.write(self._commands, self._ring.commit().to_bytes(8, "little"))
        except BrokenPipeError:
            self._check_alive()

    def _wake(self) -> None:
        try:
            os.write(self._control, b"w")
        except BrokenPipeError:
            self._check_alive()

    def _check_alive(self) -> None:
        if self._ring.counters[rings.FAILED] or self._process.poll() is not None:
            self._answer("closed")

    def _answer(self, expected: str) -> object:
        """What the process says under this name.

        Raises:
            UserError: it says that the file cannot be written, or it is gone.
        """
        while True:
            while b"\n" not in self._inbox:
                data = os.read(self._answers, 65536)
                if not data:
                    self._fail("the recorder process was ended from outside", "run the replay again")
                self._inbox += data
            line, _, self._inbox = self._inbox.partition(b"\n")
            message: dict[str, dict[str, str]] = json.loads(line)
            if expected in message:
                return message[expected]
            if "error" in message:
                error = message["error"]
                self._fail(error["reason"], error["do"], bool(error.get("gone")))

    def _fail(self, reason: str, do: str, gone: bool = False) -> None:
        safe = self._ring.counters[rings.SAFE]
        if self._state == "starting":
            what = f"the recording cannot be written: {reason}"
        elif gone:
            what = f"{reason}: what was in it is no longer there"
        else:
            what = f"{reason}; the first {safe} frame{'' if safe == 1 else 's'} of the recording are safe"
        self._end("failed")
        raise UserError(what, str(self.path), do)

    def _end(self, state: str) -> None:
        if self._state in ("closed", "failed"):
            return
        self._state = state
        for fd in (self._commands, self._control):
            os.close(fd)
        self._process.wait()
        os.close(self._answers)
        os.close(self._ring.fd)

    def close(self, status: str = "done") -> dict[str, object]:
        """What the recording holds and what writing it cost; the file is closed with this status.

        Raises:
            UserError: the last frames could not be written.
        """
        if self._state in ("closed", "failed"):
            return self.result
        self.ready()
        self._send(rings.CLOSE, status.encode())
        self._wake()
        closed = self._answer("closed")
        assert isinstance(closed, dict), "the process says what writing cost"
        self.result = {**closed, "stalls": self.stalls, "stalled_s": self.stalled_s}
        self._end("closed")
        return self.result

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if self._state not in ("closed", "failed"):
            self.close("done" if kind is None else "interrupted")


def refuse_other_files(path: Path) -> None:
    """Keeps a slip of the keyboard from overwriting a scene with a recording.

    Raises:
        UserError: there is no such folder, or what is there is no recording.
    """
    folder = path.resolve().parent
    if not folder.is_dir():
        raise UserError("the folder of the recording does not exist", str(path), f"mkdir -p {folder}")
    if path.is_dir():
        raise UserError("this is a folder", str(path), f"name a file in it, such as {path / 'run.vtkhdf'}")
    refuse_foreign(RecordingFile(path), str(path))
