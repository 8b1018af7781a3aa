"""Lost joints and feet are brought back: by one change, or by two at once."""

from dataclasses import replace

import numpy as np
import pytest
from restshape_apps.furniture.guidance.design import Design
from restshape_apps.furniture.guidance.opening import Opening
from restshape_apps.furniture.guidance.reconnect import reconnect
from restshape_apps.furniture.physics.furniture import LOST, OVERLAPPING, UNSTABLE, Furniture
from restshape_apps.furniture.pieces import table
from restshape_apps.furniture.shape.planks import FREEDOMS, Load, Piece, Plank, feet_near, joints_near


def lost(*changes: tuple[str, str, float]) -> Furniture:
    """The table after changes of planks that joints do not follow."""
    piece = table()
    gamma = np.zeros((len(piece.planks), 8))
    for plank, freedom, change in changes:
        gamma[piece.index(plank), FREEDOMS.index(freedom)] = change
    furniture = Furniture(Furniture(piece).moved(gamma))
    assert furniture.test().flaws & LOST
    return furniture


def test_lost_joints_are_brought_back() -> None:
    furniture = lost(("leg-1", "move y", -0.2))
    ways = reconnect(furniture).found
    assert len(ways) >= 3
    for way in ways:
        assert not furniture.test(way.t * way.direction).flaws & LOST
        assert furniture.test((way.span[0] - 1e-4) * way.direction).flaws & LOST
    # Back by a quarter of what it was moved: the leg's half width of 60 mm must meet the top by 10 mm.
    back = next(way for way in ways if way.mode == "leg-1: move y")
    assert back.span[0] * furniture.piece.size == pytest.approx(0.05, abs=1e-4)


def test_a_foot_that_does_not_stand_flat_is_turned_back() -> None:
    furniture = lost(("leg-1", "turn z", 0.1))
    assert any(furniture.geometry().foot_faults)
    (way,) = reconnect(furniture).found
    assert way.mode == "leg-1: turn z"
    # By as much as it was turned, and by nothing else: a tilted foot has no range.
    assert way.t * way.direction[1, 5] == pytest.approx(-0.1, abs=1e-6)
    assert not furniture.test(way.t * way.direction).flaws & LOST
    assert not any(Furniture(furniture.moved(way.t * way.direction)).geometry().foot_faults)


def test_two_changes_bring_back_what_none_does_alone() -> None:
    furniture = lost(("leg-1", "turn z", 0.1), ("leg-1", "move y", -0.3))
    found = reconnect(furniture).found
    assert found
    for way in found:
        used = np.argwhere(way.direction)
        assert len(used) == 2
        assert not furniture.test(way.t * way.direction).flaws & LOST
        for plank, number in used:
            alone = np.zeros_like(way.direction)
            alone[plank, number] = way.direction[plank, number]
            reach = np.linspace(-1.0, 1.0, 401) * 0.5 / np.abs(alone[plank, number])
            assert all(furniture.kernel.scan(alone, reach, LOST)[0])


def test_what_is_too_far_away_is_reported() -> None:
    furniture = lost(("leg-1", "move y", -3.0))
    search = reconnect(furniture)
    assert search.found == ()
    assert "top, leg-1" in search.why
    assert Design(furniture.piece).suggestion_list.why == search.why


def test_openings_are_zero_where_all_is_closed_and_smooth_elsewhere() -> None:
    piece = table()
    assert np.abs(Opening(Furniture(piece)).at(np.zeros((5, 8)))).max() == pytest.approx(0.0, abs=1e-9)
    furniture = lost(("leg-1", "move y", -0.2))
    gamma = np.zeros((5, 8))
    sizes = []
    for back in (0.0, 0.02, 0.04, 0.0499):
        gamma[1, 1] = back
        sizes.append(float(np.linalg.norm(Opening(furniture).at(gamma))))
    # Each step back closes as much as it is long.
    assert np.diff(sizes) == pytest.approx([-0.02, -0.02, -0.0099], abs=1e-4)


