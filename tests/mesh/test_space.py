"""Second-order nodes on moving meshes: in the middle of sides, on curves, through flips, transferred to new meshes."""

import numpy as np
import pytest
from mesh_samples import SQUARE, holed_mesh, l_mesh, polygon_outline
from test_moving import Hand, plate

from restshape import _kernels
from restshape.mesh.generate import generate
from restshape.mesh.lagrange_space import MIN_JACOBIAN, LagrangeSpace, interpolated
from restshape.mesh.mesh import Mesh
from restshape.mesh.moving import MovingMesh
from restshape.mesh.quadratic_basis import quadratic_basis
from restshape.mesh.quality import areas
from restshape.mesh.reconnect import Reconnection
from restshape.mesh.transfer import Transfer, transfer
from restshape.scene.model import MeshSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.hand import gesture as gestures

A = np.array([[1.0, -2.0], [0.5, 3.0]])


def quadratic(X: np.ndarray) -> np.ndarray:
    """A vector field of degree 2 (n, 2)."""
    x, y = X.T
    return np.column_stack([1 + 2 * x - y + x * x - 3 * x * y, y * y + 0.5 * x * y - 4])


def begin(kind: str = "harmonic", size: float = 0.1, radius: float = 0.12, **options):
    """A plate of second order whose round hole the hand holds."""
    outline = plate(radius)
    mesh = MovingMesh(outline, MeshSpec(size=size, relocation=kind, order=2, edges_per_circle=8), **options)
    hand = Hand(outline, mesh.spec)
    assert mesh.update(hand.frame("start", "start")).level == 3
    gesture = gestures.drag(outline, outline.entity("window"))
    mesh.update(hand.frame("press", "none", gesture))
    return mesh, hand, gesture


def check(space: LagrangeSpace, outline) -> None:
    """Nodes where they belong, valid triangles, arrays that agree with those of the mesh."""
    mesh = space.mesh
    assert np.array_equal(space.X[space.corner_number], mesh.X)
    assert np.array_equal(space.corners, space.corner_number[mesh.cells])
    assert np.array_equal(space.corners, space.cells[:, :3])
    curved = np.zeros(len(space.X), dtype=bool)
    curved[space.side_number[space.curved]] = True
    for i in range(3):
        ends, middle = space.cells[:, [i, (i + 1) % 3]], space.cells[:, 3 + i]
        straight = ~curved[middle]
        np.testing.assert_allclose(space.X[middle[straight]], space.X[ends[straight]].mean(axis=1), atol=1e-14)
    for facet, edge in zip(space.facets, space.facet_edge):
        if outline.edges[edge].kind == "arc":
            a, middle, b = space.X[facet[[0, 2, 1]]]
            start = outline.points[outline.edges[edge].start]
            centre = outline.points[[e.start for e in outline.edges if e.parent.startswith("window")]].mean(axis=0)
            radius = np.linalg.norm(start - centre)
            assert np.linalg.norm(middle - centre) == pytest.approx(radius, rel=1e-12)
            assert np.linalg.norm(middle - a) == pytest.approx(np.linalg.norm(middle - b), rel=1e-9)
    assert (
        _kernels.curved_jacobian_bound(space.X, space.cells) >= 2 * MIN_JACOBIAN * areas(mesh.X, mesh.cells) - 1e-15
    ).all()


def test_nodes_are_numbered_rank_by_rank():
    mesh = generate(plate(), MeshSpec(size=0.1), ranks=3)
    space = LagrangeSpace(mesh)
    assert space.n_nodes == len(mesh.X) + len(mesh.edge_nodes) == space.node_offsets[-1]
    numbers = np.concatenate([space.corner_number, space.side_number])
    assert np.array_equal(np.sort(numbers), np.arange(space.n_nodes))

    def rank(node, offsets):
        return np.searchsorted(offsets, node, side="right") - 1

    assert np.array_equal(
        rank(space.corner_number, space.node_offsets), rank(np.arange(len(mesh.X)), mesh.node_offsets)
    )
    assert np.array_equal(
        rank(space.side_number, space.node_offsets), rank(mesh.edge_nodes.min(axis=1), mesh.node_offsets)
    )


