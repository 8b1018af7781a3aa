"""Nested meshes: areas, curves, ties to the outline, what is prolonged between levels, and a hand that moves them."""

import numpy as np
import pytest
from mesh_samples import SQUARE, holed_mesh, l_mesh, polygon_outline, qualities
from test_moving import Hand, check, plate

from restshape.errors import ReplayProblem, UserError
from restshape.mesh import moving
from restshape.mesh.generate import generate
from restshape.mesh.mesh import Mesh, edges_of_cells
from restshape.mesh.moving import MovingMesh
from restshape.mesh.nested import NestedMesh, refine
from restshape.mesh.quality import areas
from restshape.mesh.transfer import transfer
from restshape.scene.model import MeshSpec, ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.hand import gesture as gestures
from restshape.shape.outline import Outline

A = np.array([[1.0, -2.0, 0.3], [0.5, 3.0, -1.0]])


def curved_outline() -> Outline:
    """An arc, a spline, and a polyline that bends too little for nodes at its corners; a round region."""
    shape = {
        "vertices": {"a": [0, 0], "b": [2, 0], "c": [1.8, 1.2], "d": [0, 1]},
        "edges": {
            "low": {"polyline": ["a", "b"], "through": [[0.7, 0.08], [1.3, 0.1]]},
            "right": {"arc": ["b", "c"], "bulge": 0.4},
            "top": {"spline": ["c", "d"], "through": [[1.2, 0.9], [0.6, 1.15]]},
            "left": {"line": ["d", "a"]},
        },
        "outline": ["low", "right", "top", "left"],
        "regions": {"disc": {"circle": {"center": [0.6, 0.5], "radius": 0.25}}},
    }
    return outline_from_spec(ShapeSpec.model_validate(shape))


def fault(mesh: Mesh) -> str:
    """What is wrong with the ties of a mesh, reported from its cells, its nodes and its outline alone."""
    nodes, _ = edges_of_cells(mesh.cells, len(mesh.X))
    if areas(mesh.X, mesh.cells).min() <= 0:
        return "inverted"
    holes = sum(loop.kind == "hole" for loop in mesh.outline.loops)
    if len(mesh.X) - len(nodes) + len(mesh.cells) != 1 - holes:
        return "Euler's characteristic"
    for node in np.flatnonzero(mesh.node_edge >= 0):
        at = mesh.outline.point(int(mesh.node_edge[node]), mesh.node_param[node])[0]
        if np.abs(mesh.X[node] - at).max() > 1e-13:
            return f"node {node} is not where its parameter says"
    if np.abs(mesh.X[mesh.vertex_node] - mesh.outline.points[: len(mesh.vertex_node)]).max() > 1e-13:
        return "a vertex"
    sides = {(int(c[i]), int(c[i - 2])): j for j, c in enumerate(mesh.cells) for i in range(3)}
    if [sides.get(tuple(pair)) for pair in mesh.facets.tolist()] != mesh.facet_cell.tolist():
        return "a facet's cell"
    return ""


@pytest.mark.parametrize("make", [l_mesh, holed_mesh, lambda: generate(curved_outline(), MeshSpec(size=0.2))])
def test_each_triangle_becomes_four_with_all_ties(make):
    mesh = make()
    step = refine(mesh)
    fine = step.mesh
    assert fault(fine) == ""
    assert len(fine.cells) == 4 * len(mesh.cells) and len(fine.facets) == 2 * len(mesh.facets)
    assert len(fine.X) == len(mesh.X) + len(mesh.edge_nodes)
    assert np.array_equal(fine.X[step.corner_number], mesh.X)
    for name in ("outline", "all", *[loop.name for loop in mesh.outline.loops]):
        assert np.isin(step.corner_number[mesh.nodes_of(name)], fine.nodes_of(name)).all()
        assert len(fine.cells_of(name)) == 4 * len(mesh.cells_of(name))
        assert len(fine.facets_of(name)) == 2 * len(mesh.facets_of(name))
    np.testing.assert_array_equal(step.corner_number[mesh.cells[:, 1]], fine.cells[step.children[:, 1], 1])


