"""Bodies over plane meshes: volume, walls that fit, flips, ranks, velocities."""

import itertools

import numpy as np
import pytest
from mesh_samples import SQUARE, grid, mesh_of, polygon_outline

from restshape import _kernels
from restshape.errors import ReplayProblem
from restshape.mesh.extrude import Extrusion
from restshape.mesh.generate import generate
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.plate import PlateMesh
from restshape.mesh.reconnect import Reconnection
from restshape.scene.expressions import Expression
from restshape.scene.model import MeshSpec, ShapeSpec
from restshape.shape.build import outline_from_spec

WEDGE = Expression("h0*(1 + x/2)")


def disc(size: float = 0.3, ranks: int = 1):
    """The unit disc, of four arcs."""
    corners = {"a": [1, 0], "b": [0, 1], "c": [-1, 0], "d": [0, -1]}
    ends = [*itertools.pairwise(corners), ("d", "a")]
    edges = {f"{a}{b}": {"arc": [a, b], "bulge": float(np.tan(np.pi / 8))} for a, b in ends}
    spec = ShapeSpec.model_validate({"vertices": corners, "edges": edges, "outline": list(edges)})
    return generate(outline_from_spec(spec), MeshSpec(size=size), ranks)


def square():
    X, cells = grid(5, 4, 1.0, 1.0)
    inner = np.all((X > 1e-9) & (X < 1 - 1e-9), axis=1)
    X[inner] += np.random.default_rng(2).uniform(-0.06, 0.06, (inner.sum(), 2))
    return mesh_of(polygon_outline(SQUARE), X, cells)


def plane(mesh, order: int):
    return mesh if order == 1 else LagrangeSpace(mesh)


def volumes(body: Extrusion) -> np.ndarray:
    """Volumes (ne,) of the tetrahedra, by the mass of density 1."""
    order = body.order
    element = _kernels.Element("mass_tet4" if order == 1 else "mass_tet10")
    up = np.tile([0.0, 0.0, 1.0], (len(body.X), 1))
    return 2 * element.energy(body.X, up, body.cells, np.array([1.0]))


def faces(body: Extrusion) -> dict[frozenset, int]:
    """How many tetrahedra each face belongs to; faces are distinguished by all their nodes."""
    sides = {frozenset((0, 1)): 4, frozenset((1, 2)): 5, frozenset((0, 2)): 6}
    sides |= {frozenset((0, 3)): 7, frozenset((1, 3)): 8, frozenset((2, 3)): 9}
    count: dict[frozenset, int] = {}
    for cell in body.cells.tolist():
        for face in itertools.combinations(range(4), 3):
            own = list(face)
            if body.order == 2:
                own += [sides[frozenset(pair)] for pair in itertools.combinations(face, 2)]
            key = frozenset(cell[i] for i in own)
            count[key] = count.get(key, 0) + 1
    return count


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("layers", [1, 2, 3])
def test_volume_and_walls(order, layers):
    """Of a square wedge: all tetrahedra stand upright, fill it, and share faces; outside there are 2 per facet."""
    mesh = square()
    body = Extrusion(plane(mesh, order), layers, WEDGE, {"h0": 0.2})
    assert len(body.cells) == 3 * layers * len(mesh.cells)
    assert len(np.unique(body.cells)) == body.n_nodes
    size = volumes(body)
    assert size.min() > 0
    np.testing.assert_allclose(size.sum(), 0.2 * 1.25, rtol=1e-13)
    shared = list(faces(body).values())
    assert set(shared) == {1, 2}
    assert shared.count(1) == 2 * len(mesh.cells) + 2 * layers * len(mesh.facets)


@pytest.mark.parametrize("order", [1, 2])
def test_sides_have_their_nodes_in_the_middle(order):
    body = Extrusion(plane(square(), order), 2, 0.3)
    if order == 2:
        sides = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
        ends = body.X[body.cells[:, sides]].mean(axis=2)
        np.testing.assert_allclose(body.X[body.cells[:, 4:]], ends, atol=1e-15)
    np.testing.assert_array_equal(np.unique(body.X[:, 2].round(12)), np.linspace(-0.15, 0.15, body.levels).round(12))


def test_two_layers_are_mirror_images():
    """Each tetrahedron of the lower one is one of the upper one with z turned round."""
    body = Extrusion(square(), 2, 0.3)
    mirrored = np.arange(body.n_nodes).reshape(-1, 3)[:, ::-1].ravel()
    cells = {frozenset(cell) for cell in body.cells.tolist()}
    assert cells == {frozenset(mirrored[cell].tolist()) for cell in body.cells}


def test_second_order_walls_follow_arcs():
    """Beyond the chord of an angle t lies t^3/12 of the unit disc, beyond the parabola t^5/960."""
    mesh = disc()
    ends = mesh.X[mesh.facets]
    t = 2 * np.arcsin(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / 2)
    lack = [np.pi - 2 * volumes(Extrusion(plane(mesh, order), 1, 0.5)).sum() for order in (1, 2)]
    np.testing.assert_allclose(lack, [np.sum(t**3) / 12, np.sum(t**5) / 960], rtol=0.01)


@pytest.mark.parametrize("flat, bottom, top", [("bottom", 0, 0.4), ("middle", -0.2, 0.2), ("top", -0.4, 0)])
def test_flat_face(flat, bottom, top):
    body = Extrusion(square(), 1, 0.4, flat=flat)
    assert (body.X[:, 2].min(), body.X[:, 2].max()) == (bottom, top)


