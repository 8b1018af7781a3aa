"""Rails that pass beside their legs, go through them, or lie flat before them: what is said, and the first mend."""

import numpy as np
import pytest
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.guidance.lengthening import NAME
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.report.guided import runs
from restshape_apps.furniture.shape.free_ends import free_ends
from restshape_apps.furniture.shape.plank_scene import piece_of
from restshape_apps.furniture.shape.planks import Piece, parts_of
from restshape_apps.furniture.tests.furniture_scenes import BENCH, write_bench, write_edits
from small_scenes import make_replay

from restshape.scene.load import load_scene

FLAT, EDGE = (0, 0.1, 0), (0, 0, 0.1)
"""Widths of rails of 100 mm: level, and upright. The legs' inner faces are at x = -0.49 and 0.49 m, 0.3 m wide."""


def rail(start: float, end: float, y: float, width: tuple[float, float, float], name: str = "rail") -> str:
    return f"\n[planks.{name}]\nfrom = [{start}, {y}, 0.2]\nto = [{end}, {y}, 0.2]\nwidth = {list(width)}\n"


def drawn(tmp_path, *rails: str, text: str = BENCH) -> Design:
    scene = load_scene(write_bench(tmp_path, text + "".join(rails)))
    return Design.closed(piece_of(scene), Guidance())


def ends_of(piece: Piece, name: str = "rail") -> np.ndarray:
    """Both ends of a rail [m]."""
    plank = piece.planks[piece.index(name)]
    return np.array([plank.end(0), plank.end(1)])


CASES = [
    # Beside: its middle line 8 mm off, so that all 20 mm of it lie on the legs once it has gone 18 mm.
    (
        rail(-0.49, 0.49, 0.158, EDGE),
        "the centre line of rail -x passes 8 mm beside left, on its +y side",
        "rail moved 18 mm towards -y, to meet left and right",
        0.14,
    ),
    # Level, it lies on the legs with all of its width.
    (
        rail(-0.49, 0.49, -0.208, FLAT),
        "the centre line of rail -x passes 8 mm beside left, on its -y side",
        "rail moved 108 mm towards +y, to meet left and right",
        -0.1,
    ),
    # Beside and too short at once.
    (
        rail(-0.47, 0.46, 0.158, EDGE),
        "the centre line of rail -x passes 8 mm beside left, on its +y side",
        "rail moved 18 mm towards -y, 20 mm longer at its end -x and 30 mm longer at its end +x, "
        "to meet left and right",
        0.14,
    ),
    # Through both legs, by more than joints reach behind a face.
    (
        rail(-0.55, 0.57, 0.0, FLAT),
        "rail -x is 60 mm beyond the face of left",
        "rail 60 mm shorter at its end -x and 80 mm shorter at its end +x, to meet left and right",
        0.0,
    ),
]


@pytest.mark.parametrize(("text", "status", "mend", "y"), CASES)
def test_the_status_names_what_a_rail_missed_and_the_first_suggestion_mends_it(tmp_path, text, status, mend, y):
    design = drawn(tmp_path, text)
    assert design.furniture.test().words[0] == f"in two parts: top with 2 more, rail ({status})"
    first = design.suggestion_list.found[0]
    assert first.valid and first.words == mend and first.kind == NAME
    assert ends_of(first.piece) == pytest.approx(np.array([[-0.49, y, 0.2], [0.49, y, 0.2]]), abs=1e-9)
    assert Furniture(first.piece).test().valid and not free_ends(first.piece)
    # What its warning says to do is what the suggestion does.
    said = " ".join(one.words(design.piece) for one in free_ends(design.piece))
    amounts = [word for word in mend.replace(",", "").split() if word.isdigit()]
    assert amounts and all(f"{amount} mm" in said for amount in amounts)
    # The same move is not shown twice.
    places = [np.round(ends_of(one.piece), 6).tobytes() for one in design.suggestion_list.found]
    assert len(set(places)) == len(places)


def test_two_rails_go_onto_their_legs_at_once(tmp_path) -> None:
    design = drawn(tmp_path, rail(-0.49, 0.49, 0.158, EDGE), rail(-0.49, 0.49, -0.158, EDGE, "other"))
    assert len(parts_of(design.piece)) == 3
    first = design.suggestion_list.found[0]
    assert first.valid and len(parts_of(first.piece)) == 1
    both = "rail moved 18 mm towards -y, to meet left and right; other moved 18 mm towards +y, to meet left and right"
    assert first.words == both


