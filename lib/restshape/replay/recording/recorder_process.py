"""The process that writes a recording: takes frames out of the shared ring, outlives the solver, closes the file.

Started by `restshape.replay.recording.recorder.Recorder` with the numbers of four inherited file descriptors: RING
COMMANDS CONTROL ANSWERS CORES. It knows neither MPI nor PETSc. COMMANDS carries the ring's published position, CONTROL
wakes it, ANSWERS takes its JSON lines; the end of CONTROL means that the solver is gone.
"""

import errno
import json
import os
import select
import signal
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import TypedDict

import numpy as np

from restshape.outputs.locks import Locked
from restshape.replay.recording import ring as rings
from restshape.replay.recording.rows import row_dtype
from restshape.replay.recording.vtkhdf import NoRoom, RecordedFrame, Removed, Topology, VtkHdfWriter

PERIOD = 0.2
BATCH_BYTES = 8 << 20
LIMITS = {b"t": "frame limit", b"m": "memory limit"}
"""What a solver writes that ends at a limit, and the status of its recording."""
_NO_ROOM = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}


class Opening(TypedDict):
    """What the solver says first: path and header of the recording, names and types of its columns."""

    path: str
    header: dict[str, object]
    columns: list[tuple[str, str]]


class FrameLayout(TypedDict):
    """How the frames that follow are laid out: names of fields, shapes of positions and of these fields."""

    point_data: list[str]
    cell_data: list[str]
    shapes: list[list[int]]


class Writing:
    """The recorder process's state: reads records, writes batches, answers."""

    def __init__(self, ring: rings.Ring, answers: int) -> None:
        self.ring, self.answers = ring, answers
        self.writer: VtkHdfWriter | None = None
        self.status: str | None = None
        self.lag = 0.0
        self.batches = 0
        self._layout: FrameLayout | None = None
        self._row_bytes = 0
        self._oldest: float | None = None

    def take(self, end: int) -> None:
        """Writes all records up to ``end``, in batches."""
        size = 0
        for record in self.ring.records(end):
            self._take_one(record)
            size += len(record.payload)
            if size > BATCH_BYTES:
                self.commit()
                size = 0
        self.commit()

    def commit(self) -> None:
        """Makes safe what was taken, and frees its place in the ring."""
        if self._oldest is not None and self.writer is not None:
            self.writer.commit()
            self.batches += 1
            self.lag = max(self.lag, time.monotonic() - self._oldest)
            self._oldest = None
            self.ring.counters[rings.SAFE] = self.writer.frames
        self.ring.release()

    def _take_one(self, record: rings.Record) -> None:
        if record.kind == rings.HEADER:
            self._open(json.loads(bytes(record.payload)))
            return
        assert self.writer is not None
        if record.kind == rings.FRAME:
            self._oldest = record.b if self._oldest is None else self._oldest
            self.writer.append(self._frame(record))
        elif record.kind == rings.TOPOLOGY:
            width, cell_type = int(record.a), int(record.b)
            cells = np.frombuffer(record.payload, dtype="i4").reshape(-1, width).copy()
            self.writer.append(Topology(cells, cell_type))
        elif record.kind == rings.LAYOUT:
            self._layout = json.loads(bytes(record.payload))
        elif record.kind == rings.NOTE:
            self.writer.add_header(json.loads(bytes(record.payload)))
        elif record.kind == rings.CLOSE:
            self.status = bytes(record.payload).decode()

    def _open(self, start: Opening) -> None:
        dtype = row_dtype(dict(start["columns"]))
        self._row_bytes = dtype.itemsize
        self.writer = VtkHdfWriter(Path(start["path"]), start["header"], dtype)
        self.answer(ready=os.getpid())

    def _frame(self, record: rings.Record) -> RecordedFrame:
        at, layout, arrays = (self._row_bytes + 7) & ~7, self._layout, []
        assert layout is not None, "the layout of frames comes before them"
        for shape in layout["shapes"]:
            count = int(np.prod(shape))
            arrays.append(np.frombuffer(record.payload, "f8", count, at).reshape(shape))
            at += 8 * count
        points, cells = layout["point_data"], layout["cell_data"]
        fields = arrays[1:]
        row = bytes(record.payload[: self._row_bytes])
        return RecordedFrame(
            record.a, arrays[0], dict(zip(points, fields)), dict(zip(cells, fields[len(points) :])), row
        )

    def finish(self, status: str) -> None:
        """Closes the file and says what writing it cost."""
        if self.writer is None:
            return
        usage = os.times()
        cost = {"cpu_s": usage.user + usage.system, "lag_s": self.lag, "batches": self.batches}
        frames = self.writer.frames
        size = self.writer.close(status, cost)
        self.answer(closed={"frames": frames, "bytes": size, "status": status, **cost})

    def answer(self, **message: object) -> None:
        """Sends one line to the solver, if it still listens."""
        try:
            os.write(self.answers, json.dumps(message).encode() + b"\n")
        except BrokenPipeError:
            return

    def fail(self, error: OSError) -> None:
        """Reports the solver why the file cannot be written, and how many frames are safe."""
        number = error.errno or (errno.ENOSPC if "errno = 28" in str(error) else 0)
        safe = self.ring.counters[rings.SAFE]
        full = number in _NO_ROOM
        reason = "the disk is full" if full else (os.strerror(number) if number else str(error).splitlines()[0])
        do = "free space on that disk, or choose another file by --out"
        if isinstance(error, Locked):
            reason, do = str(error.strerror), "wait until it ends, or choose another file by --out"
        elif isinstance(error, Removed | FileExistsError):
            reason, do = str(error.strerror), "leave the files of a recording alone, or choose another file by --out"
        gone = isinstance(error, Removed)
        self.answer(error={"reason": reason, "errno": number, "safe": safe, "gone": gone, "do": do})
        self.ring.counters[rings.FAILED] = 1


