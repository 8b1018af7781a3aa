"""What replays of furniture report of guidance: programs in JSON, people on the terminal."""

import csv
import json

import numpy as np
import pytest
from furniture_scenes import BENCH, write_bench, write_edits
from restshape_apps.furniture.cli.guidance import print_guidance
from restshape_apps.furniture.guidance.valid_ranges import Grabbed, ValidRange, decode_ranges, encode_ranges
from restshape_apps.furniture.physics.plank_findings import APART, FALLS, LOST, NEAREST, PART, PULL, WEAK, WEIGHTS
from restshape_apps.furniture.physics.plank_phrases import phrases
from restshape_apps.furniture.report.guided import runs

from restshape.cli.main import main
from restshape.findings import Finding, encode_findings
from restshape.replay.constraints import LIMIT, MAX, Limit, formatted_constraint, joined, violated_constraints

EVENTS = [
    {"do": "press", "on": "left", "parameter": "move z"},
    {"do": "drag", "by": -0.7, "frames": 7},
    {"do": "release"},
    {"do": "undo"},
    {"do": "rotate", "on": "right", "by": "4 deg", "about": "y", "frames": 2},
    {"do": "press", "on": "left", "parameter": "move z"},
    {"do": "drag", "by": -0.7, "frames": 1},
    {"do": "release"},
]


USES = ((1.2, 3.5e-3), (1.81, 1.1), (1.05, 0.04))
"""Of three frames in a row: use of a joint, and deflection of a plank."""


@pytest.fixture(scope="module")
def reported(tmp_path_factory):
    """What JSON and CSV of a replay hold: the leg goes too far twice, each time it is let go."""
    folder = tmp_path_factory.mktemp("reported")
    words = ["replay", str(write_bench(folder)), "--edits", str(write_edits(folder, *EVENTS))]
    assert main([*words, "--json", str(folder / "run.json"), "--csv", str(folder / "run.csv")]) == 0
    with (folder / "run.csv").open(newline="") as file:
        return json.loads((folder / "run.json").read_text()), list(csv.DictReader(file))


def test_json_has_the_guidance_of_each_frame(reported):
    found, rows = reported
    frames = found["guidance"]["frames"]
    assert len(frames) == found["frames"] == len(rows) == 16
    # The box tips over the leg's outer side: the leg has moved by 0.5 m and a little more.
    grabbed = frames[2:9]
    assert [frame["constraint_status"] for frame in grabbed] == ["holds"] * 5 + ["fails"] * 2
    assert [frame["inside"] for frame in grabbed] == [True] * 5 + [False] * 2
    assert [frame["at"] for frame in grabbed] == pytest.approx([-0.1 * k for k in range(1, 8)])
    for frame, row in zip(grabbed, rows[2:9]):
        assert (frame["parameter"], frame["unit"]) == ("left: move z", "m")
        ((low, high),) = frame["ranges"]
        assert -0.6 < low < -0.5 < 0.0 < high and low == pytest.approx(float(row["range_low"]), abs=1e-6)
        assert frame["utilisation"] == pytest.approx(float(row["utilisation"])) and frame[
            "stability_margin"
        ] == pytest.approx(float(row["stability_margin"]))
    idle = frames[9]
    assert idle["parameter"] == "" and idle["at"] is idle["ranges"] is idle["inside"] is idle["unit"] is None
    assert [frame["unit"] for frame in frames[11:13]] == ["rad"] * 2


def test_json_has_every_search_for_suggestions(reported):
    found, rows = reported
    searches = found["guidance"]["suggestions"]
    assert [search["frame"] for search in searches] == [9, 15]
    for search in searches:
        row = rows[search["frame"]]
        assert search["found"] == json.loads(row["suggestions"]) and len(search["found"]) == int(row["suggested"]) > 0
        assert (
            search["violated_constraints"].startswith("falls")
            and search["tried"] == int(row["tried"]) > 0
            and search["ms"] > 0.0
        )


def test_the_terminal_shows_constraint_status_and_all_suggestions(tmp_path, capsys):
    assert main(["replay", str(write_bench(tmp_path)), "--edits", str(write_edits(tmp_path, *EVENTS))]) == 0
    lines = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    assert "0 0 to 6 holds" in lines and "3 7 to 9 falls under its weights" in lines
    assert "left: move z" in next(line for line in lines if line.startswith("3 left"))
    # In millimetres and degrees.
    assert any(line.endswith("mm 7 5") for line in lines) and any("deg 2 2" in line for line in lines)
    assert sum(line.startswith("suggestions in frame") for line in lines) == 2


