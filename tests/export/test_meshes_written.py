"""Meshes, fields and surfaces of a recorded frame: as recorded, closed, and of the right volume."""

import csv
import json
from dataclasses import replace

import meshio
import numpy as np
import pytest
from cloths import BALL, CONTACT, write_cloth
from small_scenes import drag, plate, write_scene, write_script

from restshape.cli.main import main
from restshape.export.formats import write_mesh
from restshape.export.frame_mesh import FrameMesh
from restshape.export.stl_surface import surface
from restshape.mesh.importer import read_mesh
from restshape.replay.recording.recording import Recording

ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
FAR = [(0.55, 0.5), (2.0, 0.5), (0.6, 0.5)]
"""The way of a hand whose second place is outside of the plate."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a recording of a plate 10 mm thick, whose second moved frame is refused."""
    folder = tmp_path_factory.mktemp("recorded")
    text = plate(0.2)
    assert "thickness = 0.01\n" in text
    scene = write_scene(folder, text, "plate.toml")
    script = write_script(folder, drag("window", (0.5, 0.5), FAR))
    assert main(["replay", str(scene), "--edits", str(script), "--out", str(folder / "plate.vtkhdf")]) == 0
    return folder


@pytest.fixture
def recording(folder):
    with Recording(folder / "plate.vtkhdf") as recording:
        yield recording


def export(folder, *words):
    """The result of an export of the recording, for programs."""
    numbers = folder / "numbers.json"
    assert main(["export", str(folder / "plate.vtkhdf"), *words, "--json", str(numbers)]) == 0
    return json.loads(numbers.read_text())


def triangles(path) -> np.ndarray:
    """The corners (m, 3, 3) [mm] in a binary STL file."""
    data = path.read_bytes()
    rows = np.frombuffer(data[84:], ROW)
    assert int.from_bytes(data[80:84], "little") == len(rows)
    normals = np.cross(rows["corners"][:, 1] - rows["corners"][:, 0], rows["corners"][:, 2] - rows["corners"][:, 0])
    np.testing.assert_allclose(normals / np.linalg.norm(normals, axis=1)[:, None], rows["normal"], atol=1e-3)
    return rows["corners"].astype(float)


def assert_closed(corners: np.ndarray) -> None:
    """Each side belongs to two triangles, which pass it in opposite directions."""
    _, places = np.unique(corners.reshape(-1, 3).round(5), axis=0, return_inverse=True)
    cells = places.reshape(-1, 3)
    sides = cells[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    assert {tuple(side) for side in sides} == {tuple(side[::-1]) for side in sides}
    assert len(np.unique(sides, axis=0)) == len(sides)


def volume(corners: np.ndarray) -> float:
    """By Gauss's theorem."""
    return float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))) / 6.0


@pytest.mark.slow
def test_an_stl_is_closed_and_has_the_volume_of_the_mesh(folder, recording):
    export(folder, "--as", "stl")
    corners = triangles(folder / "plate.stl")
    assert_closed(corners)
    assert volume(corners) == pytest.approx(1e9 * 0.01 * recording.table["mesh_area"][-1], rel=1e-6)
    assert corners[:, :, 2].min() == 0.0 and corners[:, :, 2].max() == pytest.approx(10.0)


@pytest.mark.parametrize("order", [1, 2])
def test_the_border_of_tetrahedra_is_closed(order):
    X = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 2.0)])
    corner = {(x, y, z): 4 * x + 2 * y + z for x in (0, 1) for y in (0, 1) for z in (0, 1)}
    ways = [(0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)]
    cells = []
    for k, way in enumerate(ways):
        chain = np.cumsum([np.zeros(3, int), *np.eye(3, dtype=int)[list(way)]], axis=0)
        found = [corner[tuple(place)] for place in chain]
        cells.append(found if k < 3 else [found[0], found[2], found[1], found[3]])
    wide = np.column_stack([cells, np.zeros((6, 6), int)]) if order == 2 else np.array(cells)
    corners = surface(FrameMesh(X, wide, "tetra10" if order == 2 else "tetra"), None)
    assert len(corners) == 12 and volume(corners) == pytest.approx(2.0)
    assert_closed(corners)


def test_a_vtu_holds_mesh_and_fields_and_is_read_back(folder, recording):
    export(folder, "--as", "vtu", "--frame", "1")
    found = meshio.read(folder / "plate.vtu")
    X, cells = recording.mesh(1)
    np.testing.assert_array_equal(found.points[:, :2], X)
    np.testing.assert_array_equal(found.cells[0].data, cells)
    np.testing.assert_array_equal(found.point_data["displacement"][:, :2], recording.field(1, "displacement"))
    assert set(found.point_data) | set(found.cell_data) == set(recording.fields)


def test_the_mesh_of_a_scene_is_read_back_with_the_area_of_its_shape(folder):
    assert main(["export", str(folder / "plate.toml"), "--as", "vtu", "--out", str(folder / "mesh.vtu")]) == 0
    # The hole is a polygon in the file, and is known to be a circle.
    assert read_mesh(folder / "mesh.vtu")[1].area() == pytest.approx(2.0 - np.pi * 0.15**2, rel=1e-9)