@pytest.mark.parametrize("mesh", [l_mesh(), holed_mesh()], ids=["L", "holed"])
def test_straight_sides_keep_areas_and_shapes(mesh):
    fine = NestedMesh(mesh, 3)
    whole = areas(mesh.X, mesh.cells)
    np.testing.assert_allclose(areas(fine.finest.X, fine.finest.cells), np.repeat(whole / 16, 16), rtol=1e-11)
    wanted = np.repeat(qualities(mesh.X, mesh.cells), 16)
    np.testing.assert_allclose(qualities(fine.finest.X, fine.finest.cells), wanted, rtol=1e-11)
    assert [len(m.cells) for m in fine.meshes] == [len(mesh.cells), 4 * len(mesh.cells), 16 * len(mesh.cells)]
    assert fine.finest.hierarchy is fine and fine.meshes[1].hierarchy is None


def test_round_holes_stay_round():
    nested = NestedMesh(generate(plate(0.3, 0.5), MeshSpec(size=0.3)), 4)
    found = []
    for mesh in nested.meshes:
        rim = mesh.nodes_of("window")
        np.testing.assert_allclose(np.linalg.norm(mesh.X[rim] - [0.5, 0.5], axis=1), 0.3, rtol=1e-12)
        half = np.pi / len(rim)
        assert areas(mesh.X, mesh.cells).sum() == pytest.approx(2 - 0.09 * len(rim) * np.sin(half) * np.cos(half))
        found.append(2 - 0.09 * np.pi - areas(mesh.X, mesh.cells).sum())
    # A polygon's area misses that of its circle by the square of its sides.
    np.testing.assert_allclose(np.divide(found[:-1], found[1:]), 4.0, rtol=0.05)


def test_a_bent_side_that_spoils_its_triangles_stays_straight_on_all_levels():
    """A flat triangle under an arc that bulges into it by a fifth of the chord, which is more than its height."""
    shape = {
        "vertices": {"a": [0, 0], "b": [1, 0], "c": [0.5, 0.15]},
        "edges": {"arc": {"arc": ["a", "b"], "bulge": -0.4}, "r": {"line": ["b", "c"]}, "l": {"line": ["c", "a"]}},
        "outline": ["arc", "r", "l"],
    }
    outline = outline_from_spec(ShapeSpec.model_validate(shape))
    mesh = Mesh.build(
        outline.points, np.array([[0, 1, 2]]), outline, facets=np.array([[0, 1], [1, 2], [2, 0]]),
        facet_edge=np.arange(3), node_edge=np.array([0, 0, 1]), node_param=np.array([0.0, 1.0, 1.0]),
        vertex_node=np.arange(3),
    )  # fmt: skip
    nested = NestedMesh(mesh, 3)
    np.testing.assert_allclose(areas(nested.finest.X, nested.finest.cells), 0.075 / 16, rtol=1e-12)
    assert nested.steps[0].straight.tolist() == [True, False, False] and nested.follow() == 0
    kept = NestedMesh(mesh, 2, [np.zeros(3, dtype=bool)])
    assert kept.follow() == 1 and areas(kept.finest.X, kept.finest.cells).min() < 0


@pytest.mark.parametrize("ranks", [2, 3])
def test_nodes_are_numbered_rank_by_rank(ranks):
    spec = MeshSpec(size=0.1)
    nested, one = (NestedMesh(generate(plate(), spec, ranks=r), 3) for r in (ranks, 1))
    for coarse, step in zip(nested.meshes, nested.steps):
        fine = step.mesh
        numbers = np.concatenate([step.corner_number, step.side_number])
        assert np.array_equal(np.sort(numbers), np.arange(len(fine.X))) and fine.node_offsets[-1] == len(fine.X)
        owner = np.searchsorted(fine.node_offsets, np.arange(len(fine.X)), side="right") - 1
        parent_owner = np.searchsorted(coarse.node_offsets, step.parents.min(axis=1), side="right") - 1
        assert np.array_equal(owner, parent_owner)
    assert np.array_equal(one.finest.places, np.arange(len(one.finest.X)))
    # The places bring the nodes into the one order of all numbers of ranks.
    for many, single in zip(nested.meshes, one.meshes):
        np.testing.assert_array_equal(many.X[np.argsort(many.places)], single.X)


def test_fields_are_prolonged_exactly_where_they_are_linear():
    nested = NestedMesh(holed_mesh(), 3)
    for level, (coarse, fine) in enumerate(zip(nested.meshes, nested.meshes[1:])):
        found = nested.prolong(level, coarse.X @ A + 1.0)
        np.testing.assert_allclose(found, fine.X @ A + 1.0, atol=1e-13)


