"""Exports of furniture: the planks of a recording as meshes and surfaces, and why there is no drawing."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from restshape.application import applications
from restshape.cli.main import main
from restshape.replay.recording import Recording

ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def test_the_surface_of_planks_holds_their_volume(tmp_path, capsys):
    scene, recorded = applications()["furniture"].folder / "scenes" / "table.toml", tmp_path / "table.vtkhdf"
    assert main(["replay", str(scene), "--out", str(recorded)]) == 0
    for kind in ("stl", "vtu", "csv"):
        assert main(["export", str(recorded), "--as", kind]) == 0
    corners = np.frombuffer((tmp_path / "table.stl").read_bytes()[84:], ROW)["corners"].astype(float)
    found = float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))) / 6.0
    with Recording(recorded) as recording:
        points, cells = recording.mesh(0)
        assert len(corners) == 12 * len(cells)
    assert found == pytest.approx(1e9 * sum(ConvexHull(points[cell]).volume for cell in cells), rel=1e-5)
    capsys.readouterr()
    assert main(["export", str(recorded), "--as", "dxf"]) == 2
    assert "has no outline" in capsys.readouterr().err
