"""The file of a recording: a temporal VTKHDF unstructured grid beside a table of the frames.

`/VTKHDF` follows version 2.0 of the format (read by vtk from 9.3 and ParaView from 5.12 on); `/restshape` is outside of
what that format speaks about, so its readers leave it alone. Arrays of all frames are concatenated, frames say where
theirs start. Cells are stored once a topology; points and fields that repeat the last bytes are not stored again.

The file survives the death of its writer: HDF5's own metadata stay in memory between commits, a commit brings the data
and then all metadata together (`journal`). The older superblock has no mark "open" that would bar the file.
"""

import errno
import json
import os
import re
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np

from restshape.arrays import AnyArray, Indices, Reals
from restshape.outputs.atomic_files import new_part
from restshape.outputs.kinds import RecordingFile
from restshape.outputs.locks import Lock
from restshape.replay.recording.frame_data import FrameData
from restshape.replay.recording.growable_array import Growing
from restshape.replay.recording.journal import JournaledFile, lock

VERSION = (2, 0)
FORMAT = 1
STATUS_BYTES = 64
ROOM = 2 << 20
"""Bytes that are reserved beyond what a batch takes: for HDF5's metadata, and for their journal."""
PARTS = ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds")


class Topology(NamedTuple):
    """Cells that hold from the next frame on: (ne, nodes) int32 and their VTK cell type."""

    cells: Indices
    cell_type: int


class RecordedFrame(NamedTuple):
    """One frame: edit time, rest points (n, dim), fields, the row's bytes."""

    t: float
    X: Reals
    point_data: dict[str, Reals]
    cell_data: dict[str, Reals]
    row: bytes


def checksum(topology: int, row: bytes, arrays: Sequence[AnyArray]) -> int:
    """The CRC-32 of a frame: that of its cells, carried on over its row, points and fields."""
    value = zlib.crc32(row, topology)
    for array in arrays:
        value = zlib.crc32(np.ascontiguousarray(array).reshape(-1).view(np.uint8).data, value)
    return value


class NoRoom(OSError):
    """The disk has no room for the next batch; nothing of it has been written."""


class Removed(OSError):
    """The file is not at its place any more: removed, or replaced by another."""


