"""Planks that lie on the floor or on each other stay there when they become thicker: heights by hand."""

import numpy as np
import pytest
from restshape_apps.furniture.guidance.remedies import remedies
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.session.plank_session import PlankSession
from restshape_apps.furniture.shape.face_contacts import face_contacts, kept_contacts
from restshape_apps.furniture.shape.plank_scene import piece_of
from restshape_apps.furniture.shape.planks import Piece, Plane, Plank
from restshape_apps.furniture.tests.furniture_scenes import BENCH, FLOOR_BOARD, HEAD, write_edits

from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene, recorded_scene

FLOOR = (Plane(),)


def board(name: str, x: float, z: float, t: float, size: tuple[float, float] = (0.4, 0.3)) -> Plank:
    """A level board with its middle at x and z."""
    return Plank(name, np.array([x, 0.0, z]), np.eye(3), np.array([*size, t]), "pine")


def thickened(planks: list[Plank], *thickness: float, fixed: tuple[int, ...] = ()) -> list[float]:
    """Heights of the middles of planks of other thicknesses [m]."""
    after = [Plank(p.name, p.centre, p.axes, np.array([*p.size[:2], t])) for p, t in zip(planks, thickness)]
    return [float(plank.centre[2]) for plank in kept_contacts(planks, after, FLOOR, fixed)]


def scene_in(folder, text: str = FLOOR_BOARD, *overrides: str):
    """The scene of a text without its head."""
    path = folder / "scene.toml"
    path.write_text(HEAD + text)
    return load_scene(path, overrides)


def played(scene, folder, *events) -> Piece:
    """The piece after events."""
    script = load_script(write_edits(folder, *events, scene="scene.toml"), scene)
    frame = list(PlankSession(scene, script).frames())[-1]
    assert not frame.refused
    return frame.design.furniture.moved(frame.gamma)


def placed(piece: Piece) -> dict[str, list[float]]:
    """Lowest and highest place of each plank [m]."""
    ends = {plank.name: plank.corners()[:, 2] for plank in piece.planks}
    return {name: [float(z.min()), float(z.max())] for name, z in ends.items()}


def test_a_stack_on_the_floor_grows_upwards() -> None:
    t, u = 0.018, 0.024
    stack = [board(f"{k}", 0.0, (k + 0.5) * t, t) for k in range(3)]
    assert thickened(stack, u, u, u) == pytest.approx([0.5 * u, 1.5 * u, 2.5 * u], abs=1e-15)
    # One of them alone lifts what lies on it.
    assert thickened(stack, t, u, t) == pytest.approx([0.5 * t, t + 0.5 * u, 1.5 * t + u], abs=1e-15)
    assert thickened(stack[::-1], t, t, u) == pytest.approx([1.5 * t + u, t + 0.5 * u + 0.5 * (u - t), 0.5 * u])


def test_the_face_stays_where_boards_meet_away_from_the_floor() -> None:
    t, u = 0.018, 0.024
    face = 0.5
    two = [board("low", 0.0, face - 0.5 * t, t), board("high", 0.05, face + 0.5 * t, t)]
    assert thickened(two, u, u) == pytest.approx([face - 0.5 * u, face + 0.5 * u])
    assert thickened(two, t, u) == pytest.approx([face - 0.5 * t, face + 0.5 * u])
    three = [*two, board("top", 0.0, face + 1.5 * t, t)]
    assert thickened(three, u, u, u) == pytest.approx([face + 0.5 * t - u, face + 0.5 * t, face + 0.5 * t + u])


def test_a_board_on_two_keeps_the_one_that_it_would_overlap() -> None:
    t, u = 0.018, 0.024
    planks = [board("a", -0.3, 0.5 * t, t), board("b", 0.3, 0.5 * t, t), board("c", 0.0, 1.5 * t, t, (1.0, 0.3))]
    assert thickened(planks, u, t, t) == pytest.approx([0.5 * u, 0.5 * t, u + 0.5 * t])


def test_a_board_that_is_drawn_elsewhere_takes_along_what_lies_on_it() -> None:
    t, u = 0.018, 0.024
    low, high = board("low", 0.0, 0.5, t), board("high", 0.0, 0.5 + t, t)
    after = [board("low", 0.0, 0.7, u), board("high", 0.0, 0.5 + t, u)]
    found = kept_contacts([low, high], after, FLOOR, (0,))
    assert [float(plank.centre[2]) for plank in found] == pytest.approx([0.7, 0.7 + u])


