"""Maps of the boundary into the mesh: linear precision, positivity, known harmonic functions."""

import numpy as np
import pytest
from mesh_samples import SQUARE, grid, holed_mesh, l_mesh, mesh_of, polygon_outline, shaken

from restshape import _kernels
from restshape.mesh.relocate import BoundaryNodes, HarmonicExtension, PositiveMeanValueExtension, extension, motion
from restshape.shape.hand.gesture import drag

LINEAR = np.array([[2.0, -1.0, 0.5], [0.3, 4.0, -2.0]])


@pytest.mark.parametrize("make", [l_mesh, holed_mesh])
@pytest.mark.parametrize(("kind", "tolerance"), [("harmonic", 1e-12), ("pmvc", 1e-13), ("mvc", 1e-12)])
def test_linear_functions_are_reproduced_in_concave_shapes_and_around_holes(make, kind, tolerance):
    mesh = make()
    boundary = BoundaryNodes(mesh)
    linear = mesh.X @ LINEAR + [1.0, -3.0, 0.2]
    found = extension(mesh, boundary.nodes, kind)(linear[boundary.nodes])
    assert np.abs(found - linear).max() < tolerance * np.abs(linear).max()


@pytest.mark.parametrize("kind", ["harmonic", "pmvc", "mvc"])
def test_the_map_is_linear_in_the_boundary(kind):
    mesh = holed_mesh()
    nodes = BoundaryNodes(mesh).nodes
    rng = np.random.default_rng(3)
    u, v = rng.normal(size=(2, len(nodes), 2))
    extend = extension(mesh, nodes, kind)
    assert np.allclose(extend(2.0 * u - 3.0 * v), 2.0 * extend(u) - 3.0 * extend(v), rtol=0, atol=1e-12)


@pytest.mark.parametrize("columns", [1, 2, 3, 4])
def test_columns_are_extended_together_as_each_by_itself(columns):
    """Two and four are substituted together; the Laplacian in dense numbers is another way to each."""
    mesh = holed_mesh()
    nodes = BoundaryNodes(mesh).nodes
    values = np.random.default_rng(7).normal(size=(len(nodes), columns))
    found = extension(mesh, nodes, "harmonic")(values)
    stiffness = np.zeros((len(mesh.X), len(mesh.X)))
    for cell in mesh.cells:
        a, b, c = mesh.X[cell]
        opposite = np.array([c - b, a - c, b - a])
        area = 0.5 * abs((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0])
        stiffness[np.ix_(cell, cell)] += opposite @ opposite.T / (4.0 * area)
    inside = np.setdiff1d(np.arange(len(mesh.X)), nodes)
    wanted = np.linalg.solve(stiffness[np.ix_(inside, inside)], -stiffness[np.ix_(inside, nodes)] @ values)
    assert np.abs(found[inside] - wanted).max() < 1e-12 * np.abs(values).max()
    assert np.array_equal(found[nodes], values)


@pytest.mark.parametrize("make", [l_mesh, holed_mesh])
def test_positive_mean_value_weights_are_non_negative_and_sum_to_one(make):
    mesh = make()
    boundary = np.unique(mesh.facets)
    row = np.full(len(mesh.X), -1, dtype=np.int32)
    row[boundary] = np.arange(len(boundary))
    inside = np.setdiff1d(np.arange(len(mesh.X)), boundary)
    weights = _kernels.positive_mean_value(mesh.X[inside], mesh.X[boundary], row[mesh.facets], np.eye(len(boundary)))
    assert weights.min() >= 0.0
    assert np.abs(weights.sum(axis=1) - 1.0).max() < 1e-14


def test_positive_mean_value_equals_mean_value_weights_where_all_is_visible():
    corners = np.array([[0.0, 0.0], [3.0, 0.5], [3.5, 2.0], [1.0, 3.0], [-0.5, 1.5]])
    segments = np.array([[i, (i + 1) % 5] for i in range(5)], dtype=np.int32)
    point = np.array([1.3, 1.1])
    # Floater's mean value weights of a convex polygon, straight from angles.
    arms = corners - point
    r = np.linalg.norm(arms, axis=1)
    angles = np.unwrap(np.arctan2(arms[:, 1], arms[:, 0]))
    tangents = np.tan(np.diff([*angles, angles[0] + 2 * np.pi]) / 2)
    weights = (tangents + np.roll(tangents, 1)) / r
    found = _kernels.positive_mean_value(point[None], corners, segments, np.eye(5))[0]
    assert np.allclose(found, weights / weights.sum(), rtol=0, atol=1e-14)


