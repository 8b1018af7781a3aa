"""The load case that a picture of furniture draws, and numbers beside joints: those of the constraint status."""

import pytest
from matplotlib.colors import to_hex
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.physics.joint_compliance import utilisation_range
from restshape_apps.furniture.physics.joint_label import joint_label
from restshape_apps.furniture.physics.plank_findings import load_case
from restshape_apps.furniture.physics.worst_load_case import worst_case
from restshape_apps.furniture.report.furniture import draw_piece, marks_redundant, redundant_label
from restshape_apps.furniture.report.piece_frames import caption
from restshape_apps.furniture.report.status_colour import DOUBT
from restshape_apps.furniture.tests.furniture_scenes import EDGE_STOOL, post
from small_scenes import make_replay

from restshape.cli.main import main
from restshape.replay.recording.recording import Recording
from restshape.report.style import REFUSED, new_figure
from restshape.report.tables import row_of


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


@pytest.mark.slow
def test_redundant_joints_have_their_range_and_headings_begin_with_what_depends_on_joints(model_of, tmp_path) -> None:
    scene, path = tmp_path / "stool.toml", tmp_path / "stool.vtkhdf"
    scene.write_text(EDGE_STOOL)
    assert main(["replay", str(scene), "--out", str(path)]) == 0
    recording = Recording(path)
    words, _ = caption(recording, 0)
    assert words.split("\n")[1].startswith("depends on joints") and words.count("depends on joints") == 1
    assert row_of(recording, 0)["violated_constraints"].startswith("weak")
    furniture = model_of(EDGE_STOOL)
    known = utilisation_range(furniture.moved(), furniture.compliance)
    axes = new_figure(4.0, 3.5).subplots()
    draw_piece(axes, furniture)
    ranges = [text.get_text() for text in axes.texts if "\N{EN DASH}" in text.get_text()]
    assert ranges == [redundant_label(known.low[k], known.high[k]) for k in known.largest(9)]
    assert len(ranges) == len(known.redundant) > 1


def test_the_legend_of_redundant_joints_stands_where_one_is_marked(model_of) -> None:
    for text, marked in ((EDGE_STOOL, True), (post("0.2 m", "500 N"), False)):
        axes = new_figure(4.0, 3.5).subplots()
        draw_piece(axes, model_of(text))
        assert marks_redundant([axes]) is marked


@pytest.mark.slow
def test_a_reason_for_no_suggestions_says_that_it_depends_on_joints(tmp_path) -> None:
    path = tmp_path / "stool.toml"
    path.write_text(EDGE_STOOL.replace("70 kg", "170 kg") + "[effects.guidance]\nfarthest = 1e-6\n")
    row = next(iter(make_replay(path).frames()))
    assert row["constraint_status"] == "fails" and "depends on joints" in row["violated_constraints"]
    assert row["no_suggestions"].startswith("depends on joints: ")
