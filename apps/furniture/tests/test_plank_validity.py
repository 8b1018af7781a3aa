"""Which geometry is valid: ends that come to faces from outside, planks above the floor, one piece, one joint rule."""

from dataclasses import replace

import numpy as np
import pytest
from restshape_apps.furniture.physics.furniture import APART, LOST, OVERLAPPING, Compliance, Furniture
from restshape_apps.furniture.pieces import PIECES, cantilever, table
from restshape_apps.furniture.shape.plank_edits import added
from restshape_apps.furniture.shape.planks import Foot, Joint, Piece, Plane, Plank, feet_near, joints_near, parts_of
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

T = 0.012
DEEP = (Plane((0.0, 0.0, -9.0)),)
"""A floor that nothing reaches."""


def upright(name: str = "upright", x: float = 0.0, high: float = 0.6) -> Plank:
    return Plank.between(name, (x, 0, 0), (x, 0, high), (0, 0.2, 0), T)


def bracket(end: float, far: float = 0.3, z: float = 0.3) -> Plank:
    """A board from x = `far` to where it ends."""
    return Plank.between("bracket", (far, 0, z), (end, 0, z), (0, 0.15, 0), T)


@pytest.mark.parametrize("end", [0.006, 0.014, 0.002, -0.003, -0.0059])
def test_an_end_is_joined_to_the_face_that_it_comes_to(end: float) -> None:
    # Drawn short of the face, into the plank, beyond its middle, and nearly through: it ends at the face at x = 6 mm.
    planks = (upright(), bracket(end))
    piece = Piece(planks, joints_near(planks, 0.015), feet_near(planks))
    closed = Furniture(piece).moved().planks[1]
    assert closed.end(1) == pytest.approx([0.006, 0.0, 0.3], abs=1e-12)
    assert Furniture(piece).test().flaws & (LOST | OVERLAPPING) == 0


def test_a_joint_on_the_far_face_is_lost() -> None:
    planks = (upright(), bracket(-0.006))
    through = next(face for face in (4, 5) if planks[0].end(face)[0] < 0.0)
    piece = Piece(planks, (Joint(1, 1, 0, through),), feet_near(planks))
    result = Furniture(piece).test()
    assert result.flaws & LOST
    assert result.words == ("lost: bracket comes to upright from behind",)
    near = replace(piece, joints=(Joint(1, 1, 0, 9 - through),))
    assert not Furniture(near).test().flaws & LOST


def test_a_plank_that_is_turned_over_to_the_other_side_loses_its_joint() -> None:
    furniture = Furniture(cantilever())
    beam = furniture.piece.index("beam")
    gamma = np.zeros((len(furniture.piece.planks), 8))
    for angle, lost in ((0.0, False), (30.0, False), (180.0, True)):
        # Turned by half a turn and moved to the left of the post, its end reaches the right face through the post.
        gamma[beam, :5] = -0.2 * (angle == 180.0), 0.0, 0.0, 0.0, np.radians(angle)
        result = furniture.test(gamma)
        assert bool(result.flaws & LOST) is lost
    assert result.words == ("lost: beam comes to post from behind",)


def test_turns_of_many_times_around_are_those_of_what_is_left() -> None:
    furniture = Furniture(table())
    one, other = np.zeros((5, 8)), np.zeros((5, 8))
    one[1, 4], other[1, 4] = 0.2, 0.2 + 14.0 * np.pi
    np.testing.assert_allclose(furniture.geometry(other).axes, furniture.geometry(one).axes, atol=1e-12)
    one[1, 3:6], other[1, 3:6] = Rotation.from_rotvec([3.0, 4.0, 5.0]).as_rotvec(), [3.0, 4.0, 5.0]
    np.testing.assert_allclose(furniture.geometry(other).axes, furniture.geometry(one).axes, atol=1e-12)