def test_a_piece_without_feet_that_has_lost_a_joint_is_looked_at_too() -> None:
    furniture = lost(("leg-1", "move y", -0.2))
    floating = Furniture(replace(furniture.piece, feet=()))
    assert [way.mode for way in reconnect(floating).found if way.mode == "leg-1: move y"]


def shelf_with_a_post(spot: float, push: float = 0.0) -> Furniture:
    """A top on two sides, a shelf between them, and a post on it that was moved to x = `spot` [m]."""
    thick, low, high = 0.018, 0.12, 0.45

    def board(name: str, start: tuple[float, float], end: tuple[float, float]) -> Plank:
        return Plank.between(name, (start[0], 0.0, start[1]), (end[0], 0.0, end[1]), (0.0, 0.35, 0.0), thick)

    half = 0.55 - thick / 2
    planks = (
        board("left", (-0.55, 0.0), (-0.55, high)),
        board("right", (0.55, 0.0), (0.55, high)),
        board("shelf", (-half, low), (half, low)),
        board("post", (0.0, low + thick / 2), (0.0, high - 0.1)),
        board("top", (-0.6, high + thick / 2), (0.6, high + thick / 2)),
    )
    joints, pushes = joints_near(planks), (Load("push", 4, (0.0, 0.0, 0.5), (push, 0.0, 0.0)),) if push else ()
    piece = Piece(planks, joints, feet_near(planks), pushes=pushes)
    gamma = np.zeros((5, 8))
    gamma[3, 2] = spot * planks[3].axes[0, 2]
    return Furniture(Furniture(piece).moved(gamma))


def test_the_range_of_what_mends_all_is_where_nothing_at_all_is_wrong() -> None:
    # The post, 18 mm thick, sticks 28 mm into the side that ends the shelf; within 0.1 mm planks only touch.
    furniture = shelf_with_a_post(0.56)
    assert furniture.test().flaws & (LOST | OVERLAPPING) == LOST | OVERLAPPING
    ways = [way for way in reconnect(furniture).found if way.mode == "post: move z"]
    (back,) = [way for way in ways if way.flaws == 0]
    scale = float(np.abs(back.direction).max())
    assert back.span[0] * scale == pytest.approx(0.0279, abs=1e-5)
    for t in np.linspace(*back.span, 40):
        assert furniture.test(t * back.direction).valid


def test_the_range_of_what_mends_in_part_ends_where_more_is_wrong() -> None:
    # A push that throws it over keeps all ways from mending more than the joint.
    furniture = shelf_with_a_post(0.56, push=2000.0)
    ways = reconnect(furniture).found
    assert ways
    for way in ways:
        assert way.flaws & UNSTABLE
        for t in np.linspace(*way.span, 20):
            assert furniture.test(t * way.direction).flaws & ~way.flaws == 0
    (back,) = [way for way in ways if way.mode == "post: move z"]
    assert back.span[0] * float(np.abs(back.direction).max()) == pytest.approx(0.0279, abs=1e-5)


def test_planks_that_meet_from_behind_are_named() -> None:
    post = Plank.between("post", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.3, 0.0), 0.02)
    arm = Plank.between("arm", (0.01, 0.0, 0.8), (0.31, 0.0, 0.8), (0.0, 0.1, 0.0), 0.02)
    piece = Piece((post, arm), joints_near((post, arm)), feet_near((post, arm)))
    # The arm goes through to the other side, and its end with it.
    behind = Plank.between("arm", (0.01, 0.0, 0.8), (-0.29, 0.0, 0.8), (0.0, -0.1, 0.0), 0.02)
    furniture = Furniture(replace(piece, planks=(post, behind)))
    assert "from behind" in furniture.test().words[0]
    search = reconnect(furniture)
    assert search.tried > 0
    assert search.found or "length of post, arm, alone" in search.why
