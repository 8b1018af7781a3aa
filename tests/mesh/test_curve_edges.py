"""How many mesh edges curves get: whole circles, arcs, splines, many holes, and what that leaves of the area."""

import numpy as np
import pytest
from test_nested import begin

from restshape.mesh.curve_edges import curve_edges
from restshape.mesh.generate import generate
from restshape.mesh.quality import areas
from restshape.scene.model import MeshSpec, ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.outline import Outline


def drilled(radii: list[float], bend: float | None = None) -> Outline:
    """A plate of 2 x 1 with round holes in a row; its upper edge is an arc of this angle."""
    corners = {"a": [0.0, 0.0], "b": [2.0, 0.0], "c": [2.0, 1.0], "d": [0.0, 1.0]}
    top = {"line": ["c", "d"]} if bend is None else {"arc": ["c", "d"], "bulge": float(np.tan(bend / 4.0))}
    at = (np.arange(len(radii)) + 0.5) * 2.0 / len(radii)
    return outline_from_spec(
        ShapeSpec(
            vertices=corners,
            edges={"ab": {"line": ["a", "b"]}, "bc": {"line": ["b", "c"]}, "cd": top, "da": {"line": ["d", "a"]}},
            outline=["ab", "bc", "cd", "da"],
            holes={
                f"h{i}": {"circle": {"center": [float(x), 0.5], "radius": r}} for i, (x, r) in enumerate(zip(at, radii))
            },
        )
    )


@pytest.mark.parametrize(("order", "edges"), [(None, 24), (1, 24), (2, 12)])
@pytest.mark.parametrize("radius", [0.3, 0.1, 0.02])
def test_a_hole_has_as_many_edges_whatever_its_size(order, edges, radius):
    outline, spec = drilled([radius]), MeshSpec(size=0.2, order=order)
    (found,) = curve_edges(outline, spec)
    assert found.name == "h0" and found.count >= edges
    assert found.count == edges or radius == 0.3
    assert found.turn <= 2.0 * np.pi / edges * 1.001
    mesh = generate(outline, spec)
    assert len(mesh.facets_of("h0")) == found.count


def test_the_mesh_misses_what_the_chords_cut_off():
    outline = drilled([0.1])
    mesh = generate(outline, MeshSpec(size=0.2))
    chords = 12.0 * 0.1**2 * np.sin(2.0 * np.pi / 24.0)
    assert areas(mesh.X, mesh.cells).sum() == pytest.approx(2.0 - chords, rel=1e-12)
    assert outline.area() == pytest.approx(2.0 - np.pi * 0.1**2, rel=1e-14)


def test_an_arc_gets_its_share():
    # 100 degrees are 6.7 times 15: seven edges, not six.
    (found,) = curve_edges(drilled([], np.radians(100.0)), MeshSpec(size=5.0))
    assert found.name == "outline" and found.count == 7


def test_a_number_in_the_scene_is_kept():
    (found,) = curve_edges(drilled([0.02]), MeshSpec(size=0.2, edges_per_circle=60))
    assert found.count == 60


def test_many_holes_at_most_double_the_triangles():
    outline, plain = drilled([0.015] * 40), drilled([])
    spec = MeshSpec(size=0.05)
    without = len(generate(plain, spec).cells)
    found = curve_edges(outline, spec)
    assert 8 <= max(one.count for one in found) < 24
    all_fine = generate(outline, spec.model_copy(update={"edges_per_circle": 24}))
    assert len(generate(outline, spec).cells) < 2.5 * without < len(all_fine.cells)


def test_the_finest_of_nested_meshes_has_them():
    mesh, _, _ = begin(levels=2, size=0.1)
    assert len(mesh.field_mesh.facets_of("window")) == 24
    assert mesh.area() == pytest.approx(areas(mesh.field_mesh.X, mesh.field_mesh.cells).sum(), rel=1e-13)