def test_planks_that_have_a_joint_may_not_be_in_each_other_elsewhere() -> None:
    # Its end is flush with one board, and 5 mm inside another that it has a joint with as well.
    boards = [
        Plank.between(f"board-{k}", (-0.2, y, z), (0.2, y, z), (0, 0.2, 0), T)
        for k, y, z in ((1, 0.1, 0.606), (2, -0.1, 0.601))
    ]
    post = Plank.between("post", (0, 0, 0.1), (0, 0, 0.6), (0, 0.3, 0), T)
    piece = Piece((*boards, post), (Joint(2, 1, 0, 4), Joint(2, 1, 1, 4)), (), DEEP)
    assert Furniture(piece).geometry().overlaps == ((1, 2),)
    flat = replace(piece, planks=(boards[0], replace(boards[1], centre=np.array([0, -0.1, 0.606])), post))
    assert Furniture(flat).test().flaws & (LOST | OVERLAPPING) == 0


def shared(bodies: list[list[list[float]]]) -> float:
    """How far the deepest point that bodies of half-spaces (a, b: a x <= b) share lies inside them all [m]."""
    rows = np.array([row for body in bodies for row in body])
    bounds = [(None, None)] * 4
    answer = linprog([0, 0, 0, -1], np.column_stack([rows[:, :3], np.ones(len(rows))]), rows[:, 3], bounds=bounds)
    return float(answer.x[3])


