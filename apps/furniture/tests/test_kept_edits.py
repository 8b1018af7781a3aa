"""What edits have changed of planks stays when parameters and thicknesses are set: places and sizes by hand."""

import numpy as np
import pytest
from restshape_apps.furniture.session.plank_session import PlankSession
from restshape_apps.furniture.tests.furniture_scenes import HEAD, write_edits

from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

SHELF = """
[parameters]
b = "700 mm"
h = "900 mm"
d = "240 mm"
t = "18 mm"
[wood]
name = "oak"
thickness = "t"
[fastener]
name = "dowel"
spacing = "50 mm"
[planks]
left = { from = ["-b/2 + t/2", 0, 0], to = ["-b/2 + t/2", 0, "h - t"], width = [0, "d", 0] }
right = { from = ["b/2 - t/2", 0, 0], to = ["b/2 - t/2", 0, "h - t"], width = [0, "d", 0] }
top = { from = ["-b/2", 0, "h - t/2"], to = ["b/2", 0, "h - t/2"], width = [0, "d", 0] }
mid = { from = ["-b/2 + t", 0, "h/2"], to = ["b/2 - t", 0, "h/2"], width = [0, "d", 0] }
[weights.books]
on = "mid"
mass = "20 kg"
[effects.gravity]
"""


@pytest.fixture
def play(tmp_path):
    """The last frame of events on the shelf, and its planks by name."""

    def played(*events, text=SHELF):
        (tmp_path / "shelf.toml").write_text(HEAD + text)
        scene = load_scene(tmp_path / "shelf.toml")
        script = load_script(write_edits(tmp_path, *events, scene="shelf.toml"), scene)
        frames = list(PlankSession(scene, script).frames())
        return frames[-1], {one.name: one for one in frames[-1].design.furniture.moved(frames[-1].gamma).planks}

    return played


def drag(on, parameter, by):
    return {"do": "press", "on": on, "parameter": parameter}, {"do": "drag", "by": by}, {"do": "release"}


def set_(key, value, **more):
    return {"do": "set", "key": key, "value": value, **more}


EDITED = (*drag("mid", "move z", "100 mm"), *drag("top", "length y", "60 mm"), *drag("mid", "length y", "-40 mm"))


@pytest.mark.parametrize("frames", [1, 3])
@pytest.mark.parametrize("key", ["parameters.t", "wood.thickness"])
def test_edits_stay_where_the_thickness_is_set(play, key, frames):
    frame, planks = play(*EDITED, set_(key, "22 mm", frames=frames))
    assert not frame.refused and not frame.note
    assert planks["mid"].centre == pytest.approx([0.0, 0.0, 0.55]) and planks["top"].centre[2] == pytest.approx(0.889)
    assert planks["mid"].size == pytest.approx([0.656, 0.2, 0.022])
    assert planks["top"].size == pytest.approx([0.7, 0.3, 0.022])
    assert planks["left"].centre == pytest.approx([-0.339, 0.0, 0.439])


def test_what_a_parameter_changes_is_added_to_what_edits_have_changed(play):
    _, planks = play(*EDITED, set_("parameters.d", "300 mm"), set_("parameters.h", "1 m"), set_("parameters.b", 0.9))
    assert planks["mid"].centre == pytest.approx([0.0, 0.0, 0.6])
    assert planks["mid"].size[:2] == pytest.approx([0.864, 0.26]) and planks["top"].size[1] == pytest.approx(0.36)
    # All that no edit has changed is as the scene draws it, to the last bit.
    fresh = SHELF.replace("700 mm", "900 mm").replace('h = "900 mm"', 'h = "1 m"').replace("240 mm", "300 mm")
    _, drawn = play(text=fresh)
    for name in ("left", "right"):
        assert np.array_equal(planks[name].corners(), drawn[name].corners())


def test_a_turned_plank_stays_turned(play):
    turn = {"do": "rotate", "on": "mid", "about": "y", "by": "5 deg"}
    frame, planks = play(turn, set_("parameters.b", "800 mm"))
    assert not frame.refused
    assert planks["mid"].axes[:, 0] == pytest.approx([np.cos(np.radians(5)), 0, -np.sin(np.radians(5))])
    assert planks["mid"].size[0] == pytest.approx(0.764 / np.cos(np.radians(5)))


