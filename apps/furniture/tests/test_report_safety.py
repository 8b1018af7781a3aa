"""A report makes the piece again, from the recording alone."""

import json
from pathlib import Path

import h5py
import numpy as np
import pytest
from restshape_apps.furniture import application

from restshape.cli.main import main


def header_of(path: Path) -> dict:
    with h5py.File(path) as file:
        return json.loads(bytes(file["restshape/header"][()]))


def put_header(path: Path, header: dict) -> None:
    with h5py.File(path, "r+") as file:
        del file["restshape/header"]
        del file["restshape"].attrs["header_checksum"]
        file["restshape/header"] = np.frombuffer(json.dumps(header).encode(), dtype=np.uint8)


@pytest.mark.parametrize("key", ["shape", "mesh"])
def test_a_report_reads_no_file_that_its_header_names(tmp_path, capsys, key):
    path, geometry = tmp_path / "bench.vtkhdf", tmp_path / "x.geo"
    assert main(["replay", str(application.folder / "scenes" / "bench.toml"), "--out", str(path)]) == 0
    geometry.write_text("Point(1) = {0, 0, 0};")
    values = {"format": "restshape-scene", "version": 1, "app": "plane", "mesh": {"size": 0.5}, "shape": {}}
    values |= {"material": {"steel": {"E": 2e11, "nu": 0.3}}, "effects": {"solid": {}}}
    values[key] = {"file": "x.geo"}
    put_header(path, {**header_of(path), "scene": "../../x.toml", "scene_values": values})
    capsys.readouterr()
    assert main(["report", str(path)]) == 2
    reported = capsys.readouterr().err
    assert f"{key}.file" in reported and "no file but the recording is read" in reported
