"""Forces and validity of furniture against statics by hand, and against a linear solution made independently."""

from dataclasses import replace

import numpy as np
import pytest
from restshape_apps.furniture.analysis.plank_equilibrium import PlankEquilibrium
from restshape_apps.furniture.physics.furniture import LOST, OVERLAPPING, UNSTABLE, Compliance, Furniture
from restshape_apps.furniture.pieces import bookshelf, cantilever, chair, shelf_1, shelf_2, stool_chair, table
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.shape.planks import Load, Piece, Plank, feet_near, joints_near, weight
from restshape_apps.furniture.small_pieces import bench, block, ladder, mirrored, stool, stretched
from restshape_verification.furniture.least_energy import least_energy
from scipy.optimize import linprog

from restshape.errors import UserError

G = 9.80665
FINE = Compliance(least_overlap=1e-6)


def in_equilibrium(piece: Piece, compliance: Compliance | None = None) -> Furniture:
    """The model of a piece after its test."""
    furniture = Furniture(piece, compliance)
    furniture.test()
    return furniture


def foot_forces(furniture: Furniture, case: int = 0) -> np.ndarray:
    """The force (f, 3) of each foot."""
    return furniture.forces(case).contacts.reshape(-1, 4, 3).sum(axis=1)


# --- determinate ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("place", [0.0, 0.1, -0.35])
def test_a_plank_on_two_supports_has_the_reactions_of_the_lever(place: float) -> None:
    furniture = in_equilibrium(bench(place, mu=0.0), FINE)
    own = furniture.geometry().mass * G
    load = 20.0 * G
    expected = np.array([0.5 - place, 0.5 + place]) * load + 0.5 * own[0] + own[1:]
    assert foot_forces(furniture)[:, 2] == pytest.approx(expected, rel=1e-3)
    # Without friction the legs carry straight down: no thrust, and compression of the joints.
    assert np.abs(foot_forces(furniture)[:, :2]).max() < 1e-6 * load
    assert -furniture.forces().tension == pytest.approx(expected - own[1:], rel=1e-3)


def test_a_cantilever_has_the_moment_of_its_load_and_of_its_weight() -> None:
    arm, kilograms = 0.19, 0.8
    furniture = in_equilibrium(cantilever(arm=arm, kilograms=kilograms))
    beam = furniture.geometry().mass[2] * G
    forces = furniture.forces()
    assert abs(forces.bending[1]) == pytest.approx(kilograms * G * arm + beam * arm / 2, rel=1e-6)
    assert np.hypot(*forces.shear[1]) == pytest.approx(kilograms * G + beam, rel=1e-6)
    assert abs(forces.tension[1]) < 1e-6 * beam
    assert furniture.nails()[1] == 3


def test_the_nail_cantilever_breaks_at_the_weight_of_the_experiment() -> None:
    # 5.2 kN/m x 20 mm x 3 nails x 6 mm = 1.87 N m; the thesis hung about 1 kg at 0.19 m.
    piece = cantilever(kilograms=1.0)
    furniture = in_equilibrium(piece)
    beam = furniture.geometry().mass[2] * G
    moment = 5.2e3 * 0.02 * 3 * 0.006
    limit = (moment - beam * 0.095) / 0.19 / G
    for kilograms, breaks in ((0.999 * limit, False), (1.001 * limit, True)):
        assert (Furniture(cantilever(kilograms=kilograms)).test().pull > 1.0) is breaks
    assert limit == pytest.approx(1.0, rel=0.06)


def test_a_tripod_has_barycentric_reactions() -> None:
    feet, at = [(-0.4, -0.3), (0.45, -0.2), (0.0, 0.4)], (0.1, 0.05)
    furniture = in_equilibrium(stool(feet, at, 30.0, mu=0.0), FINE)
    assert furniture.test().flaws & UNSTABLE == 0
    corners = np.vstack([np.array(feet).T, np.ones(3)])
    share = np.linalg.solve(corners, [*at, 1.0])
    middle = np.linalg.solve(corners, [0.0, 0.0, 1.0])
    own = furniture.geometry().mass * G
    expected = 30.0 * G * share + own[0] * middle + own[1:]
    assert foot_forces(furniture)[:, 2] == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("mu", [0.3, 0.5, 0.8])
