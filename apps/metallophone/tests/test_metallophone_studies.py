"""Studies of the metallophone: table 4.4, the accuracy of models, their picture; no time is asserted."""

import json

import pytest
from restshape_studies.bench.job import Outcome
from restshape_studies.pictures.accuracy import draw_accuracy
from restshape_verification.metallophone import accuracy, thesis

from restshape.cli.main import main


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
def test_rows_of_table_44_have_the_thesis_counts(monkeypatch):
    """About those of the thesis's table, whether timed or not: the last digits of a size change some 4 % of a mesh."""
    rows = [row for length in thesis.BARS for row in thesis.bar_rows(length, timed=False)]
    assert [row["thesis"] for row in rows] == [2196, 3192, 4524] and all(row["rounding"] for row in rows)
    for row in rows:
        # Two layers of prisms, each of three tetrahedra.
        assert row["ours"] == pytest.approx(row["thesis"], rel=0.12) and row["ours"] % 6 == 0
    plan = thesis.PLAN
    monkeypatch.setattr(thesis, "PLAN", type(plan)(plan.policies, 1, 6, plan.overrides))
    counted, *speeds = thesis.bar_rows(100, timed=True)
    assert counted == rows[0] and [row["thesis"] for row in speeds] == [10.7, 10.7]
    assert all(row["ours"] > 0 and row["timing"] for row in speeds) and {row["table"] for row in rows} == {"4.4"}


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
def test_each_point_is_as_far_off_as_its_model(tmp_path, monkeypatch):
    """First-order tetrahedra far too high, plates and Kirchhoff's limit where plate theory has them."""
    first, plate = accuracy.FAMILIES[2], accuracy.FAMILIES[-1]
    families = (
        accuracy.Family(first.name, first.overrides, (8.0,)),
        accuracy.Family(plate.name, plate.overrides, (8.0,)),
    )
    monkeypatch.setattr(accuracy, "FAMILIES", families)
    monkeypatch.setattr(accuracy, "BARS", {100: accuracy.BARS[100]})
    (record,) = accuracy.study(5)
    stiff, good = record["points"]
    assert stiff["error"] > 0.4 and good["error"] < 0.01
    # By Euler and Bernoulli.
    assert record["kirchhoff"]["frequencies"][0] == pytest.approx(2093.56, rel=0.01)
    # A plate without shear misses about 3 % at the third bending mode.
    assert record["kirchhoff"]["errors"][4] == pytest.approx(0.03, abs=0.015)
    picture = tmp_path / "a.png"
    draw_accuracy([record], picture)
    assert picture.read_bytes().startswith(b"\x89PNG\r\n\x1a\n")


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
def test_command_writes_what_it_measured(tmp_path, monkeypatch, capsys):
    plate = accuracy.FAMILIES[-1]
    monkeypatch.setattr(accuracy, "FAMILIES", (accuracy.Family(plate.name, plate.overrides, (12.0, 8.0)),))
    monkeypatch.setattr(accuracy, "BARS", {200: accuracy.BARS[200]})
    out = tmp_path / "a.json"
    assert main(["bar-accuracy", "--frames", "5", "--json", str(out)]) == 0
    records = json.loads(out.read_text())
    assert [record["length"] for record in records] == [200] and len(records[0]["points"]) == 2
    assert "Kirchhoff's limit" in capsys.readouterr().out


def test_what_cannot_be_measured(monkeypatch, capsys):
    assert main(["bar-accuracy", "--frames", "1"]) == 2
    monkeypatch.setattr(accuracy, "study", lambda *words: accuracy.replayed(100, (), 5, lambda job: Outcome([], "end")))
    assert main(["bar-accuracy"]) == 2
    assert "bar end" in capsys.readouterr().err
