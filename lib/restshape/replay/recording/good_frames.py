"""The good frames of a damaged recording, in a new one."""

import os
import struct
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from restshape.errors import UserError
from restshape.outputs.claims import refuse_foreign
from restshape.outputs.kinds import RecordingFile
from restshape.replay.recording.layout import DamagedRecording
from restshape.replay.recording.recording import Recording
from restshape.replay.recording.vtkhdf import RecordedFrame, Topology, VtkHdfWriter

SIGNATURE = b"\x89HDF\r\n\x1a\n"
END_OF_FILE = 40
"""Place of the file's length in a superblock of version 0."""
MOST_MISSING = 1 << 40
"""Bytes that a truncated file may lack: they take no room."""


def salvage(path: Path, out: Path) -> tuple[list[int], int]:
    """Writes the good frames of a recording into a new one; their numbers, and of how many.

    Args:
        path: of the damaged recording, which may be cut off at its end.
        out: of the new one.

    Raises:
        UserError: no frame is good, or a file cannot be opened or written.
    """
    refuse_foreign(RecordingFile(out), str(out))
    with opened(path) as recording:
        damaged = set(recording.verify())
        good = [i for i in range(recording.n) if i not in damaged]
        if not good:
            raise UserError(f"none of its {recording.n} frames is good", str(path), "record it again")
        try:
            _write(recording, good, out)
        except OSError as error:
            what = f"the recording cannot be written: {error.strerror or error}"
            raise UserError(what, str(out), "choose another file by --out") from error
        return good, recording.n


@contextmanager
def opened(path: Path) -> Iterator[Recording]:
    """A recording, also one that is cut off: a copy is opened then, as long as the file was, with zeros at its end.

    Raises:
        UserError: it cannot be opened.
    """
    missing = _missing(path)
    if not missing:
        with _found(path, path) as recording:
            yield recording
        return
    with tempfile.TemporaryDirectory(prefix="restshape-") as folder:
        copy = Path(folder) / "copy.vtkhdf"
        with path.open("rb") as old, copy.open("xb") as new:
            while data := old.read(1 << 20):
                new.write(data)
            new.truncate(old.tell() + missing)
        with _found(copy, path) as recording:
            yield recording


def _found(path: Path, named: Path) -> Recording:
    """The recording in a file, opened.

    Args:
        path: of the file.
        named: the file that the user has named, for messages.

    Raises:
        UserError: it cannot be opened; without its header and the index of its frames none of them can be found.
    """
    try:
        return Recording(path)
    except DamagedRecording as error:
        what = f"no frame can be found, for header or index cannot be read: {error.what}"
        raise UserError(what, str(named), "record it again: salvage needs both") from error
    except UserError as error:
        raise UserError(error.what, str(named), error.do) from error


def _missing(path: Path) -> int:
    """Bytes that lack at the end of a file, by its own superblock; 0 where it has none, or is not to be had."""
    try:
        with path.open("rb") as file:
            head = file.read(END_OF_FILE + 8)
            size = os.fstat(file.fileno()).st_size
    except OSError:
        return 0
    if len(head) < END_OF_FILE + 8 or not head.startswith(SIGNATURE) or head[8] != 0:
        return 0
    missing = struct.unpack_from("<Q", head, END_OF_FILE)[0] - size
    return missing if 0 < missing < MOST_MISSING else 0


def _write(recording: Recording, frames: list[int], out: Path) -> None:
    rows = recording.rows
    # As text: h5py's types carry what numpy's records do not take.
    columns = [(name, rows.dtype[name].str) for name in rows.dtype.names or () if name != "checksum"]
    kept = {"from": recording.path.name, "frames": len(frames), "of": recording.n}
    writer = VtkHdfWriter(out, {**recording.header, "salvaged": kept}, np.dtype(columns))
    topology = -1
    for i in frames:
        if recording.topology(i) != topology:
            topology = recording.topology(i)
            writer.append(Topology(recording.cells(i), recording.cell_type(i)))
        known = {name: kind for name, kind in recording.fields.items() if kind.first_frame <= i}
        points = {name: recording.field(i, name) for name, kind in known.items() if kind.where == "point_data"}
        cells = {name: recording.field(i, name) for name, kind in known.items() if kind.where == "cell_data"}
        row = rows[i].tobytes()[: -rows.dtype["checksum"].itemsize]
        time = float(recording.table["t"][i]) if "t" in recording.table else float(recording.times[i])
        writer.append(RecordedFrame(time, recording.points(i), points, cells, row))
        if i % 64 == 63:
            writer.commit()
    writer.commit()
    writer.close("salvaged", {})