def test_a_leaning_plank_slides_below_the_angle_of_friction(mu: float) -> None:
    limit = np.arctan(1.0 / (2.0 * mu))
    for angle, falls in ((limit + 1e-4, False), (limit - 1e-4, True)):
        assert bool(Furniture(ladder(angle, mu)).test().flaws & UNSTABLE) is falls


def test_a_leaning_plank_exactly_at_the_limit_stands() -> None:
    assert not Furniture(ladder(np.arctan(1.0), 0.5)).test().flaws & UNSTABLE


@pytest.mark.parametrize(("base", "high", "mu"), [(0.1, 0.5, 0.5), (0.3, 0.5, 0.3), (0.2, 1.0, 0.15)])
def test_a_block_on_an_incline_tips_or_slides(base: float, high: float, mu: float) -> None:
    limit = np.arctan(min(mu, base / high))
    for angle, falls in ((limit - 1e-5, False), (limit + 1e-5, True)):
        assert bool(Furniture(block(base, high, mu, angle)).test().flaws & UNSTABLE) is falls


@pytest.mark.parametrize("height", [0.05, 0.25, 0.5])
def test_a_push_tips_or_slides_a_block(height: float) -> None:
    base, high, mu = 0.2, 0.5, 0.4
    piece = block(base, high, mu)
    own = Furniture(piece).geometry().mass[0] * G
    limit = min(mu * own, own * 0.5 * base / height)
    for push, falls in ((limit * (1 - 1e-5), False), (limit * (1 + 1e-5), True)):
        load = Load("push", 0, (height / high - 0.5, 0.0, 0.0), (push, 0.0, 0.0))
        assert bool(Furniture(replace(piece, pushes=(load,))).test().flaws & UNSTABLE) is falls


# --- four legs, and legs of unequal length ----------------------------------------------------------------------------

CORNERS = [(-0.4, -0.4), (0.4, -0.4), (-0.4, 0.4), (0.4, 0.4)]


def test_four_legs_stand_where_springs_would_pull() -> None:
    # With the mass beyond the diagonal of the opposite legs, bilateral springs pull at one of them.
    furniture = Furniture(stool(CORNERS, (0.3, 0.3), 50.0), FINE)
    assert not furniture.test().flaws & UNSTABLE
    assert furniture.forces().one_sided
    reactions = foot_forces(furniture)
    assert reactions[:, 2].min() >= -1e-9
    own = furniture.geometry().mass.sum() * G
    assert reactions[:, 2].sum() == pytest.approx(own + 50.0 * G, rel=1e-9)


@pytest.mark.parametrize(("at", "falls"), [((0.05, -0.1), False), ((0.2, 0.2), True)])
def test_a_short_leg_leaves_three(at: tuple[float, float], falls: bool) -> None:
    furniture = Furniture(stool(CORNERS, at, 200.0, short=3), FINE)
    assert len(furniture.piece.feet) == 3
    assert bool(furniture.test().flaws & UNSTABLE) is falls


def test_feet_in_one_line_fall_unless_the_weight_is_right_above() -> None:
    assert Furniture(stool([(-0.4, 0.0), (0.4, 0.0)], (0.0, 0.05), 20.0), FINE).test().flaws & UNSTABLE
    assert not Furniture(stool([(-0.4, 0.0), (0.4, 0.0)], (0.1, 0.0), 20.0), FINE).test().flaws & UNSTABLE


