"""Pattern beside drape: strains against closed forms, seams on both, textures that are read back."""

import meshio
import numpy as np
import pytest
from cloths_recorded import COLUMNS
from PIL import Image
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOGeometry import vtkOBJReader
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

from restshape.cli.main import main
from restshape.export.frame_mesh import mesh_of_shape
from restshape.physics.cloth.pictures.drawn_seams import drawn_seams
from restshape.physics.cloth.pictures.membrane_stretch import grain_angles, stretches
from restshape.physics.cloth.pictures.pattern_beside_drape import strain_rows
from restshape.replay.recording.recorder import Recorder
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec
from restshape.shape.patterns.seam_parts import COLOURS

SCENE = """
format = "restshape-scene"
version = 1
app = "couture"
[panels.front]
outline = ["hem", "side", "top", "left"]
grain = "30 deg"
[panels.front.vertices]
a = [0, 0]
b = [0.3, 0]
c = [0.3, 0.4]
d = [0, 0.4]
[panels.front.edges]
hem = { line = ["a", "b"] }
side = { line = ["b", "c"] }
top = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[panels.back]
outline = ["up", "right", "tip"]
angle = "25 deg"
[panels.back.vertices]
a = [0, 0]
b = [0, 0.4]
c = [0.2, 0.2]
[panels.back.edges]
up = { line = ["b", "a"] }
right = { line = ["a", "c"] }
tip = { line = ["c", "b"] }
[seams.long]
from = "front.side"
to = "back.up"
[seams.dart]
from = "back.right"
to = "back.tip"
[supports.pin]
on = "front.top"
fix = ["x", "y", "z"]
[material.cloth]
name = "denim"
grain = "10 deg"
[effects.gravity]
[mesh]
size = "60 mm"
"""
STRETCH = np.array([[1.10, 0.02], [-0.03, 0.95], [0.04, 0.0]])
"""Gradient of the recorded deformation."""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A recording of two panels that one linear map has deformed; scene and mesh."""
    folder = tmp_path_factory.mktemp("recorded")
    (folder / "two.toml").write_text(SCENE)
    scene = load_scene(folder / "two.toml")
    outline = outline_from_spec(scene.shape)
    mesh = mesh_of_shape(scene, outline)
    moved = mesh.X @ STRETCH.T - np.column_stack([mesh.X, np.zeros(len(mesh.X))])
    head = {"title": "two", "app": "couture", "scene_values": scene.raw, "scene": "two.toml"}
    row = {"index": 0, "t": 0.0, "do": "", "level": 3, "iterations": 7, "ms": 1.0, "residual": 5e-5, "converged": 1}
    with Recorder.start(folder / "two.vtkhdf", head, COLUMNS) as recorder:
        recorder.topology(mesh.cells)
        fields = {"displacement": moved}, {"tension": np.ones(len(mesh.cells))}
        recorder.frame(0.0, mesh.X, *fields, row | {"tangent_positive_definite": 1})
    return folder / "two.vtkhdf", scene, outline, mesh


def test_strains_are_lengths_along_the_grain(recorded):
    _, _, _, mesh = recorded
    angle = 0.4
    found = stretches(mesh.X, mesh.X @ STRETCH.T, mesh.cells, np.full(len(mesh.cells), angle))
    along = np.array([np.cos(angle), np.sin(angle)])
    assert found["warp"] == pytest.approx(np.linalg.norm(STRETCH @ along) - 1.0, abs=1e-12)
    across = np.array([-np.sin(angle), np.cos(angle)])
    assert found["weft"] == pytest.approx(np.linalg.norm(STRETCH @ across) - 1.0, abs=1e-12)
    assert found["warp"].min() > 0.0 > found["weft"].max()


def test_the_grain_is_that_of_the_panel_turned_with_it(recorded):
    _, scene, outline, mesh = recorded
    found = np.degrees(grain_angles(scene, outline, mesh.X[mesh.cells].mean(axis=1)))
    a, b, c = np.moveaxis(mesh.X[mesh.cells], 1, 0)
    area = 0.5 * np.cross(b - a, c - a)
    own, of_material = (area[np.abs(found - angle) < 1e-9].sum() for angle in (30.0, 10.0 + 25.0))
    assert (own, of_material) == (pytest.approx(0.3 * 0.4), pytest.approx(0.5 * 0.4 * 0.2))


def test_seams_lie_on_sides_of_the_mesh(recorded):
    _, scene, outline, mesh = recorded
    long, dart = drawn_seams(scene, outline, mesh.X, mesh.cells)
    lengths = [
        float(np.linalg.norm(mesh.X[seam.sides[:, 1]] - mesh.X[seam.sides[:, 0]], axis=1).sum())
        for seam in (long, dart)
    ]
    assert lengths == pytest.approx([0.8, 2.0 * 0.08**0.5], rel=1e-9)
    assert (long.colour, dart.colour) == COLOURS[:2]
    assert len(long.names) == 2 and len(dart.names) == 1, "both sides of a dart have one name"


@pytest.mark.parametrize("size", ["90 mm", "20 mm"])
def test_seams_on_lines_within_a_panel_lie_on_sides_of_the_mesh(tmp_path, size):
    within = "[panels.front.regions]\nplace = { polygon = [[0.1, 0.1], [0.2, 0.1], [0.2, 0.3], [0.1, 0.3]] }\n"
    text = SCENE.replace("[panels.back]", f"{within}[panels.back]").replace('"60 mm"', f'"{size}"')
    text = text.replace('to = "back.up"', 'to = ["front.place.1", "front.place.2"]')
    (tmp_path / "pocket.toml").write_text(text)
    scene = load_scene(tmp_path / "pocket.toml")
    outline = outline_from_spec(scene.shape)
    mesh = mesh_of_shape(scene, outline)
    seam, _ = drawn_seams(scene, outline, mesh.X, mesh.cells)
    length = float(np.linalg.norm(mesh.X[seam.sides[:, 1]] - mesh.X[seam.sides[:, 0]], axis=1).sum())
    assert length == pytest.approx(0.4 + 0.1 + 0.2, rel=1e-9)
    assert [name.outward.tolist() for name in seam.names] == [[1.0, 0.0], [1.0, 0.0]]


@pytest.mark.parametrize("what", ["strain", "pattern"])
def test_a_picture_has_the_width_and_the_colours_of_seams(recorded, tmp_path, what):
    out = tmp_path / "a.png"
    assert main(["drapes", str(recorded[0]), "--show", what, "--width", "600", "--out", str(out)]) == 0
    with Image.open(out) as image:
        assert image.size[0] == 600
        colours = {tuple(int(one[k : k + 2], 16) for k in (1, 3, 5)) for one in COLOURS[:2]}
        assert colours <= set(map(tuple, np.asarray(image.convert("RGB")).reshape(-1, 3).tolist()))


def test_a_width_without_a_pattern_is_refused(recorded, tmp_path, capsys):
    assert main(["drapes", str(recorded[0]), "--width", "600", "--out", str(tmp_path / "a.png")]) == 2
    assert "--width 600" in capsys.readouterr().err


def test_textures_are_places_in_the_pattern(recorded, tmp_path):
    path, _, _, mesh = recorded
    for kind in ("obj", "vtu"):
        assert main(["export", str(path), "--as", kind, "--out", str(tmp_path / f"a.{kind}")]) == 0
    low, size = mesh.X.min(axis=0), float(np.ptp(mesh.X, axis=0).max())
    space = mesh.X @ STRETCH.T
    reader = vtkOBJReader()
    reader.SetFileName(str(tmp_path / "a.obj"))
    reader.Update()
    surface = reader.GetOutput()
    assert vtk_to_numpy(surface.GetPoints().GetData()) == pytest.approx(space, abs=1e-6)
    assert vtk_to_numpy(surface.GetPointData().GetTCoords()) == pytest.approx((mesh.X - low) / size, abs=1e-6)
    assert surface.GetNumberOfPolys() == len(mesh.cells)
    grid = vtkXMLUnstructuredGridReader()
    grid.SetFileName(str(tmp_path / "a.vtu"))
    grid.Update()
    coordinates = grid.GetOutput().GetPointData().GetTCoords()
    assert coordinates.GetName() == "texture"
    assert size * vtk_to_numpy(coordinates) + low == pytest.approx(mesh.X, abs=1e-12)
    assert meshio.read(tmp_path / "a.vtu").points == pytest.approx(space, abs=1e-12)
    assert f"/ {size:.9g} m" in (tmp_path / "a.obj").read_text().splitlines()[0]


def test_colours_end_at_the_strain_that_there_is():
    """Of stiff cloth, far below the bound: the largest strain has the colour of the end, and no bound is drawn."""
    strains = np.linspace(-4e-4, 4e-4, 101)
    rows = strain_rows({"warp": strains}, 0.05)
    assert rows[0].end == pytest.approx(4e-4, rel=0.02)
    assert not rows[0].bound_shown and strain_rows({"warp": 300.0 * strains}, 0.05)[0].bound_shown
    assert strain_rows({"warp": 0.0 * strains}, 0.05)[0].end == 0.05
