"""Analysis on demand: nothing is solved until it is asked for; then the result is that of a replay of every frame."""

import json

import modal
import numpy as np
import pytest
from small_scenes import BLOCK, CLAMPED, HEAD, HOLE, STEEL
from vibrating import dynamics, tower

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.interface.replays import replay_files
from restshape.replay.constraints import Limit, constraint_status, violated_constraints
from restshape.replay.recording.recording import Recording
from restshape.scene.load import load_scene

REST = """
[loads.pull]
on = "right"
traction = ["1 MPa", 0]

[mesh]
size = 0.08

[solve]
tolerance = 1e-9

[quantities]
strength = { stress = "von_mises", reduce = "max", max = "3.3 MPa" }
score = { area = true }
"""
EVENTS = [
    {"do": "press", "on": "window", "at": [0.5, 0.5]},
    {"do": "drag", "path": [[0.52, 0.5], [0.6, 0.5], [0.9, 0.55], [1.2, 0.6]]},
    {"do": "analyse"},
    {"do": "drag", "path": [[1.25, 0.6], [1.3, 0.6]]},
    {"do": "release"},
    {"do": "analyse"},
    {"do": "idle", "frames": 2},
    {"do": "scale", "on": "window", "factor": 1.9, "frames": 4},
    {"do": "analyse"},
    {"do": "hole", "name": "second", "center": [0.4, 0.5], "radius": 0.1},
    {"do": "undo"},
    {"do": "analyse"},
]


@pytest.fixture
def files(tmp_path):
    """A scene, and the script of both ways."""
    (tmp_path / "plate.toml").write_text(HEAD + BLOCK.format(width=2, height=1) + HOLE + STEEL + CLAMPED + REST)
    for name in ("every frame", "on demand"):
        header = {"format": "restshape-edits", "version": 1, "scene": "plate.toml", "analysis": name}
        lines = [header, *({"t": 0.1 * i, **event} for i, event in enumerate(EVENTS))]
        (tmp_path / f"{name}.jsonl").write_text("\n".join(map(json.dumps, lines)) + "\n")
    return tmp_path


def test_what_is_asked_for_is_what_every_frame_gives(files):
    every, asked = (
        replay_files(files / "plate.toml", files / f"{name}.jsonl", "auto")["rows"]
        for name in ("every frame", "on demand")
    )
    assert [row["event"] for row in every] == [row["event"] for row in asked]
    for one, other in zip(every, asked):
        assert one["q_score"] == pytest.approx(other["q_score"], rel=1e-12)
        assert one["level"] == other["level"]
        if other["event"] == "analyse":
            assert other["q_strength"] == pytest.approx(one["q_strength"], rel=1e-6)
            assert other["constraint_status"] == one["constraint_status"] and other["residual"] < 1e-8
    known = [row["index"] for row in asked if np.isfinite(row["q_strength"])]
    # The start and the press that leaves it, the three moments asked for, and what follows until the shape changes.
    assert known == [0, 1, 6, 10, 11, 12, 17, 20]
    assert all(row["iterations"] == 0 for row in asked if row["event"] not in ("start", "analyse"))
    # The clamped corners are singular places: what holds there is uncertain.
    assert {row["constraint_status"] for row in asked} == {"", "uncertain", "fails"}


