"""Reads recordings: finished, interrupted, and those whose writer was killed."""

import json
import time
import zlib
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np

from restshape.arrays import AnyArray, Indices, Integers, Reals, Records
from restshape.errors import UserError, printable
from restshape.replay.columns import ALIASES, SIMULATED, renamed
from restshape.replay.recording.cell_types import CELL_TYPES
from restshape.replay.recording.containment import refuse_other_files
from restshape.replay.recording.journal import Unfinished, finish_journal
from restshape.replay.recording.layout import (
    DamagedRecording,
    bad,
    refuse_bad_arrays,
    refuse_bad_header,
    refuse_bad_places,
)
from restshape.replay.recording.vtkhdf import FORMAT, PARTS, checksum
from restshape.scene.plain_values import Table

_ATTEMPTS, _PAUSE = 20, 0.05
ARRAYS = ("Points", "Connectivity", "Types", "Offsets")
"""Of all frames, in which each has a place."""


class FieldInfo(NamedTuple):
    """A recorded field: ``point_data`` or ``cell_data``, components (0 = scalar), first frame that has it."""

    where: str
    components: int
    first_frame: int


class StoredField(NamedTuple):
    """Where a field's values are: its dataset of the file, and the row (n,) of it at which each frame begins."""

    dataset: h5py.Dataset
    starts: Integers