def begin(kind: str = "harmonic", size: float = 0.06, levels: int = 2, radius: float = 0.12, **options):
    """A nested plate whose round hole the hand holds."""
    outline = plate(radius)
    mesh = MovingMesh(outline, MeshSpec(size=size, relocation=kind, levels=levels), **options)
    hand = Hand(outline, mesh.spec)
    assert mesh.update(hand.frame("start", "start")).level == 3
    gesture = gestures.drag(outline, outline.entity("window"))
    mesh.update(hand.frame("press", "none", gesture))
    return mesh, hand, gesture


def same(nested: NestedMesh, coarse: Mesh) -> None:
    """Each mesh is what refining the coarse one from scratch gives."""
    fresh = coarse
    for mesh, kept in zip(nested.meshes[1:], nested.steps):
        fresh = refine(fresh, kept.straight, mend=False).mesh
        np.testing.assert_allclose(mesh.X, fresh.X, atol=1e-15)
        for name in ("cells", "cell_edges", "edge_nodes", "facets", "facet_cell", "node_edge", "node_param"):
            assert np.array_equal(getattr(mesh, name), getattr(fresh, name)), name


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["harmonic", "pmvc", "mvc", "laplacian"])
@pytest.mark.parametrize("levels", [2, 3])
def test_a_hole_dragged_there_and_back(kind, levels):
    mesh, hand, gesture = begin(kind, levels=levels)
    seen = {level: 0 for level in range(4)}
    for x in np.concatenate([np.linspace(0, 1.2, 30)[1:], np.linspace(1.2, 0, 30)[1:]]):
        field, topology, geometry = mesh.field_mesh, mesh.field_mesh.topology, mesh.field_mesh.geometry
        old = field.X.copy(), field.cells
        frame = hand.frame("drag", "move", gesture, (float(x), float(0.2 * np.sin(3 * x))))
        advance = mesh.update(frame)
        seen[advance.level] += 1
        check(mesh, frame.outline)
        now = mesh.field_mesh
        assert fault(now) == "" and now.outline is frame.outline and now.hierarchy is mesh.nested
        same(mesh.nested, mesh.mesh)
        assert advance.min_quality == pytest.approx(qualities(mesh.mesh.X, mesh.mesh.cells).min())
        if advance.level == 1:
            assert now is field and now.topology == topology and now.geometry == geometry + 1
            assert advance.old_mesh is None and len(advance.changed_cells) == 0
            continue
        assert now is not field and now.topology != topology and advance.old_mesh is field
        assert areas(field.X, field.cells).min() > 0 and field.cells is old[1]
        np.testing.assert_allclose(transfer(field, field, field.X), field.X, atol=1e-12)
        if advance.level == 2:
            assert advance.flips and len(advance.changed_cells) >= 2 * 4 ** (levels - 1)
            assert len(now.X) == len(field.X)
    assert seen[1] and seen[3] and (seen[2] or kind == "mvc")


def test_the_finest_mesh_has_the_size_that_is_asked_for():
    counts = [len(begin(size=0.03, levels=levels)[0].field_mesh.cells) for levels in (1, 2, 3)]
    assert counts[1] == pytest.approx(counts[0], rel=0.1) and counts[2] == pytest.approx(counts[0], rel=0.2)
    near = MovingMesh(plate(), MeshSpec(size=0.1, near={"window": 0.02}, levels=2))
    near.update(Hand(plate(), near.spec).frame("start", "start"))
    rim = near.field_mesh.facets[near.field_mesh.facets_of("window")]
    lengths = np.linalg.norm(np.diff(near.field_mesh.X[rim], axis=1)[:, 0], axis=1)
    assert lengths.mean() == pytest.approx(0.02, rel=0.1)
    with pytest.raises(UserError, match="triangles"):
        endless = MovingMesh(plate(), MeshSpec(size=4e-4, levels=4))
        endless.update(Hand(plate(), endless.spec).frame("start", "start"))


def test_an_imported_mesh_is_the_coarsest_also_where_no_size_is_given():
    outline = plate()
    given = generate(outline, MeshSpec(size=0.2))
    mesh = MovingMesh(outline, MeshSpec(levels=2), imported=given)
    hand = Hand(outline, mesh.spec)
    mesh.update(hand.frame("start", "start"))
    assert mesh.mesh is given and len(mesh.field_mesh.cells) == 4 * len(given.cells)
    assert mesh.update(hand.frame("hole", "shape")).level == 3
    assert len(mesh.mesh.cells) == pytest.approx(2000, rel=0.15)
    assert len(mesh.field_mesh.cells) == 4 * len(mesh.mesh.cells)