def test_entities_have_the_nodes_of_their_sides():
    mesh = holed_mesh()
    space = LagrangeSpace(mesh)
    for name in ("e0", "window", "patch", "probe", "v1", "outline", "all"):
        nodes = space.nodes_of(name)
        corners = np.isin(nodes, space.corner_number)
        assert np.array_equal(nodes[corners], np.sort(space.corner_number[mesh.nodes_of(name)]))
    X = space.X[space.nodes_of("e0")]
    assert len(X) == 2 * len(mesh.nodes_of("e0")) - 1 and not X[:, 1].any()
    assert len(space.nodes_of("probe")) == 1 and len(space.nodes_of("all")) == space.n_nodes
    outline = polygon_outline(SQUARE, regions={"patch": [[0.3, 0.3], [0.7, 0.3], [0.7, 0.7], [0.3, 0.7]]})
    space = LagrangeSpace(generate(outline, MeshSpec(size=0.1)))
    inside = (np.abs(space.X - 0.5) <= 0.2 + 1e-12).all(axis=1)
    assert np.array_equal(space.nodes_of("patch"), np.flatnonzero(inside))


@pytest.mark.parametrize("size", [0.3, 0.15, 0.05])
def test_the_area_is_that_of_the_parabolas(size):
    # Between chord and parabola lie two thirds of chord times height.
    space = LagrangeSpace(mesh := generate(plate(0.3, 0.5), MeshSpec(size=size)))
    ends = mesh.X[mesh.facets[mesh.facets_of("window")]]
    chords = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    assert len(chords) == len(space.curved)
    half = np.arcsin(chords / (2 * 0.3))
    polygon = 0.5 * 0.09 * np.sum(np.sin(2 * half))
    parabolas = np.sum(2 / 3 * chords * 0.3 * (1 - np.cos(half)))
    assert _kernels.total_area(space.X, space.cells) == pytest.approx(2.0 - polygon - parabolas, rel=1e-13)


@pytest.mark.parametrize("kind", ["harmonic", "pmvc", "mvc", "laplacian"])
def test_a_hole_dragged_there_and_back(kind):
    mesh, hand, gesture = begin(kind)
    levels = set()
    for x in np.concatenate([np.linspace(0, 1.2, 25)[1:], np.linspace(1.2, 0, 25)[1:]]):
        frame = hand.frame("drag", "move", gesture, (float(x), float(0.2 * np.sin(3 * x))))
        levels.add(mesh.update(frame).level)
        check(mesh.space, frame.outline)
    assert {1, 3} <= levels


def test_all_nodes_follow_the_linear_map():
    mesh, hand, gesture = begin()
    start, motion = mesh.space.X.copy(), mesh.field_motion
    for c in [(0.01, 0.0), (0.02, -0.01)]:
        assert mesh.update(hand.frame("drag", "move", gesture, c)).level == 1
        assert np.allclose(mesh.space.X, start + c[0] * motion[0] + c[1] * motion[1], rtol=0, atol=1e-15)
    grown = gestures.scale(mesh.mesh.outline, mesh.mesh.outline.entity("window"), np.array([0.32, 0.49]))
    hand.outline = mesh.mesh.outline
    mesh.update(hand.frame("press", "none", grown))
    start, motion = mesh.space.X.copy(), mesh.field_motion
    frame = hand.frame("scale", "move", grown, (0.1, 0.0))
    assert mesh.update(frame).level == 1
    assert np.allclose(mesh.space.X, start + 0.1 * motion[0], rtol=0, atol=1e-15)
    check(mesh.space, frame.outline)


def test_a_bent_arc_carries_its_middles():
    mesh, hand, _ = begin()
    bend, levels = gestures.bend(hand.outline), []
    edge = hand.outline.entity("window.1").edges[0]
    for share in np.linspace(1, 0.6, 9)[1:]:
        frame = hand.frame("arc", "move", bend)
        bulges = hand.outline.bulges.copy()
        bulges[edge] *= share
        frame.outline = hand.outline.moved(bulges=bulges)
        levels.append(mesh.update(frame).level)
        space = mesh.space
        for facet in space.facets[space.facet_edge == edge]:
            s = [float(np.interp(0.5, [0, 1], [p, q])) for p, q in [_ends(space, facet[:2], edge)]]
            assert np.allclose(space.X[facet[2]], frame.outline.point(edge, s[0])[0], atol=1e-13)
    assert levels.count(1) >= 4


def _ends(space, nodes, edge):
    """Parameters of the ends of a facet, found by distance."""
    s = np.linspace(0, 1, 4001)
    curve = space.outline.point(edge, s)
    return [s[np.linalg.norm(curve - space.X[node], axis=1).argmin()] for node in nodes]


