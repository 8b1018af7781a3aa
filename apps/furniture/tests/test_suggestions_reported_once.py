"""Suggestions of a piece that stays as it is are reported once, for all frames that they hold for."""

import json

from furniture_scenes import write_bench, write_edits
from restshape_apps.furniture.report.guided import searches

from restshape.cli.main import main

LET_GO = [
    {"do": "press", "on": "left", "parameter": "move z"},
    {"do": "drag", "by": -0.7, "frames": 7},
    {"do": "release"},
]
SAME = [{"do": "idle"}, {"do": "delete", "on": "nothing"}, {"do": "undo"}, {"do": "redo"}]


def test_idle_refused_and_undone_frames_report_nothing_again(tmp_path, capsys):
    words = ["replay", str(write_bench(tmp_path)), "--edits", str(write_edits(tmp_path, *LET_GO, *SAME))]
    assert main([*words, "--json", str(tmp_path / "run.json")]) == 0
    shown_text = json.loads((tmp_path / "run.json").read_text())["guidance"]["suggestions"]
    # Frame 12 is that of the undo, where the piece holds.
    assert [(one["frame"], one["frames"]) for one in shown_text] == [(9, [9, 10, 13])]
    printed = capsys.readouterr().out
    assert printed.count("suggestions in frame") == 1
    assert "suggestions in frame 9, line 4 (and in 10, 13): falls" in printed


def test_other_flaws_and_other_suggestions_are_distinguished():
    rows = [
        {"index": 0, "suggestions": "", "no_suggestions": "", "violated_constraints": ""},
        {"index": 1, "suggestions": "[1]", "no_suggestions": "", "violated_constraints": "falls"},
        {"index": 2, "suggestions": "[1]", "no_suggestions": "", "violated_constraints": "weak"},
        {"index": 3, "suggestions": "", "no_suggestions": "none", "violated_constraints": "falls"},
        {"index": 4, "suggestions": "[1]", "no_suggestions": "", "violated_constraints": "falls"},
    ]
    assert [[row["index"] for row in same] for same in searches(rows)] == [[1, 4], [2], [3]]
