"""`solve.estimate`: which frames have estimates of errors, and what counts in those that have none."""

import csv
import json
from dataclasses import dataclass
from math import isnan

import pytest
from small_scenes import across, drag, make_replay, plate, rows_of, write_scene, write_script

from restshape.cli.main import main
from restshape.replay.constraints import HOLDS, UNCERTAIN
from restshape.replay.estimated_frames import estimated
from restshape.replay.step_errors import StepErrors
from restshape.replay.uncertain_limits import BY_EARLIER, BY_ERROR, BY_VALUES

EDITS = [{"do": "idle", "frames": 2}, *drag("window", (0.5, 0.5), across((0.5, 0.5), (1.2, 0.5), 12))]
LIMITED = plate(0.08) + 'held = { reaction = "x", at = "left" }\nsag = { displacement = "x", at = "c", max = 1 }\n'


@dataclass
class Edit:
    """What the rule sees of a frame."""

    index: int
    edit_ended: bool = False


def row(level=1, pc_rebuilt=0, newton=0):
    return {"level": level, "pc_rebuilt": pc_rebuilt, "newton": newton}


@pytest.mark.parametrize(
    ("edit", "made", "solves"),
    [
        (Edit(0), row(0), True),
        (Edit(5), row(1), False),
        (Edit(5), row(2), False),
        (Edit(5, edit_ended=True), row(0), True),
        (Edit(5), row(3), True),
        (Edit(5), row(2, pc_rebuilt=1), True),
        (Edit(5), row(1, newton=2), True),
    ],
)
def test_a_frame_of_a_drag_solves_for_errors_only_where_it_has_made_something_itself(edit, made, solves):
    assert estimated("auto", edit, made) == (True, solves)
    assert estimated("every", edit, made) == (True, True)
    assert estimated("none", edit, made) == (False, False)
    rests = edit.edit_ended or edit.index == 0
    assert estimated("idle", edit, made) == (rests, rests)
    assert estimated(2, edit, made) == ((edit.index % 2 == 0),) * 2


def replayed(folder, when):
    scene = write_scene(folder, LIMITED + f"[solve]\nestimate = {json.dumps(when)}\n")
    return rows_of(make_replay(scene, write_script(folder, EDITS)))


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The rows with estimates in all frames."""
    return replayed(tmp_path_factory.mktemp("whole"), "every")


@pytest.mark.parametrize("when", ["auto", "every", 3, "idle", "none"])
def test_answers_are_the_same_and_only_frames_asked_for_have_errors(tmp_path, whole, when):
    rows = replayed(tmp_path, when)
    kept = ("q_held", "q_sag", "residual", "iterations", "level", "constraint_status")
    assert [[one[key] for key in kept] for one in rows] == [[one[key] for key in kept] for one in whole]
    has = [one["index"] for one in rows if not isnan(one["estimate"])]
    every = [one["index"] for one in rows]
    ends = [0, 1, 2, 3, every[-1]]
    assert has == {"auto": every, "every": every, 3: every[::3], "idle": ends, "none": []}[when]
    errors = [one["index"] for one in rows if not isnan(one["sag_error"])]
    if when == "auto":
        assert set(ends) <= set(errors) < set(every)
        made = {one["index"] for one in rows if one["level"] == 3 or one["pc_rebuilt"]}
        assert set(errors) == made | set(ends)
    else:
        assert errors == has
    for one, other in zip(rows, whole):
        assert isnan(one["sag_error"]) or one["sag_error"] == pytest.approx(other["sag_error"], rel=0.05)


def test_errors_that_a_scene_asks_for_are_in_every_frame_by_itself(tmp_path):
    scene = write_scene(tmp_path, LIMITED.replace("max = 1", "error = true"))
    assert not any(isnan(one["sag_error"]) for one in rows_of(make_replay(scene, write_script(tmp_path, EDITS))))


def test_of_a_limit_the_last_known_error_counts(tmp_path, whole):
    error = whole[2]["sag_error"]
    limit = max(one["q_sag"] for one in whole) + error
    text = LIMITED.replace("max = 1", f"max = {limit!r}")
    found = {}
    for when in ("idle", "none"):
        scene = write_scene(tmp_path, text + f'[solve]\nestimate = "{when}"\njumps = false\n')
        found[when] = rows_of(make_replay(scene, write_script(tmp_path, EDITS)))
    known, seen = 0.0, set()
    for one in found["idle"]:
        known = known if isnan(one["sag_error"]) else one["sag_error"]
        status = UNCERTAIN if limit - one["q_sag"] < 2.0 * known else HOLDS
        assert one["constraint_status"] == status
        seen |= {(isnan(one["sag_error"]), status)}
        if status == UNCERTAIN:
            assert one["note"].endswith(BY_EARLIER if isnan(one["sag_error"]) else BY_ERROR)
    assert (True, UNCERTAIN) in seen and (True, HOLDS) in seen
    assert {one["constraint_status"] for one in found["none"]} == {HOLDS}
    said = {when: [one["index"] for one in rows if BY_VALUES in one["note"]] for when, rows in found.items()}
    assert said == {"idle": [], "none": [0]}


def test_a_frame_without_an_estimate_does_not_count_as_one_without_an_error():
    steps = StepErrors()
    steps.take({"estimate_time": 1e-3, "q_top": 2.0}, ["top"])
    known = steps.error("top")
    for _ in range(9):
        steps.take({"estimate_time": float("nan"), "q_top": 2.0}, ["top"], estimated=False)
    assert steps.error("top") == known > 0.0
    for _ in range(9):
        steps.take({"estimate_time": float("nan"), "q_top": 2.0}, ["top"])
    assert steps.error("top") == 0.0


def test_the_command_says_which_frames_and_its_file_has_empty_cells(tmp_path, capsys):
    scene, script = write_scene(tmp_path, LIMITED), write_script(tmp_path, EDITS)
    table = tmp_path / "rows.csv"
    command = ["replay", str(scene), str(script), "--estimate", "4", "--csv", str(table)]
    assert main(command) == 0
    with table.open() as file:
        rows = list(csv.DictReader(file))
    assert [bool(one["estimate"]) for one in rows] == [k % 4 == 0 for k in range(len(rows))]
    assert all(float(one["ms"]) >= float(one["ms_estimate"]) + float(one["ms_record"]) for one in rows)
    capsys.readouterr()
    assert main([*command[:4], "0"]) == 2
    assert "solve.estimate" in capsys.readouterr().err