def test_json_of_what_is_no_furniture_has_no_guidance(tmp_path):
    from small_scenes import plate, write_scene

    assert main(["replay", str(write_scene(tmp_path, plate(0.3))), "--json", str(tmp_path / "run.json")]) == 0
    assert "guidance" not in json.loads((tmp_path / "run.json").read_text())


def failing(*frames):
    """Rows of frames that fail by these findings."""
    return [
        {
            "index": k,
            "constraint_status": "fails",
            "violated_constraints": "; ".join(phrases(found)),
            "findings": encode_findings(found),
        }
        for k, found in enumerate(frames)
    ]


def grouped(*frames):
    """What is said of each run of frames."""
    return [words for _, _, words in runs(failing(*frames))]


def test_valid_ranges_are_read_as_they_were_written():
    ranges = (ValidRange(-0.2, 0.03, False, False), ValidRange(0.1, 0.55, False, True))
    for known in (ranges, (), None):
        assert decode_ranges(encode_ranges(Grabbed("left: move", "m", known))) == Grabbed("left: move", "m", known)
    assert decode_ranges("") is None
    # What does not fit is left out.
    many = Grabbed("left: " * 40, "m", tuple(ValidRange(k, k + 0.5, False, False) for k in range(40)))
    text = encode_ranges(many, 200)
    assert len(text) <= 200 and 0 < len(decode_ranges(text).ranges) < 40


def test_runs():
    rows = [
        {"index": k, "constraint_status": result, "violated_constraints": why}
        for k, (result, why) in enumerate(
            [("holds", ""), ("", ""), ("holds", ""), ("fails", "falls"), ("fails", "falls"), ("holds", "")]
        )
    ]
    assert [(a["index"], b["index"], words) for a, b, words in runs(rows)] == [
        (0, 2, "holds"),
        (3, 4, "falls"),
        (5, 5, "holds"),
    ]


def test_a_piece_and_a_limit_fail_together():
    leg = Finding(LIMIT, MAX, ("leg",), 2.0, 1.0)
    limit = {"constraint_status": "fails", "violated_constraints": "leg", "note": "", "findings": (leg,)}
    piece = {"constraint_status": "holds", "violated_constraints": "", "note": "left out", "utilisation": 0.5}
    assert joined(limit, piece) == {
        "constraint_status": "fails",
        "violated_constraints": "leg",
        "note": "left out",
        "utilisation": 0.5,
        "findings": (leg,),
    }
    piece |= {"constraint_status": "fails", "violated_constraints": "falls", "findings": (Finding(FALLS),)}
    both = joined(limit, piece)
    assert both["violated_constraints"] == "falls; leg" and both["findings"] == (Finding(FALLS), leg)
    empty = {"constraint_status": "", "violated_constraints": "", "note": "", "findings": ()}
    assert joined(empty, piece)["constraint_status"] == "fails"
    assert np.isnan(joined(limit, {"deflection": np.nan})["deflection"])


def test_grouped_frames_have_the_worst_of_their_amounts():
    frames = [
        [
            Finding(WEAK, PULL, ("a", "b"), utilisation, 1.0, case=WEIGHTS),
            Finding(LIMIT, MAX, ("sag",), deflection, 3e-3, "m"),
        ]
        for utilisation, deflection in USES
    ]
    rows = failing(*frames)
    ((first, last, words),) = runs(rows)
    assert (first["index"], last["index"]) == (0, 2)
    assert words == "weak: joint a on b at up to 1.81 of its strength; sag is up to 1.1 m, at most 3 mm"
    assert runs(rows[:1] * 2)[0][2] == rows[0]["violated_constraints"]


def test_rows_without_findings_are_grouped_by_their_text():
    rows = [{name: row[name] for name in row if name != "findings"} for row in failing(*[[Finding(FALLS)]] * 2)]
    rows.append({"index": 2, "constraint_status": "fails", "violated_constraints": "planks overlap"})
    assert [words for _, _, words in runs(rows)] == ["falls", "planks overlap"]


def test_a_violated_limit_has_value_limit_and_unit():
    limits = {"sag": Limit(most=3e-3, unit="m"), "hold": Limit(least=0.14)}

    def formatted(**values):
        return [formatted_constraint(one) for one in violated_constraints(limits, values)]

    assert formatted(sag=3.2e-3, hold=0.1) == ["sag is 3.2 mm, at most 3 mm", "hold is 0.1, at least 0.14"]
    assert formatted(sag=3.0000004e-3, hold=0.2) == ["sag is 3.0000004 mm, at most 3 mm"]


