"""Whether two recordings hold the same bits, times left out."""

from __future__ import annotations

from hashlib import sha256

import numpy as np

from restshape.arrays import AnyArray
from restshape.comparison.result import is_time
from restshape.replay.recording.recording import Recording


def column_hashes(recording: Recording) -> dict[str, str]:
    """The hash of the bits of all frames by column, of `cells`, `points` and each field; times are left out."""
    found = {name: _hash([np.asarray(values)]) for name, values in recording.table.items() if not is_time(name)}
    frames = range(recording.n)
    found["cells"] = _hash([recording.cells(i) for i in frames])
    found["points"] = _hash([recording.points(i) for i in frames])
    for name, info in recording.fields.items():
        found[f"field {name}"] = _hash([recording.field(i, name) for i in frames if i >= info.first_frame])
    return found


def result_hash(hashes: dict[str, str]) -> str:
    """One hash of all columns and fields."""
    return f"sha256:{sha256(repr(sorted(hashes.items())).encode()).hexdigest()}"


def _hash(arrays: list[AnyArray]) -> str:
    """The hash of arrays: of their types, shapes and bytes; of texts their characters."""
    found = sha256()
    for array in arrays:
        plain = np.array([str(one) for one in array.tolist()]) if array.dtype.kind == "O" else array
        found.update(f"{plain.dtype.str} {plain.shape}".encode())
        found.update(np.ascontiguousarray(plain).tobytes())
    return found.hexdigest()