def mean_value_weights(point, loops):
    """Floater's weights of a point in nested polygons, straight from signed angles; the inside is on their left."""
    found = []
    for corners in loops:
        arms = corners - point
        angles = np.angle(np.roll(arms, -1, axis=0) @ [1, 1j] * np.conj(arms @ [1, 1j]))
        tangents = np.tan(angles / 2)
        found.append((tangents + np.roll(tangents, 1)) / np.linalg.norm(arms, axis=1))
    weights = np.concatenate(found)
    return weights / weights.sum()


def test_mean_value_weights_are_those_of_signed_angles_with_negative_ones():
    outer = np.array([[0.0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]])
    hole = np.array([[0.4, 0.4], [0.4, 0.6], [0.6, 0.6], [0.6, 0.4]])
    points = np.array([[1.8, 0.5], [0.2, 1.7], [0.5, 0.2], [0.9, 0.9], [1.0, 0.999]])
    segments = [[i, (i + 1) % 6] for i in range(6)] + [[6 + i, 6 + (i + 1) % 4] for i in range(4)]
    vertices = np.concatenate([outer, hole])
    found = _kernels.mean_value(points, vertices, np.array(segments, dtype=np.int32), np.eye(10))
    expected = [mean_value_weights(point, [outer, hole]) for point in points]
    assert np.allclose(found, expected, rtol=0, atol=1e-12)
    assert found.min() < -0.01 and np.abs(found.sum(axis=1) - 1).max() < 1e-13


@pytest.mark.parametrize("kind", ["pmvc", "mvc"])
def test_mean_values_of_both_kinds_are_one_in_a_convex_shape(kind):
    X, cells = grid(12, 12, 1.0, 1.0)
    mesh = shaken(mesh_of(polygon_outline(SQUARE), X, cells), 0.02)
    nodes = BoundaryNodes(mesh).nodes
    values = np.random.default_rng(5).normal(size=(len(nodes), 2))
    found = extension(mesh, nodes, kind)(values)
    assert np.allclose(found, extension(mesh, nodes, "pmvc")(values), rtol=0, atol=1e-13)


def test_mean_values_over_the_border_of_a_region_leave_no_jump():
    """Around a node on it, neighbours on both sides have nearly its value."""
    mesh = holed_mesh(16)
    nodes = BoundaryNodes(mesh).nodes
    smooth = np.sin(3 * mesh.X[:, :1]) * np.cos(2 * mesh.X[:, 1:])
    found = extension(mesh, nodes, "mvc")(smooth[nodes])
    border = np.isin(np.arange(len(mesh.X)), mesh.facets[mesh.facets_of("patch")])
    ends = mesh.edge_nodes[border[mesh.edge_nodes].any(axis=1)]
    steps, lengths = np.ptp(found[ends, 0], axis=1), np.linalg.norm(np.ptp(mesh.X[ends], axis=1), axis=1)
    assert (steps < 6 * lengths).all()


def test_positive_mean_value_ignores_what_is_hidden():
    mesh = l_mesh()
    boundary = np.unique(mesh.facets)
    row = np.full(len(mesh.X), -1, dtype=np.int32)
    row[boundary] = np.arange(len(boundary))
    point = np.array([[1.9, 0.5]])
    # The line of sight through the inner corner (1, 1) meets the left side at
    # 0.5 + 1.9 * 0.5 / 0.9, and facets are 1/8 long.
    x, y = mesh.X[boundary].T
    hidden = ((x == 1.0) & (y > 1.0)) | (y > 0.5 + 1.9 * 0.5 / 0.9 + 0.125)
    values = hidden.astype(float)[:, None]
    assert hidden.sum() > 10
    assert _kernels.positive_mean_value(point, mesh.X[boundary], row[mesh.facets], values)[0, 0] == 0.0


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_positive_mean_value_is_the_mean_over_all_directions(seed):
    rng = np.random.default_rng(seed)
    angles = (np.arange(14) + rng.uniform(0, 0.9, 14)) * 2 * np.pi / 14
    star = rng.uniform(0.4, 2.0, (14, 1)) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    hole = 0.08 * np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    vertices, point = np.concatenate([star, hole]), np.array([0.15, 0.12])
    segments = [(i, (i + 1) % 14) for i in range(14)] + [(14 + i, 14 + (i + 1) % 4) for i in range(4)]
    values = rng.normal(size=(18, 2))
    # Rays in many directions: the value where each first meets the boundary, weighted by one over the distance.
    rays = (np.arange(100_000) + 0.5) * 2 * np.pi / 100_000
    u = np.stack([np.cos(rays), np.sin(rays)], axis=1)
    nearest, met = np.full(len(rays), np.inf), np.zeros((len(rays), 2))
    for i, j in segments:
        a, along = vertices[i] - point, vertices[j] - vertices[i]
        turn = u[:, 0] * along[1] - u[:, 1] * along[0]
        distance = (a[0] * along[1] - a[1] * along[0]) / turn
        share = (a[0] * u[:, 1] - a[1] * u[:, 0]) / turn
        hit = (distance > 0) & (share >= 0) & (share <= 1) & (distance < nearest)
        nearest[hit] = distance[hit]
        met[hit] = values[i] * (1 - share[hit, None]) + values[j] * share[hit, None]
    expected = (met / nearest[:, None]).sum(axis=0) / (1 / nearest).sum()
    found = _kernels.positive_mean_value(point[None], vertices, np.array(segments, dtype=np.int32), values)[0]
    assert np.allclose(found, expected, rtol=0, atol=1e-4)


