"""Areas of large meshes from their border, beside sums over cells."""

import numpy as np
import pytest
from mesh_samples import SQUARE, polygon_outline

from restshape.mesh import mesh_area
from restshape.mesh.generate import generate
from restshape.mesh.mesh import Mesh
from restshape.mesh.mesh_area import MeshArea
from restshape.mesh.quality import areas
from restshape.scene.model import MeshSpec, ShapeSpec
from restshape.shape.build import outline_from_spec


class Counted:
    """The sum over cells, and how often it was asked for."""

    def __init__(self) -> None:
        self.calls = 0

    def total_area(self, X: np.ndarray, cells: np.ndarray) -> float:
        self.calls += 1
        return float(areas(X, cells).sum())


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> Counted:
    """Meshes of any size are large, and sums over cells counted."""
    found = Counted()
    monkeypatch.setattr(mesh_area, "MANY", 1)
    monkeypatch.setattr(mesh_area, "_kernels", found)
    return found


def holed() -> Mesh:
    """A square with a square hole."""
    hole = [[0.3, 0.3], [0.6, 0.3], [0.6, 0.6], [0.3, 0.6]]
    return generate(polygon_outline(SQUARE, holes={"window": hole}), MeshSpec(size=0.1))


def moved(mesh: Mesh, by: float) -> float:
    """The sum over the cells of a mesh, whose nodes are moved before."""
    mesh.X += by * np.sin(3.0 * mesh.X[:, ::-1])
    return float(areas(mesh.X, mesh.cells).sum())


def test_a_mesh_that_moves_is_measured_by_its_border(counted):
    mesh, area = holed(), MeshArea()
    for by in (0.0, 0.02, -0.03):
        exact = moved(mesh, by)
        assert area(mesh) == pytest.approx(exact, rel=1e-13)
    assert counted.calls == 1


def test_cells_are_read_again_after_flips(counted):
    mesh, area = holed(), MeshArea()
    area(mesh)
    mesh.topology -= 1
    area(mesh)
    assert counted.calls == 2


def test_a_small_mesh_is_measured_by_its_cells():
    mesh = holed()
    assert MeshArea()(mesh) == pytest.approx(moved(mesh, 0.0), rel=1e-14)


def test_lines_of_regions_are_no_border(counted):
    shape = {
        "vertices": {"a": [0, 0], "b": [2, 0], "c": [2, 1], "d": [0, 1]},
        "edges": {
            "low": {"line": ["a", "b"]},
            "r": {"line": ["b", "c"]},
            "t": {"line": ["c", "d"]},
            "l": {"line": ["d", "a"]},
        },
        "outline": ["low", "r", "t", "l"],
        "regions": {"disc": {"circle": {"center": [0.6, 0.5], "radius": 0.25}}},
    }
    mesh, area = generate(outline_from_spec(ShapeSpec.model_validate(shape)), MeshSpec(size=0.2)), MeshArea()
    for by in (0.0, 0.02):
        exact = moved(mesh, by)
        assert area(mesh) == pytest.approx(exact, rel=1e-13)


def test_a_border_with_a_gap_is_not_trusted(counted):
    mesh, area = generate(polygon_outline(SQUARE), MeshSpec(size=0.3)), MeshArea()
    mesh.facets = mesh.facets[1:]
    assert area(mesh) == pytest.approx(moved(mesh, 0.0), rel=1e-14)
