"""`restshape cloth-paths`: the same edits in half as many frames, and what is said of both ends."""

import json

import pytest
from restshape_verification.couture.hard_scenes import CONTACT, ball, pinned, square
from restshape_verification.couture.paths import Ends, halved

from restshape.cli.main import main


def test_half_as_many_frames_are_half_of_each_event_but_its_end():
    path = [[0.1 * k, 0.0] for k in range(1, 6)]
    events = [
        {"do": "press", "on": "ball"},
        {"do": "drag", "path": path},
        {"do": "set", "key": "mesh.size", "value": 1, "frames": 9},
        {"do": "set", "key": "mesh.size", "value": 2, "frames": 1},
        {"do": "idle", "frames": 4},
    ]
    found = halved(events)
    assert found[1]["path"] == [path[1], path[3], path[4]] and events[1]["path"] == path
    assert [event.get("frames") for event in found] == [None, None, 4, 1, 4]


def test_two_rests_are_reported_with_their_energies():
    same = Ends((9, 5), (-0.1, -0.1), 1e-5, 0.3, (True, True))
    assert same.same and same.report().startswith("the same drape in 9 and in 5 frames: 10 µm apart")
    two = Ends((9, 5), (-0.1, -0.2), 0.02, 0.3, (True, True))
    assert not two.same and two.report() == "two rests in 9 and in 5 frames: 20 mm apart, energies -100 mJ and -200 mJ"
    assert "different meshes" in Ends((9, 5), (-0.1, -0.2), None, 0.3, (True, True)).report()
    refused = Ends((9, 5), (-0.1, -0.1), 0.0, 0.3, (False, True)).report()
    assert refused.endswith("; frames until then were refused, or have not converged")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "same"),
    [(square(0.06, pinned("top")), True), (square(0.06, ball(0.15, 0.15, friction=0.8), CONTACT), None)],
)
def test_the_command_says_how_both_ways_end(tmp_path, capsys, text, same):
    (tmp_path / "cloth.toml").write_text(text)
    lines = [{"format": "restshape-edits", "version": 1, "units": "m"}]
    edit = ("bodies.ball.sphere.radius", 0.07) if same is None else ("material.cotton.rho", 900)
    lines.append({"t": 0.1, "do": "set", "key": edit[0], "value": edit[1], "frames": 4})
    (tmp_path / "cloth.jsonl").write_text("\n".join(map(json.dumps, lines)))
    words = ["cloth-paths", str(tmp_path / "cloth.toml"), "--edits", str(tmp_path / "cloth.jsonl")]
    assert main([*words, "--json", str(tmp_path / "a.json")]) == 0
    found, said = json.loads((tmp_path / "a.json").read_text()), capsys.readouterr().out
    assert said.startswith(f"line 2: {'the same drape' if found['same'] else 'two rests'} in 5 and in 3 frames")
    assert all(found["converged"]) and found["frames"] == [5, 3] and found["same"] in (True, same or found["same"])
    assert main(words[:2]) == 2


def test_edits_are_compared_where_they_end_and_not_what_an_undo_brings_back(tmp_path, capsys, monkeypatch):
    """Places of the script are in millimetres, blank lines count, and progress is shown."""
    monkeypatch.setenv("RESTSHAPE_PROGRESS", "0")
    (tmp_path / "cloth.toml").write_text(square(0.15, pinned("top")))
    lines = [{"format": "restshape-edits", "version": 1, "units": "mm", "scene": "cloth.toml"}]
    lines.append({"t": 0.1, "do": "set", "key": "material.cotton.rho", "value": 900, "frames": 2})
    lines.append({"t": 0.2, "do": "press", "on": "supports.top", "at": [0, 300, 0]})
    lines.append({"t": 0.3, "do": "drag", "to": [0, 330, 0], "frames": 2})
    lines += [{"t": 0.4, "do": "release"}, {"t": 0.5, "do": "undo"}, {"t": 0.6, "do": "undo"}]
    (tmp_path / "cloth.jsonl").write_text("\n".join([json.dumps(lines[0]), "", *map(json.dumps, lines[1:])]))
    words = ["cloth-paths", str(tmp_path / "cloth.toml"), "--edits", str(tmp_path / "cloth.jsonl")]
    assert main([*words, "--json", str(tmp_path / "a.json")]) == 0
    found, out = json.loads((tmp_path / "a.json").read_text()), capsys.readouterr()
    assert [(one["line"], one["frames"]) for one in found["edits"]] == [(3, [3, 2]), (5, [6, 4])]
    assert all(one["same"] for one in found["edits"]) and all(found["converged"]) and found["line"] == 5
    assert "line 5: the same drape in 6 and in 4 frames" in out.out and "2 of 2 edits end in the same drape" in out.out
    assert "9 of 16 frames" in out.err