def test_harmonic_error_falls_with_the_square_of_the_size():
    errors = []
    for n in (8, 16, 32):
        X, cells = grid(n, n, 1.0, 1.0)
        mesh = shaken(mesh_of(polygon_outline(SQUARE), X, cells), 0.2 / n)
        x, y = mesh.X.T
        exact = (np.exp(x) * np.sin(y))[:, None]
        nodes = BoundaryNodes(mesh).nodes
        inside = np.setdiff1d(np.arange(len(mesh.X)), nodes)
        errors.append(np.sqrt(np.mean((HarmonicExtension(mesh, nodes)(exact[nodes]) - exact)[inside] ** 2)))
    assert np.log2(errors[0] / errors[2]) / 2 > 1.8


@pytest.mark.parametrize("kind", ["harmonic", "pmvc", "mvc"])
def test_a_dragged_hole_moves_its_boundary_by_the_hand_and_leaves_the_rest(kind):
    mesh = holed_mesh()
    outline = mesh.outline
    gesture = drag(outline, outline.entity("window"))
    boundary = BoundaryNodes(mesh)
    Psi = motion(mesh, boundary.basis(outline, gesture.basis), kind)
    moved = np.isin(np.arange(len(mesh.X)), mesh.nodes_of("window"))
    still = np.isin(np.arange(len(mesh.X)), [*mesh.nodes_of("outline"), *mesh.nodes_of("patch")])
    still |= np.arange(len(mesh.X)) == mesh.vertex_node[outline.vertex_names.index("probe")]
    on_boundary = np.isin(np.arange(len(mesh.X)), boundary.nodes)
    assert np.array_equal(Psi[0][moved], np.tile([1.0, 0.0], (moved.sum(), 1)))
    assert np.array_equal(Psi[1][moved], np.tile([0.0, 1.0], (moved.sum(), 1)))
    assert np.abs(Psi[:, still & on_boundary]).max() < 1e-15
    # The probe, which no direction sees, may push mean values a little below the range of the boundary.
    assert Psi[0][:, 0].min() > -1e-2 and Psi[0][:, 0].max() < 1 + 1e-12


def test_mean_values_reach_embedded_points():
    mesh = holed_mesh()
    boundary = BoundaryNodes(mesh)
    values = np.zeros((len(boundary.nodes), 1))
    probe = mesh.vertex_node[mesh.outline.vertex_names.index("probe")]
    values[boundary.nodes == probe] = 1.0
    found = PositiveMeanValueExtension(mesh, boundary.nodes)(values)
    assert found[probe, 0] == pytest.approx(1.0, abs=1e-13)
    assert np.array_equal(found[boundary.nodes[boundary.nodes != probe]], np.zeros((len(boundary.nodes) - 1, 1)))
    neighbours = np.unique(mesh.cells[(mesh.cells == probe).any(axis=1)])
    assert 0.2 < found[neighbours].mean() < 0.8


@pytest.mark.parametrize("make", [l_mesh, holed_mesh])
def test_a_gesture_that_is_linear_is_linear_inside_though_stiffened(make):
    mesh = make()
    boundary = BoundaryNodes(mesh)
    turned = np.stack([-mesh.X[:, 1], mesh.X[:, 0]], axis=1)
    basis = np.stack([mesh.X - 0.5, turned])
    assert np.abs(motion(mesh, basis[:, boundary.nodes], "harmonic") - basis).max() < 1e-12


def test_stiffening_lowers_the_largest_strain_of_a_dragged_hole():
    mesh = holed_mesh()
    gesture = drag(mesh.outline, mesh.outline.entity("window"))
    boundary = BoundaryNodes(mesh)
    basis = boundary.basis(mesh.outline, gesture.basis)

    def strain(Psi):
        corners, values = mesh.X[mesh.cells], Psi[mesh.cells]
        sides = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=2)
        jumps = np.stack([values[:, 1] - values[:, 0], values[:, 2] - values[:, 0]], axis=2)
        return np.linalg.norm(jumps @ np.linalg.inv(sides), axis=(1, 2)).max()

    plain = HarmonicExtension(mesh, boundary.nodes)(basis[0])
    assert strain(motion(mesh, basis, "harmonic")[0]) < 0.75 * strain(plain)