def test_all_nodes_follow_the_linear_map():
    mesh, hand, gesture = begin(levels=3)
    start, motion = mesh.field_mesh.X.copy(), mesh.field_motion
    for c in [(0.02, 0.0), (0.03, -0.02)]:
        assert mesh.update(hand.frame("drag", "move", gesture, c)).level == 1
        np.testing.assert_allclose(mesh.field_mesh.X, start + np.tensordot(c, motion, 1), atol=1e-14)
    mesh.update(hand.frame("drag", "move", gesture, (0.0, 0.0)))
    assert np.array_equal(mesh.field_mesh.X, start)


def test_an_arc_that_grows_carries_all_levels():
    outline = curved_outline()
    mesh = MovingMesh(outline, MeshSpec(size=0.08, levels=3))
    hand = Hand(outline, mesh.spec)
    mesh.update(hand.frame("start", "start"))
    edge = next(i for i, edge in enumerate(outline.edges) if edge.name == "right")
    bent = gestures.Gesture("arc", None, False, outline.points, np.zeros(len(outline.points), dtype=bool))
    for bulge in (0.42, 0.45, 0.3, 0.1):
        frame = hand.frame("arc", "none", bent)
        bulges = outline.bulges.copy()
        bulges[edge] = bulge
        frame.change, frame.outline = "move", outline.moved(bulges=bulges)
        mesh.update(frame)
        assert fault(mesh.field_mesh) == "" and mesh.field_mesh.outline is frame.outline


@pytest.mark.parametrize("kind", ["harmonic", "laplacian"])
def test_a_frame_is_taken_back_whatever_its_level(kind):
    mesh, hand, gesture = begin(kind)
    levels = set()
    for x in np.linspace(0, 1.2, 30)[1:]:
        field = mesh.field_mesh
        kept = {name: getattr(field, name) for name in ("topology", "geometry", "outline")}
        X, cells = field.X.copy(), field.cells.copy()
        frame = hand.frame("drag", "move", gesture, (float(x), 0.0))
        levels.add(mesh.update(frame).level)
        mesh.rollback()
        assert mesh.field_mesh is field and kept == {name: getattr(field, name) for name in kept}
        assert np.array_equal(field.X, X) and np.array_equal(field.cells, cells)
        same(mesh.nested, mesh.mesh)
        mesh.update(frame)
        same(mesh.nested, mesh.mesh)
    assert levels >= ({1, 2, 3} if kind == "harmonic" else {1, 2})


def test_a_frame_without_a_mesh_leaves_all_levels_as_they_were(monkeypatch):
    mesh, hand, gesture = begin(levels=3)
    mesh.update(hand.frame("drag", "move", gesture, (0.1, 0.0)))
    field, X = mesh.field_mesh, mesh.field_mesh.X.copy()

    def refuse(*arguments):
        raise ReplayProblem("no mesh")

    monkeypatch.setattr(moving, "generate", refuse)
    with pytest.raises(ReplayProblem):
        mesh.update(hand.frame("drag", "move", gesture, (1.2, 0.3)))
    assert mesh.field_mesh is field and np.array_equal(field.X, X) and fault(field) == ""


def test_levels_may_change_between_frames():
    mesh, hand, _ = begin(levels=2)
    finer = type(hand.scene)(mesh=mesh.spec.model_copy(update={"levels": 3}))
    field = mesh.field_mesh
    advance = mesh.update(hand.frame("set", "mesh", scene=finer))
    assert advance.level == 3 and advance.old_mesh is field and len(mesh.nested.meshes) == 3
    plain = type(hand.scene)(mesh=mesh.spec.model_copy(update={"levels": 1}))
    mesh.update(hand.frame("set", "mesh", scene=plain))
    assert mesh.nested is None and mesh.field_mesh is mesh.mesh and mesh.mesh.hierarchy is None


def test_a_region_keeps_its_cells_through_all_levels():
    outline = polygon_outline(SQUARE, regions={"patch": [[0.3, 0.3], [0.7, 0.3], [0.7, 0.7], [0.3, 0.7]]})
    mesh = NestedMesh(generate(outline, MeshSpec(size=0.2)), 3).finest
    assert areas(mesh.X, mesh.cells)[mesh.cells_of("patch")].sum() == pytest.approx(0.16, rel=1e-12)
    inside = (np.abs(mesh.X - 0.5) <= 0.2 + 1e-12).all(axis=1)
    assert np.array_equal(mesh.nodes_of("patch"), np.flatnonzero(inside))