class Recording:
    """A recording opened for reading; close it, or use it in a ``with`` statement.

    Args:
        path: a ``.vtkhdf`` file that `Recorder` wrote.

    Attributes:
        n: number of frames.
        header: what the writer put there: scene, script, options, versions, calibration ...
        table: column -> array (n,); text columns hold ``str``.
        old_names: of columns that an earlier version has written under another name, by their names in `table`.
        status: "done", or why the recording ended early: "interrupted" (the solver was stopped), "disk full", "killed"
            (its writer was).
        fields: name -> FieldInfo.
        writer: what writing cost: cpu_s, lag_s, batches; empty where the writer was killed.

    Raises:
        UserError: the file is not there, is no recording, or is being written.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._file = self._open()
        try:
            refuse_other_files(self._file, self.path)
            refuse_bad_arrays(self._file, self.path)
            self._read_frame_index()
            refuse_bad_header(self.header, self.path)
        except UserError:
            self._file.close()
            raise
        # HDF5 answers damage with errors of many kinds.
        except (KeyError, OSError, ValueError, TypeError, RuntimeError, AttributeError, IndexError) as error:
            self._file.close()
            what = printable(f"this is no recording, or it is damaged ({str(error)[:200]})")
            raise DamagedRecording(what, self.path) from error

    def _open(self) -> h5py.File:
        if not self.path.is_file():
            raise UserError("there is no such recording", str(self.path), "restshape replay SCENE --out FILE makes one")
        for attempt in range(_ATTEMPTS):
            try:
                finish_journal(self.path)
                return h5py.File(self.path, "r")
            except BlockingIOError:
                # A writer that was just killed holds its lock until the system has buried it.
                time.sleep(_PAUSE if attempt + 1 < _ATTEMPTS else 0.0)
            except Unfinished as error:
                what = (
                    "its writer was killed while it wrote, and the rest of that waits in the file, which is read-only"
                )
                raise UserError(
                    what, str(self.path), "open it once where it may be written: chmod u+w, or a copy"
                ) from error
            except PermissionError as error:
                raise UserError("this file may not be read", str(self.path), "chmod u+r allows it") from error
            except OSError as error:
                if "truncated" in str(error):
                    raise DamagedRecording("this recording is cut off", self.path) from error
                what, do = "this is no recording (not an HDF5 file)", "restshape replay SCENE --out FILE makes one"
                raise UserError(what, str(self.path), do) from error
        raise UserError("this recording is still being written", str(self.path), "wait for its replay to end")

    def _read_frame_index(self) -> None:
        own, root = self._file["restshape"], self._file["VTKHDF"]
        if own.attrs["format"] != FORMAT:
            raise ValueError(f"format {own.attrs['format']}, this program reads {FORMAT}")
        steps = root["Steps"]
        self.n = int(steps.attrs["NSteps"])
        data = bytes(own["header"][()])
        if "header_checksum" in own.attrs and int(own.attrs["header_checksum"]) != zlib.crc32(data):
            raise ValueError("its header does not match its checksum")
        header = cleaned(json.loads(data))
        if not isinstance(header, dict):
            raise bad(self.path, "its header is no table")
        self.header: Table = header
        self.dimension = int(own.attrs["dimension"])
        status = printable(own["status"][()].decode().strip())
        self.status = "killed" if status == "recording" else status
        self.writer = {k.removeprefix("writer_"): float(v) for k, v in own.attrs.items() if k.startswith("writer_")}
        if not 0 <= self.n <= len(own["table"]) or self.dimension not in (0, 2, 3):
            raise ValueError("frames are missing")
        self._rows = own["table"][: self.n]
        if "checksum" not in (self._rows.dtype.names or ()):
            raise ValueError("its table has no checksums")
        stored = columns_in(self._rows)
        self.table = renamed(stored)
        self.old_names = {new: old for new, old in ALIASES.items() if new in self.table and new not in stored}
        places = {name: item for name, item in steps.items() if isinstance(item, h5py.Dataset)}
        self._steps = {name: place[: self.n].reshape(-1) for name, place in places.items()}
        self._parts = {name: root[name][()] for name in PARTS}
        self._data = {name: root[name] for name in ARRAYS if name in root}
        if groups := [name for name, item in self._data.items() if not isinstance(item, h5py.Dataset)]:
            raise ValueError(f"{groups[0]} is no array")
        if "Values" not in self._steps or min(map(len, (self._rows, *self._steps.values()))) < self.n:
            raise ValueError("frames are missing")
        self.fields: dict[str, FieldInfo] = {}
        self._stored: dict[str, StoredField] = {}
        for group, where in (("PointData", "point_data"), ("CellData", "cell_data")):
            for name, dataset in sorted(root[group].items(), key=lambda item: item[1].attrs["order"]):
                attributes = dataset.attrs
                ((today, _),) = renamed({name: name}).items()
                self.fields[today] = FieldInfo(where, int(attributes["components"]), int(attributes["first_frame"]))
                self._stored[today] = StoredField(dataset, steps[f"{group}Offsets"][name][: self.n])
        self._check_places()

    def _check_places(self) -> None:
        """Makes sure that all that frames refer to is in the file.

        Raises:
            ValueError: it is not.
        """
        parts = self._steps["PartOffsets"]
        lengths = {len(values) for values in self._parts.values()}
        if len(lengths) != 1:
            raise ValueError("its parts do not fit each other")
        refuse_bad_places(parts, np.ones_like(parts), lengths.pop(), "cells")
        points, cells, ids = (self._parts[name][parts] for name in PARTS)
        if (cells * np.isin(ids // np.maximum(cells, 1), list(CELL_TYPES)) != cells).any() or (
            ids % np.maximum(cells, 1)
        ).any():
            raise ValueError("cells have no known number of nodes")
        refuse_bad_places(self._steps["ConnectivityIdOffsets"], ids, len(self._data["Connectivity"]), "cells")
        refuse_bad_places(self._steps["CellOffsets"], cells, len(self._data["Types"]), "cells")
        if self.n and "Offsets" not in self._data:
            raise ValueError("cells have no offsets")
        if self.n and (self._data["Points"].ndim != 2 or self._data["Points"].shape[1] != 3):
            raise ValueError("points have no three components")
        if self.n:
            refuse_bad_places(self._steps["PointOffsets"], points, len(self._data["Points"]), "points")
        for name, (dataset, starts) in self._stored.items():
            info = self.fields[name]
            if len(starts) < self.n or not 0 <= info.first_frame <= self.n:
                raise ValueError(f"frames of {name} are missing")
            if dataset.dtype.kind != "f" or dataset.ndim != 1 + bool(info.components):
                raise ValueError(f"{name} is no field of numbers")
            if info.components and not 0 < info.components <= dataset.shape[1]:
                raise ValueError(f"{name} has no {info.components} components")
            counts = points if info.where == "point_data" else cells
            here = slice(info.first_frame, self.n)
            refuse_bad_places(starts[here], counts[here], len(dataset), name)

    @property
    def fingerprint(self) -> str:
        """The hash of all that it holds: of its header, and of its rows, which hold the checksum of each frame."""
        header = json.dumps(self.header, sort_keys=True).encode()
        return f"sha256:{sha256(header + self._rows.tobytes()).hexdigest()}"

    @property
    def times(self) -> Reals:
        """Edit time of each frame [s] as ParaView sees it: frames at the same time are one last bit apart."""
        return self._steps["Values"]

    def number(self, i: int) -> int:
        """The number of frame i in its replay, for people."""
        return i

    def moments(self, i: int) -> list[str]:
        """The edit time of frame i in words, and its simulated time where it has one that is not the same."""
        t, simulated = float(self.times[i]), float(self.table[SIMULATED][i]) if SIMULATED in self.table else np.nan
        words = [f"t = {t:.2f} s"]
        return (
            words if not np.isfinite(simulated) or abs(simulated - t) < 0.005 else [*words, f"sim. {simulated:.4g} s"]
        )

    @property
    def summary(self) -> str:
        """One sentence for people: how many frames, and why it ended if it ended early."""
        frames = f"{self.n} frame{'' if self.n == 1 else 's'}"
        reasons = {
            "done": "",
            "killed": "; its writer was killed, up to half a second is missing",
            "interrupted": "; the replay was interrupted",
        }
        return frames + reasons.get(self.status, f"; ended early: {self.status}")

    def topology(self, i: int) -> int:
        """The number of frame i's topology: equal numbers, equal cells."""
        return int(self._steps["PartOffsets"][self._frame(i)])

    def cells(self, i: int) -> Indices:
        """The (ne, nodes) int32 cells of frame i."""
        i = self._frame(i)
        part = self.topology(i)
        start, count = self._steps["ConnectivityIdOffsets"][i], self._parts["NumberOfConnectivityIds"][part]
        flat = self._data["Connectivity"][start : start + count]
        return flat.astype(np.int32).reshape(self._parts["NumberOfCells"][part], -1)

    def cell_type(self, i: int) -> int:
        """VTK's number for the cells of frame i."""
        return int(self._data["Types"][self._steps["CellOffsets"][self._frame(i)]])

    @property
    def rows(self) -> Records:
        """The table as it is stored: a record a frame, with its checksum."""
        return self._rows

    def points(self, i: int) -> Reals:
        """The (n, dimension) rest positions of frame i [m]."""
        i = self._frame(i)
        start, count = self._steps["PointOffsets"][i], self._parts["NumberOfPoints"][self.topology(i)]
        return np.ascontiguousarray(self._data["Points"][start : start + count, : self.dimension])

    def mesh(self, i: int) -> tuple[Reals, Indices]:
        """Rest positions (n, dimension) [m] and cells (ne, nodes) of frame i."""
        return self.points(i), self.cells(i)

    def field(self, i: int, name: str) -> Reals:
        """A field of frame i as it was recorded: (n,) or (n, components) at points, (ne,) or (ne, components) at cells.

        Raises:
            UserError: no field has that name.
        """
        if name not in self.fields:
            raise UserError(f"no field is named {name!r}", str(self.path), f"use one of: {', '.join(self.fields)}")
        i = self._frame(i)
        info = self.fields[name]
        counts = self._parts["NumberOfPoints" if info.where == "point_data" else "NumberOfCells"]
        dataset, starts = self._stored[name]
        rows = dataset[starts[i] : starts[i] + counts[self.topology(i)]]
        return np.ascontiguousarray(rows[:, : info.components]) if info.components else rows

    def verify(self) -> list[int]:
        """The frames whose bytes do not match their checksum, or that cannot be drawn: none in a sound file.

        Edit times, which checksums do not cover, follow from those in the rows.
        """
        damaged = []
        topologies: dict[int, int] = {}
        for i in range(self.n):
            try:
                part = self.topology(i)
                points, cells = self.mesh(i)
                if part not in topologies:
                    topologies[part] = checksum(0, cells.tobytes(), [])
                arrays = [points, *(self.field(i, k) for k, f in self.fields.items() if f.first_frame <= i)]
                good = bool(np.isfinite(points).all()) and _fit(cells, points) and self._are_typed(i, cells)
                good = good and self._are_plain(i, cells)
                code = checksum(topologies[part], self._rows[i].tobytes()[:-4], arrays)
            except (OSError, ValueError, IndexError, RuntimeError):
                code, good = -1, False
            if not good or code != self._rows["checksum"][i]:
                damaged.append(i)
        return damaged

    def _are_typed(self, i: int, cells: Indices) -> bool:
        """Whether VTK's types and offsets of the cells of frame i are those of cells with so many nodes."""
        part, start = self.topology(i), self._steps["CellOffsets"][i]
        count, width = cells.shape
        types = self._data["Types"][start : start + count]
        # Each topology has one offset more than cells.
        offsets = self._data["Offsets"][start + part : start + part + count + 1]
        return bool((types == CELL_TYPES[width]).all()) and np.array_equal(offsets, np.arange(count + 1) * width)

    def _are_plain(self, i: int, cells: Indices) -> bool:
        """Whether what checksums leave out is as it was written: zeros beyond the plane, indices as they are read."""
        part, start = self.topology(i), self._steps["ConnectivityIdOffsets"][i]
        counts = {name: self._parts[name][part] for name in ("NumberOfPoints", "NumberOfCells")}
        first = self._steps["PointOffsets"][i]
        beyond = [self._data["Points"][first : first + counts["NumberOfPoints"], self.dimension :]]
        for name, info in self.fields.items():
            if info.components and info.first_frame <= i:
                dataset, starts = self._stored[name]
                count = counts["NumberOfPoints" if info.where == "point_data" else "NumberOfCells"]
                beyond.append(dataset[starts[i] : starts[i] + count, info.components :])
        flat = self._data["Connectivity"][start : start + cells.size]
        return np.array_equal(flat, cells.ravel()) and not any(values.any() for values in beyond)

    def _frame(self, i: int) -> int:
        if not -self.n <= i < self.n:
            raise IndexError(f"frame {i} of a recording of {self.n}")
        return i % self.n

    def close(self) -> None:
        """Closes the file."""
        self._file.close()

    def __enter__(self) -> "Recording":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _fit(cells: Indices, points: Reals) -> bool:
    """Whether cells refer to points that are there."""
    return not cells.size or (cells.min() >= 0 and int(cells.max()) < len(points))


def columns_in(rows: Records) -> dict[str, AnyArray]:
    """The columns of a stored table (n,) by name, its checksum left out; texts are `str`."""
    return {name: _column(rows[name]) for name in rows.dtype.names or () if name != "checksum"}


def _column(values: AnyArray) -> AnyArray:
    if values.dtype.kind != "S":
        return np.ascontiguousarray(values)
    return np.array([printable(value.decode(errors="replace")) for value in values], dtype=object)


def cleaned(value: object) -> object:
    """JSON without control characters in its texts."""
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, dict):
        return {printable(key): cleaned(item) for key, item in value.items()}
    return [cleaned(item) for item in value] if isinstance(value, list) else value


def ranges(numbers: list[int]) -> str:
    """Numbers in order, such as ``0-5, 7``."""
    spans: list[list[int]] = []
    for number in numbers:
        if spans and number == spans[-1][-1] + 1:
            spans[-1][1:] = [number]
        else:
            spans.append([number])
    return ", ".join("-".join(map(str, span)) for span in spans)
