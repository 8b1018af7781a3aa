"""Generated meshes against the geometry of their outlines."""

import os
import signal
import threading

import numpy as np
import pytest
from mesh_samples import qualities

from restshape.errors import ReplayProblem, UserError
from restshape.mesh.generate import generate
from restshape.mesh.mesh import Mesh
from restshape.scene.model import MeshSpec, ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.outline import Outline


def polygon(corners, **more) -> Outline:
    """A polygon whose edges are e0, e1, ... between the corners p0, p1, ..."""
    n = len(corners)
    return outline_from_spec(
        ShapeSpec(
            vertices={f"p{i}": list(p) for i, p in enumerate(corners)},
            edges={f"e{i}": {"line": [f"p{i}", f"p{(i + 1) % n}"]} for i in range(n)},
            outline=[f"e{i}" for i in range(n)],
            **more,
        )
    )


def plate(centre=0.7, **more) -> Outline:
    """The 2 x 1 plate with a hole of radius 0.2."""
    holes = {"hole": {"circle": {"center": [centre, 0.5], "radius": 0.2}}}
    return polygon([(0, 0), (2, 0), (2, 1), (0, 1)], holes=holes, **more)


def bent() -> Outline:
    """A shape with a spline, an arc and a polyline."""
    return outline_from_spec(
        ShapeSpec(
            vertices={"a": [0, 0], "b": [1, 0], "c": [1, 1]},
            edges={
                "low": {"spline": ["a", "b"], "through": [[0.3, -0.15], [0.6, 0.1]]},
                "right": {"arc": ["b", "c"], "bulge": 0.3},
                "back": {"polyline": ["c", "a"], "through": [[0.5, 1.2], [0.1, 0.5]]},
            },
            outline=["low", "right", "back"],
        )
    )


UNIT = [(0, 0), (1, 0), (1, 1), (0, 1)]
SHAPES = {
    "square": (lambda: polygon(UNIT), MeshSpec(size=0.1), 0.4),
    "one element": (lambda: polygon(UNIT), MeshSpec(size=5.0), 0.4),
    "strip": (lambda: polygon([(0, 0), (10, 0), (10, 0.05), (0, 0.05)]), MeshSpec(size=0.5), 0.4),
    "wedge of 17 degrees": (lambda: polygon([(0, 0), (2, 0), (2, 0.6)]), MeshSpec(size=0.1), 0.3),
    "L": (lambda: polygon([(0, 0), (1, 0), (1, 0.3), (0.3, 0.3), (0.3, 1), (0, 1)]), MeshSpec(size=0.07), 0.4),
    "plate": (plate, MeshSpec(size=0.045), 0.45),
    "hole close to an edge": (lambda: plate(0.205), MeshSpec(size=0.05), 0.4),
    "curves": (bent, MeshSpec(size=0.06), 0.4),
    "small sizes near entities": (plate, MeshSpec(size=0.1, near={"hole": 0.02, "p0": 0.01}), 0.4),
}


def doubled_areas(mesh: Mesh) -> np.ndarray:
    a, b, c = (mesh.X[mesh.cells[:, i]] for i in range(3))
    return np.cross(b - a, c - a)


@pytest.mark.parametrize("name", SHAPES)
def test_mesh_fills_its_outline(name):
    make, spec, worst = SHAPES[name]
    outline = make()
    mesh = generate(outline, spec)
    holes = sum(loop.kind == "hole" for loop in outline.loops)
    assert mesh.n_nodes - len(mesh.edge_nodes) + mesh.n_cells == 1 - holes
    assert doubled_areas(mesh).min() > 0
    assert qualities(mesh.X, mesh.cells).min() > worst
    # A chord of length h cuts off about h^3 / (12 r) from a bend of radius r.
    straight = all(edge.kind == "line" for edge in outline.edges)
    assert 0.5 * doubled_areas(mesh).sum() == pytest.approx(outline.area(), rel=1e-12 if straight else 0.01)


