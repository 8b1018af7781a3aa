"""Contact of cloth with itself: a potential with its derivatives, steps that let nothing pass, and friction."""

import numpy as np
import pytest
from scipy.interpolate import griddata
from test_cloth_crossings import grid

from restshape import _kernels
from restshape.physics.cloth.contact.collision_surface import CollisionSurface
from restshape.physics.cloth.self_contact.layer_friction import LayerFriction, Touching
from restshape.physics.cloth.self_contact.self_contact import VOIGT, SelfContact, SelfContactValues
from restshape.physics.cloth.self_contact.touching_pairs import barrier_force, touching

D, STIFFNESS, FRICTION, SLIP = 0.03, 2.0, 0.4, 1e-3


@pytest.fixture
def folded():
    """A rough sheet with its flap above it, nearer than contact begins, and which nodes are the flap's."""
    X, cells = grid(12)
    random = np.random.default_rng(0)
    X = X + random.uniform(-0.01, 0.01, X.shape)
    x = np.column_stack([X, np.zeros(len(X))])
    flap = X[:, 0] > 0.55
    x[flap] = np.column_stack([1.11 - X[flap, 0], X[flap, 1] + 0.013, np.full(flap.sum(), 0.02)])
    x += random.uniform(-4e-3, 4e-3, x.shape)
    return SelfContact(CollisionSurface(X, cells), SelfContactValues(D, STIFFNESS, FRICTION, SLIP)), x, flap


def slid(contact, x):
    """Friction that holds, and positions to which some pairs have slid on and others have not."""
    random = np.random.default_rng(1)
    for scale in (5e-4, 3e-4):
        contact.update_friction(x)
        x = x + scale * random.normal(size=x.shape)
    return x


def test_forces_are_the_slope_of_the_energy(folded):
    contact, x, _ = folded
    x = slid(contact, x)
    d, h = np.random.default_rng(2).normal(size=x.shape), 1e-7
    slope = (contact.energy(x + h * d) - contact.energy(x - h * d)) / (2 * h)
    assert slope == pytest.approx(np.vdot(contact.forces(x), d), rel=1e-6)
    # Nothing outside pushes.
    np.testing.assert_allclose(contact.forces(x).sum(axis=0), 0.0, atol=1e-12)


@pytest.mark.parametrize("curved", [True, False])
def test_second_derivatives_are_the_slope_of_forces_or_semidefinite(folded, curved):
    contact, x, _ = folded
    x = slid(contact, x)
    contact.cover(x)
    single, coupled = contact.second_derivatives(x, curved)
    n = len(x)
    matrix = np.zeros((n, 3, n, 3))
    for i in range(n):
        matrix[i, :, i, :] = single[i][VOIGT]
    for (i, j), block in zip(contact.pairs, coupled.reshape(-1, 3, 3)):
        matrix[i, :, j, :], matrix[j, :, i, :] = block, block.T
    matrix = matrix.reshape(3 * n, 3 * n)
    lowest = np.linalg.eigvalsh(matrix)[0] / np.abs(matrix).max()
    if not curved:
        assert lowest > -1e-12
        return
    assert lowest < -1e-3
    d, h = np.random.default_rng(2).normal(size=x.shape), 1e-7
    slope = (contact.forces(x + h * d) - contact.forces(x - h * d)) / (2 * h)
    np.testing.assert_allclose(matrix @ d.ravel(), slope.ravel(), atol=1e-6 * np.abs(slope).max())


def test_no_share_of_a_step_lets_anything_pass(folded):
    """Steps of all sizes: after the share nothing crosses, and all of the step often would."""
    contact, x, _ = folded
    random, crossed = np.random.default_rng(3), 0
    for size in (0.003, 0.01, 0.03, 0.1, 0.3):
        d = size * random.normal(size=x.shape)
        share = contact.step_share(x, d)
        assert 0.0 < share <= 1.0
        assert not contact.surface.crosses(x + share * d)
        crossed += contact.surface.crosses(x + d)
    assert crossed >= 4
    # All of the cloth together goes any way.
    assert contact.step_share(x, np.ones_like(x)) == 1.0


def test_the_share_of_a_step_is_that_of_the_library_or_a_little_more(folded):
    contact, x, _ = folded
    library, random = contact.surface.library, np.random.default_rng(4)
    for size in (0.01, 0.1):
        d = size * random.normal(size=x.shape)
        ends = (np.asfortranarray(x), np.asfortranarray(x + d))
        method = {"broad_phase": library.BruteForce(), "narrow_phase_ccd": library.AdditiveCCD()}
        known = library.compute_collision_free_stepsize(contact.mesh, *ends, 0.0, **method)
        # The library looks as far beyond the end as its last advance leads.
        assert known * (1.0 - 1e-9) <= contact.step_share(x, d) <= 1.02 * known


