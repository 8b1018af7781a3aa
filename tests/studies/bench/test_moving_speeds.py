"""Rows of table 4.3 of cases whose mesh moves in each frame."""

from types import SimpleNamespace

import pytest
from restshape_studies.bench import moving_speeds
from restshape_studies.bench.moving_speeds import Known, moving_rows
from restshape_studies.bench.turns import Case

MS = {"auto": 4.0, "thesis": 8.0, "refactor": 10.0, "rebuild": 20.0}


@pytest.fixture
def case(monkeypatch, tmp_path):
    first = SimpleNamespace(row={"elements": 1974})
    monkeypatch.setattr(moving_speeds, "first_frame", lambda scene: first)

    def compare(case, plan, announce):
        assert plan.frames == 150
        return {name: {"moves": {"p50": ms}} for name, ms in MS.items()}

    monkeypatch.setattr(moving_speeds, "compare", compare)
    return Case("one", tmp_path, tmp_path)


def test_speeds_are_those_of_frames_that_move_the_mesh(case):
    rows = moving_rows(case, Known("flow", 1971, 30.0, 18.2), 150)
    assert [(row["thesis"], row["ours"]) for row in rows] == [
        (1971, 1974),
        *((30.0, 250.0), (30.0, 125.0), ("", 100.0), (18.2, 50.0)),
        *((1.65, 5.0), ("", 2.5)),
    ]
    assert {row["row"] for row in rows} == {"flow"} and [row["timing"] for row in rows] == [False] + 6 * [True]


def test_without_a_clock_there_are_counts_alone(case):
    assert [row["quantity"] for row in moving_rows(case, Known("flow", 1971, 30.0, 18.2), 150, timed=False)] == [
        "triangles"
    ]
