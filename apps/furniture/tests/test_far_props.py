"""Props far from the joint that they relieve, where none near it is enough."""

import numpy as np
import pytest
from restshape_apps.furniture.guidance import support_planks as boards
from restshape_apps.furniture.guidance.support_planks import FLOOR, support_planks
from restshape_apps.furniture.physics.furniture import WEAK, Furniture
from restshape_apps.furniture.shape.planks import Piece, Plank, feet_near, joints_near, weight

THICK = 0.018
OUT = 0.9
"""Where the wing ends [m]."""


def bench_with_a_wing(kilograms: float = 60.0) -> Piece:
    """A top on two sides, and a board out of the right one with a mass on its outer edge."""

    def board(name: str, start: tuple[float, float], end: tuple[float, float], wide: float) -> Plank:
        ends = (start[0], 0.0, start[1]), (end[0], 0.0, end[1])
        return Plank.between(name, *ends, (0.0, wide, 0.0), THICK, wood="pine")

    planks = (
        board("left", (-0.55, 0.0), (-0.55, 0.45), 0.33),
        board("right", (0.55, 0.0), (0.55, 0.45), 0.33),
        board("top", (-0.6, 0.459), (0.6, 0.459), 0.35),
        board("shelf", (-0.541, 0.12), (0.541, 0.12), 0.3),
        board("wing", (0.559, 0.3), (OUT, 0.3), 0.25),
    )
    loads = weight("lamp", 4, kilograms, (0.5, 0.0, 0.5)), weight("stone", 3, 60.0, (0.0, 0.0, 0.5))
    return Piece(planks, joints_near(planks, fastener="dowel"), feet_near(planks), weights=loads, spacing=0.04)


def test_a_prop_at_the_far_end_is_found_where_none_near_the_joint_is_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    furniture = Furniture(bench_with_a_wing())
    assert furniture.test().flaws == WEAK
    (prop,) = support_planks(furniture)
    assert prop.between == (4, FLOOR)
    # From the floor to the lower face of the wing, flush with its outer edge.
    corners = prop.piece.planks[-1].corners()
    assert corners[:, 0].max() == pytest.approx(OUT, abs=1e-9)
    assert (corners[:, 2].min(), corners[:, 2].max()) == pytest.approx((0.0, 0.3 - THICK / 2), abs=1e-9)
    assert Furniture(prop.piece).test().valid
    # A near board alone does not do it, but two on both sides of the mirror plane.
    monkeypatch.setattr(boards, "ROUNDS", boards.ROUNDS[:1])
    furniture.test()
    near = [one for one in support_planks(furniture) if one.result.valid]
    assert near and all(one.mirrored == (1,) for one in near)


def test_near_boards_come_first_where_they_are_enough() -> None:
    furniture = Furniture(bench_with_a_wing(30.0))
    furniture.test()
    found = support_planks(furniture)
    assert found
    assert all(one.result.valid and np.max(one.piece.planks[-1].corners()[:, 0]) < OUT - 0.1 for one in found)
