"""Cutting and merging edges: the curve stays, names stay, groups and parents follow."""

import numpy as np
import pytest
from shape_scenes import plate

from restshape.errors import UserError
from restshape.shape import topology_edits


@pytest.mark.parametrize("edge", ["bottom", "right", "top", "left", "window.2"])
@pytest.mark.parametrize("s", [0.03, 0.5, 0.77])
def test_a_cut_keeps_the_curve(edge, s):
    before = plate()
    index = before.entity(edge).edges[0]
    after = topology_edits.insert(before, edge, "new", s=s)
    first, second = after.entity(edge).edges
    u = np.linspace(0.0, 1.0, 33)
    np.testing.assert_allclose(after.point(first, u), before.point(index, s * u), atol=1e-12)
    np.testing.assert_allclose(after.point(second, u), before.point(index, s + (1 - s) * u), atol=1e-12)
    assert after.area() == pytest.approx(before.area(), rel=1e-13)
    assert after.topology != before.topology


def test_a_spline_cut_again_and_again_keeps_its_curve():
    before = after = plate()
    random = np.random.default_rng(3)
    for i in range(6):
        at = before.point(2, random.uniform(0.02, 0.98))[0]
        after = topology_edits.insert(after, "top", f"new{i}", at=at)
    fine = before.point(2, np.linspace(0, 1, 20001))
    for e in after.entity("top").edges:
        for p in after.point(e, np.linspace(0, 1, 9)):
            k = np.hypot(*(fine - p).T).argmin()
            a, b = fine[max(k - 1, 0)], fine[min(k + 1, len(fine) - 1)]
            off = (b - a)[0] * (p - a)[1] - (b - a)[1] * (p - a)[0]
            assert abs(off) / np.hypot(*(b - a)) < 1e-8
    assert after.area() == pytest.approx(before.area(), abs=1e-12)


def test_a_vertex_comes_to_the_nearest_point():
    after = topology_edits.insert(plate(), "bottom", "new", at=np.array([0.7, 0.4]))
    np.testing.assert_allclose(after.points[after.entity("new").vertices[0]], [0.7, 0.0], atol=1e-15)
    hole = topology_edits.insert(plate(), "window.1", "new", at=np.array([0.5, 0.5]) + 3 * np.array([0.6, 0.8]))
    np.testing.assert_allclose(hole.points[hole.entity("new").vertices[0]], [0.62, 0.66], atol=1e-8)


def test_pieces_remember_their_parent():
    cut = topology_edits.insert(plate(), "bottom", "q", s=0.5)
    again = topology_edits.insert(cut, "bottom.2", "r", s=0.5)
    assert [edge.name for edge in again.edges if edge.parent == "bottom"] == ["bottom.1", "bottom.3", "bottom.4"]
    assert len(again.entity("bottom").edges) == 3
    grouped = topology_edits.insert(plate(), "window.1", "q", s=0.5)
    assert len(grouped.entity("pair").edges) == 8


def test_deleting_a_vertex_leaves_one_straight_edge():
    after = topology_edits.delete(plate(), "c")
    kept = after.edges[after.entity("right").edges[0]]
    assert (kept.kind, after.vertex_names[kept.start], after.vertex_names[kept.end]) == ("line", "b", "d")
    assert "top" not in after.names("edge") and len(after.loops[0].edges) == 3


def test_cut_and_merge_of_a_line_gives_the_line_back():
    before = plate()
    after = topology_edits.delete(topology_edits.insert(before, "bottom", "q", s=0.3), "q")
    assert after.area() == pytest.approx(before.area(), rel=1e-14)
    assert len(after.edges) == len(before.edges)
    assert after.entity("bottom").edges


@pytest.mark.parametrize("bulge", [0.3, -0.2, 1.5])
def test_cut_and_merge_of_an_arc_gives_the_arc_back(bulge):
    before = topology_edits.as_arc(plate(), 0, bulge)
    after = topology_edits.delete(topology_edits.insert(before, "bottom", "q", s=0.3), "q")
    assert after.area() == pytest.approx(before.area(), rel=1e-12)
    assert after.edges[after.entity("bottom").edges[0]].kind == "arc"


def test_a_circle_without_one_of_its_vertices_is_the_circle_and_unlike_arcs_become_a_line():
    before = plate()
    assert topology_edits.delete(before, "window.v1").area() == pytest.approx(before.area(), rel=1e-12)
    cut = topology_edits.insert(topology_edits.as_arc(plate(), 0, 0.3), "bottom", "q", s=0.5)
    bulges = cut.bulges.copy()
    bulges[cut.entity("bottom.2").edges[0]] *= 2.0
    unlike = topology_edits.delete(cut.moved(bulges=bulges), "q")
    assert unlike.area() == pytest.approx(plate().area(), rel=1e-12)


def test_a_hole_goes_with_its_edges_and_vertices():
    after = topology_edits.delete(plate(), "window")
    assert after.names("hole") == []
    assert not any(name.startswith("window") for name in (*after.vertex_names, *after.names("edge")))
    assert after.groups == {"pair": ("patch",)}
    assert after.area() - plate().area() == pytest.approx(np.pi * 0.04, rel=1e-12)


@pytest.mark.parametrize("on", ["bottom", "outline", "all", "pair", "probe"])
def test_nothing_else_can_be_deleted(on):
    with pytest.raises(UserError, match="cannot be deleted"):
        topology_edits.delete(plate(), on)


def test_only_lines_and_arcs_bend():
    with pytest.raises(UserError, match="spline"):
        topology_edits.as_arc(plate(), 2, 0.1)
    bent = topology_edits.as_arc(plate(), 0, np.tan(np.pi / 8))
    # A quarter turn over a chord of 2 has the radius sqrt 2.
    assert bent.area() - plate().area() == pytest.approx(np.pi / 2 - 1.0, rel=1e-12)
    assert bent.edges[0].kind == "arc"