@pytest.mark.parametrize("order", [1, 2])
def test_ranks_hold_contiguous_nodes(order):
    mesh = disc(ranks=3)
    body = Extrusion(plane(mesh, order), 2, 0.1)
    assert body.node_offsets.dtype == np.int32 and body.node_offsets[-1] == body.n_nodes
    for r in range(3):
        own = slice(body.node_offsets[r], body.node_offsets[r + 1])
        below = slice(body.plane.node_offsets[r], body.plane.node_offsets[r + 1])
        columns = body.X[own].reshape(-1, body.levels, 3)
        np.testing.assert_array_equal(columns[:, :, :2], np.repeat(body.plane.X[below, None], body.levels, axis=1))


@pytest.mark.parametrize("order", [1, 2])
def test_flips_give_the_cells_of_a_rebuilt_body(order):
    mesh = square()
    space = plane(mesh, order)
    body = Extrusion(space, 2, WEDGE, {"h0": 0.2})
    geometry, before = body.geometry, body.cells.copy()
    mesh.X[:, 0] += 0.9 * mesh.X[:, 1]
    if order == 2:
        space.bend(mesh.outline)
        space.place()
    flips, changed = Reconnection(mesh).flip(mesh.X)
    assert flips > 0
    if order == 2:
        space.reconnect(changed)
        space.place()
    others = body.follow(changed)
    fresh = Extrusion(space, 2, WEDGE, {"h0": 0.2})
    np.testing.assert_array_equal(body.cells, fresh.cells)
    np.testing.assert_array_equal(body.X, fresh.X)
    assert set(np.flatnonzero((before != body.cells).any(axis=1))) <= set(others)
    assert len(others) == 6 * len(changed) and body.geometry != geometry
    assert volumes(body).min() > 0
    assert len(body.follow()) == 0


@pytest.mark.parametrize("kind", ["tet4", "tet10", "plate"])
def test_velocities_are_those_of_the_nodes(kind):
    """By central differences of a thickness that is a formula of the place."""
    mesh = square()
    wave = Expression("h0*(1 + sin(3*x)*y)")
    space = plane(mesh, 2 if kind == "tet10" else 1)
    dX = np.random.default_rng(5).uniform(-1, 1, (2, *space.X.shape))

    def made():
        given = (wave, {"h0": 0.2})
        return PlateMesh(mesh, *given) if kind == "plate" else Extrusion(space, 2, *given, flat="top")

    rates, X, h = made().motion(dX), space.X.copy(), 1e-5
    for direction, rate in zip(dX, rates):
        space.X[:] = X + h * direction
        ahead = made().X
        space.X[:] = X - h * direction
        np.testing.assert_allclose(rate, (ahead - made().X) / (2 * h), atol=1e-8)


def test_entities_and_fields_are_by_columns():
    mesh = square()
    body = Extrusion(mesh, 2, 0.3)
    nodes = body.nodes_of("e0")
    assert len(nodes) == 3 * len(mesh.nodes_of("e0"))
    assert np.all(body.X[nodes, 1] == 0)
    assert np.array_equal(body.cells_of("all"), np.arange(body.n_cells))
    assert len(body.cell_region) == body.n_cells


def test_thickness_must_be_positive():
    with pytest.raises(ReplayProblem, match=r"the thickness is -80 mm at x = 0.8 m"):
        Extrusion(square(), 1, Expression("0.32 - x/2"))
    with pytest.raises(ReplayProblem, match="thickness"):
        PlateMesh(square(), Expression("log(x)"))


def test_interpolated_field_is_the_old_one_at_the_new_place():
    """A quadratic field of the place in the plane, with a different one in each level."""
    mesh = square()
    mesh.X[:, 0] += 0.5 * mesh.X[:, 1]
    space = LagrangeSpace(mesh)
    body = Extrusion(space, 1, 0.3)

    def field(X):
        return np.column_stack([X[:, 0] * X[:, 1], X[:, 0] ** 2 * (1 + X[:, 2]), X[:, 1] * X[:, 2]])

    before = field(body.X)
    flips, changed = Reconnection(mesh).flip(mesh.X)
    space.reconnect(changed)
    after = body.interpolate(before, space.interpolations)
    space.place()
    body.follow(changed)
    assert flips > 0
    np.testing.assert_allclose(after, field(body.X), atol=1e-12)


def test_rim_of_a_plate_is_its_boundary_also_after_flips():
    """Sides of triangles without a neighbour: those of the outline and of holes, not those of regions."""
    hole, region = [[0.2, 0.2], [0.4, 0.2], [0.4, 0.4], [0.2, 0.4]], [[0.6, 0.6], [0.9, 0.6], [0.9, 0.9]]
    mesh = generate(polygon_outline(SQUARE, holes={"h": hole}, regions={"r": region}), MeshSpec(size=0.12))
    plate = PlateMesh(mesh, 0.1)

    def lonely():
        sides = np.sort(np.stack([mesh.cells, np.roll(mesh.cells, -1, axis=1)], axis=2), axis=2)
        _, index, count = np.unique(sides.reshape(-1, 2), axis=0, return_inverse=True, return_counts=True)
        return (count[index] == 1).reshape(-1, 3)

    np.testing.assert_array_equal(plate.rim(), lonely())
    mesh.X[:, 0] += 0.9 * mesh.X[:, 1]
    flips, changed = Reconnection(mesh).flip(mesh.X)
    plate.follow(changed)
    assert flips > 0
    np.testing.assert_array_equal(plate.rim(), lonely())
