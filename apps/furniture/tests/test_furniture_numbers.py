"""Furniture's numbers: rows of the thesis's tables, suggestions that a grid finds, sessions of three strategies."""

import json
from math import comb

import numpy as np
import pytest
from restshape_apps.furniture.guidance.force_space import durability_space
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.pieces import cantilever, scales
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_verification.furniture.misses import FIRST_ONLY, SMALL, UNLIMITED, Grid
from restshape_verification.furniture.thesis import rows
from restshape_verification.furniture.times import COLUMNS, large, timed

from restshape.cli.main import main


@pytest.fixture(scope="module")
def untimed() -> list[dict]:
    """The rows that no clock decides."""
    return rows(timed=False)


@pytest.mark.slow
def test_planks_and_joints_are_those_of_the_thesis(untimed) -> None:
    found = untimed
    assert not any(row["timing"] for row in found)
    for row in found:
        if row["quantity"] in ("planks", "joints"):
            assert row["ours"] == row["thesis"], row
    freedoms = [row["ours"] for row in found if row["quantity"] == "design freedoms"]
    tried = [row["ours"] for row in found if row["quantity"] == "combinations of at most 3"]
    assert len(freedoms) == len(COLUMNS) + 1
    for n, count in zip(freedoms, tried):
        # A piece that falls is searched in two force spaces.
        assert n <= count <= 2 * (n + n * (n - 1) // 2 + n * (n - 1) * (n - 2) // 6)


@pytest.mark.slow
def test_the_threshold_of_the_nails(untimed) -> None:
    bears = {row["row"].split(", ")[1]: row["ours"] for row in untimed if row["unit"] == "N m"}
    assert bears["nail-thesis"] == pytest.approx(0.02 * 35e3 * 0.006 * 3, rel=1e-6)
    assert bears["nail-experiment"] == pytest.approx(1.86, rel=0.01)


@pytest.mark.slow
def test_the_piece_of_224_freedoms_tries_all_triples_that_change_forces(untimed) -> None:
    found = {row["quantity"]: row["ours"] for row in untimed if row["row"] == "a bookshelf of 51 planks"}
    assert found["design freedoms"] == 224
    furniture = Furniture(large())
    furniture.test()
    modes = DesignModes.of(furniture.piece, furniture.kernel.freedoms())
    still = int((np.abs(durability_space(furniture, modes).K).max(axis=1) < 1e-6).sum())
    moving = 224 - still
    # What holds one that changes nothing is left at once, but where it comes last.
    least, most = (comb(n, 3) + comb(n, 2) + n for n in (moving, 224))
    assert least <= found["combinations of at most 3"] <= most
    assert least > 600_000
    assert found["continuous suggestions"] >= 3


@pytest.mark.slow
def test_directions_that_are_looked_for_again_find_what_the_first_ones_miss() -> None:
    # Four pairs lengthen or raise one board and widen the other: force goes with one over its width.
    grid = Grid.of(scales(), (21, 13))
    first, again = grid.beside(FIRST_ONLY), grid.beside(UNLIMITED)
    assert first.there == again.there == (0, 8)
    assert (first.missed, again.missed) == ((0, 4), (0, 0))


def test_a_grid_finds_what_a_hand_would_edit() -> None:
    # Shorten the arm, lengthen it from the other end, widen it: nothing else takes moment off its joint.
    found = Grid.of(cantilever(kilograms=1.8), (21, 13, 5)).as_shown()
    assert (found.there, found.missed, found.rate) == ((3, 0, 0), (0, 0, 0), 0.0)


@pytest.mark.slow
def test_a_grid_of_triples_finds_what_suggestions_miss() -> None:
    grid = Grid.of(SMALL["long cantilever"](), (21, 13, 9))
    assert grid.ways[2] == {(0, 4, 13)}
    for found in (grid.as_shown(), grid.beside(UNLIMITED)):
        assert (found.missed, found.rate) == ((0, 0, 1), 0.25)


@pytest.mark.slow
def test_suggestions_need_the_fewest_edits(tmp_path, capsys) -> None:
    path = tmp_path / "sessions.json"
    assert main(["design-sessions", "--json", str(path)]) == 0
    found = json.loads(path.read_text())
    assert "suggestions" in capsys.readouterr().out
    targets = {row["target"] for row in found}
    assert len(targets) == 4
    for target in targets:
        edits = {row["strategy"]: row for row in found if row["target"] == target}
        assert edits["suggestions"]["valid"] == 1.0
        assert edits["suggestions"]["edits"] < min(edits[other]["edits"] for other in ("no feedback", "ranges"))


def test_times_are_positive() -> None:
    # Longer than the processor's clock may take from one value to the next.
    spent = timed(lambda: sum(range(500_000)), 3)
    assert 0.0 < spent.own < 100.0
    assert spent.wall > 0.0
