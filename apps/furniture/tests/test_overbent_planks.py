"""A piece whose joints hold, but with a plank that bends beyond its strength, does not plainly hold."""

import json
from math import ceil

import pytest
from furniture_scenes import write_edits
from restshape_apps.furniture.physics.fasteners import wood
from restshape_apps.furniture.physics.plank_phrases import phrases
from restshape_apps.furniture.report.guided import doubt_causes
from small_scenes import make_replay, rows_of

from restshape.cli.main import main
from restshape.findings import Finding, encode_findings

G = 9.80665


def scene(folder, thick, more="[effects.bending]\n"):
    """A bench of oak with a seat of a thickness [m] on legs 1 m apart, and 100 kg in its middle."""
    seat = 0.444 + thick / 2
    text = f"""
format = "restshape-scene"
version = 1
app = "furniture"
[wood]
name = "oak"
thickness = "30 mm"
[fastener]
name = "dowel"
spacing = "40 mm"
[planks.seat]
from = [-0.6, 0, {seat}]
to = [0.6, 0, {seat}]
width = [0, 0.3, 0]
thickness = {thick}
[planks.left]
from = [-0.5, 0, 0]
to = [-0.5, 0, 0.444]
width = [0, 0.3, 0]
[planks.right]
from = [0.5, 0, 0]
to = [0.5, 0, 0.444]
width = [0, 0.3, 0]
[weights.dad]
on = "seat"
mass = "100 kg"
[effects.gravity]
{more}"""
    path = folder / f"bench-{1e3 * thick:g}.toml"
    path.write_text(text)
    return path


def use(thick):
    """The utilisation of the seat's bending strength as of a beam on two supports with overhangs."""
    oak = wood("oak")
    own = oak.density * 0.3 * thick * G
    return (100 * G / 4 + own * (1.0 / 8 - 0.1**2 / 2)) / (0.3 * thick**2 / 6) / oak.bending


@pytest.mark.slow
def test_a_seat_that_must_break_makes_a_bench_uncertain(tmp_path, capsys):
    words = f"not counted: plank seat at {ceil(100 * use(0.006)) / 100:.2f} of its bending strength"
    path = scene(tmp_path, 0.006)
    row = rows_of(make_replay(path, write_edits(tmp_path), "auto"))[-1]
    assert row["bending_utilisation"] == pytest.approx(use(0.006), rel=2e-3)
    assert (row["constraint_status"], row["flaws"], row["violated_constraints"]) == ("uncertain", 0, words)
    assert main(["check", str(path)]) == 0 and f"holds, but {words}" in capsys.readouterr().out
    # What is suggested leaves no plank overbent: moment and strength are in proportion to the way between the legs.
    suggested = json.loads(row["suggestions"])
    assert suggested and not any("doubt" in one for one in suggested)
    assert 1.0 - 2.0 * suggested[0]["range"][0] < 1.0 / use(0.006) * 1.05


@pytest.mark.parametrize(("thick", "more"), [(0.014, "[effects.bending]\n"), (0.006, "")])
def test_a_thicker_seat_and_one_whose_bending_is_not_asked_for_hold(tmp_path, thick, more):
    assert use(0.014) < 1.0
    row = rows_of(make_replay(scene(tmp_path, thick, more), write_edits(tmp_path), "auto"))[-1]
    assert (row["constraint_status"], row["violated_constraints"]) == ("holds", "")


def test_overbent_planks_are_named_with_the_worst_case():
    findings = (
        Finding("overbent", "", ("seat",), 4.561, 1.0, case="weights"),
        Finding("overbent", "", ("rail",), 1.2, 1.0, case="push shove"),
    )
    assert phrases(findings) == (
        "not counted: plank seat at 4.57 of its bending strength, "
        "rail at 1.20 of its bending strength under push shove",
    )
    row = {"constraint_status": "uncertain", "flaws": 0, "findings": encode_findings(findings)}
    assert doubt_causes([row]) == "a plank bends beyond its strength"