# --- indeterminate ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("piece", [table(), chair(), stool_chair(), shelf_1(), bench(leg=0.02)], ids=lambda p: p.name)
def test_indeterminate_forces_are_those_of_least_energy(piece: Piece) -> None:
    stiff = Compliance(1e-12, 1e-12, 1e-12)
    furniture = Furniture(piece, stiff)
    # Springs alone: what the linear solution has.
    geometry = furniture.geometry()
    solver = PlankEquilibrium(furniture)
    forces = solver.solve(0, one_sided=False)
    joints, contacts = least_energy(furniture)
    size = np.abs(joints).max()
    assert forces.contacts == pytest.approx(contacts, abs=1e-6 * np.abs(contacts).max())
    assert forces.tension == pytest.approx(np.einsum("ka,ka->k", joints[:, :3], geometry.n), abs=1e-6 * size)
    assert forces.bending == pytest.approx(np.einsum("ka,ka->k", joints[:, 3:], geometry.y), abs=1e-6 * size)
    solver.destroy()


@pytest.mark.parametrize("make", [shelf_1, stool_chair, table])
def test_forces_in_loops_depend_on_the_ratio_of_compliances_alone(make) -> None:
    found = []
    for scale in (1e-12, 1e-11, 1e-10, 1e-9, 1e-8):
        furniture = in_equilibrium(make(), Compliance(scale, 0.5 * scale, 2.0 * scale))
        found.append(np.concatenate([furniture.forces().bending, furniture.forces().tension]))
    for other in found[1:]:
        assert other == pytest.approx(found[0], abs=1e-4 * np.abs(found[0]).max())
    other = in_equilibrium(make(), Compliance(1e-9, 1e-6, 1e-9)).forces().bending
    assert np.abs(other - found[0][: len(other)]).max() > 1e-3 * np.abs(other).max()


def test_what_a_stretcher_bears_under_a_weight_over_a_leg_is_of_joints_not_of_the_floor() -> None:
    piece = stretched(0.35)
    usual = Compliance()
    joints, _ = least_energy(Furniture(piece))
    found = in_equilibrium(piece)
    rail = [k for k, joint in enumerate(piece.joints) if joint.i == 3]
    moment = np.abs(found.forces().bending[rail])
    # Feet lift at one edge, which springs both ways do not.
    expected = np.abs(np.einsum("ka,ka->k", joints[:, 3:], found.geometry().y))[rail]
    assert moment == pytest.approx(expected, rel=0.1)
    hard = in_equilibrium(piece, replace(usual, floor=1e-3 * usual.floor)).forces().bending[rail]
    assert np.abs(hard) == pytest.approx(moment, rel=0.1)
    # Where joints turn as easily as nails let them, the leg's way down bends nothing: each end bears half of the rail.
    loose = in_equilibrium(piece, replace(usual, joint_r=4.0 / 0.018**2 * usual.joint_t)).forces()
    own = 420.0 * 0.018 * 0.2 * (0.7 - 0.018) * G
    assert np.abs(loose.bending[rail]).max() < 1e-3 * moment.min()
    assert np.hypot(*loose.shear[rail].T) == pytest.approx(own / 2, rel=0.1)


def test_a_joint_that_is_pressed_bears_more_moment() -> None:
    # A post under a load: half of its thickness times the force is the moment that its screws need not bear.
    piece = stretched(0.0)
    found = in_equilibrium(piece)
    forces = found.forces()
    leg = 0
    pressed = 0.5 * (70.0 * G + found.geometry().mass[0] * G)
    assert forces.tension[leg] == pytest.approx(-pressed, rel=0.02)
    moment = abs(forces.bending[leg])
    expected = (2.0 * moment / 0.018 - pressed) / (found.nails()[leg] * found.strength[leg, 0])
    assert forces.pull_utilisation[leg] == pytest.approx(expected, rel=0.02)
    assert forces.pull_utilisation[leg] < 0.0


# --- hard -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("make", [table, chair, shelf_1, shelf_2])
def test_a_mirrored_piece_has_the_same_numbers(make) -> None:
    piece = make()
    one, other = Furniture(piece), Furniture(mirrored(piece))
    a, b = one.test(), other.test()
    assert a.flaws == b.flaws
    assert (a.pull, a.shear) == pytest.approx((b.pull, b.shear), rel=1e-8)
    assert one.kernel.freedoms() == other.kernel.freedoms()


