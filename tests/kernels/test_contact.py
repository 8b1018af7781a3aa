"""Contact: distances against a search for the nearest point, derivatives by differences, onset, friction."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from restshape import _kernels as k
from restshape.physics.cloth.contact.contact import Contact

TURN = Rotation.from_rotvec([0.3, -0.8, 0.5]).as_matrix()
CENTRE = np.array([0.1, -0.2, 0.3])
HALF = np.array([0.5, 0.3, 0.2])
ENDS = np.array([[-0.4, 0.1, 0.2], [0.5, 0.3, -0.1]])
NORMAL = np.array([0.6, 0.0, 0.8])
BODIES = {
    "sphere": k.Body.sphere(CENTRE, 0.4),
    "plane": k.Body.plane(CENTRE, 3 * NORMAL),
    "box": k.Body.box(CENTRE, HALF, TURN),
    "rounded box": k.Body.box(CENTRE, HALF, TURN, 0.1),
    "capsule": k.Body.capsule(*ENDS, 0.2),
    "cylinder": k.Body.cylinder(*ENDS, 0.4),
    "rounded cylinder": k.Body.cylinder(*ENDS, 0.4, 0.1),
}


def box_distance(x: np.ndarray, radius: float) -> np.ndarray:
    """From a box without its rounding, by clipping; outside of that core only."""
    local = (x - CENTRE) @ TURN.T
    core = HALF - radius
    return np.linalg.norm(local - np.clip(local, -core, core), axis=1) - radius


def line_distance(x: np.ndarray) -> np.ndarray:
    """From samples of the capsule's line, which lie ever closer about the nearest one."""
    middle, reach = np.full(len(x), 0.5), 0.5
    for _ in range(5):
        at = np.clip(middle[:, None] + reach * np.linspace(-1, 1, 41), 0.0, 1.0)
        away = np.linalg.norm(ENDS[0] + at[..., None] * (ENDS[1] - ENDS[0]) - x[:, None], axis=2)
        middle, reach = np.take_along_axis(at, away.argmin(axis=1)[:, None], axis=1)[:, 0], reach / 10
    return away.min(axis=1) - 0.2


def cylinder_distance(x: np.ndarray, rounded: float) -> np.ndarray:
    """From a cylinder without its rounding, by clipping along its axis and across; outside of that core only."""
    y, axis = x - ENDS.mean(axis=0), (ENDS[1] - ENDS[0]) / np.linalg.norm(ENDS[1] - ENDS[0])
    half = 0.5 * np.linalg.norm(ENDS[1] - ENDS[0]) - rounded
    along = y @ axis
    across = y - np.outer(along, axis)
    length = np.linalg.norm(across, axis=1)[:, None]
    nearest = across * np.minimum(1.0, (0.4 - rounded) / length) + np.outer(np.clip(along, -half, half), axis)
    return np.linalg.norm(y - nearest, axis=1) - rounded


EXACT = {
    "sphere": lambda x: np.linalg.norm(x - CENTRE, axis=1) - 0.4,
    "plane": lambda x: (x - CENTRE) @ NORMAL,
    "box": lambda x: box_distance(x, 0.0),
    "rounded box": lambda x: box_distance(x, 0.1),
    "capsule": line_distance,
    "cylinder": lambda x: cylinder_distance(x, 0.0),
    "rounded cylinder": lambda x: cylinder_distance(x, 0.1),
}


