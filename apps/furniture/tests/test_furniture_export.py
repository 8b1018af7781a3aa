"""Exports of furniture: the planks of a recording as meshes and surfaces, and why there is no drawing."""

import numpy as np
import pytest
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.session.plank_session import PlankSession
from restshape_apps.furniture.shape.plank_scene import piece_of
from scipy.spatial import ConvexHull

from restshape.application import applications
from restshape.cli.main import main
from restshape.replay.recording.recording import Recording
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


@pytest.mark.slow
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


@pytest.mark.parametrize("name", ["table", "bench"])
def test_an_edited_piece_is_exported_as_a_scene(tmp_path, name) -> None:
    folder = applications()["furniture"].folder
    scene, script = (folder / part / f"{name}.{end}" for part, end in (("scenes", "toml"), ("edits", "jsonl")))
    out = tmp_path / "edited.toml"
    assert main(["export", str(scene), "--edits", str(script), "--as", "toml", "--out", str(out)]) == 0
    read = load_scene(scene)
    *_, last = PlankSession(read, load_script(script, read)).frames()
    piece, again = last.design.furniture.moved(last.gamma), piece_of(load_scene(out))
    assert [plank.name for plank in again.planks] == [plank.name for plank in piece.planks]
    for one, other in zip(piece.planks, again.planks):
        assert other.corners() == pytest.approx(one.corners(), abs=1e-9) and other.wood == one.wood
    assert (again.joints, again.feet) == (piece.joints, piece.feet)
    assert Furniture(again).test().words == Furniture(piece).test().words


def test_what_names_a_deleted_plank_is_left_out_of_the_scene(tmp_path, capsys) -> None:
    bench = (applications()["furniture"].folder / "scenes" / "bench.toml").read_text()
    named = '[effects.guidance]\nkeep = ["level", "rail level"]\n'
    named += '[quantities]\nrail = { length = "x", at = "rail" }\nseat = { length = "x", at = "seat" }\n'
    scene, script, out = tmp_path / "bench.toml", tmp_path / "bench.jsonl", tmp_path / "edited.toml"
    scene.write_text(bench + named)
    script.write_text(
        '{"format": "restshape-edits", "version": 1, "scene": "bench.toml", "units": "m"}\n'
        '{"t": 0.0, "do": "delete", "on": "rail"}\n'
    )
    assert main(["export", str(scene), "--edits", str(script), "--as", "toml", "--out", str(out)]) == 0
    assert "left out, for edits have deleted what it names: quantities.rail" in capsys.readouterr().out
    again = load_scene(out)
    assert list(again.quantities) == ["seat"] and again.effects["guidance"]["keep"] == ["level"]