def test_boards_beside_each_other_or_in_the_air_stay_where_they_are() -> None:
    t, u = 0.018, 0.024
    # Their sides touch; one lies 0.2 mm above the other; one is 1 mm above the floor.
    for planks in (
        [board("a", 0.0, 0.5, t), board("b", 0.4, 0.5 + t, t)],
        [board("a", 0.0, 0.5, t), board("b", 0.0, 0.5002 + t, t)],
        [board("a", 0.0, 0.001 + 0.5 * t, t)],
    ):
        assert not face_contacts(planks, FLOOR)
        assert thickened(planks, *[u] * len(planks)) == [float(plank.centre[2]) for plank in planks]


def test_a_foot_board_of_a_script_stays_on_the_floor(tmp_path) -> None:
    scene = scene_in(tmp_path)
    before = placed(Furniture(piece_of(scene)).moved())
    assert before["base"] == pytest.approx([0.0, 0.018]) and before["post"] == pytest.approx([0.018, 0.45])
    after = played(scene, tmp_path, {"do": "set", "key": "wood.thickness", "value": "24 mm", "frames": 3})
    heights = placed(after)
    assert heights["base"] == pytest.approx([0.0, 0.024], abs=1e-12)
    # The seat keeps its middle: nothing lies flat on it. The post ends at both faces.
    assert heights["seat"] == pytest.approx([0.447, 0.471]) and heights["post"] == pytest.approx([0.024, 0.447])
    assert Furniture(after).test().valid
    # One step leads there as three do, and back again.
    once = played(scene, tmp_path, {"do": "set", "key": "wood.thickness", "value": "24 mm"})
    assert placed(once)["base"] == pytest.approx(heights["base"], abs=1e-12)
    there = (
        {"do": "set", "key": "wood.thickness", "value": "24 mm"},
        {"do": "set", "key": "wood.thickness", "value": "18 mm"},
    )
    back = placed(played(scene, tmp_path, *there))
    assert all(back[name] == pytest.approx(before[name], abs=1e-12) for name in before)


def test_boards_drawn_by_formulas_and_by_numbers_stay_in_contact(tmp_path) -> None:
    text = FLOOR_BOARD.replace('thickness = "18 mm"', 'thickness = "t"').replace('"9 mm"', '"t/2"')
    text = '[parameters]\nt = "18 mm"\n' + text + "[planks.pad]\ncenter = [0.15, 0, 0.027]\nsize = [0.08, 0.3]\n"
    scene = scene_in(tmp_path, text)
    heights = placed(played(scene, tmp_path, {"do": "set", "key": "parameters.t", "value": "24 mm"}))
    assert heights["base"] == pytest.approx([0.0, 0.024]) and heights["pad"] == pytest.approx([0.024, 0.048])


def test_thicker_boards_are_suggested_for_a_piece_on_a_foot_board(tmp_path) -> None:
    piece = Furniture(piece_of(scene_in(tmp_path, FLOOR_BOARD.replace("30 kg", "90 kg")))).moved()
    assert not Furniture(piece).test().valid
    thick = next(one for one in remedies(piece) if one.name == "thicker planks")
    t = thick.settings[0][1]
    heights = placed(thick.piece)
    assert heights["base"] == pytest.approx([0.0, t], abs=1e-12)
    assert heights["post"] == pytest.approx([t, 0.459 - 0.5 * t])
    # What is chosen is what was shown.
    scene = scene_in(tmp_path, FLOOR_BOARD.replace("30 kg", "90 kg"))
    design = PlankSession(scene, load_script(write_edits(tmp_path, scene="scene.toml"), scene)).design
    number = 1 + [one.name for one in design.suggestion_list.found].index("thicker planks")
    chosen = played(scene, tmp_path, {"do": "choose", "number": number})
    assert placed(chosen) == {name: pytest.approx(ends, abs=1e-12) for name, ends in heights.items()}
    assert Furniture(chosen).test().valid


@pytest.mark.parametrize("thickness", ["12 mm", "24 mm", "33 mm"])
def test_a_thickness_of_the_command_line_makes_the_piece_of_a_script(tmp_path, thickness: str) -> None:
    text = FLOOR_BOARD + '[planks.pad]\ncenter = [0.15, 0, "27 mm"]\nsize = [0.08, 0.3]\n'
    again = Furniture(piece_of(scene_in(tmp_path, text, f'wood.thickness="{thickness}"'))).moved()
    event = {"do": "set", "key": "wood.thickness", "value": thickness}
    edited = played(scene_in(tmp_path, text), tmp_path, event)
    t = 1e-3 * float(thickness.split()[0])
    assert placed(again)["base"] == pytest.approx([0.0, t], abs=1e-12)
    assert placed(again)["pad"] == pytest.approx([t, 2.0 * t])
    for one, other in zip(again.planks, edited.planks):
        assert one.corners() == pytest.approx(other.corners(), abs=1e-12)
    assert (again.joints, again.feet) == (edited.joints, edited.feet)