@pytest.mark.parametrize("name", SHAPES)
def test_facets_cover_each_edge_once_with_the_material_on_their_left(name):
    make, spec, _ = SHAPES[name]
    mesh = generate(make(), spec)
    outline = mesh.outline
    for i, edge in enumerate(outline.edges):
        chain = mesh.facets[mesh.facet_edge == i]
        ends = {int(mesh.vertex_node[edge.start]), int(mesh.vertex_node[edge.end])}
        first, after = set(chain[:, 0].tolist()), set(chain[:, 1].tolist())
        assert len(first) == len(chain) == len(after)
        assert first ^ after == ends
        length = np.linalg.norm(mesh.X[chain[:, 1]] - mesh.X[chain[:, 0]], axis=1).sum()
        assert length == pytest.approx(outline.length(i), rel=0.06 if edge.kind != "line" else 1e-12)
    count = np.bincount(mesh.cell_edges.ravel(), minlength=len(mesh.edge_nodes))
    assert {tuple(sorted(f)) for f in mesh.facets.tolist()} == set(map(tuple, mesh.edge_nodes[count == 1].tolist()))
    a, b = mesh.X[mesh.facets[:, 0]], mesh.X[mesh.facets[:, 1]]
    inside = mesh.X[mesh.cells[mesh.facet_cell]].mean(axis=1)
    assert np.cross(b - a, inside - a).min() > 0


@pytest.mark.parametrize("name", SHAPES)
def test_parameters_match_positions_and_vertices_are_nodes(name):
    make, spec, _ = SHAPES[name]
    mesh = generate(make(), spec)
    on_edge = np.flatnonzero(mesh.node_edge >= 0)
    assert set(on_edge.tolist()) == set(mesh.facets.ravel().tolist())
    for node in on_edge:
        at = mesh.outline.point(int(mesh.node_edge[node]), mesh.node_param[node])[0]
        assert np.allclose(mesh.X[node], at, atol=1e-14)
    named = mesh.outline.points[: len(mesh.outline.vertex_names)]
    assert np.array_equal(mesh.X[mesh.vertex_node], named)


def test_cell_edges_lie_opposite_to_the_corners():
    mesh = generate(plate(), MeshSpec(size=0.1))
    for corner in range(3):
        ends = np.sort(np.delete(mesh.cells, corner, axis=1), axis=1)
        assert np.array_equal(mesh.edge_nodes[mesh.cell_edges[:, corner]], ends)


def test_sizes_are_as_asked_for():
    mesh = generate(plate(), MeshSpec(size=0.1, near={"hole": 0.02, "p0": 0.01}))
    lengths = np.linalg.norm(np.diff(mesh.X[mesh.edge_nodes], axis=1)[:, 0], axis=1)
    middles = mesh.X[mesh.edge_nodes].mean(axis=1)
    from_hole = np.linalg.norm(middles - (0.7, 0.5), axis=1) - 0.2
    assert 0.012 < lengths[from_hole < 0.02].mean() < 0.024
    assert lengths[np.linalg.norm(middles, axis=1) < 0.02].mean() < 0.015
    away = (from_hole > 0.5) & (np.linalg.norm(middles, axis=1) > 0.5)
    assert 0.07 < lengths[away].mean() < 0.11


def test_a_region_in_near_is_fine_throughout():
    regions = {"patch": {"polygon": [[0.3, 0.3], [0.7, 0.3], [0.7, 0.7], [0.3, 0.7]]}}
    mesh = generate(polygon(UNIT, regions=regions), MeshSpec(size=0.2, near={"patch": 0.03}))
    per_cell = 0.16 / len(mesh.cells_of("patch"))
    assert 0.5 < per_cell / (np.sqrt(3) / 4 * 0.03**2) < 1.2


def test_default_size_gives_about_two_thousand_triangles():
    mesh = generate(polygon([(0, 0), (3, 0), (1, 1)]), MeshSpec())
    assert 1700 < mesh.n_cells < 2300


def test_narrow_place_is_meshed_finer_than_the_size():
    mesh = generate(plate(0.21), MeshSpec(size=0.1))
    lengths = np.linalg.norm(np.diff(mesh.X[mesh.edge_nodes], axis=1)[:, 0], axis=1)
    middles = mesh.X[mesh.edge_nodes].mean(axis=1)
    assert lengths[np.linalg.norm(middles - (0.005, 0.5), axis=1) < 0.02].max() < 0.03


REGIONS = {
    "disc": {"circle": {"center": [0.5, 0.5], "radius": 0.3}},
    "core": {"polygon": [[0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.6]]},
}


def test_regions_are_meshed_conforming():
    outline = polygon(UNIT, regions=REGIONS, points={"pin": [0.1, 0.15]})
    mesh = generate(outline, MeshSpec(size=0.05))
    areas = 0.5 * doubled_areas(mesh)
    assert areas[mesh.cells_of("core")].sum() == pytest.approx(0.04, rel=1e-12)
    assert areas[mesh.cells_of("disc")].sum() == pytest.approx(np.pi * 0.09 - 0.04, rel=0.01)
    assert areas.sum() == pytest.approx(1.0, rel=1e-12)
    assert np.array_equal(mesh.X[mesh.nodes_of("pin")], [[0.1, 0.15]])
    rows = mesh.facets_of("core")
    assert np.isin(mesh.facet_cell[rows], mesh.cells_of("core")).all()
    inside = mesh.X[mesh.nodes_of("core")]
    assert np.abs(inside - 0.5).max() == pytest.approx(0.1)


