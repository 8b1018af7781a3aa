"""Recordings and scenes as version 0.1 wrote them, for tests of any application."""

import json
import zlib
from pathlib import Path

import h5py
import numpy as np

from restshape.replay.columns import ALIASES

KEYS = {"max": "limit", "min": "at_least", "reduce": "take", "reference": "exact"}
"""Old names of keys of quantities by those of today."""
SCENE = """
format = "restshape-scene"
version = 1
app = "plane"
[shape]
outline = ["bottom", "right", "top", "left"]
vertices = { a = [0, 0], b = [1, 0], c = [1, 1], d = [0, 1] }
edges.bottom = { line = ["a", "b"] }
edges.right = { line = ["b", "c"] }
edges.top = { line = ["c", "d"] }
edges.left = { line = ["d", "a"] }
[material.m]
E = 1e9
nu = 0.3
thickness = 1
[supports.wall]
on = "left"
fix = ["x", "y"]
[loads.pull]
on = "right"
force = [1e3, 0]
[mesh]
size = 0.4
[quantities]
"""
"""A square that is pulled; quantities are to follow."""


def make_old(path: Path, **kinds: str) -> None:
    """Gives columns, fields and keys of quantities of a recording the names of version 0.1, which recorded no limits.

    Args:
        path: of the recording.
        kinds: old names of kinds of quantities by those of today.
    """
    with h5py.File(path, "r+") as file:
        own = file["restshape"]
        _replace(own, "table", _renamed_columns(own["table"][()]), maxshape=(None,), chunks=True)
        for group in ("PointData", "CellData"):
            for place in (file["VTKHDF"][group], file[f"VTKHDF/Steps/{group}Offsets"]):
                for name in [name for name in place if name in ALIASES]:
                    place.move(name, ALIASES[name])
        header = json.loads(bytes(own["header"][()]))
        del header["limits"]
        quantities = header["scene_values"].get("quantities", {})
        for name, spec in quantities.items():
            quantities[name] = {(KEYS | kinds).get(key, key): value for key, value in spec.items()}
        data = json.dumps(header).encode()
        _replace(own, "header", np.frombuffer(data, dtype=np.uint8))
        own.attrs["header_checksum"] = zlib.crc32(data)


def _renamed_columns(rows: np.ndarray) -> np.ndarray:
    rows.dtype.names = tuple(ALIASES.get(name, name) for name in rows.dtype.names)
    return rows


def _replace(group: h5py.Group, name: str, data: np.ndarray, **options: object) -> None:
    attributes = dict(group[name].attrs)
    del group[name]
    group.create_dataset(name, data=data, **options).attrs.update(attributes)
