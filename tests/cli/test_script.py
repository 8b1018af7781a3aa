"""`restshape script`: what it writes is a valid script that does what the lines say."""

import json

import numpy as np
import pytest
from cloths import BALL, CONTACT, write_cloth
from small_scenes import CURVED

from restshape.cli.main import main
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene
from restshape.shape.session import EditSession

LINES = [
    "hole window by 0.8 0 in 160 frames, hand-like",
    "rotate window by 30 deg in 5 frames",
    "scale hole window by 0.5 about 1300 mm 0.5 in 5 frames",
    "hole port at 0.4 0.5 radius 8 cm",
    "insert q on bottom at 0.5",
    "vertex q by 0 -10 cm in 10 frames, jerk, pause 3",
    "arc left to 0.2 in 4 frames",
    'set material.steel.E = "70 GPa"',
    "delete port",
    "pull top at 1 1.14 by 0 10 cm pins d (1.5 1.1) in 6 frames, hand-like",
    "smooth top by 0.4 in 3 frames",
    "undo",
    "analyse",
    "idle 10",
    "undo",
    "redo",
]


@pytest.fixture
def scene(tmp_path):
    (tmp_path / "plate.toml").write_text(CURVED)
    return tmp_path / "plate.toml"


def test_the_script_is_valid_and_leads_where_the_lines_say(scene, tmp_path, capsys):
    out, numbers = tmp_path / "edits.jsonl", tmp_path / "numbers.json"
    assert main(["script", str(scene), *LINES, "--out", str(out), "--json", str(numbers)]) == 0
    found = load_scene(scene)
    frames = list(EditSession(found, load_script(out, found)).frames())
    assert len(frames) == 1 + json.loads(numbers.read_text())["frames"]
    assert not any(frame.refused for frame in frames)
    outline = frames[-1].outline
    np.testing.assert_allclose(outline.centroid(outline.entity("window")), [1.3, 0.5], atol=1e-12)
    np.testing.assert_allclose(outline.points[outline.entity("q").vertices[0]], [1.0, -0.1], atol=1e-12)
    assert sum(outline.length(e) for e in outline.entity("window").edges) == pytest.approx(0.2 * np.pi, rel=1e-12)
    assert outline.names("hole") == ["window"]
    assert frames[-1].scene.material["steel"].E == 70e9
    # The place under the hand lies on the curve, 10 cm up from where the old curve was.
    before = next(frame.outline for frame in frames if frame.do == "pull")
    after = [frame.outline for frame in frames if frame.do == "drag"][-1]
    old, new = (shape.point(shape.entity("top").edges[0], np.linspace(0, 1, 4001)) for shape in (before, after))
    near = old[np.hypot(*(old - [1.0, 1.14]).T).argmin()]
    assert np.hypot(*(new - near - [0.0, 0.1]).T).min() < 1e-3
    steps = np.diff([frame.t for frame in frames[2:162]])
    np.testing.assert_allclose(steps, 1 / 60, atol=1e-5)


def test_the_same_seed_gives_the_same_bytes(scene, tmp_path, capsys):
    texts = []
    for seed in ("5", "5", "6"):
        assert main(["script", str(scene), LINES[0], "--seed", seed]) == 0
        texts.append(capsys.readouterr().out)
    assert texts[0] == texts[1] != texts[2]


def test_what_will_be_refused_is_reported(scene, tmp_path, capsys):
    out = tmp_path / "edits.jsonl"
    assert main(["script", str(scene), "window by 0 0.5 in 10 frames", "--out", str(out)]) == 0
    assert "3 frames will be refused: edges top and window.1" in capsys.readouterr().err


@pytest.mark.parametrize("line", ["fly window", "window by 1", "arc left to", "pull top"])
def test_lines_that_make_no_sense_get_the_grammar(scene, capsys, line):
    assert main(["script", str(scene), line]) == 2
    assert "insert NAME on EDGE at S" in capsys.readouterr().err


@pytest.mark.parametrize(
    "line, remedy", [("insert q on bottom at 2", "give a number below 1"), ("idle 0", "give at least 1")]
)
def test_numbers_out_of_bounds_are_answered_by_the_bound(scene, capsys, line, remedy):
    assert main(["script", str(scene), line]) == 2
    assert remedy in capsys.readouterr().err


def test_a_name_that_is_not_there_is_suggested(scene, capsys):
    assert main(["script", str(scene), "windw by 1 0 in 3 frames"]) == 2
    assert "did you mean 'window'" in capsys.readouterr().err


def test_bodies_and_values_over_frames(tmp_path):
    path, out = write_cloth(tmp_path, BALL, CONTACT), tmp_path / "edits.jsonl"
    lines = ["body ball by 10 cm 0 in 8 frames", "set bodies.ball.friction = 0.1 in 4 frames", "scale ball by 1.2"]
    assert main(["script", str(path), *lines, "--out", str(out)]) == 0
    found = load_scene(path)
    frames = list(EditSession(found, load_script(out, found)).frames())
    assert len(frames) == 1 + 10 + 4 + 1 and not any(frame.refused for frame in frames)
    assert [frame.scene.bodies["ball"].friction for frame in frames[-5:-1]] == pytest.approx([0.25, 0.2, 0.15, 0.1])
    ball = frames[-1].scene.bodies["ball"].evaluated(found.parameters).form
    np.testing.assert_allclose([*ball.center, ball.radius], [0.6, 0.5, -0.3, 0.3], atol=1e-15)
