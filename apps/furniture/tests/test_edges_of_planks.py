"""Ends at the edges of planks, which take no joint: what is said, and what suggestions say of planks that stick out."""

import pytest
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.shape.free_ends import free_ends
from restshape_apps.furniture.shape.plank_scene import piece_of
from restshape_apps.furniture.shape.planks import Piece
from restshape_apps.furniture.tests.furniture_scenes import BENCH, write_bench

from restshape.scene.load import load_scene


def tied(tmp_path, gap: float, turned: bool = False) -> Piece:
    """The bench with a tie across, its middle at x = 0.2 m, and a rail from the left leg that ends before the tie."""
    width, face = ([0, 0, 0.1], 0.19) if turned else ([0.1, 0, 0], 0.15)
    more = f"""
[planks.tie]
from = [0.2, -0.14, 0.2]
to = [0.2, 0.14, 0.2]
width = {width}
[planks.rail]
from = [-0.49, 0, 0.2]
to = [{face - gap}, 0, 0.2]
width = [0, 0, 0.08]
"""
    return piece_of(load_scene(write_bench(tmp_path, BENCH + more)))


@pytest.mark.parametrize(("gap", "where"), [(0.0, "touches"), (0.005, "5 mm from"), (0.014, "14 mm from")])
def test_an_end_at_an_edge_says_that_it_takes_no_joint_and_what_to_do(tmp_path, gap: float, where: str) -> None:
    piece = tied(tmp_path, gap)
    (one,) = (end for end in free_ends(piece) if end.plank == piece.index("rail"))
    said = f"rail +x is free: {where} the edge of tie, which takes no joint; let rail meet a broad face, or turn tie"
    assert one.edge and one.words(piece) == said
    words = Design.closed(piece, Guidance()).furniture.test().words[0]
    where = where.replace("5 mm", "is 5 mm").replace("14 mm", "is 14 mm")
    assert f"(rail +x {where} the edge of tie, which takes no joint: let rail meet a broad face, or turn tie)" in words


def test_an_end_far_from_an_edge_or_at_a_face_says_nothing_of_it(tmp_path) -> None:
    assert not [end for end in free_ends(tied(tmp_path, 0.02)) if end.edge]
    # With its width upright the tie has a face there, and the rail is joined: what is said to do does help.
    turned = tied(tmp_path, 0.0, turned=True)
    ends = turned.index("rail"), turned.index("tie")
    assert any((joint.i, joint.j) == ends for joint in turned.joints)
    assert not [end for end in free_ends(turned) if end.plank == ends[0]]


def test_a_plank_that_a_suggestion_lets_stick_out_is_called_so_and_comes_last(tmp_path) -> None:
    # Upright between the legs, 0.3 m above the floor: brought to one leg it sticks out, brought down it stands.
    peg = "\n[planks.peg]\nfrom = [-0.2, 0, 0.25]\nto = [0.2, 0, 0.25]\nwidth = [0, 0.1, 0]\n"
    design = Design.closed(piece_of(load_scene(write_bench(tmp_path, BENCH + peg))), Guidance())
    found = design.suggestion_list.found
    assert found
    for one in found:
        joints = [joint for joint in design.after(one).joints if joint.i == design.piece.index("peg")]
        assert ("sticks out" in one.words) is (len({joint.side for joint in joints}) == 1)
    assert any("joined to left by its end -x alone: it sticks out there" in one.words for one in found)
