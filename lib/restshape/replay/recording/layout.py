"""Whether an HDF5 file can be a recording, found out before any of its arrays is read."""

from pathlib import Path

import h5py
from pydantic import BaseModel, ConfigDict, ValidationError

from restshape.arrays import Integers
from restshape.errors import UserError, printable
from restshape.scene.plain_values import Table

MOST_HEADER = 64 << 20
"""Bytes of a header."""
MOST_ATTRIBUTE = 4096
"""Bytes of an attribute."""


class _RecordedScene(BaseModel):
    """What readers of a recording take from its scene without reading it as a scene.

    Beside quantities stands the switch for the errors of all of them.
    """

    model_config = ConfigDict(extra="allow", strict=True)

    quantities: dict[str, Table | bool] = {}
    effects: Table = {}


class _Header(BaseModel):
    """The entries of a header that readers rely on; others are as they are."""

    model_config = ConfigDict(extra="allow", strict=True)

    script: str = ""
    script_text: str = ""
    title: str = ""
    app: str = ""
    policy: str = ""
    predict: str = ""
    scene_values: _RecordedScene = _RecordedScene()
    limits: dict[str, Table] = {}
    singular: dict[str, float] = {}
    load_scales: dict[str, float] = {}
    calibration: Table = {}
    petsc_in_effect: Table = {}


def refuse_bad_arrays(file: h5py.File, path: Path) -> None:
    """Makes sure that no array is larger than what the file holds, and that names and types are those of recordings.

    Args:
        file: opened for reading, without links.
        path: of it.

    Raises:
        UserError: naming the first one that is not.
    """
    size = path.stat().st_size

    def look(name: str, item: h5py.Group | h5py.Dataset) -> None:
        if name != printable(name):
            raise bad(path, f"the name {printable(name)!r} has control characters")
        for key in item.attrs:
            if item.attrs.get_id(key).get_storage_size() > MOST_ATTRIBUTE:
                raise bad(path, f"the attribute {printable(key)!r} of {name} has more than {MOST_ATTRIBUTE} bytes")
        if isinstance(item, h5py.Dataset):
            _look_at_array(item, size, path)

    file.visititems(look)
    if file["restshape/header"].nbytes > MOST_HEADER:
        raise bad(path, f"its header has more than {MOST_HEADER} bytes")


def _look_at_array(array: h5py.Dataset, size: int, path: Path) -> None:
    if array.dtype.hasobject or array.shape is None or array.id.get_create_plist().get_nfilters():
        raise bad(path, f"{array.name} is not stored as recordings store arrays")
    if array.nbytes > array.id.get_storage_size() or array.nbytes > size:
        raise bad(path, f"{array.name} claims {array.nbytes} bytes, and the file has {size}")


def refuse_bad_header(header: Table, path: Path) -> None:
    """Makes sure that the entries of the header are of the kinds that readers rely on.

    Raises:
        UserError: naming the first that is not.
    """
    try:
        _Header.model_validate(header)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = ".".join(str(part) for part in first["loc"])
        what = {"string_type": "no text", "float_type": "no number"}.get(first["type"], "no table")
        raise bad(path, f"{printable(place)!r} of its header is {what}") from None


def refuse_bad_places(starts: Integers, counts: Integers, length: int, what: str) -> None:
    """Makes sure that what frames refer to is there.

    Args:
        starts: (n,) first row of each frame.
        counts: (n,) rows of each frame.
        length: rows that there are.
        what: for the message.

    Raises:
        ValueError: it is not.
    """
    if len(starts) and ((starts < 0) | (counts < 0) | (counts > length) | (starts > length - counts)).any():
        raise ValueError(f"frames refer to {what} that are not there")


class DamagedRecording(UserError):
    """A file that is no recording, or one of which some frames may be good: `restshape salvage` looks for them.

    Args:
        what: is wrong.
        path: of the file.
    """

    def __init__(self, what: str, path: Path) -> None:
        do = f"restshape salvage {path} --out FILE.vtkhdf writes the frames that are good, if there are any"
        super().__init__(what, str(path), do)


def bad(path: Path, what: str) -> DamagedRecording:
    """The error of a file that is none of ours."""
    return DamagedRecording(f"this is no recording, or it is damaged: {what}", path)