def test_a_chosen_suggestion_stays(play):
    heavy, chosen = SHELF.replace("20 kg", "400 kg").replace("dowel", "screw"), {"do": "choose", "number": 3}
    _, drawn = play(text=heavy)
    frame, before = play(chosen, text=heavy)
    assert frame.note.startswith("suggestion 3: left ")
    _, after = play(chosen, set_("parameters.t", "22 mm"), text=heavy)
    for name in ("left", "right", "mid"):
        assert before[name].size[1] > drawn[name].size[1] + 1e-3
        assert after[name].size[1] == pytest.approx(before[name].size[1], abs=1e-12)


def test_a_key_of_the_plank_itself_is_taken_as_it_is_and_a_note_says_so(play):
    text = SHELF.replace('0, "h/2"], width = [0, "d"', "0, 0.45], width = [0, 0.24")
    # What the key does not decide stays.
    frame, planks = play(*EDITED, set_("planks.mid.width", [0, 0.25, 0]), text=text)
    assert planks["mid"].centre[2] == pytest.approx(0.55) and planks["mid"].size[1] == 0.25
    assert frame.note == "what edits had changed of mid is taken back where planks.mid.width decides it"
    # Nothing had changed the top's thickness.
    frame, planks = play(*EDITED, set_("planks.top.thickness", "25 mm"))
    assert planks["top"].size[1:] == pytest.approx([0.3, 0.025]) and not frame.note


def test_planks_that_edits_leave_no_size_are_refused(play):
    frame, planks = play(*drag("mid", "length y", "-200 mm"), set_("parameters.d", "150 mm"))
    assert "mid would have no length along its y left: edits have made it shorter" in frame.refused
    assert planks["mid"].size[1] == pytest.approx(0.04)


def test_a_chosen_thickness_sets_the_parameter_that_gives_it(play):
    push = '[pushes.side]\non = "top"\nforce = ["160 N", 0, 0]\n[effects.push]\n[effects.guidance]\n'
    heavy = SHELF.replace("20 kg", "60 kg").replace("dowel", "screw").replace("50 mm", "80 mm") + push
    frame, _ = play(text=heavy)
    found = frame.design.suggestion_list.found
    number = next(k for k, one in enumerate(found, 1) if one.settings and one.settings[0][0] == "wood.thickness")
    t = found[number - 1].settings[0][1]
    frame, planks = play({"do": "choose", "number": number}, text=heavy)
    assert frame.scene.parameters["t"] == t and frame.note.endswith("; set by parameters.t")
    # As the formulas have it: the outer width stays, and the shelf is between the sides.
    _, drawn = play(set_("wood.thickness", t), text=heavy)
    for name, plank in planks.items():
        assert plank.corners() == pytest.approx(drawn[name].corners(), abs=1e-12)
    assert np.ptp([planks[name].corners()[:, 0] for name in ("left", "right")]) == pytest.approx(0.7)
    assert frame.design.furniture.test().valid
    _, thicker = play({"do": "choose", "number": number}, set_("parameters.t", "30 mm"), text=heavy)
    assert {float(plank.size[2]) for plank in thicker.values()} == {0.03}


def test_a_drawn_plank_follows_the_thickness_of_all_after_another_key_of_it_was_set(play):
    tie = {"do": "plank", "name": "tie", "from": [-0.332, 0.1, 0.7], "to": [0.332, 0.1, 0.7], "width": [0, 0, 0.08]}
    _, planks = play(tie, set_("planks.tie.width", [0, 0, 0.1]), set_("parameters.t", "25 mm"))
    assert planks["tie"].size == pytest.approx([0.65, 0.1, 0.025])
    # One of its own stays.
    _, planks = play(tie, set_("planks.tie.thickness", "20 mm"), set_("parameters.t", "25 mm"))
    assert planks["tie"].size[2] == pytest.approx(0.02)