def test_shares_and_pairs_of_steps_beside_each_other_are_those_of_steps_by_themselves(folded):
    """Pairs that are kept from one step to the next lose none: long steps, short ones, and some that go back."""
    contact, x, _ = folded
    surface, reach, random = contact.surface, 0.02, np.random.default_rng(6)
    parts = surface.flat[:, :2], surface.edges, surface.cells
    kept, shares = _kernels.NearPairs(*parts), []
    for k in range(24):
        d = random.choice([1e-4, 1e-3, 5e-3, 3e-2]) * random.normal(size=x.shape) + random.normal(size=3)
        shares.append(kept.step_share(x, d, reach))
        assert shares[-1] == _kernels.NearPairs(*parts).step_share(x, d, reach)
        x = x + (0.5 * shares[-1] if k % 3 else -1e-3) * d
        for found, known in zip(kept.search(x, reach), _kernels.NearPairs(*parts).search(x, reach)):
            np.testing.assert_array_equal(found, known)
    assert min(shares) < 1.0 == max(shares)


def test_near_pairs_are_those_that_comparing_all_finds(folded):
    contact, x, _ = folded
    surface, reach = contact.surface, 0.05
    edge_edge, cell_node = _kernels.NearPairs(surface.flat[:, :2], surface.edges, surface.cells).search(x, reach)
    found = surface.library.Candidates()
    found.build(contact.mesh, np.asfortranarray(x), reach, surface.library.BruteForce())
    edges, cells = np.asfortranarray(surface.edges), np.asfortranarray(surface.cells)
    at = np.asfortranarray(x)
    near = [one for one in found.ee_candidates if one.compute_distance(at, edges, cells) < reach**2]
    assert sorted(sorted((one.edge0_id, one.edge1_id)) for one in near) == edge_edge.tolist()
    near = [one for one in found.fv_candidates if one.compute_distance(at, edges, cells) < reach**2]
    assert sorted([one.face_id, one.vertex_id] for one in near) == cell_node.tolist()
    assert len(edge_edge) > 1000 and len(cell_node) > 300


def test_pairs_press_as_hard_as_the_barrier_does(folded):
    """Forces along the normals are all that the barrier does, but for what turns edges that are nearly parallel."""
    contact, x, flap = folded
    pairs, forces = touching(contact.surface, contact.at(x).collisions, x, D, STIFFNESS), contact.at(x).forces
    pushed = np.zeros_like(x)
    np.add.at(pushed, pairs.nodes, -(pairs.forces[:, None] * pairs.shares)[:, :, None] * pairs.normals[:, None, :])
    np.testing.assert_allclose(pushed, forces, atol=0.03 * np.abs(forces).max())
    np.testing.assert_allclose(pushed[flap].sum(axis=0), forces[flap].sum(axis=0), atol=1e-3 * np.abs(forces).max())


def test_the_barrier_grows_from_none_at_its_onset_without_end():
    pressure = barrier_force(np.array([2.0, 1.0, 0.999, 0.5, 1e-3]), 1.0)
    assert pressure[0] == pressure[1] == 0.0 < pressure[2] < 1e-4
    # 4 y (y^2 - 1) ln y^2 + 2 (y^2 - 1)^2/y at y = 1/2.
    assert pressure[3] == pytest.approx(1.5 * np.log(4.0) + 2.25)
    assert pressure[4] == pytest.approx(2e3, rel=0.05)


def test_friction_holds_up_to_its_coefficient_and_no_further():
    """A node on a triangle, pressed with 5 N, is pushed along it."""
    x = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.25, 0.25, 0.01]])
    pair = Touching(
        np.array([[0, 1, 2, 3]]), np.array([[0.5, 0.25, 0.25, -1.0]]), np.array([[0, 0, -1.0]]), np.array([5.0])
    )
    friction, _ = LayerFriction.none(4).updated(x, pair, SLIP)
    for way, part in ((0.5 * SLIP, 0.75), (SLIP, 1.0), (7 * SLIP, 1.0)):
        out, moved = np.zeros_like(x), x.copy()
        moved[3] += [way, 0.0, 0.3]
        friction.add_forces(moved, FRICTION, SLIP, out)
        np.testing.assert_allclose(out[3], [part * FRICTION * 5.0, 0.0, 0.0], atol=1e-12)
        np.testing.assert_allclose(out.sum(axis=0), 0.0, atol=1e-12)
        # After an update it is held as before, the anchor dragged behind it.
        after, slid_on = friction.updated(moved, pair, SLIP)
        assert slid_on == pytest.approx(max(0.0, way - SLIP))
        again = np.zeros_like(x)
        after.add_forces(moved, FRICTION, SLIP, again)
        np.testing.assert_allclose(again, out, atol=1e-12)


def test_friction_is_handed_on_to_the_next_triangle():
    x = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.5, 0.5, 0.01], [1, 1, 0]])
    first = Touching(np.array([[0, 1, 2, 3]]), np.array([[0.0, 0.5, 0.5, -1.0]]), np.array([[0, 0, -1.0]]), np.ones(1))
    second = Touching(
        np.array([[4, 1, 2, 3]]), np.array([[0.1, 0.45, 0.45, -1.0]]), np.array([[0, 0, -1.0]]), np.ones(1)
    )
    friction, _ = LayerFriction.none(5).updated(x, first, SLIP)
    x[3, 0] += 0.5 * SLIP
    friction, _ = friction.updated(x, second, SLIP)
    out = np.zeros_like(x)
    friction.add_forces(x, FRICTION, SLIP, out)
    # 0.9 of what held it: one node of the new triangle has touched nothing.
    y = 0.5
    assert 0.8 < out[3, 0] / (FRICTION * (2 * y - y**2)) <= 1.0


