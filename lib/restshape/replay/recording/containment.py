"""Whether an HDF5 file holds all its data itself."""

from pathlib import Path

import h5py

from restshape.errors import UserError

MOST_ITEMS = 10_000
"""Groups and datasets of a recording at most."""


def refuse_other_files(file: h5py.File, path: Path) -> None:
    """Makes sure that reading this file reads no other: no links, no data kept elsewhere, no views of other datasets.

    Args:
        file: opened for reading.
        path: of it, for messages.

    Raises:
        UserError: naming the first item that leads elsewhere, or telling that there are too many items.
    """
    groups, seen, count = [file], {h5py.h5o.get_info(file.id).addr}, 0
    while groups:
        group = groups.pop()
        for name in group:
            count += 1
            if count > MOST_ITEMS:
                raise _error(path, f"the file holds more than {MOST_ITEMS} items")
            if not isinstance(group.get(name, getlink=True), h5py.HardLink):
                raise _error(path, f"{group.name.rstrip('/')}/{name} is a link")
            item = group[name]
            address = h5py.h5o.get_info(item.id).addr
            if address in seen:
                continue
            seen.add(address)
            if isinstance(item, h5py.Group):
                groups.append(item)
            elif isinstance(item, h5py.Dataset) and (item.external or item.is_virtual):
                raise _error(path, f"{item.name} keeps its data elsewhere")


def _error(path: Path, what: str) -> UserError:
    do = "record it again; no file but the recording is read"
    return UserError(f"{what}, which no recording does", str(path), do)