def drain(commands: int, position: int) -> int:
    """The last position published."""
    while True:
        try:
            data = os.read(commands, 65536)
        except BlockingIOError:
            return position
        if not data:
            return position
        position = int.from_bytes(data[-8:], "little")


def serve(ring: rings.Ring, commands: int, control: int, answers: int) -> int:
    """The exit code after the solver has closed the recording or has gone."""
    writing = Writing(ring, answers)
    poll = select.poll()
    poll.register(control, select.POLLIN)
    position, gone, due, ending = 0, False, 0.0, "interrupted"
    try:
        while writing.status is None and not gone:
            if poll.poll(max(0.0, 1000 * (due - time.monotonic()))):
                heard = os.read(control, 4096)
                gone = not heard
                ending = next((why for sign, why in LIMITS.items() if sign in heard), ending)
            due = time.monotonic() + PERIOD
            position = drain(commands, position)
            ring.follow()
            writing.take(position)
        writing.finish(writing.status or ending)
    except OSError as error:
        if isinstance(error, NoRoom) and writing.writer is not None:
            writing.writer.abandon("disk full")
        writing.fail(error)
        # Not an ordinary exit: HDF5 would try once more to write what does not fit.
        os._exit(3)
    return 0


def main(words: list[str]) -> int:
    """The exit code of the process."""
    for name in (signal.SIGINT, signal.SIGHUP, signal.SIGQUIT, signal.SIGTERM):
        signal.signal(name, signal.SIG_IGN)
    with suppress(OSError):
        # mpiexec binds the solver to a core; the recorder must not share that one.
        os.sched_setaffinity(0, map(int, words[4].split(",")))
    ring_fd, commands, control, answers = map(int, words[:4])
    os.set_blocking(commands, False)
    return serve(rings.Ring(ring_fd), commands, control, answers)


if __name__ == "__main__":
    # The file is closed, and the solver waits: Python would take 0.1 s to clear its modules.
    os._exit(main(sys.argv[1:]))