# More than 15 attributes: each is a dataset or group of the file that every frame appends to.
class VtkHdfWriter:
    """Writes a recording; `append` then `commit` makes frames safe.

    Until its first frames are safe the file has a name of its own, NAME.part-..., so that a run without any leaves an
    earlier recording whole. NAME.lock keeps a second writer away.

    Args:
        path: the file, replaced by the first commit of frames.
        header: stored as JSON.
        row_dtype: record type of a row; a column ``checksum`` is added.

    Raises:
        Locked: another process writes this recording.
        OSError: the file cannot be made.
    """

    def __init__(self, path: Path, header: Mapping[str, object], row_dtype: np.dtype[np.void]) -> None:
        self.path = path
        self.frames = 0
        self._header = dict(header)
        if path.exists() and not os.access(path, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
        self._lock = Lock(path)
        try:
            _remove_left(path)
            self._part: Path | None = None
            self._part, self._space = new_part(path)
            lock(self._space)
            self._writes = JournaledFile(self._space)
            self.file = h5py.File(self._writes, "w", libver=("earliest", "v110"), rdcc_nbytes=0)
        except BaseException:
            self._lock.release()
            raise
        settings = self.file.id.get_mdc_config()
        settings.incr_mode = settings.flash_incr_mode = settings.decr_mode = 0
        settings.evictions_enabled = False
        self.file.id.set_mdc_config(settings)
        self._row_dtype = row_dtype
        self._make_groups()
        self._topologies: list[int] = []
        self._fresh: Topology | None = None
        self._offsets: dict[str, Growing] = {}
        self._fields: dict[str, dict[str, Growing]] = {"PointData": {}, "CellData": {}}
        self._largest = {"PointData": 0, "CellData": 0}
        try:
            self.commit()
        except OSError:
            # The recorder process has no writer yet that it could tell to leave nothing.
            self.abandon("disk full")
            raise

    def _make_groups(self) -> None:
        root = self.file.create_group("VTKHDF")
        root.attrs["Version"] = np.array(VERSION, dtype="i8")
        root.attrs.create("Type", b"UnstructuredGrid", dtype=h5py.string_dtype("ascii", len("UnstructuredGrid")))
        steps = root.create_group("Steps")
        steps.attrs["NSteps"] = np.int64(0)
        self.root, self.steps = root, steps
        self._parts = {name: Growing(root, name, "i8") for name in PARTS}
        self._connectivity = Growing(root, "Connectivity", "i8", chunk=65536)
        self._cell_offsets = Growing(root, "Offsets", "i8", chunk=16384)
        self._types = Growing(root, "Types", "u1", chunk=16384)
        self._points: Growing | None = None
        self._step = {"Values": Growing(steps, "Values", "f8")}
        self._step |= {name: Growing(steps, name, "i8") for name in ("PartOffsets", "NumberOfParts", "PointOffsets")}
        self._step |= {name: Growing(steps, name, "i8", width=1) for name in ("CellOffsets", "ConnectivityIdOffsets")}
        for kind in ("PointData", "CellData"):
            root.create_group(kind)
            steps.create_group(f"{kind}Offsets")
        own = self.file.create_group("restshape")
        own.attrs["format"] = FORMAT
        # A dataset of its own, whose place in the file is known: written past HDF5 when HDF5 has no room.
        self._status = own.create_dataset("status", data=np.bytes_("recording".ljust(STATUS_BYTES)))
        own.attrs["dimension"] = 0
        self.own = own
        self._table = Growing(own, "table", np.dtype([*self._row_dtype.descr, ("checksum", "<u4")]), chunk=64)
        self._frame_data = FrameData(root, steps, self._row_dtype)
        self._last_time = -np.inf
        self._write_header()

    def _write_header(self) -> None:
        if "header" in self.own:
            del self.own["header"]
        # The order of tables is the order of what is in them.
        text = json.dumps(self._header, allow_nan=False).encode()
        self.own.create_dataset("header", data=np.frombuffer(text, dtype="u1"))
        self.own.attrs["header_checksum"] = zlib.crc32(text)

    def add_header(self, extra: Mapping[str, object]) -> None:
        """Merges more keys into the header, and commits."""
        self._header |= extra
        self._write_header()
        self.commit()

    def append(self, item: Topology | RecordedFrame) -> None:
        """Takes one topology or frame; it is in the file after the next `commit`."""
        if isinstance(item, Topology):
            self._fresh = item
        else:
            self._append_frame(item)

    def _append_topology(self, topology: Topology, points: int) -> None:
        cells = topology.cells
        count, width = cells.shape
        self._start_cells = self._types.add(np.full(count, topology.cell_type, dtype="u1"))
        self._start_connectivity = self._connectivity.add(cells.astype("i8").reshape(-1))
        self._cell_offsets.add(np.arange(0, count * width + 1, width, dtype="i8"))
        for name, value in zip(PARTS, (points, count, count * width), strict=True):
            self._parts[name].add(np.array([value], dtype="i8"))
        self._topologies.append(zlib.crc32(np.ascontiguousarray(cells, dtype="i4").data.cast("B")))

    def _append_frame(self, frame: RecordedFrame) -> None:
        n, dim = frame.X.shape
        if self._points is None:
            self._points = Growing(self.root, "Points", "f8", width=3, chunk=min(max(4096, 16 * n), 1 << 18))
            self.own.attrs["dimension"] = dim
        if self._fresh is not None:
            self._append_topology(self._fresh, n)
            self._cells, self._fresh = len(self._fresh.cells), None
        start = self._points.add_changed(_padded(frame.X))
        data = self._append_fields("PointData", frame.point_data, n)
        data += self._append_fields("CellData", frame.cell_data, self._cells)
        self._last_time = frame.t if frame.t > self._last_time else float(np.nextafter(self._last_time, np.inf))
        values = {"PartOffsets": len(self._topologies) - 1, "NumberOfParts": 1, "PointOffsets": start}
        values |= {"CellOffsets": self._start_cells, "ConnectivityIdOffsets": self._start_connectivity}
        for name, value in values.items():
            place = self._step[name]
            place.add(np.full((1, 1) if place.width else 1, value, dtype="i8"))
        self._step["Values"].add(np.array([self._last_time]))
        row = np.zeros(1, dtype=self._table.dataset.dtype)
        code = checksum(self._topologies[-1], frame.row, [frame.X, *data])
        row.view("u1")[:] = np.frombuffer(frame.row + np.uint32(code).tobytes(), dtype="u1")
        self._table.add(row)
        self._frame_data.add(row, self.frames)
        self.frames += 1

    def _append_fields(self, kind: str, given: dict[str, Reals], count: int) -> list[Reals]:
        fields = self._fields[kind]
        for name, values in given.items():
            if name not in fields:
                fields[name] = self._new_field(kind, name, values)
        self._largest[kind] = max(self._largest[kind], count)
        written: list[Reals] = []
        for name, field in fields.items():
            if name in given:
                values = given[name]
            else:
                shape = (count, field.dataset.attrs["components"]) if field.width else (count,)
                values = np.full(shape, np.nan)
            self._offsets[f"{kind}/{name}"].add(np.array([field.add_changed(_padded(values))], dtype="i8"))
            written.append(values)
        return written

    def _new_field(self, kind: str, name: str, values: Reals) -> Growing:
        """A field's dataset; frames before it find NaN there."""
        components = values.shape[1] if values.ndim == 2 else 0
        width = 3 if components == 2 else components
        field = Growing(self.root[kind], name, "f8", width=width, chunk=min(max(4096, 16 * len(values)), 1 << 18))
        field.dataset.attrs["components"] = components
        field.dataset.attrs["first_frame"] = self.frames
        field.dataset.attrs["order"] = len(self._fields[kind])
        offsets = self._offsets[f"{kind}/{name}"] = Growing(self.steps[f"{kind}Offsets"], name, "i8")
        if self.frames:
            missing = self._largest[kind]
            field.add(np.full((missing, width) if width else missing, np.nan))
            offsets.add(np.zeros(self.frames, dtype="i8"))
        return field

    def _datasets(self) -> list[Growing]:
        fields = [*self._fields["PointData"].values(), *self._fields["CellData"].values()] if self.frames else []
        points = [self._points] if self._points else []
        cells = [self._connectivity, self._cell_offsets, self._types]
        small = [*self._parts.values(), *self._step.values(), self._table, *self._frame_data.datasets]
        return points + fields + cells + small + (list(self._offsets.values()) if self.frames else [])

    def commit(self) -> None:
        """Makes everything appended safe.

        Raises:
            OSError: no room on the disk; what was safe before still is.
        """
        datasets = self._datasets()
        self._check_place()
        self._reserve(sum(d.pending_bytes for d in datasets))
        with self._writes.direct():
            for dataset in datasets:
                dataset.write()
        self.steps.attrs.modify("NSteps", np.int64(self.frames))
        self.file.flush()
        self._settle()
        if self.frames and self._part is not None:
            # Open handles stay with the file, whatever its name.
            os.replace(self._part, self.path)
            self._part = None

    def _settle(self) -> None:
        try:
            self._writes.settle()
        except OSError as error:
            raise NoRoom(error.errno, error.strerror) from error
        self._size = self._writes.end

    def _check_place(self) -> None:
        """Makes sure that the file is where its readers look for it.

        Raises:
            Removed: it is not.
        """
        mine, path = os.fstat(self._space), self._part or self.path
        try:
            found = os.stat(path, follow_symlinks=False)
        except FileNotFoundError:
            found = None
        if found is None or (found.st_dev, found.st_ino) != (mine.st_dev, mine.st_ino):
            what = f"the recording was {'replaced' if found else 'removed'} while it was being written"
            raise Removed(errno.ENOENT, what, str(path))

    def _reserve(self, pending: int) -> None:
        """Asks the disk for room before HDF5 writes: a write of its that fails half-way could cost the whole file.

        The room is counted generously: a dataset's last chunk is allocated whole.
        """
        chunks = sum(int(np.prod(d.dataset.chunks)) * d.dataset.dtype.itemsize for d in self._datasets())
        size = os.fstat(self._space).st_size
        need = self._writes.end + pending + chunks + ROOM
        if need > size:
            try:
                os.posix_fallocate(self._space, size, need - size)
            except OSError as error:
                raise NoRoom(error.errno, error.strerror) from error

    def close(self, status: str, written: dict[str, float]) -> int:
        """The file's size in bytes, closed with this status and what writing it cost; 0 and no file without frames."""
        self._status[()] = status.encode()[:STATUS_BYTES].ljust(STATUS_BYTES)
        for name, value in written.items():
            self.own.attrs[f"writer_{name}"] = value
        self.file.close()
        self._settle()
        size = self._size
        os.ftruncate(self._space, size)
        try:
            self._check_place()
            return 0 if self._discard() else size
        finally:
            os.close(self._space)
            self._lock.release()

    def abandon(self, status: str) -> None:
        """Leaves the file as the last `commit` made it, with this status; the process must end without closing it."""
        self._lock.release()
        if self._discard() or self._writes.settling:
            return
        os.ftruncate(self._space, self._size)
        os.pwrite(self._space, status.encode()[:STATUS_BYTES].ljust(STATUS_BYTES), self._status.id.get_offset())

    def _discard(self) -> bool:
        """Remove the file if no frame was made safe in it; returns whether that was so."""
        if self._part is None:
            return False
        self._part.unlink(missing_ok=True)
        return True


def _remove_left(path: Path) -> None:
    """Remove what killed writers of this recording left: they hold no lock any more, and no frame of theirs is safe."""
    known = re.compile(re.escape(path.name) + r"\.part-\d+-[0-9a-f]{8}")
    for left in path.parent.iterdir():
        if known.fullmatch(left.name) and left.is_file() and not left.is_symlink() and RecordingFile(left).ours():
            left.unlink()


def _padded(values: Reals) -> Reals:
    """A copy with a third component 0 where there are two."""
    if values.ndim == 2 and values.shape[1] == 2:
        padded = np.zeros((len(values), 3))
        padded[:, :2] = values
        return padded
    return np.array(values)