@pytest.mark.slow
def test_the_mesh_of_a_second_order_scene_is_that_of_its_first_frame(tmp_path):
    """And the surface has the middles of sides on the circle of the hole: it is a polygon of 16 sides, not 8."""
    scene = write_scene(tmp_path, plate(0.2).replace("order = 1", "order = 2"), "plate.toml")
    assert main(["replay", str(scene), "--out", str(tmp_path / "a.vtkhdf")]) == 0
    for kind in ("vtu", "stl", "csv"):
        assert main(["export", str(scene), "--as", kind, "--out", str(tmp_path / f"plate.{kind}")]) == 0
    found = meshio.read(tmp_path / "plate.vtu")
    with Recording(tmp_path / "a.vtkhdf") as recording:
        X, cells = recording.mesh(0)
    assert found.cells[0].type == "triangle6"
    np.testing.assert_array_equal(found.points[:, :2], X)
    np.testing.assert_array_equal(found.cells[0].data, cells)
    assert len((tmp_path / "plate.csv").read_text().splitlines()) == len(X) + 1
    corners = triangles(tmp_path / "plate.stl")
    assert_closed(corners)
    straight = 2.0 - 8 * 0.5 * 0.15**2 * np.sin(2 * np.pi / 8)
    halved = 2.0 - 16 * 0.5 * 0.15**2 * np.sin(2 * np.pi / 16)
    assert volume(corners) == pytest.approx(1e7 * halved, rel=1e-6) and halved < straight


def test_a_csv_has_a_row_a_node(folder, recording):
    export(folder, "--as", "csv", "--frame", "-1")
    with (folder / "plate.csv").open() as file:
        rows = list(csv.DictReader(file))
    moved = np.array([[float(row["displacement_x"]), float(row["displacement_y"])] for row in rows])
    np.testing.assert_array_equal(moved, recording.field(-1, "displacement"))
    np.testing.assert_array_equal([[float(row["x"]), float(row["y"])] for row in rows], recording.points(-1))


def test_a_csv_says_which_fields_have_values_a_cell(tmp_path):
    """As stresses of a body with regions, which jump between these."""
    mesh = FrameMesh(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), np.array([[0, 1, 2]]), "triangle")
    with_stress = replace(mesh, in_cells={"von_mises_in_cells": np.ones((1, 3))})
    (note,) = write_mesh("csv", with_stress, tmp_path / "a.csv")
    assert "von_mises_in_cells" in note and "vtu" in note
    assert write_mesh("csv", mesh, tmp_path / "b.csv") == write_mesh("vtu", with_stress, tmp_path / "a.vtu") == []


def test_a_refused_frame_shows_the_shape_before_it(folder, recording, capsys):
    (refused,) = (i for i, why in enumerate(recording.table["refused"]) if why)
    before, own, after = (export(folder, "--as", "svg", "--frame", str(refused + i)) for i in (-1, 0, 1))
    assert own["refused"] and not before["refused"] and own["area"] == before["area"]
    assert "this is the shape before it" in capsys.readouterr().out
    assert not after["refused"] and own["frames"] == recording.n


def test_a_solve_that_failed_keeps_the_shape_before_it(folder, monkeypatch):
    """A recording says which frames its replay refused: following its script without solves refuses them, too."""
    from restshape.export.edited_frame import frame_of_recording

    with Recording(folder / "plate.vtkhdf") as recording:
        last = recording.n - 1
        moved = frame_of_recording(recording, last).outline
        places = [i for i in range(recording.n) if recording.table["event"][i] == "drag"]
        recording.table["refused"][places[-1]] = "the solver has not converged"
        kept = frame_of_recording(recording, places[-1])
        assert kept.refused == "the solver has not converged"
        window = [float(shape.centroid(shape.entity("window"))[0]) for shape in (moved, kept.outline)]
    assert window[0] == pytest.approx(0.6) and window[1] == pytest.approx(0.55)


@pytest.mark.slow
def test_nothing_of_the_users_is_replaced(folder, capsys):
    (folder / "mine.dxf").write_text("mine")
    words = ["export", str(folder / "plate.vtkhdf"), "--as", "dxf", "--out", str(folder / "mine.dxf")]
    assert main(words) == 2
    assert "is not a file that restshape export wrote" in capsys.readouterr().err
    assert (folder / "mine.dxf").read_text() == "mine"
    for kind in ("toml", "dxf", "svg", "step", "stl", "vtu", "csv"):
        for _ in range(2):
            export(folder, "--as", kind, "--out", str(folder / f"own.{kind}"))
    assert not list(folder.glob("*.part*"))
    for words, why in [
        (["--frame", "99"], "the recording has"),
        (["--set", "title='x'"], "its own scene and edits"),
        (["--out", str(folder / "none" / "a.dxf")], "make its folder first"),
    ]:
        assert main(["export", str(folder / "plate.vtkhdf"), "--as", "dxf", *words]) == 2
        assert why in capsys.readouterr().err


@pytest.mark.slow
def test_cloth_is_flat_in_drawings_and_in_space_in_meshes(tmp_path, capsys):
    scene = write_cloth(tmp_path, BALL + CONTACT)
    recorded = tmp_path / "cloth.vtkhdf"
    assert main(["replay", str(scene), "--out", str(recorded)]) == 0
    for kind in ("stl", "svg", "vtu"):
        assert main(["export", str(recorded), "--as", kind, "--out", str(tmp_path / f"cloth.{kind}")]) == 0
    with Recording(recorded) as recording:
        space = recording.field(0, "displacement")
        space[:, :2] += recording.points(0)
        corners = triangles(tmp_path / "cloth.stl")
        np.testing.assert_allclose(corners, 1e3 * space[recording.cells(0)], rtol=1e-6, atol=1e-4)
        np.testing.assert_array_equal(meshio.read(tmp_path / "cloth.vtu").points, space)
    assert np.ptp(corners[:, :, 2]) > 1.0
