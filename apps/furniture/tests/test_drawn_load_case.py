"""The load case that a picture of furniture draws, and numbers beside joints: those of the constraint status."""

import pytest
from matplotlib.colors import to_hex
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.physics.plank_findings import load_case
from restshape_apps.furniture.report.furniture import draw_piece, joint_label
from restshape_apps.furniture.report.piece_frames import worst_case
from restshape_apps.furniture.report.status_colour import DOUBT
from small_scenes import make_replay
from test_moments_of_joints import post

from restshape.report.style import REFUSED, new_figure


@pytest.fixture
def model_of(tmp_path):
    """What makes the tested model of a scene's text."""

    def made(text: str) -> Furniture:
        path = tmp_path / "scene.toml"
        path.write_text(text)
        furniture = Furniture(make_replay(path).session.design.piece)
        furniture.test()
        return furniture

    return made


def numbers(furniture: Furniture, case: int) -> dict[str, str]:
    """The numbers beside joints in a picture, with their colours."""
    axes = new_figure(4.0, 3.5).subplots()
    draw_piece(axes, furniture, case=case)
    written = {text.get_text(): to_hex(text.get_color()) for text in axes.texts}
    return {text: colour for text, colour in written.items() if colour in (DOUBT, REFUSED)}


def test_the_drawn_case_is_that_of_the_doubt(model_of) -> None:
    # Across, the push uses the joint more of what counts; along it overloads it by a moment that does not.
    furniture = model_of(post("0.2 m", "500 N").replace("force = [1,", "force = [30,"))
    (doubt,) = furniture.test().doubts
    utilisations = [furniture.forces(case).utilisation.max() for case in range(3)]
    assert max(utilisations) == utilisations[1] < 1.0 < doubt.value
    case = worst_case(furniture)
    assert load_case(furniture.piece, case) == doubt.case == "push along"
    assert numbers(furniture, case) == {joint_label(doubt.value): DOUBT}


def test_numbers_beside_joints_are_those_of_the_heading(model_of) -> None:
    # One push breaks the joint, the other one or the weights alone do not: whichever is drawn, the heading is the same.
    furniture = model_of(post("0.2 m", "2000 N").replace("force = [1,", "force = [80,"))
    weak = [one for one in furniture.test().findings if one.kind == "weak"]
    assert len({one.case for one in weak}) == len(weak) == 1
    for case in range(3):
        assert numbers(furniture, case) == {joint_label(one.value): REFUSED for one in weak}
