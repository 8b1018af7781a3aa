"""Shapes that follow the parameters of their scenes while scripts edit them."""

import json

import numpy as np
import pytest
from parametric_scenes import BRACKET, PLATE, scene_of

from restshape.replay.sessions import session_of
from restshape.scene.edit_script import load_script
from restshape.shape.build import outline_from_spec

LAST = 8


def frames_of(folder, body, *events):
    """The frames of a script on a scene; those of a `set` are its last ones."""
    scene = scene_of(folder, body)
    lines = [{"format": "restshape-edits", "version": 1, "scene": "plate.toml", "units": "m"}]
    lines += [{"t": float(i), **event} for i, event in enumerate(events)]
    path = folder / "edit.jsonl"
    path.write_text("\n".join(map(json.dumps, lines)) + "\n", encoding="utf-8")
    return list(session_of(scene, load_script(path, scene)).frames())


def given(folder, body, *overrides):
    """The outline that a scene gives."""
    return outline_from_spec(scene_of(folder, body, *overrides).shape)


def wider(key="parameters.width", value="40 cm", frames=LAST):
    return {"do": "set", "key": key, "value": value, "frames": frames}


def moved(frames, name):
    outline = frames[-1].outline
    return outline.points[outline.vertex_names.index(name)]


def dragged(on, to):
    return {"do": "press", "on": on}, {"do": "drag", "to": to}, {"do": "release"}


def test_a_parameter_moves_the_shape_linearly_along_one_gesture(tmp_path):
    frames = frames_of(tmp_path, PLATE, wider())[1:]
    assert [frame.change for frame in frames] == ["move"] * LAST
    assert len({id(frame.gesture) for frame in frames}) == 1 and frames[0].gesture.linear
    assert [frame.c[0] for frame in frames] == [i / LAST for i in range(1, LAST + 1)]
    for i, frame in enumerate(frames, 1):
        width = 0.3 + 0.1 * i / LAST
        # The area in closed form.
        assert frame.outline.area() == pytest.approx(width**2 / 3 - np.pi * (width / 15) ** 2, rel=1e-13)


@pytest.mark.parametrize(
    ("body", "key", "value"),
    [(PLATE, "parameters.width", "40 cm"), (BRACKET, "parameters.depth", "28 cm"), (BRACKET, "parameters.turn", 0.3)],
)
def test_the_shape_is_that_of_the_scene_with_the_parameter(tmp_path, body, key, value):
    frames = frames_of(tmp_path, body, wider(key, value))
    found, wanted = frames[-1].outline, given(tmp_path, body, f"{key}={json.dumps(value)}")
    assert [frame.change for frame in frames[1:]] == ["move"] * LAST
    assert all(frame.outline.topology == frames[0].outline.topology for frame in frames)
    assert np.array_equal(found.points, wanted.points) and np.array_equal(found.bulges, wanted.bulges)
    for edge in range(len(found.edges)):
        s = np.linspace(0.0, 1.0, 7)
        if found.edges[edge].kind != "polyline":
            assert np.array_equal(found.point(edge, s), wanted.point(edge, s))
    assert found.area() == pytest.approx(wanted.area(), rel=1e-14)


def test_a_shape_that_is_no_linear_function_has_a_gesture_a_frame(tmp_path):
    body = PLATE.replace('height = "width/3"', 'height = "width^2/(90 cm)"')
    frames = frames_of(tmp_path, body, wider())[1:]
    assert len({id(frame.gesture) for frame in frames}) == LAST
    for frame in frames:
        assert np.allclose(frame.gesture.points(frame.c), frame.outline.points, rtol=0.0, atol=1e-15)


def test_a_vertex_that_a_hand_has_moved_keeps_its_distance(tmp_path):
    frames = frames_of(tmp_path, PLATE, *dragged("c", [0.31, 0.12]), wider())
    assert moved(frames, "c") == pytest.approx([0.4 + 0.01, 0.4 / 3 + 0.02], abs=1e-15)
    assert moved(frames, "d").tolist() == [0.0, 0.4 / 3]