def test_pairs_that_touch_as_before_keep_what_held_them():
    """Two edges that end at one node give its pair twice, once in the reverse order; the last pair is two edges."""
    nodes = np.array([[0, 1, 2, 3], [4, 5, 4, 4], [5, 4, 5, 5], [4, 5, 4, 4], [0, 1, 2, 3]])
    shares = [[0.5, 0.25, 0.25, -1.0], [1, -1, 0, 0], [1, -1, 0, 0], [1, -1, 0, 0], [0.4, 0.6, -0.5, -0.5]]
    normals = np.array([[0, 0, 1.0], [0, 0, 1], [0, 0, -1], [0, 0, 1], [0, 0, 1]])
    pairs = Touching(nodes, np.array(shares), normals, np.ones(5))
    ways = np.array([[1.0, 2, 0], [3, 4, 0], [-3, -4, 0], [3, 4, 0], [-5, 6, 0]])
    friction = LayerFriction(pairs, SLIP * ways, np.zeros((6, 3)))
    np.testing.assert_array_equal(friction.handed_on(pairs), friction.offsets)
    reverse = Touching(nodes, -pairs.shares, -normals, pairs.forces)
    np.testing.assert_array_equal(friction.handed_on(reverse), -friction.offsets)


def test_design_rates_are_the_slopes_of_forces_where_the_pattern_changes(folded):
    contact, x, _ = folded
    X, cells = contact.surface.flat[:, :2].copy(), contact.surface.cells
    dX, h = np.random.default_rng(5).normal(size=X.shape), 1e-7
    ends = [SelfContact(CollisionSurface(X + s * h * dX, cells), contact.values).forces(x) for s in (1, -1)]
    rates = contact.force_rates(x, dX)
    slope = (ends[0] - ends[1]) / (2 * h)
    np.testing.assert_allclose(rates, slope, atol=1e-5 * np.abs(slope).max())
    assert np.abs(rates).max() > 0.0


def test_friction_is_handed_on_to_another_mesh(folded):
    """A flap that has slid by half of the way at which friction is all there is held as hard on a finer mesh."""
    held = {}
    for n in (12, 20):
        X, cells = grid(n)
        x, flap = np.column_stack([X, np.zeros(len(X))]), X[:, 0] > 0.55
        x[flap] = np.column_stack([1.11 - X[flap, 0], X[flap, 1], np.full(flap.sum(), 0.02)])
        contact = SelfContact(CollisionSurface(X, cells), SelfContactValues(D, STIFFNESS, FRICTION, SLIP))
        if not held:
            contact.update_friction(x)
            x[flap, 1] += 0.5 * SLIP
            old, values = X, contact.history.mapped(x, lambda values: values)
        else:
            x[flap, 1] += 0.5 * SLIP
            assert contact.history.energy(x, FRICTION, SLIP) == 0.0
            contact.hold(x, griddata(old, values, X))
        forces = np.zeros_like(x)
        contact.history.add_forces(x, FRICTION, SLIP, forces)
        held[n] = forces[flap].sum(axis=0) / contact.at(x).forces[flap, 2].sum()
    # At half of the way three quarters of the coefficient.
    np.testing.assert_allclose(held[12], [0.0, -0.75 * FRICTION, 0.0], atol=0.01 * FRICTION)
    np.testing.assert_allclose(held[20], held[12], atol=0.05 * FRICTION)


@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_cloth_that_is_folded_over_in_its_own_plane_does_not_touch_itself_yet(turn):
    """A corner lies in the triangle beside its own: no edge passes through one, and the barrier is infinite."""
    X, cells = grid(4)
    contact = SelfContact(CollisionSurface(X, cells), SelfContactValues(D, STIFFNESS, 0.0, SLIP))
    corner = next(node for node in range(len(X)) if (cells == node).sum() == 1)
    own = cells[(cells == corner).any(axis=1)][0]
    beside = next(cell for cell in cells if len(np.intersect1d(cell, own)) == 2)
    x = np.column_stack([X, np.zeros(len(X))])
    x = x @ np.array([[np.cos(turn), 0.0, np.sin(turn)], [0.0, 1.0, 0.0], [-np.sin(turn), 0.0, np.cos(turn)]])
    assert contact.begin(x)
    x[corner] = x[beside].mean(axis=0)
    assert not contact.surface.crosses(x) and not contact.begin(x)
    x[corner] += 1e-3 * np.array([-np.sin(turn), 0.0, np.cos(turn)])
    assert contact.begin(x) and np.isfinite(contact.energy(x))
