"""Points of triangles that touch: their quadrature, forces and tangents, their friction, and what they keep out."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.operator import Operator
from restshape.fem.assembled import Assembled
from restshape.physics.cloth.contact.contact import Contact
from restshape.physics.cloth.contact.contact_points import MOST_PARTS, ContactPoints, lattice
from restshape.physics.cloth.point_forces import PointForces, TriangleForces
from restshape.physics.cloth.sheet.parameters import lumped, lumped_rates, triangle_areas, triangle_rates

X = np.array([[0.0, 0.0], [0.03, 0.0], [0.0, 0.03], [0.03, 0.03], [0.06, 0.01]])
CELLS = np.array([[0, 1, 2], [1, 3, 2], [1, 4, 3]], dtype=np.int32)
THICKNESS = 2e-3
EDGE = _kernels.Body.capsule((0.012, -1.0, -5.5e-3), (0.012, 1.0, -5.5e-3), 5e-3)


def flat() -> np.ndarray:
    """The triangles at z = 0, half a millimetre above a bar of 5 mm that runs between their corners."""
    return np.column_stack([X, np.zeros(len(X))])


def contact(bodies=(EDGE,), friction: float = 0.4) -> Contact:
    return Contact(
        bodies, lumped(X, CELLS), 1e6, THICKNESS, friction, 1e-4, cells=CELLS, cell_area=triangle_areas(X, CELLS)
    )


def terms(made: Contact, curved: bool = True) -> list[PointForces | TriangleForces]:
    """What contact adds to an operator over these triangles and their corners."""
    entities = np.arange(len(X), dtype=np.int32)[:, None]

    def rates(dX: np.ndarray) -> np.ndarray:
        return made.points.areas(
            lumped_rates(CELLS, triangle_rates(X, CELLS, dX), len(X)), triangle_rates(X, CELLS, dX)
        )

    nodes = PointForces(X, entities, made, np.ones(len(X)), rates, curved=curved)
    return [nodes, TriangleForces(X, entities, made, rates, curved)]


def test_places_of_points_are_sums_of_their_corners():
    """Those of three numbers a corner have a kernel; others are NumPy's."""
    points = ContactPoints(CELLS, np.array([3, 1, 2]))
    values = np.random.default_rng(3).normal(size=(len(X), 3))
    np.testing.assert_allclose(points.place(values), np.hstack([points.place(values[:, a : a + 1]) for a in range(3)]))
    found = _kernels.nonzero_rows(np.array([[0.0, 0.0], [0.0, 2.0], [0.0, -0.0], [np.nan, 0.0]]))
    np.testing.assert_array_equal(found, [1, 3])


def pressed(friction: float = 0.4) -> tuple[Contact, np.ndarray]:
    """Contact whose friction has begun, and positions somewhat off from there."""
    made, x = contact(friction=friction), flat()
    made.cut(x)
    made.update_friction(made.place(x))
    return made, x + np.random.default_rng(0).uniform(-1e-4, 1e-4, x.shape)


@pytest.mark.parametrize("parts", [2, 3, 7])
def test_the_points_are_the_composite_rule_of_the_corners(parts):
    """It integrates linear functions exactly, and x^2 with the error of the trapezoidal rule."""
    weights, share = lattice(parts)
    places = np.concatenate([np.eye(3), weights])
    rule = np.concatenate([np.full(3, 1.0 / (3 * parts**2)), share])
    assert rule.sum() == pytest.approx(1.0) and rule @ places == pytest.approx([1 / 3] * 3)
    # Exact is 1/6; one triangle's corners give 1/3.
    assert rule @ places[:, 0] ** 2 - 1 / 6 == pytest.approx((1 / 3 - 1 / 6) / parts**2)


def test_points_are_where_corners_do_not_suffice_and_no_area_is_lost():
    made, x = contact(), flat()
    assert EDGE.distances(x).min() > THICKNESS, "no corner touches"
    made.cut(x)
    points = made.points
    assert points.parts[:2].min() > 1 and points.parts[2] == 1
    spacing = 0.03 * np.sqrt(2) / points.parts[0]
    assert spacing**2 / (8 * (5e-3 + 0.5 * THICKNESS)) <= 0.5 * THICKNESS
    assert made.areas.sum() == pytest.approx(lumped(X, CELLS).sum())
    assert EDGE.distances(made.place(x)[len(x) :]).min() == pytest.approx(0.5e-3, abs=0.6e-3)
    # Once the bar has left there are corners alone, whose areas are theirs, to the bit.
    made.cut(x + np.array([0, 0, 0.1]))
    assert (made.points.parts == 1).all() and made.areas is made.area


def test_flat_faces_and_large_balls_need_no_points():
    floor, ball = _kernels.Body.plane((0, 0, -1e-3), (0, 0, 1)), _kernels.Body.sphere((0.01, 0.01, -1.001), 1.0)
    table = _kernels.Body.box((0, 0, -0.101), (1, 1, 0.1), None, 4e-3)
    for body in (floor, ball, table):
        made = contact([body])
        made.cut(flat())
        assert (made.points.parts == 1).all()