def cut(plank: Plank) -> list[list[float]]:
    """The half-spaces of a plank whose end -x is cut along the floor z = 0."""
    rows = [[0.0, 0.0, -1.0, 0.0]]
    for side in range(1, 6):
        axis = plank.axes[:, side // 2] * (1.0 if side % 2 else -1.0)
        rows.append([*axis, axis @ plank.end(side)])
    return rows


@pytest.mark.slow
def test_ends_that_are_cut_along_the_floor_overlap_as_in_a_linear_program() -> None:
    rng, seen = np.random.default_rng(4), []
    for _ in range(200):
        planks = []
        for name in "ab":
            foot, lean = np.append(0.03 * rng.normal(size=2), 0.0), rng.uniform(-0.6, 0.6)
            angle = rng.uniform(0.0, 2.0 * np.pi)
            across = np.array([-np.sin(angle), np.cos(angle), 0.0])
            up = np.array([lean * np.cos(angle), lean * np.sin(angle), 1.0])
            planks.append(Plank.between(name, foot, foot + 0.3 * up, 0.1 * across, 0.03))
        inside = shared([cut(plank) for plank in planks])
        if abs(inside) < 1e-5:
            continue
        piece = Piece(tuple(planks), (), (Foot(0, 0), Foot(1, 0)))
        found = Furniture(piece, Compliance(interference=0.0, gap=1e-9)).geometry()
        assert ((0, 1) in found.overlaps) is (inside > 0.0)
        assert not any(found.foot_faults)
        seen.append(inside > 0.0)
    assert min(np.mean(seen), 1.0 - np.mean(seen)) > 0.1


def test_planks_do_not_go_through_the_floor() -> None:
    piece = table()
    furniture = Furniture(piece)
    for down in np.linspace(0.0, 0.25, 6):
        bar = Plank.between("bar", (-0.4, 0.0, 0.3), (-0.4, 0.0, 0.1 - down), (0.1, 0, 0), T)
        low = replace(piece, planks=(*piece.planks, bar))
        result = Furniture(low).test()
        assert bool(result.flaws & OVERLAPPING) is bool(bar.corners()[:, 2].min() < -1e-4)
    assert "overlapping: bar and the floor by 150 mm" in result.words
    # Slanted legs are cut along the floor, and do not go through it.
    assert not furniture.test().flaws & OVERLAPPING


def test_all_planks_make_one_piece() -> None:
    piece = table()
    assert parts_of(piece) == ((0, 1, 2, 3, 4),)
    loose = Plank.between("loose", (2, 0, T / 2), (3, 0, T / 2), (0, 0.1, 0), T)
    more = replace(piece, planks=(*piece.planks, loose), feet=(*piece.feet, Foot(5, 4)))
    result = Furniture(more).test()
    assert result.flaws & APART and not result.valid
    assert result.words[0].startswith("in two parts: top with 4 more, loose (loose -x is ")
    # Nothing else is wrong with it that is not wrong with the table.
    assert result.flaws & ~APART == Furniture(piece).test().flaws
    scan = Furniture(more).kernel.scan(np.zeros((6, 8)), np.zeros(1), APART)[0]
    assert scan.tolist() == [APART]


@pytest.mark.parametrize("short", [0.0, 0.005, -0.005, 0.0149, 0.02])
def test_a_leg_that_ends_near_the_floor_stands_on_it(short: float) -> None:
    planks = [*table().planks]
    leg = planks[1]
    up, less = np.array([0.0, 0.0, short / 2]), np.array([short, 0.0, 0.0])
    planks[1] = replace(leg, centre=leg.centre + up, size=leg.size - less)
    assert planks[1].end(0)[2] == pytest.approx(short)
    joints = joints_near(planks, 0.015)
    piece = Piece(tuple(planks), joints, feet_near(planks, 0.015, joints=joints))
    assert len(piece.feet) == (4 if abs(short) <= 0.015 else 3)
    if len(piece.feet) == 4:
        assert Furniture(piece).moved().planks[1].end(0)[2] == pytest.approx(0.0, abs=1e-12)


def test_a_leg_that_does_not_stand_flat_is_reported() -> None:
    planks = [*table().planks]
    turn = Rotation.from_euler("x", 1.0, degrees=True).as_matrix()
    planks[1] = replace(planks[1], axes=turn @ planks[1].axes, size=planks[1].size - np.array([0.004, 0.0, 0.0]))
    joints = joints_near(planks, 0.015)
    result = Furniture(Piece(tuple(planks), joints, feet_near(planks, 0.015, joints=joints))).test()
    assert result.words[0] == "lost: leg-1 is not flush with top, leg-1 does not stand flat on the floor"


def test_an_end_that_is_joined_does_not_stand_on_the_floor_as_well() -> None:
    piece = cantilever()
    # The post ends 12 mm above the floor, on its foot.
    assert piece.planks[0].end(0)[2] == pytest.approx(0.012)
    feet = feet_near(piece.planks, 0.015, joints=piece.joints)
    assert feet == piece.feet


def test_drawn_at_once_or_one_after_the_other_a_piece_has_the_same_joints() -> None:
    beside = [upright("one"), replace(upright("two"), centre=np.array([0.0, 0.2, 0.3])), upright("far", 0.5)]
    wide = Plank.between("wide", (0.01, 0.1, 0.3), (0.49, 0.1, 0.3), (0, 0.3, 0), T)
    behind = replace(beside[1], name="behind", centre=np.array([-0.008, 0.2, 0.3]))
    cases = [[*beside, wide], [beside[0], behind, beside[2], wide], *([*make().planks] for make in PIECES.values())]
    for planks in cases:
        at_once = joints_near(planks, 0.015)
        grown = Piece((planks[0],), (), ())
        for plank in planks[1:]:
            grown = added(grown, plank, 0.015)
        assert {(j.i, j.side, j.j, j.face) for j in grown.joints} == {(j.i, j.side, j.j, j.face) for j in at_once}
    # An end meets two boards side by side, but only the nearer one of two that are not in one plane.
    ends = [sorted(j.j for j in joints_near(planks, 0.015) if j.i == 3) for planks in cases[:2]]
    assert ends == [[0, 1, 2], [0, 2]]


@pytest.mark.parametrize(("over", "lost"), [(0.0, False), (0.5, False), (0.99, False), (1.01, True)])
def test_an_end_holds_as_long_as_its_middle_line_is_on_the_face(over: float, lost: bool) -> None:
    # A leg moved so far that it hangs over the edge of its top by so many halves of its thickness.
    top = Plank.between("top", (-0.3, 0, 0.506), (0.3, 0, 0.506), (0, 0.3, 0), T)
    x = 0.3 - 0.5 * T + 0.5 * over * T
    legs = [Plank.between(f"leg {at}", (at, 0, 0), (at, 0, 0.5), (0, 0.3, 0), T) for at in (-0.2, 0.2)]
    planks = (top, *legs)
    piece = Piece(planks, joints_near(planks), feet_near(planks))
    gamma = np.zeros((3, 8))
    gamma[2, :3] = legs[1].axes.T @ (x - 0.2, 0.0, 0.0)
    assert bool(Furniture(piece).test(gamma).flaws & LOST) is lost
    moved = Furniture(piece).geometry(gamma).centre[2]
    assert moved == pytest.approx([x, 0.0, 0.25], abs=1e-12)