def test_furniture_is_not_predicted_and_says_why(tmp_path, capsys):
    edits = write_edits(tmp_path, *EVENTS)
    assert main(["replay", str(write_bench(tmp_path)), "--edits", str(edits), "--predict", "linear"]) == 2
    assert "furniture is not predicted" in capsys.readouterr().err


def test_the_terminal_says_that_ranges_look_at_no_limit(tmp_path, capsys):
    note = "limits of quantities count in the constraint status and in suggestions, not in valid ranges"
    text = BENCH + '[quantities]\nlong = { length = "x", at = "top", limit = "90 cm" }\n'
    for scene, reported in ((write_bench(tmp_path, text, "limited.toml"), True), (write_bench(tmp_path), False)):
        assert main(["replay", str(scene)]) == 0
        assert (note in capsys.readouterr().out) is reported


LOOSE = """
[planks.shelf]
from = [0.25, 0, 0.2]
to = [0.45, 0, 0.2]
width = [0, 0.1, 0]
"""


def test_a_piece_in_parts_reports_its_gap_as_the_hand_goes_and_no_combinations(tmp_path, capsys):
    drag = [{"do": "press", "on": "shelf"}, {"do": "drag", "path": [[0.33, 0, 0.2], [0.31, 0, 0.2]]}, {"do": "release"}]
    words = ["replay", str(write_bench(tmp_path, BENCH + LOOSE)), "--edits", str(write_edits(tmp_path, *drag))]
    assert main([*words, "--csv", str(tmp_path / "run.csv")]) == 0
    with (tmp_path / "run.csv").open(newline="") as file:
        violated = [row["violated_constraints"] for row in csv.DictReader(file)]
    # The face of the right leg is at x = 0.49; the shelf ends at 0.45, then 0.43 and 0.41.
    for far, said in zip((40, 40, 60, 80, 80), violated, strict=True):
        gap = f"shelf +x is {far} mm from right, beyond the reach of 15 mm of joints"
        assert said.startswith(f"in two parts: top with 2 more, shelf ({gap}); falls under its weights: shelf")
    out = " ".join(capsys.readouterr().out.split())
    assert "suggestions in frame 0" in out and "combinations tried" not in out
    assert "0 to 4 in two parts: top with 2 more, shelf (shelf +x is up to 80 mm from right, beyond the reach" in out


def test_grouped_frames_have_the_largest_of_their_distances():
    parts = [Finding(APART, PART, (name,), 1) for name in "ab"]
    falls = Finding(FALLS, PART, ("b",), 1, case=WEIGHTS)

    def gap(*mm):
        nearest = [Finding(APART, NEAREST, ("b", "-x", "a"), 1e-3 * far, 0.015, "m") for far in mm]
        return [*parts, *nearest, falls]

    text = "in two parts: a, b (b -x is {} mm from a, beyond the reach of 15 mm of joints); falls under its weights: b"
    assert grouped(gap(20), gap(100), gap(30)) == [text.format("up to 100")]
    assert grouped(gap(), gap(20)) == [text.format(20)]
    assert grouped(gap(), gap()) == ["in two parts: a, b; falls under its weights: b"]

    def lost(mm, *names):
        return [Finding(LOST, "missed", names or ("arm", "post"), 1e-3 * mm, 0.015, "m")]

    other = lost(1, "leg", "top")
    text = "lost: arm misses post, {} mm from it, leg misses top"
    assert grouped(lost(20) + other, lost(19.5) + other) == [text.format("up to 20")]
    assert grouped(lost(20) + other, lost(9.5) + other) == ["lost: arm misses post, leg misses top"]
    assert grouped(lost(1), other) == ["lost: arm misses post", "lost: leg misses top"]


def test_tables_show_rounding_as_nothing(capsys):
    """Against the largest end of the ranges of a parameter, and against the utilisation at which a joint breaks."""
    hand = Grabbed("left: move", "m", (ValidRange(1.4e-20, 0.2, False, False),), ((-3e-17, 0.1),))
    uses = json.dumps([["left on seat", 1.4e-20, 0.3], ["right on seat", 1e-6, 0.2]])
    row = {"index": 0, "line": 2, "parameter": "left: move", "valid_ranges": encode_ranges(hand), "inside": 1}
    print_guidance([{**row, "redundant": uses, "constraint_status": "holds", "no_suggestions": ""}])
    shown = capsys.readouterr().out
    assert "e-20" not in shown and "e-17" not in shown
    assert "+0 to +200 mm; doubtful from +0 to +100 mm" in shown and "1e-06" in shown
