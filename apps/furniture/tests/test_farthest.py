"""How far suggestions move things: within a share of the piece that scenes may set."""

import pytest
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.guidance.farthest import FARTHEST, NEAR
from restshape_apps.furniture.guidance.preferences import farthest_move
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.pieces import drawn
from restshape_apps.furniture.shape.plank_scene import piece_of
from restshape_apps.furniture.shape.planks import parts_of
from restshape_apps.furniture.tests.furniture_scenes import PARTED_STOOL

from restshape.application import application_of
from restshape.errors import UserError
from restshape.scene.load import load_scene
from restshape.scene.plan import plan


def move(design: Design, one) -> float:
    """How far the corner goes that goes farthest, in parts of the piece."""
    return farthest_move(design.piece, design.after(one)) / design.piece.size


@pytest.mark.slow
@pytest.mark.parametrize("name", ["table", "bookshelf", "scales", "shelf-2"])
def test_no_suggestion_goes_farther_and_some_would(name: str) -> None:
    design, free = (Design(drawn(name), Guidance(farthest=share)) for share in (None, 10.0))
    found, every = design.suggestion_list.found, free.suggestion_list.found
    assert found and max(move(design, one) for one in found) <= NEAR
    assert max(move(free, one) for one in every) > NEAR
    # What is near is shown all the same, of each kind in the same order.
    for kind in {one.kind for one in every}:
        near = [one.words for one in every if one.kind == kind and move(free, one) <= NEAR]
        assert near == [one.words for one in found if one.kind == kind][: len(near)]


def test_a_piece_in_parts_far_apart_is_not_pushed_together(tmp_path) -> None:
    path = tmp_path / "stool.toml"
    path.write_text(PARTED_STOOL)
    piece = Furniture(piece_of(load_scene(path))).moved()
    assert len(parts_of(piece)) == 2
    none = Design(piece).suggestion_list
    assert not none.found and "effects.guidance.farthest is 0.5" in none.why and "draw a plank between" in none.why
    some = Design(piece, Guidance(farthest=1.5))
    least = min(move(some, one) for one in some.suggestion_list.found)
    assert least > FARTHEST and f"{least:.2g} of the piece" in none.why


def test_scenes_set_it_and_none_of_no_way_is_taken(tmp_path) -> None:
    path = tmp_path / "stool.toml"
    path.write_text(PARTED_STOOL.replace("guidance = {}", "guidance = { farthest = 0.3 }"))
    scene = load_scene(path)
    assert plan(scene, application_of(scene)).settings("guidance").farthest == 0.3
    path.write_text(PARTED_STOOL.replace("guidance = {}", "guidance = { farthest = 0 }"))
    with pytest.raises(UserError, match="farthest"):
        load_scene(path)