def test_what_is_joined_to_a_rail_goes_with_it(tmp_path) -> None:
    shelf = "\n[planks.shelf]\nfrom = [0, 0.05, 0.2]\nto = [0, 0.148, 0.2]\nwidth = [0.3, 0, 0]\n"
    design = drawn(tmp_path, rail(-0.49, 0.49, 0.158, EDGE), shelf)
    assert len(parts_of(design.piece)[1]) == 2
    first = design.suggestion_list.found[0]
    assert first.valid and first.words == "rail moved 18 mm towards -y, to meet left and right"
    ends = ends_of(first.piece, "shelf")[:, 1] - ends_of(design.piece, "shelf")[:, 1]
    assert ends == pytest.approx([-0.018, -0.018], abs=1e-9)


@pytest.mark.parametrize("apart", [0.0, 0.008])
def test_a_rail_flat_before_its_legs_says_that_joints_hold_ends(tmp_path, apart: float) -> None:
    # Legs 0.1 m wide along x, whose faces are at y = -0.01 and 0.01 m.
    text = BENCH.replace("0.5]\nwidth = [0, 0.3, 0]", "0.5]\nwidth = [0.1, 0, 0]")
    words = drawn(tmp_path, rail(-0.6, 0.6, 0.02 + apart, EDGE), text=text).furniture.test().words
    said = "rail lies face to face with left, 8 mm from it" if apart else "rail lies face to face with left"
    assert words[0] == f"in two parts: top with 2 more, rail ({said}: a joint needs an end at a face)"


@pytest.mark.parametrize("off", [0.0, 2e-17, 9e-7])
def test_a_tray_on_a_top_says_that_joints_alone_hold_and_what_to_do(tmp_path, off: float) -> None:
    # The top is 20 mm thick with its middle at 0.51 m, so that a tray of 20 mm lies on it at 0.53 m.
    height = 0.53 + off
    tray = f"\n[planks.tray]\nfrom = [-0.1, 0, {height!r}]\nto = [0.1, 0, {height!r}]\nwidth = [0, 0.1, 0]\n"
    words = drawn(tmp_path, tray).furniture.test().words[0]
    assert words.startswith(
        "in two parts: top with 2 more, tray (tray lies on top, but planks are held by joints alone"
    )
    assert "put its weights on top and leave it out" in words and not any(word in words for word in ("mm", "0.0"))


def test_frames_of_a_drag_that_differ_in_how_far_a_rail_is_off_are_one_row(tmp_path) -> None:
    path = write_bench(tmp_path, BENCH + rail(-0.49, 0.49, 0.158, EDGE))
    events = {"do": "press", "on": "rail", "at": [0, 0.158, 0.2]}, {"do": "drag", "to": [0, 0.168, 0.2], "frames": 2}
    rows = list(make_replay(path, write_edits(tmp_path, *events)).frames())
    (span,) = runs(rows)
    assert "the centre line of rail -x passes up to 18 mm beside left, on its +y side" in span[2]


def test_a_rail_that_cannot_be_connected_says_what_to_do(tmp_path) -> None:
    path = write_bench(tmp_path, BENCH + rail(-0.49, 0.49, 0.158, EDGE))
    *_, row = make_replay(path, write_edits(tmp_path, {"do": "connect", "on": "rail"})).frames()
    assert (
        "near nothing" in row["refused"]
        and "8 mm beside left, on its +y side; move rail 18 mm along -y" in row["refused"]
    )


MIDDLE = "\n[planks.middle]\nfrom = [0, 0, 0]\nto = [0, 0, 0.5]\nwidth = [0, 0.3, 0]\n"


@pytest.mark.parametrize("width", [FLAT, EDGE])
def test_a_rail_through_a_leg_between_its_ends_is_to_be_drawn_as_two(tmp_path, width) -> None:
    design = drawn(tmp_path, rail(-0.49, 0.49, 0.0, width), MIDDLE)
    assert design.furniture.test().words[0].startswith("overlapping: rail and middle by ")
    suggestions = design.suggestion_list
    assert not suggestions.found
    assert suggestions.why == "rail goes through middle: draw it as two planks, one on each side of middle"


def test_planks_that_share_an_edge_go_through_nothing(tmp_path) -> None:
    # The rail is a quarter outside of the middle leg.
    design = drawn(tmp_path, rail(-0.49, 0.49, 0.135, EDGE), MIDDLE.replace("0.3, 0]", "0.28, 0]"))
    # The rail, 20 mm thick, reaches from y = 0.125 m, the middle leg to 0.14 m.
    assert design.suggestion_list.why == "move middle 15 mm along -y, off rail"


def test_a_tray_that_cannot_be_connected_says_that_it_lies_on_the_top(tmp_path) -> None:
    tray = "\n[planks.tray]\nfrom = [-0.1, 0, 0.53]\nto = [0.1, 0, 0.53]\nwidth = [0, 0.1, 0]\n"
    path = write_bench(tmp_path, BENCH + tray)
    *_, row = make_replay(path, write_edits(tmp_path, {"do": "connect", "on": "tray"})).frames()
    assert (
        "near nothing" in row["refused"] and "tray lies on top, but planks are held by joints alone" in row["refused"]
    )