def flipping(size=0.08):
    """A drag with flips: yields the moving mesh after each frame, with its field_mesh's nodes before."""
    mesh, hand, gesture = begin("laplacian", size, flip_everywhere=True)
    for x in np.linspace(0, 0.6, 40)[1:]:
        before = mesh.field_mesh
        mesh.space.interpolations = ()
        advance = mesh.update(hand.frame("drag", "move", gesture, (float(x), 0.0)))
        yield mesh, before, advance


def test_only_flips_move_nodes_along_the_field():
    flips = 0
    for mesh, before, advance in flipping():
        interpolations = mesh.space.interpolations
        assert bool(interpolations) == (advance.level == 2)
        if advance.level == 2:
            assert mesh.space is before
            flips += advance.flips
            assert 0 < sum(len(part.nodes) for part in interpolations) <= advance.flips
            assert np.isin(np.concatenate([part.nodes for part in interpolations]), mesh.space.side_number).all()
    assert flips > 5


def test_fields_survive_flips_at_rest():
    mesh = generate(plate(), MeshSpec(size=0.1, edges_per_circle=8))
    rng = np.random.default_rng(3)
    free = mesh.node_edge < 0
    mesh.X[free] += rng.uniform(-0.02, 0.02, (int(free.sum()), 2))
    while areas(mesh.X, mesh.cells).min() <= 1e-4:
        mesh.X[free] += rng.uniform(-0.004, 0.004, (int(free.sum()), 2))
    space = LagrangeSpace(mesh)
    for values, tolerance in ((lambda X: X @ A.T + 1, 1e-11), (quadratic, None)):
        field = values(space.X)
        edges = mesh.edge_nodes.copy()
        flips, changed = Reconnection(mesh).flip(mesh.X)
        space.reconnect(changed)
        space.place()
        there = interpolated(field, space.interpolations)
        flipped = (mesh.edge_nodes != edges).any(axis=1)
        assert flips and flipped.any()
        bent = np.zeros(len(space.X), dtype=bool)
        bent[space.cells[np.isin(mesh.cell_edges, space.curved).any(axis=1)]] = True
        nodes = space.side_number[flipped]
        # Quadratic fields too where the triangles are straight.
        nodes = nodes if tolerance else nodes[~bent[nodes]]
        assert np.abs(there - values(space.X))[nodes].max() < (tolerance or 1e-11)
        mesh = generate(plate(), MeshSpec(size=0.1, edges_per_circle=8))
        mesh.X[mesh.node_edge < 0] += rng.uniform(-0.015, 0.015, (int((mesh.node_edge < 0).sum()), 2))
        space = LagrangeSpace(mesh)


def test_an_edge_keeps_its_node_through_flips():
    for mesh, before, advance in flipping():
        space = mesh.space
        if advance.level == 3:
            assert space is not before
            continue
        sides = np.sort(np.stack([space.mesh.cell_edges[:, k] for k in (2, 0, 1)]), axis=1)
        assert np.array_equal(np.sort(space.cells[:, 3:].T, axis=1), np.sort(space.side_number[sides], axis=1))
        check(space, space.outline)


def test_a_frame_that_is_taken_back_leaves_no_trace():
    mesh, hand, gesture = begin("laplacian", 0.08, flip_everywhere=True)
    taken = 0
    for x in np.linspace(0, 0.6, 40)[1:]:
        space = mesh.space
        kept = space.X.copy(), space.cells.copy(), space.offset.copy(), space.interpolations
        mesh.update(hand.frame("drag", "move", gesture, (float(x), 0.0)))
        taken += bool(space.interpolations)
        mesh.rollback()
        assert mesh.space is space and space.interpolations == kept[3]
        for now, before in zip((space.X, space.cells, space.offset), kept):
            assert np.array_equal(now, before)
        mesh.update(hand.frame("drag", "move", gesture, (float(x), 0.0)))
        mesh.space.interpolations = ()
    assert taken


def test_a_side_bent_beyond_reason_calls_for_a_new_mesh():
    # The arc's bulge grows from a quarter of a circle until its facets bend so much that triangles would fold.
    outline = plate(0.12)
    mesh = MovingMesh(outline, MeshSpec(size=0.3, order=2))
    hand = Hand(outline, mesh.spec)
    mesh.update(hand.frame("start", "start"))
    edge, bend, levels = outline.entity("window.1").edges[0], gestures.bend(outline), []
    for bulge in np.linspace(outline.bulges[edge], 3.5 * outline.bulges[edge], 30):
        frame = hand.frame("arc", "move", bend)
        bulges = outline.bulges.copy()
        bulges[edge] = bulge
        frame.outline = outline.moved(bulges=bulges)
        levels.append(mesh.update(frame).level)
        check_bounds(mesh.space)
    assert 1 in levels and 3 in levels


