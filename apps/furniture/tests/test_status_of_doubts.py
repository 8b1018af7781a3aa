"""A piece that holds with something left to mend: every command says the same of it."""

import json
from pathlib import Path

import pytest
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.report.guided import doubt_causes, runs, said
from restshape_apps.furniture.report.piece_frames import caption, meaning
from restshape_apps.furniture.report.status_colour import BEYOND, DOUBT
from restshape_apps.furniture.shape.plank_scene import piece_of
from restshape_apps.furniture.tests.furniture_scenes import BENCH, rail, write_bench
from small_scenes import make_replay

from restshape.cli.main import main
from restshape.replay.recording.recording import Recording
from restshape.report.tables import row_of
from restshape.scene.load import load_scene

SHORT = rail(-0.49, 0.466)
"""A rail of the bench that ends 24 mm before its right leg, without which the bench holds."""
FREE = "holds, but free end: rail +x is 24 mm from right"


@pytest.fixture
def scene(tmp_path) -> Path:
    return write_bench(tmp_path, BENCH + SHORT + "[effects.guidance]\n")


@pytest.mark.slow
def test_a_free_end_makes_a_piece_that_holds_uncertain_in_all_outputs(scene, tmp_path, capsys) -> None:
    recorded, checked = tmp_path / "bench.vtkhdf", tmp_path / "check.json"
    assert main(["check", str(scene), "--json", str(checked)]) == 0
    assert f"constraint status  {FREE}" in capsys.readouterr().out
    found = json.loads(checked.read_text())
    assert found["valid"] and found["doubts"] == [FREE.removeprefix("holds, but ")]
    assert main(["replay", str(scene), "--out", str(recorded)]) == 0
    assert FREE in capsys.readouterr().out
    recording = Recording(recorded)
    row = row_of(recording, 0)
    assert row["constraint_status"] == "uncertain" and said(row) == FREE
    words, colour = caption(recording, 0)
    assert FREE in " ".join(words.split("\n")) and colour == DOUBT
    assert "free" in doubt_causes([row])


def test_a_range_is_doubtful_where_an_end_is_free(scene) -> None:
    # An end that is more than 250 mm from a face has not missed it.
    design = Design.closed(piece_of(load_scene(scene)), Guidance())
    lengthened = design.parameter(design.piece.index("rail"), 6)
    (doubtful,) = lengthened.doubtful
    assert lengthened.ranges.intervals[0, 0] < -0.25
    assert doubtful == pytest.approx((0.024 - 0.25, lengthened.ranges.intervals[0, 1]), abs=1e-3)


def test_a_violated_limit_alone_is_said_in_the_words_of_the_report(tmp_path) -> None:
    limit = '[quantities]\nlong = { length = "x", at = "top", max = "1.1 m" }\n'
    rows = list(make_replay(write_bench(tmp_path, BENCH + limit)).frames())
    assert rows[0]["constraint_status"] == "fails"
    (span,) = runs(rows)
    assert span[2] == said(rows[0]) == "holds, but long is 1.2 m, at most 1.1 m"


def test_a_free_end_of_a_piece_that_breaks_is_no_finding(scene) -> None:
    scene.write_text(f'{scene.read_text()}[effects.push]\n[pushes.shove]\non = "top"\nforce = [5000, 0, 0]\n')
    (row,) = make_replay(scene).frames()
    assert row["constraint_status"] == "fails" and "free end" not in row["violated_constraints"]


@pytest.mark.slow
def test_a_heading_begins_with_the_limit_and_its_legend_names_the_doubt(tmp_path) -> None:
    # The rail ends before the leg, and the top is longer than it may be.
    limit = '[effects.guidance]\n[quantities]\nlong = { length = "x", at = "top", max = "1.1 m" }\n'
    recorded = tmp_path / "bench.vtkhdf"
    assert main(["replay", str(write_bench(tmp_path, BENCH + SHORT + limit)), "--out", str(recorded)]) == 0
    recording = Recording(recorded)
    words, colour = caption(recording, 0)
    said_first = "holds, but long is 1.2 m, at most 1.1 m; free end: rail +x is 24 mm from right"
    assert said_first in " ".join(words.split("\n")) and colour == BEYOND
    legend = meaning(recording, [0], ranges=False, numbers=False)
    assert "Purple heading" in legend and "an end is free" in legend and "joined by a dash" not in legend
    assert "joined by a dash" in meaning(recording, [0], ranges=False, numbers=True)