def test_a_needle_between_corners_touches():
    """1 mm across, between corners that are 30 mm apart: forces push the triangle off."""
    made = contact([_kernels.Body.capsule((0.01, -1, -4e-4), (0.01, 1, -4e-4), 5e-4)])
    made.cut(flat())
    out = np.zeros((len(X), 3))
    Assembled(terms(made)).residual(flat(), out)
    assert out[:, 2].sum() < -1e-3
    assert made.points.parts.max() <= MOST_PARTS


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_forces_are_slopes_of_the_energy_and_tangents_of_the_forces(friction):
    made, x = pressed(friction)
    d, h = np.random.default_rng(1).uniform(-1, 1, x.shape), 1e-8
    found = Assembled(terms(made))
    force, product = found.residual(x), found.tangent_product(x, d)
    energies = [found.energy(x + sign * h * d) for sign in (1, -1)]
    assert float((force * d).sum()) == pytest.approx((energies[0] - energies[1]) / (2 * h), rel=1e-5)
    rates = (found.residual(x + h * d) - found.residual(x - h * d)) / (2 * h)
    np.testing.assert_allclose(product, rates, atol=2e-5 * np.abs(product).max())
    assert np.abs(force[:3]).max() > 0.0


@pytest.mark.parametrize("backend", ["csr", "bcsr"])
def test_the_matrix_multiplies_as_the_product_does(backend):
    made, x = pressed()
    operator = Operator(PETSc.COMM_SELF, 3, np.array([0, len(X)]), backend)
    operator.set_topology([CELLS, np.arange(len(X), dtype=np.int32)[:, None]], np.zeros(3 * len(X), np.uint8))
    found, right = Assembled(terms(made), operator), np.zeros_like(x)
    matrix = found.tangent(x, right)
    np.testing.assert_allclose(right, found.residual(x), atol=1e-12 * np.abs(right).max())
    d = np.random.default_rng(1).uniform(-1, 1, x.shape)
    source, out = PETSc.Vec().createWithArray(d.ravel()), PETSc.Vec().createSeq(d.size)
    matrix.mult(source, out)
    product = found.tangent_product(x, d)
    np.testing.assert_allclose(out.getArray().reshape(x.shape), product, atol=1e-10 * np.abs(product).max())


def test_design_products_are_slopes_of_forces_where_areas_change():
    made, x = pressed()
    dX, h = np.random.default_rng(2).uniform(-1, 1, X.shape), 1e-7

    def forces(step: float) -> np.ndarray:
        moved = X + step * dX
        made.area, made.cell_area = lumped(moved, CELLS), triangle_areas(moved, CELLS)
        return Assembled(terms(made)).residual(x)

    expected = (forces(h) - forces(-h)) / (2 * h)
    forces(0.0)
    found = Assembled(terms(made)).design_product(x, dX)
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(found).max())


def test_friction_goes_on_at_other_points_of_the_same_triangles():
    """Every point is as far from its anchor, by friction that the corners had, or is where it was."""
    made, x = contact([_kernels.Body.plane((0, 0, -1e-3), (0, 0, 1))]), flat()
    made.update_friction(x)
    way = np.array([3e-5, -1e-5, 0.0])
    history = made.history.on(ContactPoints(CELLS, np.array([3, 1, 4])), x + way)
    place = history.points.place(x + way)
    np.testing.assert_allclose(place - history.anchors[0], np.tile(way, (len(place), 1)), atol=1e-15)
    assert (history.limits > 0.0).all()
    again = history.on(ContactPoints(CELLS, np.array([3, 2, 4])), x + way)
    same = again.points.cell != 1
    np.testing.assert_array_equal(again.anchors[0, len(x) :][same], history.anchors[0, len(x) :])


def test_forces_converge_to_those_of_a_bar_under_a_band():
    """The push of a flat band on a bar by the integral of the pressure: within 2 % with the points that are chosen."""
    made, x = contact(friction=0.0), flat()
    made.cut(x)
    push = -Assembled(terms(made)).residual(x)[:, 2].sum()
    # All of the first two triangles within reach of the bar: x from 0 to 30 mm, a width of 30 mm.
    across = np.linspace(0.0, 0.03, 200_001)
    gap = np.hypot(across - 0.012, 5.5e-3) - 5e-3
    s = np.clip(THICKNESS - gap, 0.0, None)
    pressure = 1e6 * s**2 / (2 * THICKNESS) * 5.5e-3 / np.hypot(across - 0.012, 5.5e-3)
    exact = 0.03 * np.trapezoid(pressure, across) if hasattr(np, "trapezoid") else 0.03 * np.trapz(pressure, across)
    errors = []
    for parts in (made.points.parts[0], 24):
        made.history = made.history.on(ContactPoints(CELLS, np.array([parts, parts, 1])), x)
        push = -Assembled(terms(made)).residual(x)[:, 2].sum()
        errors.append(abs(push / exact - 1.0))
    assert errors[0] < 0.25 and errors[1] < 0.01
