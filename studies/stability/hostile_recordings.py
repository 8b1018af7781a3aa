"""Damaged and crafted recordings, which `restshape report` and `restshape salvage` must read or refuse."""

import json
import random
import shutil
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings
from restshape_studies.stability.batch import RECORDINGS, Batch
from restshape_studies.stability.commanded import run_command
from restshape_studies.stability.crafted_recordings import craft
from restshape_studies.stability.example import RECORDED, RECORDING, Example
from restshape_studies.stability.player import Fault, play
from restshape_studies.stability.strategies import examples

SALVAGED = "salvaged.vtkhdf"
REPORT = "report"
DONE = "done.txt"
"""The file that says what was done to the recording."""
TRIES = 60
"""Examples that are drawn until one has a recording."""
LARGE = 4_000_000
"""Bytes of a recording that is damaged; larger ones take long to copy."""
HOSTILE: list[Any] = [0, -1, 2**31 - 1, 2**62, -(2**62), 10_000_000]
HEADERS: list[Any] = [None, -1, 1e308, "", "x" * 5000, "\x1b[2J", [], {}, [[]], {"file": "/etc/passwd"}, True]


class EnoughError(Exception):
    """A recording was found: no more examples are drawn."""


def recordings(batch: Batch, folder: Path, alive: Callable[[], None] = lambda: None) -> bytes:
    """A recording of some frames of a random scene; `alive` is called before each try."""
    found: list[bytes] = []

    @seed(batch.seed)
    @settings(
        max_examples=TRIES,
        database=None,
        deadline=None,
        phases=(Phase.generate,),
        suppress_health_check=list(HealthCheck),
    )
    @given(examples(batch.apps, RECORDINGS))
    def record(example: Example) -> None:
        if found:
            raise EnoughError
        alive()
        example = replace(example, written=True, onto="")
        example.write(folder)
        played = play(folder, example)
        path = folder / RECORDING
        if played.frames > 1 and path.is_file() and path.stat().st_size < LARGE:
            found.append(path.read_bytes())

    with suppress(EnoughError):
        record()
    if not found:
        raise RuntimeError(f"no recording in {TRIES} examples of seed {batch.seed}")
    return found[0]


def damages(batch: Batch, folder: Path, alive: Callable[[], None] = lambda: None) -> Iterator[tuple[str, Path]]:
    """What was done to each recording, and its file; `alive` is called meanwhile."""
    data = recordings(batch, folder, alive)
    dice = random.Random(batch.seed)
    for _ in range(batch.count):
        name = dice.choice(list(DAMAGE))
        path = folder / RECORDED
        (folder / DONE).write_text(name)
        path.write_bytes(data)
        # HDF5 refuses to write what it refuses to read.
        with suppress(OSError, ValueError, TypeError, RuntimeError, KeyError, OverflowError):
            DAMAGE[name](dice, path)
        yield f"recording: {name}", path


def again(folder: Path) -> Iterator[tuple[str, Path]]:
    """What was done to the recording that lies in the folder already, and its file."""
    yield f"recording: {(folder / DONE).read_text()}", folder / RECORDED


def outcome(folder: Path, path: Path) -> str:
    """The exit codes of `report` and `salvage` of a file.

    Raises:
        Fault: another code than those of messages, no message, or the file was changed.
        BaseException: whatever a user would see a traceback of.
    """
    before = path.read_bytes()
    shutil.rmtree(folder / REPORT, ignore_errors=True)
    (folder / SALVAGED).unlink(missing_ok=True)
    codes = []
    for words in (
        ["report", str(path), "--out", str(folder / REPORT), "--animation", "none"],
        ["salvage", str(path), "--out", str(folder / SALVAGED)],
    ):
        code, printed = run_command(words)
        if code not in (0, 1, 2) or "Traceback" in printed:
            raise Fault(f"{words[0]}: ends with {code}: {printed[-300:]}")
        if code == 2 and "restshape " not in printed:
            raise Fault(f"{words[0]}: ends with 2 and says nothing")
        codes.append(code)
    if path.read_bytes() != before:
        raise Fault("written over: the recording")
    return f"report {codes[0]}, salvage {codes[1]}"


def _bytes(dice: random.Random, path: Path) -> None:
    data = bytearray(path.read_bytes())
    for _ in range(dice.choice([1, 4, 64])):
        data[dice.randrange(len(data))] = dice.randrange(256)
    path.write_bytes(data)