def test_without_friction_slanted_legs_thrust_into_their_joints() -> None:
    piece = table()
    rough, smooth = in_equilibrium(piece), in_equilibrium(replace(piece, planes=(replace(piece.planes[0], mu=0.0),)))
    assert smooth.test().flaws & UNSTABLE == 0
    assert np.abs(smooth.forces().contacts[:, :2]).max() < 1e-6
    assert np.abs(rough.forces().contacts[:, :2]).max() > 1.0


def test_without_friction_any_push_slides() -> None:
    load = Load("push", 0, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    assert Furniture(replace(block(0.2, 0.4, 0.0), pushes=(load,))).test().flaws & UNSTABLE


def test_a_part_in_the_air_falls_and_two_parts_that_stand_do_not() -> None:
    one, other = bench(leg=0.02), bench(leg=0.02)
    away = np.array([0.0, 2.0, 0.0])
    for lift, falls in ((0.0, False), (0.3, True)):
        shift = away + np.array([0.0, 0.0, lift])
        planks = (*one.planks, *(replace(p, centre=p.centre + shift, name=p.name + "'") for p in other.planks))
        joints = (*one.joints, *(replace(j, i=j.i + 3, j=j.j + 3) for j in other.joints))
        feet = (*one.feet, *(replace(f, plank=f.plank + 3) for f in other.feet if not falls))
        weights = (*one.weights, *(replace(w, plank=w.plank + 3) for w in other.weights))
        both = Furniture(Piece(planks, joints, feet, one.planes, weights))
        assert both.kernel.parts == 2
        assert bool(both.test().flaws & UNSTABLE) is falls
        alone = in_equilibrium(one).forces()
        assert both.forces().bending[:2] == pytest.approx(alone.bending, rel=1e-6, abs=1e-9)


def test_coincident_planks_overlap_and_parallel_ones_do_not() -> None:
    piece = bench(leg=0.02)
    for shift, overlaps in ((0.0, True), (0.005, True), (0.02, False)):
        twin = replace(piece.planks[1], name="twin", centre=piece.planks[1].centre + np.array([shift, 0.0, 0.0]))
        # The twin has the same joint and foot.
        joints = (*piece.joints, replace(piece.joints[0], i=3))
        double = replace(
            piece, planks=(*piece.planks, twin), joints=joints, feet=(*piece.feet, replace(piece.feet[0], plank=3))
        )
        result = Furniture(double).test()
        assert bool(result.flaws & OVERLAPPING) is overlaps
        assert np.isfinite(result.pull)


def test_sixty_planks() -> None:
    piece = bookshelf((14, 14, 14), dividers=13, brackets=1, kilograms=1.0, heavy=10.0)
    assert len(piece.planks) == 60
    furniture = Furniture(piece)
    result = furniture.test()
    assert not result.flaws & (LOST | UNSTABLE)
    total = furniture.geometry().mass.sum() * G + sum(-w.force[2] for w in piece.weights)
    assert furniture.forces().contacts.sum(axis=0) == pytest.approx([0.0, 0.0, total], abs=1e-6 * total)


def test_what_balances_the_load_lies_in_the_friction_cones() -> None:
    furniture = in_equilibrium(table(push=60.0))
    for case in range(2):
        forces = furniture.forces(case)
        f = forces.balance
        assert np.hypot(f[:, 0], f[:, 1]) == pytest.approx(np.minimum(np.hypot(f[:, 0], f[:, 1]), 0.5 * f[:, 2]))
        loads = furniture.cases[case].sum(axis=0) - [0.0, 0.0, furniture.geometry().mass.sum() * G]
        assert f.sum(axis=0) == pytest.approx(-loads, abs=1e-5 * np.abs(loads).max())


def balanced_by_polygons(furniture: Furniture, case: int, mu: float) -> bool:
    """Whether friction cones of 64 sides can balance the loads of a case on a level floor: a linear program."""
    geometry, piece = furniture.geometry(), furniture.piece
    loads = [*piece.weights, *piece.pushes]
    at = [
        geometry.centre[k.plank] + geometry.axes[k.plank] @ (np.array(k.place) * geometry.size[k.plank]) for k in loads
    ]
    places = np.array([*geometry.centre, *at])
    forces = np.array([*(geometry.mass[:, None] * piece.gravity), *furniture.cases[case]])
    turn = np.arange(64) * (2 * np.pi / 64)
    edges = np.column_stack([mu * np.cos(turn), mu * np.sin(turn), np.ones(64)])
    columns = np.concatenate([np.hstack([edges, np.cross(p, edges)]) for p in geometry.contacts]).T
    wanted = -np.concatenate([forces.sum(axis=0), np.cross(places, forces).sum(axis=0)])
    size = np.linalg.norm(wanted)
    return linprog(np.ones(columns.shape[1]), A_eq=columns, b_eq=wanted / size).status == 0


@pytest.mark.slow
def test_what_stands_is_what_a_linear_program_can_balance() -> None:
    rng, seen = np.random.default_rng(1), []
    for trial in range(60):
        piece = (table(), chair(), stool(CORNERS, tuple(rng.uniform(-0.3, 0.3, 2)), 50.0))[trial % 3]
        force = rng.normal(size=3) * (1.0, 1.0, 0.4)
        force *= rng.uniform(10.0, 900.0) / np.linalg.norm(force)
        push = Load("push", 0, tuple(rng.uniform(-0.5, 0.5, 3)), tuple(force))
        furniture = in_equilibrium(replace(piece, pushes=(push,)), FINE)
        stands = furniture.forces(1).unbalanced <= 1e-7
        # The round cone lies between the polygon in it and the one around it.
        inner, outer = (balanced_by_polygons(furniture, 1, mu) for mu in (0.5, 0.5 / np.cos(np.pi / 64)))
        assert inner <= stands <= outer, trial
        seen.append(stands)
    assert 10 < sum(seen) < 50


def test_a_nail_too_short_says_so() -> None:
    thick = Plank.between("slab", (-1, 0, 0.02), (1, 0, 0.02), (0, 1, 0), 0.04)
    post = Plank.between("post", (0, 0, 0.04), (0, 0, 0.4), (0, 0.2, 0), 0.02)
    with pytest.raises(UserError, match="does not reach"):
        Furniture(
            Piece((thick, post), joints_near((thick, post)), feet_near((thick, post)), weights=(weight("w", 1, 1),))
        )


@pytest.mark.parametrize(
    "piece", [shelf_1(), table(push=60.0), stool_chair(lean=0.3, kilograms=80.0)], ids=lambda p: p.name
)
def test_a_test_does_not_depend_on_those_before(piece: Piece) -> None:
    furniture = Furniture(piece)
    furniture.test()
    modes = DesignModes.of(piece, furniture.kernel.freedoms())
    rng, one_sided = np.random.default_rng(0), 0
    for _ in range(40):
        gamma = (0.15 * rng.normal(size=len(modes)) / np.sqrt(len(modes)) @ modes.directions).reshape(-1, 8)
        warm = furniture.test(gamma)
        furniture.kernel.forget()
        cold = furniture.test(gamma)
        one_sided += furniture.forces(len(furniture.cases) - 1).one_sided
        assert warm.flaws == cold.flaws
        assert warm.pull == pytest.approx(cold.pull, rel=1e-9)
    assert one_sided


@pytest.mark.parametrize("millimetres", [12, 15, 18])
def test_strength_follows_the_thickness(millimetres: int) -> None:
    # Per nail l_z / 2 x 35 kN/m x (32 mm - l_z), which grows up to 16 mm, while the board's own weight grows too.
    t = millimetres * 1e-3
    furniture = in_equilibrium(table(thickness=t))
    forces, nails = furniture.forces(), furniture.nails()
    bears = nails * 35e3 * (0.032 - t)
    assert forces.pull_utilisation == pytest.approx((2 * np.abs(forces.bending) / t + forces.tension) / bears)