def places(name: str, count: int = 400) -> np.ndarray:
    """Points about a body, half of them within 2 % of where the nearest feature changes."""
    rng = np.random.default_rng(5)
    x = rng.uniform(-1.2, 1.2, (count, 3)) + CENTRE
    half = count // 2
    if "box" in name:
        core = HALF - (0.1 if name == "rounded box" else 0.0)
        local = rng.uniform(-1.2, 1.2, (half, 3))
        axis = rng.integers(0, 3, half)
        local[np.arange(half), axis] = core[axis] * rng.choice([-1, 1], half) * (1 + rng.uniform(-0.02, 0.02, half))
        x[:half] = local @ TURN + CENTRE
    elif name == "capsule" or "cylinder" in name:
        along = ENDS[1] - ENDS[0]
        offset = rng.uniform(-1, 1, (half, 3))
        offset -= np.outer(offset @ along, along) / (along @ along)
        x[:half] = ENDS[rng.integers(0, 2, half)] + offset + np.outer(rng.uniform(-0.02, 0.02, half), along)
    if "cylinder" in name:
        # A quarter near the border of the curved side and the rim.
        axis, core = along / np.linalg.norm(along), 0.1 if "rounded" in name else 0.0
        y = x[: half // 2] - ENDS.mean(axis=0)
        across = y - np.outer(y @ axis, axis)
        across *= ((0.4 - core) * (1 + rng.uniform(-0.02, 0.02, len(y))) / np.linalg.norm(across, axis=1))[:, None]
        x[: half // 2] = ENDS.mean(axis=0) + across + np.outer(rng.uniform(-0.8, 0.8, len(y)), axis)
    outside = EXACT[name](x) > (1e-3 if name in ("box", "cylinder") else -0.09)
    return x[outside]


def differences(f, x: np.ndarray, h: float = 1e-6) -> np.ndarray:
    """Central differences (n, ..., 3) of f in each coordinate."""
    steps = [np.asarray(f(x + h * axis)) - np.asarray(f(x - h * axis)) for axis in np.eye(3)]
    return np.stack(steps, axis=-1) / (2 * h)


@pytest.mark.parametrize("name", BODIES)
class TestDistance:
    def test_is_that_of_the_nearest_point(self, name):
        x = places(name)
        assert len(x) > 100
        np.testing.assert_allclose(BODIES[name].distance(x)[0], EXACT[name](x), atol=2e-8)

    def test_gradient(self, name):
        x = places(name)
        _, gradient, _ = BODIES[name].distance(x)
        np.testing.assert_allclose(gradient, differences(lambda y: BODIES[name].distance(y)[0], x), atol=2e-8)
        np.testing.assert_allclose(np.linalg.norm(gradient, axis=1), 1.0, rtol=1e-13)

    def test_hessian(self, name):
        x = places(name)
        _, _, hessian = BODIES[name].distance(x)
        found = differences(lambda y: BODIES[name].distance(y)[1], x)
        # A step across the border of two features sees both.
        same = np.abs(hessian - differences(lambda y: BODIES[name].distance(y)[1], x, 2e-6)).max(axis=(1, 2)) < 1e-3
        assert same.mean() > 0.98
        np.testing.assert_allclose(hessian[same], found[same], atol=1e-6)
        np.testing.assert_array_equal(hessian, hessian.swapaxes(1, 2))

    def test_inside_is_negative_and_leads_out(self, name):
        x = CENTRE - 0.03 * NORMAL + np.random.default_rng(2).uniform(-0.02, 0.02, (20, 3))
        if name == "capsule" or "cylinder" in name:
            x += ENDS.mean(axis=0) - CENTRE
        distance, gradient, _ = BODIES[name].distance(x)
        assert (distance < 0).all()
        np.testing.assert_allclose(BODIES[name].distance(x - distance[:, None] * gradient)[0], 0.0, atol=1e-12)


DRUMS = [(k.Body.cylinder(*ENDS, radius), ENDS.mean(axis=0)) for radius in (0.1, 0.9)]
"""A long one and a flat one."""


def test_middles_of_bodies_have_a_way_out():
    for body, middle in ((BODIES["sphere"], CENTRE), (BODIES["capsule"], ENDS.mean(axis=0)), *DRUMS):
        distance, gradient, hessian = body.distance(middle[None])
        assert distance[0] < 0 and np.isclose(np.linalg.norm(gradient), 1.0) and np.isfinite(hessian).all()


def test_a_capsule_without_length_is_a_sphere():
    x = places("sphere")
    for found, expected in zip(k.Body.capsule(CENTRE, CENTRE, 0.4).distance(x), BODIES["sphere"].distance(x)):
        np.testing.assert_allclose(found, expected, atol=1e-15)


def test_a_cylinder_rounded_all_over_is_a_capsule():
    """Of radius 0.2 and length 2 + 2 * 0.2, whose flat ends have shrunk to points."""
    axis = np.array([0.6, 0.0, 0.8])
    drum = k.Body.cylinder(CENTRE - 1.2 * axis, CENTRE + 1.2 * axis, 0.2, 0.2)
    x = CENTRE + np.random.default_rng(4).uniform(-2, 2, (200, 3))
    for found, expected in zip(drum.distance(x), k.Body.capsule(CENTRE - axis, CENTRE + axis, 0.2).distance(x)):
        np.testing.assert_allclose(found, expected, atol=1e-12)


def test_the_curvatures_of_a_rim():
    """Of a torus at an angle t from the plane of its circle R: 1/d along the meridian, cos t/(R + d cos t) around."""
    R, d, t = 0.3, 0.25, 0.7
    drum = k.Body.cylinder([0, 0, -1], [0, 0, 1], R + 0.1, 0.1)
    x = np.array([[R + d * np.cos(t), 0.0, 0.9 + d * np.sin(t)]])
    value, gradient, hessian = drum.distance(x)
    assert value[0] == pytest.approx(d - 0.1, rel=1e-14)
    np.testing.assert_allclose(gradient[0], [np.cos(t), 0, np.sin(t)], atol=1e-15)
    found = sorted(np.linalg.eigvalsh(hessian[0]))
    np.testing.assert_allclose(found, [0.0, np.cos(t) / (R + d * np.cos(t)), 1 / d], atol=1e-13)


@pytest.mark.parametrize(
    "make",
    [
        lambda: k.Body.sphere(CENTRE, 0.0),
        lambda: k.Body.plane(CENTRE, np.zeros(3)),
        lambda: k.Body.box(CENTRE, HALF, 2 * TURN),
        lambda: k.Body.box(CENTRE, HALF, TURN, 0.25),
        lambda: k.Body.capsule(*ENDS, -1.0),
        lambda: k.Body.cylinder(*ENDS, 0.0),
        lambda: k.Body.cylinder(ENDS[0], ENDS[0], 0.4),
        lambda: k.Body.cylinder(*ENDS, 0.4, 0.41),
        lambda: k.Body.cylinder(*ENDS, 0.9, 0.6),
        lambda: k.Body.cylinder(*ENDS, 0.4, -0.1),
    ],
)
def test_impossible_bodies_are_refused(make):
    with pytest.raises(ValueError):
        make()


STIFFNESS, THICKNESS = 700.0, 0.05


def contact_of(body, x, curved=True, stiffness=STIFFNESS):
    """Energy, gradient (n, 3) and Hessian (n, 3, 3) at x, with areas of 1."""
    table = np.zeros((len(x), 12))
    energy = body.add_contact(x, np.ones(len(x)), stiffness, THICKNESS, table, curved)
    return energy, table[:, 3:6], table[:, 6:][:, [[0, 5, 4], [5, 1, 3], [4, 3, 2]]]


@pytest.mark.parametrize("name", ["sphere", "rounded box", "capsule", "rounded cylinder"])
class TestPenalty:
    def near(self, name):
        x = places(name, 4000)
        distance, gradient, _ = BODIES[name].distance(x)
        wanted = np.random.default_rng(8).uniform(-0.03, 1.2 * THICKNESS, len(x))
        return (x + (wanted - distance)[:, None] * gradient)[:200]

    @pytest.mark.slow
    def test_gradient_and_hessian(self, name):
        x = self.near(name)
        body = BODIES[name]
        _, gradient, hessian = contact_of(body, x)
        for i in range(0, len(x), 10):
            found = differences(lambda y: contact_of(body, y)[0], x[i : i + 1])
            np.testing.assert_allclose(gradient[i], found, atol=1e-6)
        found = differences(lambda y: contact_of(body, y)[1], x)
        close = np.isclose(hessian, found, atol=1e-3).all(axis=(1, 2))
        assert close.mean() > 0.97  # the rest: a step across the border of two features

    @pytest.mark.slow
    def test_hessian_without_curvature_is_semidefinite(self, name):
        _, gradient, hessian = contact_of(BODIES[name], self.near(name), curved=False)
        assert np.linalg.eigvalsh(hessian).min() > -1e-12 * np.abs(hessian).max()
        assert np.abs(gradient).max() > 1.0


def test_penalty_has_two_continuous_derivatives():
    """On a plane, across the onset and the surface: jumps of the second derivative fall with the step."""
    body = k.Body.plane(np.zeros(3), [0, 0, 1.0])
    for edge in (THICKNESS, 0.0, -THICKNESS / 3):
        for step in (1e-4, 1e-5):
            x = np.array([[0, 0, edge - step], [0, 0, edge + step]])
            energy = [contact_of(body, x[i : i + 1])[0] for i in (0, 1)]
            _, gradient, hessian = contact_of(body, x)
            grown = 48 * np.exp(8.0) if edge < 0 else 48 if edge == 0.0 else 1.0
            assert abs(hessian[0, 2, 2] - hessian[1, 2, 2]) < 2.1 * grown * step * STIFFNESS / THICKNESS
            mean = gradient[:, 2].mean()
            assert abs(energy[1] - energy[0] - 2 * step * mean) < 10 * grown * STIFFNESS / THICKNESS * step**3
    # Below the surface a stiffness that grows by e^(24 u) on the way u t, and from t/3 on a spring of e^8 times it.
    x = np.array([[0, 0, -0.25 * THICKNESS], [0, 0, -0.1], [0, 0, -0.2]])
    _, gradient, hessian = contact_of(body, x)
    assert hessian[0, 2, 2] == pytest.approx(np.exp(6.0) * STIFFNESS)
    assert gradient[0, 2] == pytest.approx(-STIFFNESS * THICKNESS * (0.5 + (np.exp(6.0) - 1.0) / 24.0))
    np.testing.assert_allclose(gradient[2, 2] - gradient[1, 2], -0.1 * np.exp(8.0) * STIFFNESS, rtol=1e-9)


@pytest.mark.parametrize("name", BODIES)
def test_what_is_left_out_as_far_has_no_contact(name):
    """Energies of points all about a body, beside those of the penalty at their distances."""
    body, x = BODIES[name], np.random.default_rng(7).uniform(-1.2, 1.2, (4000, 3))
    s = np.maximum(THICKNESS - body.distances(x), 0.0) / THICKNESS
    outside = s < 1.0
    expected = STIFFNESS * THICKNESS**2 * (s[outside] ** 3).sum() / 6.0
    assert (s[outside] > 0.0).sum() > 20
    assert contact_of(body, x[outside])[0] == pytest.approx(expected, rel=1e-12)


def follow(body: k.Body, x: np.ndarray, coefficient: float, slip: float, *memory: np.ndarray) -> float:
    """Friction that follows to points x (n, 3) of area 1, as a body presses them; the way that it is dragged."""
    pushed = np.zeros((len(x), 12))
    body.add_contact(x, np.ones(len(x)), STIFFNESS, THICKNESS, pushed)
    return k.update_friction(x, pushed, coefficient, slip, *memory)


def test_far_points_take_no_normal_and_stick_where_they_are():
    """Those that a body has never pressed need none."""
    x = np.array([[0.0, 0.0, 3.0], [0.1, -0.2, 0.71]])
    memory = np.zeros((2, 3)), np.zeros((2, 3)), np.zeros(2)
    follow(BODIES["sphere"], x, 0.4, 0.01, *memory)
    anchors, normals, limits = memory
    np.testing.assert_allclose(anchors, x)
    np.testing.assert_allclose(normals, [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]], atol=1e-12)
    assert limits[0] == 0.0 < limits[1]


class TestFriction:
    slip, limit = 0.01, 3.0

    def of(self, u: np.ndarray):
        """Energy, gradient and Hessian at ways u (n, 3) from anchors at the origin."""
        n, table = len(u), np.zeros((len(u), 12))
        normals = np.tile(NORMAL, (n, 1))
        energy = k.add_friction(u, np.zeros((n, 3)), normals, np.full(n, self.limit), self.slip, table)
        return energy, table[:, 3:6], table[:, 6:][:, [[0, 5, 4], [5, 1, 3], [4, 3, 2]]]

    def test_derivatives(self):
        u = np.random.default_rng(1).uniform(-2, 2, (100, 3)) * self.slip
        _, gradient, hessian = self.of(u)
        for i in range(20):
            found = differences(lambda y: self.of(y)[0], u[i : i + 1], 1e-7)
            np.testing.assert_allclose(gradient[i], found, atol=1e-6)
        np.testing.assert_allclose(hessian, differences(lambda y: self.of(y)[1], u, 1e-7), atol=1e-3)
        assert np.linalg.eigvalsh(hessian).min() > -1e-10

    def test_force_is_along_the_surface_and_limited(self):
        u = np.random.default_rng(1).uniform(-3, 3, (100, 3)) * self.slip
        _, gradient, _ = self.of(u)
        np.testing.assert_allclose(gradient @ NORMAL, 0.0, atol=1e-13)
        along = u - np.outer(u @ NORMAL, NORMAL)
        length = np.linalg.norm(along, axis=1)
        np.testing.assert_allclose(np.linalg.norm(gradient, axis=1)[length > self.slip], self.limit, rtol=1e-12)
        assert (np.linalg.norm(gradient, axis=1) <= self.limit * (1 + 1e-12)).all()

    def test_anchors_stay_until_the_slip_is_whole(self):
        """On a plane deep enough for the limit, from anchors at the origin."""
        body, t = k.Body.plane(np.zeros(3), NORMAL), np.array([0.8, 0.0, -0.6])
        depth = 0.0 * NORMAL
        x = np.outer([0.5, 1.0, 3.0], t) * self.slip - depth
        coefficient = self.limit / (0.5 * STIFFNESS * THICKNESS)
        anchors, normals, limits = np.zeros((3, 3)), np.zeros((3, 3)), np.full(3, self.limit)

        def update(friction: float) -> float:
            return follow(body, x, friction, self.slip, anchors, normals, limits)

        np.testing.assert_allclose(update(coefficient), 2 * self.slip, rtol=1e-12)
        np.testing.assert_allclose(anchors, np.outer([0, 0, 2.0], t) * self.slip - depth, atol=1e-16)
        np.testing.assert_allclose(limits, self.limit, rtol=1e-12)
        np.testing.assert_allclose(normals, np.tile(NORMAL, (3, 1)), atol=1e-15)
        assert update(coefficient) < 1e-16
        update(0.0)
        assert not limits.any()
        np.testing.assert_array_equal(anchors, x)

    def test_what_touches_for_the_first_time_sticks_where_it_is(self):
        body, x = k.Body.plane(np.zeros(3), NORMAL), np.outer([-1.0, 2.0], NORMAL) * THICKNESS + [0.3, 0.1, 0.2]
        x -= np.outer((x @ NORMAL) - np.array([-1.0, 2.0]) * THICKNESS, NORMAL)
        anchors, normals, limits = np.ones((2, 3)), np.zeros((2, 3)), np.zeros(2)
        assert follow(body, x, 0.5, self.slip, anchors, normals, limits) == 0.0
        np.testing.assert_allclose(anchors, x, atol=1e-15)
        assert limits[0] > 0.0 and limits[1] == 0.0


def block_on_incline(friction: float, slope: float) -> tuple[bool, float]:
    """Whether a point of weight 2 N comes to rest on an incline, and how far it went."""
    normal = np.array([np.sin(slope), 0, np.cos(slope)])
    contact = Contact([k.Body.plane(np.zeros(3), normal)], np.ones(1), 1e5, 1e-3, friction, slip=1e-5)
    # Where the penalty of 1e5 s^2/(2e-3) carries the weight.
    x = (normal * (1e-3 - np.sqrt(2e-3 * 2.0 * np.cos(slope) / 1e5)))[None].copy()
    weight = np.array([0, 0, -2.0])
    contact.update_friction(x)
    for _ in range(60):
        for _ in range(60):
            _, table = contact.potential(x)
            r = table[0, 3:6] - weight
            H = table[0, 6:][[[0, 5, 4], [5, 1, 3], [4, 3, 2]]] + 1e-3 * np.eye(3)
            step = np.linalg.solve(H, -r)
            x += step * min(1.0, 1e-3 / np.linalg.norm(step))
            if np.linalg.norm(r) < 1e-9:
                break
        still = np.linalg.norm(r) < 1e-6
        if contact.update_friction(x) < 1e-9 and still:
            return True, np.linalg.norm(x)
        if np.linalg.norm(x) > 0.02:
            break
    return False, np.linalg.norm(x)


@pytest.mark.parametrize("friction", [0.2, 0.5])
def test_a_point_on_an_incline_sticks_up_to_the_friction_angle(friction):
    """tan(slope) = mu, within 1 %."""
    assert block_on_incline(friction, np.arctan(0.99 * friction))[0]
    assert not block_on_incline(friction, np.arctan(1.01 * friction))[0]


def test_what_is_known_of_a_potential_is_that_of_the_place_and_of_all_that_it_depends_on():
    body, x = k.Body.sphere(np.zeros(3), 0.4), np.array([[0.4, 0.0, 0.0], [0.0, 0.399, 0.0]])

    def fresh() -> Contact:
        made = Contact(contact.bodies, contact.area, contact.stiffness, contact.thickness, 0.3, contact.slip)
        made.history = contact.history
        return made

    contact = Contact([body], np.ones(2), STIFFNESS, THICKNESS, 0.3, slip=1e-3)
    changes = (
        lambda: None,
        lambda: contact.update_friction(x),
        lambda: x.__setitem__((1, 1), 0.3985),
        lambda: setattr(contact, "bodies", [k.Body.sphere(np.zeros(3), 0.401)]),
        lambda: setattr(contact, "area", 2.0 * np.ones(2)),
        lambda: setattr(contact, "stiffness", 3.0 * STIFFNESS),
        lambda: setattr(contact, "slip", 2e-3),
    )
    for change in changes:
        change()
        for curved in (True, False, True):
            energy, table = contact.potential(x, curved)
            expected = fresh().potential(x, curved)
            assert energy == expected[0] > 0.0 and np.array_equal(table, expected[1])
            assert contact.energy(x) == energy and np.array_equal(contact.forces(x), table[:, 3:6])