def _cut(dice: random.Random, path: Path) -> None:
    data = path.read_bytes()
    path.write_bytes(data[: dice.randrange(len(data))])


def _zeros(dice: random.Random, path: Path) -> None:
    data, size = bytearray(path.read_bytes()), dice.choice([8, 64, 512, 4096, 65536])
    start = dice.randrange(len(data))
    data[start : start + size] = bytes(len(data[start : start + size]))
    path.write_bytes(data)


def _items(file: h5py.File) -> list[str]:
    names: list[str] = []
    file.visit(names.append)
    return sorted(names)


def _values(dice: random.Random, path: Path) -> None:
    with h5py.File(path, "r+") as file:
        sets = [name for name in _items(file) if isinstance(file[name], h5py.Dataset) and file[name].size]
        item = file[dice.choice(sets)]
        flat = item[()].copy()
        place = dice.randrange(len(flat)) if flat.ndim else ()
        if flat.dtype.kind == "f":
            flat[place] = dice.choice([np.nan, np.inf, -1e308, 1e308, 0.0])
        elif flat.dtype.kind in "iu":
            flat[place] = np.array(dice.choice(HOSTILE)).astype(flat.dtype)
        elif flat.dtype.names:
            name = dice.choice(flat.dtype.names)
            kind = flat.dtype[name].kind
            flat[name][place] = {"f": np.nan, "S": b"\xff\x1b[31m"}.get(kind, -1)
        item[...] = flat


def _attributes(dice: random.Random, path: Path) -> None:
    with h5py.File(path, "r+") as file:
        places = [(name, key) for name in _items(file) for key in file[name].attrs]
        name, key = dice.choice(places)
        file[name].attrs[key] = dice.choice([*HOSTILE, np.nan, "text", b"\xff", [1, 2, 3], []])


def _gone(dice: random.Random, path: Path) -> None:
    with h5py.File(path, "r+") as file:
        del file[dice.choice(_items(file))]


def _other_arrays(dice: random.Random, path: Path) -> None:
    with h5py.File(path, "r+") as file:
        name = dice.choice([name for name in _items(file) if isinstance(file[name], h5py.Dataset)])
        attributes, old = dict(file[name].attrs), file[name][()]
        del file[name]
        kind = dice.choice(["short", "float", "empty", "text", "claimed", "link"])
        if kind == "link":
            file[name] = h5py.ExternalLink("/etc/passwd", "/")
            return
        if kind == "claimed":
            item = file.create_dataset(name, shape=(10**10,), maxshape=(None,), chunks=(1024,), dtype="f8")
        else:
            shown = np.atleast_1d(old)
            made = {"short": shown[: len(shown) // 2], "empty": shown[:0], "text": np.array([b"abc"])}
            item = file.create_dataset(name, data=made.get(kind, np.full(3, 0.5)))
        for key, value in attributes.items():
            item.attrs[key] = value


def _header(dice: random.Random, path: Path) -> None:
    from restshape_studies.stability.mutators import at, leaves, put

    with h5py.File(path, "r+") as file:
        own = file["restshape"]
        header = json.loads(bytes(own["header"][()]))
        for _ in range(dice.choice([1, 1, 3])):
            place = dice.choice(leaves(header))
            place = place[: dice.randrange(1, len(place) + 1)] if place else place
            value = at(header, place)
            choices = [*HEADERS, [value], str(value)]
            header = put(header, place, dice.choice(choices))
        stream = StringIO()
        json.dump(header, stream)
        data = np.frombuffer(stream.getvalue().encode(), dtype=own["header"].dtype)
        del own["header"]
        own.create_dataset("header", data=data)
        own.attrs.pop("header_checksum", None)


def _crafted(dice: random.Random, path: Path) -> None:
    with h5py.File(path, "r+") as file:
        craft(dice, file)


DAMAGE: dict[str, Callable[[random.Random, Path], None]] = {
    "bytes": _bytes,
    "cut": _cut,
    "zeros": _zeros,
    "values": _values,
    "attributes": _attributes,
    "items gone": _gone,
    "other arrays": _other_arrays,
    "header": _header,
    "crafted": _crafted,
}
"""What may be done to a recording, by name."""