def test_one_plank_thickened_on_the_command_line_lifts_what_lies_on_it(tmp_path) -> None:
    text = FLOOR_BOARD + '[planks.pad]\nfrom = [0.11, 0, 0.027]\nto = ["190 mm", 0, "27 mm"]\nwidth = [0, 0.3, 0]\n'
    scene = scene_in(tmp_path, text, "planks.base.thickness=0.024")
    assert placed(Furniture(piece_of(scene)).moved())["pad"] == pytest.approx([0.024, 0.042])
    # Nothing else of it is changed, and a recording of these values has the same piece.
    assert scene.raw["planks"]["pad"]["to"] == ["190 mm", 0, pytest.approx(0.033)]
    again = recorded_scene(scene.raw, scene.path)
    assert placed(piece_of(again)) == placed(piece_of(scene))


def test_a_place_of_the_command_line_is_taken_as_it_is(tmp_path) -> None:
    scene = scene_in(tmp_path, FLOOR_BOARD, "wood.thickness=0.024", "planks.base.center=[0, 0, 0.1]")
    assert scene.raw["planks"]["base"]["center"] == [0, 0, 0.1]
    # A scene that is one with the override only has nothing to follow.
    bad = FLOOR_BOARD.replace('thickness = "18 mm"', "thickness = 0")
    assert scene_in(tmp_path, bad, "wood.thickness=0.024").raw["planks"]["base"]["center"] == [0, 0, "9 mm"]


RIB = {"do": "plank", "name": "rib", "from": [0.1, -0.1, 0.45], "to": [0.1, -0.1, 0.35], "width": [0.1, 0, 0]}
"""A board that hangs from the seat."""


@pytest.mark.parametrize(("own", "thick"), [({}, 0.024), ({"thickness": "12 mm"}, 0.012)])
def test_a_plank_that_an_edit_drew_as_thick_as_all_follows_them(tmp_path, own: dict[str, str], thick: float) -> None:
    event = {"do": "set", "key": "wood.thickness", "value": "24 mm"}
    piece = played(scene_in(tmp_path), tmp_path, {**RIB, **own}, event)
    assert piece.planks[piece.index("rib")].size[2] == pytest.approx(thick)


@pytest.mark.parametrize("own", ['\nthickness = "18 mm"', ""])
def test_thicker_planks_are_what_was_shown_whoever_drew_them(tmp_path, own: str) -> None:
    text = FLOOR_BOARD.replace("30 kg", "90 kg").replace("size = [0.4, 0.3]\n", f"size = [0.4, 0.3]{own}\n")
    scene = scene_in(tmp_path, text)
    script = load_script(write_edits(tmp_path, RIB, scene="scene.toml"), scene)
    *_, last = PlankSession(scene, script).frames()
    design = last.design
    names = [one.name for one in design.suggestion_list.found]
    shown = design.suggestion_list.found[names.index("thicker planks")].piece
    chosen = played(scene, tmp_path, RIB, {"do": "choose", "number": 1 + names.index("thicker planks")})
    assert [plank.size[2] for plank in chosen.planks] == [shown.planks[0].size[2]] * 4
    assert placed(chosen) == {name: pytest.approx(ends, abs=1e-12) for name, ends in placed(shown).items()}


@pytest.mark.parametrize("thickness", ["12 mm", "38 mm"])
def test_ends_that_were_within_reach_of_their_faces_stay_joined(tmp_path, thickness: str) -> None:
    # The rail is drawn from the middle of one leg to that of the other: 19 mm from the faces of legs of 38 mm.
    rail = "\n[planks.rail]\nfrom = [-0.5, 0, 0.2]\nto = [0.5, 0, 0.2]\nwidth = [0, 0.1, 0]\n"
    text = BENCH.removeprefix("\n") + rail + "[planks.strut]\ncenter = [0, 0, 0.35]\nsize = [0.99, 0.1]\n"
    again = Furniture(piece_of(scene_in(tmp_path, text, f'wood.thickness="{thickness}"'))).moved()
    event = {"do": "set", "key": "wood.thickness", "value": thickness}
    edited = played(scene_in(tmp_path, text), tmp_path, event)
    t = 1e-3 * float(thickness.split()[0])
    for name in ("rail", "strut"):
        assert again.planks[again.index(name)].size == pytest.approx([1.0 - t, 0.1, t])
    assert len(again.joints) == 6 and (again.joints, again.feet) == (edited.joints, edited.feet)
    for one, other in zip(again.planks, edited.planks):
        assert one.corners() == pytest.approx(other.corners(), abs=1e-12)