def test_what_edits_have_added_stays_and_what_they_have_taken_away_is_gone(tmp_path):
    frames = frames_of(
        tmp_path,
        PLATE,
        {"do": "insert", "on": "top", "name": "m", "s": 0.5},
        {"do": "hole", "name": "extra", "center": [0.05, 0.05], "radius": 0.01},
        {"do": "delete", "on": "bore"},
        wider(),
    )
    assert [frame.change for frame in frames[-LAST:]] == ["move"] * LAST
    assert moved(frames, "m").tolist() == [0.15, pytest.approx(0.1)] and moved(frames, "c")[0] == 0.4
    assert frames[-1].outline.names("hole") == ["extra"]


def test_a_curve_that_an_edit_has_cut_is_refused_by_its_name(tmp_path):
    frames = frames_of(
        tmp_path, BRACKET, {"do": "insert", "on": "curve", "name": "m", "s": 0.5}, wider("parameters.depth")
    )
    assert all("'curve'" in frame.refused for frame in frames[-LAST:])
    # The bulge of the foot alone changes nothing of it.
    frames = frames_of(
        tmp_path, BRACKET, {"do": "insert", "on": "curve", "name": "m", "s": 0.5}, wider("parameters.turn", 0.3)
    )
    assert not any(frame.refused for frame in frames)


def test_setting_what_one_parameter_gives_sets_that(tmp_path):
    frames = frames_of(tmp_path, PLATE, wider("shape.vertices.b.0"))
    assert moved(frames, "c").tolist() == [0.4, 0.4 / 3] and frames[-1].scene.parameters["width"] == 0.4


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("shape.holes.bore.circle.center.0", ("'width/2'", "set parameters.width")),
        ("parameters.height", ("'width/3'", "set parameters.width")),
        ("shape.vertices.a.0", ("cannot be set during an edit",)),
    ],
)
def test_what_more_than_a_parameter_gives_is_refused_in_words(tmp_path, key, words):
    frames = frames_of(tmp_path, PLATE, wider(key, 0.2))
    assert all(word in frame.refused for frame in frames[1:] for word in words)
    assert frames[-1].outline is frames[0].outline


def test_a_limit_follows_its_parameter_with_the_shape(tmp_path):
    body = PLATE + '[quantities.low]\ndisplacement = "y"\nat = "tip"\nmax = "width/100"\n'
    frames = frames_of(tmp_path, body, wider())
    assert all(frame.refused is None for frame in frames)
    limits = [frame.scene.quantities["low"].max for frame in frames]
    assert limits == pytest.approx([frame.scene.parameters["width"] / 100.0 for frame in frames])
    assert limits[0] != limits[-1] and frames[-1].outline is not frames[0].outline


def test_the_shape_does_not_change_beneath_the_hand(tmp_path):
    press, drag, release = dragged("c", [0.31, 0.12])
    frames = frames_of(tmp_path, PLATE, press, wider(frames=1), wider("parameters.P", 5.0, 1), drag, release)
    assert "release it first" in frames[2].refused and frames[3].refused is None
    assert moved(frames, "c") == pytest.approx([0.31, 0.12])


def test_frames_without_a_valid_shape_are_refused_and_the_others_are_not(tmp_path):
    frames = frames_of(tmp_path, PLATE.replace('r = "height/5"', 'r = "2 cm"'), wider("parameters.r", "6 cm"))[1:]
    refused = [frame.refused is not None for frame in frames]
    # The hole has room up to 5 cm.
    assert refused == [0.02 + 0.04 * i / LAST >= 0.05 - 1e-9 for i in range(1, LAST + 1)]
    assert frames[-1].scene.parameters["r"] == pytest.approx(0.045)


def test_an_undo_takes_all_of_it_back(tmp_path):
    frames = frames_of(tmp_path, PLATE, wider(), {"do": "undo"}, {"do": "redo"})
    assert [frame.change for frame in frames[-2:]] == ["move", "move"]
    assert np.array_equal(frames[-2].outline.points, frames[0].outline.points)
    assert frames[-2].scene is frames[0].scene and moved(frames, "c")[0] == 0.4


def test_a_mesh_size_by_the_parameter_is_another_mesh(tmp_path):
    body = PLATE.replace("[loads.pull]", '[mesh.near]\nbore = "r/4"\n[loads.pull]')
    frames = frames_of(tmp_path, body, wider())
    assert [frame.change for frame in frames[1:]] == ["mesh"] * LAST