@pytest.mark.slow
def test_the_command_prints_the_constraint_status_and_writes_no_nan(files, capsys):
    out, numbers = files / "a.vtkhdf", files / "a.json"
    call = ["replay", str(files / "plate.toml"), "--edits", str(files / "on demand.jsonl")]
    assert main([*call, "--out", str(out), "--json", str(numbers), "--csv", str(files / "a.csv")]) == 0
    reported = json.loads(numbers.read_text())
    assert reported["quantities"]["strength"][2] is None and reported["quantities"]["score"][2] > 1.9
    assert sum(reported["constraint_status"][word] for word in ("holds", "uncertain", "fails")) == 8
    printed = capsys.readouterr().out
    assert f"constraint status: {reported['constraint_status']['last']} at the end" in printed and "0 solved" in printed
    with Recording(out) as recording:
        assert recording.verify() == []
        assert np.isfinite(recording.field(1, "displacement")).all()
        assert np.isnan(recording.field(2, "displacement")).all()
        assert np.isnan(recording.field(2, "von_mises")).all()
        # The shape is recorded all the same: the hole has moved by 20 mm.
        assert np.abs(recording.points(2) - recording.points(1)).max() == pytest.approx(0.02, rel=1e-9)
        assert recording.table["constraint_status"][0] in ("uncertain", "fails")
    assert main(["report", str(out), "--animation", "none"]) == 0


def test_what_is_not_analysed_cannot_be_predicted(files, capsys):
    call = ["replay", str(files / "plate.toml"), "--edits", str(files / "on demand.jsonl")]
    assert main([*call, "--predict", "linear"]) == 2
    assert "cannot be predicted" in capsys.readouterr().err


def test_modes_are_found_on_demand(tmp_path):
    """Frequencies in plane stress go as one over the size of the body."""
    edits = [{"format": "restshape-edits", "version": 1, "units": "m", "analysis": "on demand"}]
    edits += [{"t": 0.1, "do": "scale", "on": "outline", "factor": 1.6, "frames": 4}, {"t": 0.5, "do": "analyse"}]
    (tmp_path / "edits.jsonl").write_text("".join(json.dumps(line) + "\n" for line in edits))
    name, overrides = modal.SMALL["plane"]
    overrides = [*overrides, "solve.tolerance=1e-9"]
    rows = [dict(row) for row in modal.replay(name, tmp_path / "edits.jsonl", overrides).frames()]
    assert [row["event"] for row in rows] == ["start", *["scale"] * 4, "analyse"]
    assert np.isfinite([row["q_first"] for row in rows]).tolist() == [True, *[False] * 4, True]
    assert rows[-1]["q_first"] == pytest.approx(rows[0]["q_first"] / 1.6, rel=1e-9)


@pytest.mark.parametrize("command", ["check", "replay"])
def test_a_motion_is_not_analysed_on_demand(tmp_path, capsys, command):
    scene = tower(tmp_path, dynamics())
    edits = tmp_path / "edits.jsonl"
    edits.write_text(
        '{"format": "restshape-edits", "version": 1, "analysis": "on demand"}\n{"t": 0, "do": "analyse"}\n'
    )
    assert main([command, str(scene), *(["--edits"] if command == "replay" else []), str(edits)]) == 2
    reported = capsys.readouterr().err
    assert (
        "edits.jsonl: line 1: time integration goes on from frame to frame" in reported
        and 'leave "analysis" out' in reported
    )


def test_the_constraint_status_of_quantities():
    most = Limit(most=2.0)
    assert constraint_status({"a": most}, {"a": 2.0, "b": 9.0}) == "holds"
    assert constraint_status({"a": most, "b": most}, {"a": 1.0, "b": 2.1}) == "fails"
    assert constraint_status({"a": most}, {"a": float("nan")}) == constraint_status({}, {"a": 1.0}) == ""
    (one,) = violated_constraints({"a": most, "b": most}, {"a": 1.0, "b": 2.1})
    assert (one.subjects, one.detail, one.value, one.bound) == (("b",), "max", 2.1, 2.0)
    least = Limit(least=1.0)
    assert [constraint_status({"a": least}, {"a": value}) for value in (1.0, float("inf"))] == ["holds"] * 2
    assert constraint_status({"a": least}, {"a": 0.999}) == "fails"


def test_a_limit_has_the_unit_of_its_quantity(files):
    assert load_scene(files / "plate.toml").quantities["strength"].max == 3.3e6
    with pytest.raises(UserError, match=r"quantities.strength.max.*(length|pressure)"):
        load_scene(files / "plate.toml", ['quantities.strength.max="3 mm"'])
