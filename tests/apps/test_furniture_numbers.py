"""Furniture's numbers: rows of the thesis's tables, suggestions that a grid finds, sessions of three strategies."""

import json

import pytest
from restshape_apps.furniture import sessions
from restshape_apps.furniture.misses import misses
from restshape_apps.furniture.pieces import cantilever, scales
from restshape_apps.furniture.thesis import rows
from restshape_apps.furniture.times import COLUMNS, timed


def test_planks_and_joints_are_those_of_the_thesis() -> None:
    found = rows(timed=False)
    assert not any(row["timing"] for row in found)
    for row in found:
        if row["quantity"] in ("planks", "joints"):
            assert row["ours"] == row["thesis"], row
    freedoms = [row["ours"] for row in found if row["quantity"] == "design freedoms"]
    tried = [row["ours"] for row in found if row["quantity"] == "combinations of at most 3"]
    assert len(freedoms) == len(COLUMNS)
    for n, count in zip(freedoms, tried):
        assert n <= count <= n + n * (n - 1) // 2 + n * (n - 1) * (n - 2) // 6


def test_the_threshold_of_the_nails() -> None:
    bears = {row["row"].split(", ")[1]: row["ours"] for row in rows(timed=False) if row["unit"] == "N m"}
    assert bears["nail-thesis"] == pytest.approx(0.02 * 35e3 * 0.006 * 3, rel=1e-6)
    assert bears["nail-experiment"] == pytest.approx(1.86, rel=0.01)


def test_directions_that_are_looked_for_again_find_what_the_first_ones_miss() -> None:
    # Four pairs lengthen or raise one board and widen the other: force goes with one over its width.
    first, again = misses(scales(), points=13, mended=0), misses(scales(), points=13)
    assert (first.pairs, first.pairs_missed) == (again.pairs, 4)
    assert again.pairs == 8
    assert again.missed == 0


def test_a_grid_finds_what_a_hand_would_edit() -> None:
    # Shorten the arm, lengthen it from the other end, widen it: nothing else takes moment off its joint.
    found = misses(cantilever(kilograms=1.8), points=13)
    assert (found.single, found.single_missed, found.rate) == (3, 0, 0.0)


def test_suggestions_need_the_fewest_edits(tmp_path, capsys) -> None:
    path = tmp_path / "sessions.json"
    assert sessions.main(["--json", str(path)]) == 0
    found = json.loads(path.read_text())
    assert "suggestions" in capsys.readouterr().out
    targets = {row["target"] for row in found}
    assert len(targets) == 4
    for target in targets:
        edits = {row["strategy"]: row for row in found if row["target"] == target}
        assert edits["suggestions"]["valid"] == 1.0
        assert edits["suggestions"]["edits"] < min(edits[other]["edits"] for other in ("no feedback", "ranges"))


def test_times_are_positive() -> None:
    spent = timed(lambda: sum(range(1000)), 3)
    assert 0.0 < spent.own < 100.0
    assert spent.wall > 0.0
