"""What accuracy costs in furniture: measures of ranges by hand, a study whose numbers statics knows, its page."""

import json

import numpy as np
import pytest
from furniture_scenes import write_bench, write_edits
from restshape_apps.furniture.pieces import cantilever, table
from restshape_studies.accuracy.study import Case
from restshape_verification.furniture import plank_study as planks
from restshape_verification.furniture.plank_study import study_planks, unseen, wrong

from restshape.cli.main import main

NONE = np.zeros((0, 2))
ENDS = (1e-2, 1e-5, 1e-8)
"""Tolerances of ends that the study is made with here."""


BEYOND = (
    {"do": "press", "on": "left", "parameter": "move z"},
    {"do": "drag", "by": -0.7},
    {"do": "release"},
)
"""A leg goes beyond the middle: the bench tips, and asks for suggestions."""


def spans(*pairs):
    """Intervals (k, 2)."""
    return np.array(pairs, dtype=float).reshape(-1, 2)


@pytest.mark.parametrize(
    ("found", "truth", "length", "missed"),
    [
        (spans((-1, 1)), spans((-1, 1)), 0.0, 0),
        (spans((-1, 0.75)), spans((-1, 1)), 0.25, 0),
        (spans((-1, 1)), spans((-1, 0), (0.5, 1)), 0.5, 0),
        (spans((-1, 0)), spans((-1, 0), (0.5, 1)), 0.5, 1),
        (NONE, spans((0, 0.25), (0.5, 1)), 0.75, 2),
        (spans((2, 3)), NONE, 1.0, 0),
    ],
)
def test_wrong_answers_are_where_intervals_differ(found, truth, length, missed):
    assert wrong(found, truth) == pytest.approx(length)
    assert unseen(found, truth) == missed


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    patch = pytest.MonkeyPatch()
    for name, value in (("DENSE", 1537), ("WAYS", 8), ("TOLERANCES", ENDS)):
        patch.setattr(planks, name, value)
    found = study_planks(Case("bench", write_bench(folder), write_edits(folder, *BEYOND)))
    patch.undo()
    return found


@pytest.mark.slow
def test_ends_are_as_exact_as_they_are_asked_to_be(study):
    assert [row["tolerance"] for row in study.ends] == list(ENDS)
    for row in study.ends:
        assert 0.0 < row["worst"] <= row["tolerance"] * 1.001
    assert study.ends[-1]["worst"] < 1e-4 * study.ends[0]["worst"]


def test_more_samples_find_no_less(study):
    for hints in (True, False):
        rows = [row for row in study.ranges if row["hints"] is hints]
        assert [row["samples"] for row in rows] == list(planks.SAMPLED)
        assert rows[0]["worst"] >= rows[-1]["worst"] and rows[0]["missed"] >= rows[-1]["missed"] == 0
        assert rows[-1]["worst"] < 1e-5 and rows[0]["ms"] < rows[-1]["ms"]


def test_a_search_of_all_finds_most(study):
    usual, *efforts = study.searches
    assert efforts[-1]["found"] == efforts[-1]["all"] >= max(row["found"] for row in study.searches) > 0
    assert usual["all"] == efforts[0]["all"] and efforts[0]["tested"] <= efforts[-1]["tested"]


def test_forces_are_those_of_the_least_tolerance_or_near(study):
    rows = {row["tolerance"]: row for row in study.newton}
    assert rows[1e-11]["error"] == 0.0 and rows[1e-8]["error"] < 1e-8
    assert rows[1e-1]["steps"] <= rows[1e-11]["steps"]


def test_the_ratio_of_springs_counts_in_loops_alone(study):
    # A table is redundant; of a cantilever's joint, and of upright legs, statics alone shows.
    rows = planks.proportioned(table())
    assert max(row["worst"] for row in rows) > 0.1
    assert next(row for row in rows if row["ratio"] == 1.0)["worst"] == 0.0
    assert max(row["worst"] for row in (*planks.proportioned(cantilever()), *study.ratios)) < 1e-6


@pytest.mark.slow
def test_the_command_writes_a_page_and_takes_nothing_about_meshes(tmp_path, capsys, monkeypatch):
    few = {"DENSE": 769, "WAYS": 3, "SAMPLED": (24, 96), "TOLERANCES": (1e-2, 1e-6), "EFFORTS": (1, 64)}
    for name, value in few.items():
        monkeypatch.setattr(planks, name, value)
    scene, edits = write_bench(tmp_path), write_edits(tmp_path, *BEYOND)
    out = tmp_path / "found"
    words = ["accuracy", str(scene), "--edits", str(edits), "--out", str(out)]
    assert main([*words, "--json", str(tmp_path / "a.json")]) == 0
    page = (out / "bench.md").read_text()
    assert "![errors against time" in page and (out / "bench.png").stat().st_size > 10_000
    records = json.loads((tmp_path / "a.json").read_text())
    assert {row["varied"] for row in records} == {"ranges", "ends", "searches", "newton", "ratios"}
    capsys.readouterr()
    assert main([*words, "--sizes", "2,1"]) == 2
    assert "has no mesh" in capsys.readouterr().err