def check_bounds(space: LagrangeSpace) -> None:
    """All triangles are valid, at their own Gauss points too."""
    points = np.array([[0.1, 0.1], [0.8, 0.1], [0.1, 0.8], [1 / 3, 1 / 3], [0.5, 0.0], [0.0, 0.5], [0.5, 0.5]])
    _, slopes = quadratic_basis(points)
    J = np.einsum("qia,eib->eqab", slopes, space.X[space.cells])
    assert np.linalg.det(J).min() > 0


def test_a_new_mesh_straightens_sides_that_would_fold_their_triangle():
    # A sliver under a bulging side: a spline that dips to the opposite corner's height.
    from restshape.scene.model import ShapeSpec

    outline = outline_from_spec(ShapeSpec.model_validate({
        "vertices": {"a": [0, 0], "b": [1, 0], "c": [1, 1], "d": [0, 1]},
        "edges": {
            "low": {"spline": ["a", "b"], "through": [[0.5, 0.3]]}, "right": {"line": ["b", "c"]},
            "top": {"line": ["c", "d"]}, "left": {"line": ["d", "a"]},
        },
        "outline": ["low", "right", "top", "left"],
        "points": {"near": [0.5, 0.33]},
    }))  # fmt: skip
    X = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.33]], dtype=float)
    mesh = Mesh.build(
        X, np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]), outline,
        facets=np.array([[0, 1], [1, 2], [2, 3], [3, 0]]), facet_edge=np.arange(4),
        node_edge=np.array([0, 1, 2, 3, -1]), node_param=np.zeros(5), vertex_node=np.array([0, 1, 2, 3, 4]),
    )  # fmt: skip
    space = LagrangeSpace(mesh)
    assert len(space.curved) == 1 and not space.offset.any()
    assert _kernels.total_area(space.X, space.cells) == pytest.approx(1.0, rel=1e-14)
    check_bounds(space)


def test_quadratic_fields_are_interpolated_exactly_between_straight_sides():
    old, new = LagrangeSpace(l_mesh(4)), LagrangeSpace(l_mesh(7))
    assert np.abs(transfer(old, new, quadratic(old.X)) - quadratic(new.X)).max() < 1e-11
    assert np.abs(transfer(old, new.mesh, quadratic(old.X)) - quadratic(new.mesh.X)).max() < 1e-11


def test_linear_fields_are_interpolated_exactly_through_curved_sides():
    outline = plate(0.2)
    old, new = (LagrangeSpace(generate(outline, MeshSpec(size=size))) for size in (0.2, 0.11))
    found = transfer(old, new, old.X @ A.T + 1.0)
    assert np.abs(found - (new.X @ A.T + 1.0)).max() < 1e-10


def test_smooth_fields_are_interpolated_with_third_order():
    new = LagrangeSpace(l_mesh(13))

    def field(X):
        return (np.sin(2 * X[:, 0]) * np.cos(X[:, 1]))[:, None]

    spaces = [LagrangeSpace(l_mesh(n)) for n in (4, 8, 16)]
    errors = [np.sqrt(np.mean((transfer(old, new, field(old.X)) - field(new.X)) ** 2)) for old in spaces]
    assert np.log2(errors[0] / errors[2]) / 2 > 2.8


def test_points_outside_take_the_nearest_boundary_value():
    space = LagrangeSpace(holed_mesh())
    there = Transfer(space, np.array([[2.5, 0.4], [-0.3, -0.4], [0.6, 0.5]]))(space.X)
    assert np.allclose(there, [[2.0, 0.4], [0.0, 0.0], [0.5, 0.5]], atol=1e-12)


def test_the_basis_is_one_at_its_node_and_has_its_slopes():
    nodes = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])
    values, _ = quadratic_basis(nodes)
    np.testing.assert_allclose(values, np.eye(6), atol=1e-15)
    points = np.random.default_rng(1).dirichlet([1, 1, 1], 20)[:, 1:]
    values, slopes = quadratic_basis(points)
    np.testing.assert_allclose(values @ quadratic(nodes), quadratic(points), atol=1e-13)
    for axis in (0, 1):
        step = 1e-6 * np.eye(2)[axis]
        up, down = quadratic_basis(points + step)[0], quadratic_basis(points - step)[0]
        np.testing.assert_allclose(slopes[:, :, axis], (up - down) / 2e-6, atol=1e-8)
