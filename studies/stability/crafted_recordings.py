"""Recordings of a structure that nobody has written by chance: links, filters, types and sizes."""

import json
import random
from collections.abc import Callable

import h5py
import numpy as np

Craft = Callable[[h5py.File, str], None]
DEPTH = 100_000
"""Brackets of a header that nests too deeply."""
CLAIMED = 10**10
"""Entries of arrays that are claimed and not there."""


def datasets(file: h5py.File) -> list[str]:
    """Names of all arrays, in order."""
    names: list[str] = []
    file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
    return sorted(names)


def _put(file: h5py.File, name: str, make: Callable[[h5py.Group, str], object]) -> None:
    """Make something else in the place of an array, with the array's attributes."""
    place, _, last = name.rpartition("/")
    attributes = dict(file[name].attrs)
    del file[name]
    group = file[place] if place else file
    make(group, last)
    if isinstance(group.get(last, getlink=True), h5py.HardLink):
        for key, value in attributes.items():
            group[last].attrs[key] = value


def _link(link: object) -> Craft:
    def make(group: h5py.Group, last: str) -> None:
        group[last] = link

    return lambda file, name: _put(file, name, make)


def _array(**options: object) -> Craft:
    return lambda file, name: _put(file, name, lambda group, last: group.create_dataset(last, **options))


def _circle(file: h5py.File, name: str) -> None:
    _put(file, name, lambda group, last: group.__setitem__(last, file["/"]))


def _as_group(file: h5py.File, name: str) -> None:
    _put(file, name, lambda group, last: group.create_group(last))


def _packed(file: h5py.File, name: str) -> None:
    data = np.atleast_1d(file[name][()])
    _put(file, name, lambda group, last: group.create_dataset(last, data=data, compression="gzip", chunks=True))


def _virtual(file: h5py.File, name: str) -> None:
    layout = h5py.VirtualLayout(shape=(8,), dtype="f8")
    layout[:] = h5py.VirtualSource("/etc/passwd", "data", shape=(8,))
    _put(file, name, lambda group, last: group.create_virtual_dataset(last, layout))


def _deep_header(file: h5py.File, name: str) -> None:
    own = file["restshape"]
    del own["header"]
    own.create_dataset("header", data=np.frombuffer(b"[" * DEPTH + b"]" * DEPTH, dtype="u1"))
    own.attrs.pop("header_checksum", None)


def _large_header(file: h5py.File, name: str) -> None:
    own = file["restshape"]
    text = json.dumps({"title": "x" * 10**6, "scene": {str(k): {} for k in range(10**4)}}).encode()
    del own["header"]
    own.create_dataset("header", data=np.frombuffer(text, dtype="u1"))
    own.attrs.pop("header_checksum", None)


CRAFTED: dict[str, Craft] = {
    "a group in a circle": _circle,
    "a link to itself": lambda file, name: _link(h5py.SoftLink(f"/{name}"))(file, name),
    "a link to nothing": _link(h5py.SoftLink("/nowhere")),
    "another file": _link(h5py.ExternalLink("/etc/passwd", "/")),
    "parts of another file": _virtual,
    "a group in place of an array": _as_group,
    "claimed": _array(shape=(CLAIMED,), chunks=(1024,), maxshape=(None,), dtype="f8"),
    "claimed in both directions": _array(shape=(10**6, 10**6), chunks=(64, 64), dtype="i1"),
    "no dimension": _array(data=1.0),
    "five dimensions": _array(data=np.zeros((2, 1, 2, 1, 2))),
    "nothing": _array(data=h5py.Empty("f8")),
    "texts of any length": _array(data=["a", "\x1b[31m", ""], dtype=h5py.string_dtype()),
    "references": _array(shape=(4,), dtype=h5py.ref_dtype),
    "packed": _packed,
    "a header that nests": _deep_header,
    "a large header": _large_header,
}
"""What may stand in a recording, by what it is; each changes an open file at the array of a name."""


def craft(dice: random.Random, file: h5py.File) -> None:
    """Put something of `CRAFTED` into a recording, in the place of a random array."""
    CRAFTED[dice.choice(list(CRAFTED))](file, dice.choice(datasets(file)))