def test_a_region_may_share_edges_with_the_outline():
    corners = {"a": [0, 0], "b": [1, 0], "c": [2, 0], "d": [2, 1], "e": [1, 1], "f": [0, 1]}
    edges = {name: {"line": list(name)} for name in ("ab", "bc", "cd", "de", "ef", "fa", "be")}
    spec = ShapeSpec(
        vertices=corners,
        edges=edges,
        outline=["ab", "bc", "cd", "de", "ef", "fa"],
        regions={"left": {"loop": ["ab", "be", "ef", "fa"]}},
    )
    mesh = generate(outline_from_spec(spec), MeshSpec(size=0.2))
    assert 0.5 * doubled_areas(mesh)[mesh.cells_of("left")].sum() == pytest.approx(1.0, rel=1e-12)
    assert np.allclose(mesh.X[mesh.nodes_of("be"), 0], 1.0)


def test_entities_give_their_nodes_facets_and_cells():
    mesh = generate(plate(groups={"ends": ["e1", "e3"]}), MeshSpec(size=0.1))
    assert np.array_equal(mesh.nodes_of("e3"), np.flatnonzero(mesh.X[:, 0] == 0.0))
    assert set(mesh.X[mesh.nodes_of("ends"), 0].tolist()) == {0.0, 2.0}
    radius = np.linalg.norm(mesh.X[mesh.nodes_of("hole")] - (0.7, 0.5), axis=1)
    assert np.allclose(radius, 0.2) and len(radius) == len(mesh.facets_of("hole"))
    assert len(mesh.cells_of("all")) == mesh.n_cells and not len(mesh.cells_of("hole"))
    assert len(mesh.nodes_of("all")) == mesh.n_nodes
    assert len(mesh.nodes_of("outline")) == len(mesh.facets_of("outline"))
    with pytest.raises(UserError, match="hole"):
        mesh.nodes_of("hoel")


def test_same_input_gives_the_same_bits():
    first = generate(plate(), MeshSpec(size=0.06))
    generate(bent(), MeshSpec(size=0.05, near={"b": 0.01}))
    second = generate(plate(), MeshSpec(size=0.06))
    for name in ("X", "cells", "cell_edges", "facets", "facet_edge", "facet_cell", "node_edge", "node_param"):
        assert np.array_equal(getattr(first, name), getattr(second, name)), name


def test_shapes_that_cannot_be_meshed_are_refused():
    outline = polygon(UNIT, holes={"hole": {"circle": {"center": [0.5, 0.5], "radius": 0.2}}})
    crossing = outline.points.copy()
    crossing[4:] += (0.45, 0.0)
    with pytest.raises(ReplayProblem, match="cannot be meshed"):
        generate(outline.moved(crossing), MeshSpec(size=0.1))
    outside = polygon(UNIT, points={"pin": [0.5, 0.5]})
    moved = outside.points.copy()
    moved[outside.vertex_names.index("pin")] = (1.5, 0.5)
    with pytest.raises(ReplayProblem, match="cannot be meshed"):
        generate(outside.moved(moved), MeshSpec(size=0.1))
    bowtie = polygon(UNIT)
    with pytest.raises(ReplayProblem, match="cannot be meshed"):
        generate(bowtie.moved(bowtie.points[[0, 2, 1, 3]]), MeshSpec(size=0.1))
    # The mesher still works after each of them.
    assert generate(polygon(UNIT), MeshSpec(size=0.5)).n_cells > 0


def test_unknown_entity_in_near_is_the_users_mistake():
    with pytest.raises(UserError, match="hole"):
        generate(plate(), MeshSpec(size=0.1, near={"hoel": 0.01}))


def test_meshing_prints_nothing_and_leaves_ctrl_c_alone(capfd):
    handler = signal.getsignal(signal.SIGINT)
    generate(plate(), MeshSpec(size=0.1))
    assert signal.getsignal(signal.SIGINT) is handler
    assert capfd.readouterr() == ("", "")
    timer = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        for _ in range(10_000):
            generate(plate(), MeshSpec(size=0.1))


def resident() -> float:
    """Memory of this process [MB]."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


@pytest.mark.slow
def test_hundreds_of_meshes_do_not_grow_the_process():
    for i in range(300):
        if i == 60:
            before = resident()
        generate(plate(0.5 + 0.0027 * i), MeshSpec(size=0.2))
    assert resident() - before < 1.2
