"""Suggestions for a piece in parts: a part is moved to where it is joined."""

from dataclasses import replace

import numpy as np
import pytest
from restshape_apps.furniture.guidance.connecting import connections
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.physics.furniture import APART, Furniture
from restshape_apps.furniture.pieces import chair, shelf_1
from restshape_apps.furniture.shape.planks import Foot, Piece, Plank, parts_of


def away(piece, name, way):
    """A piece with a plank moved from its joints, which are gone."""
    k = piece.index(name)
    planks = list(piece.planks)
    planks[k] = replace(planks[k], centre=planks[k].centre + np.array(way))
    return replace(piece, planks=tuple(planks), joints=tuple(j for j in piece.joints if k not in (j.i, j.j)))


@pytest.mark.parametrize("way", [(0.0, 0.6, 0.0), (0.0, -0.5, 0.1), (0.003, 1.0, -0.02)])
def test_a_plank_that_was_taken_away_is_brought_back(way):
    piece = chair()
    apart = away(piece, "stretcher", way)
    assert Furniture(apart).test().flaws & APART
    found = connections(apart)
    assert found[0].flaws == 0 and len(parts_of(found[0].piece)) == 1
    assert Furniture(found[0].piece).test().valid
    # Both its ends meet the sides of the chair again, so it has gone the shortest way straight between them.
    assert len(found[0].piece.joints) == len(piece.joints)
    stretcher = found[0].piece.planks[piece.index("stretcher")]
    depth = 0.5 * (piece.planks[1].size[1] - stretcher.size[1])
    assert abs(stretcher.centre[1]) == pytest.approx(depth, abs=1e-9)
    assert "stretcher moved" in found[0].words and "joined to left and right" in found[0].words


def test_ways_are_shortest_first_and_lead_to_one_piece():
    apart = away(shelf_1(), "divider-1", (0.1, 0.5, 0.0))
    found = connections(apart)
    assert found and all(len(parts_of(one.piece)) == 1 for one in found)
    for group in (True, False):
        lengths = [np.linalg.norm(one.way) for one in found if (one.flaws == 0) is group]
        assert lengths == sorted(lengths)


def test_a_part_of_two_planks_moves_as_a_whole():
    piece = chair()
    far = np.array([0.0, 3.0, 0.0])
    board = Plank.between("board", (-0.1, 0, 0.3), (0.1, 0, 0.3), (0, 0.1, 0), 0.012)
    post = Plank.between("post", (0, 0, 0.306), (0, 0, 0.4), (0, 0.1, 0), 0.012)
    both = tuple(replace(p, centre=p.centre + far) for p in (board, post))
    joint = replace(piece.joints[0], i=len(piece.planks) + 1, side=0, j=len(piece.planks), face=5)
    apart = replace(piece, planks=(*piece.planks, *both), joints=(*piece.joints, joint))
    for one in connections(apart):
        moved = one.piece.planks[-2:]
        assert moved[0].end(5) == pytest.approx(moved[1].end(0), abs=1e-9)
        assert "board with 1 more moved" in one.words


def test_designs_in_parts_have_them_as_suggestions():
    suggestion_list = Design(away(chair(), "stretcher", (0.0, 0.6, 0.0)), Guidance(farthest=1.0)).suggestion_list
    assert suggestion_list.found[0].valid and suggestion_list.found[0].piece is not None and not suggestion_list.why
    empty = Design(chair()).suggestion_list
    assert not empty.found


def test_planks_that_the_fastener_does_not_reach_through_are_not_joined():
    one = Plank.between("one", (0, 0, 0), (0, 0, 0.6), (0, 0.2, 0), 0.05)
    other = Plank.between("other", (0.5, 0, 0.3), (0.9, 0, 0.3), (0, 0.2, 0), 0.05)
    thin = [replace(plank, size=np.array([*plank.size[:2], 0.012])) for plank in (one, other)]
    assert not connections(Piece((one, other), (), (Foot(0, 0),)))
    assert connections(Piece(tuple(thin), (), (Foot(0, 0),)))
