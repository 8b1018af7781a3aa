"""A drag with a reach beside one without: both are measured, and what measures nothing is refused."""

from argparse import Namespace

import pytest
from jobs_here import Here
from restshape_studies.bench.job import run
from restshape_studies.bench.reach import PART, WHOLE, reach_of, study
from restshape_studies.commands.bench_reach import check, show
from small_scenes import plate, write_scene

from restshape.errors import UserError


def test_a_share_of_the_plate_lies_within_its_reach():
    assert reach_of(0.05) == pytest.approx(0.0933, abs=1e-4)
    assert reach_of(0.1) > reach_of(0.05) > 0.0


def test_both_are_measured_and_shown(tmp_path, capsys):
    text = plate(0.1).replace("[0.5, 0.5]", "[0.4, 0.5]").replace("radius = 0.15", "radius = 0.12")
    found = study(write_scene(tmp_path, text), 2000, 0.05, 4, 1, tmp_path, play=lambda job: run(job, start=Here))
    whole, part = (found["records"][key] for key in (WHOLE, PART))
    assert whole["unknowns"] == part["unknowns"] and whole["frames"] == part["frames"] == 3
    assert found["ratios"]["p50_ms"] == pytest.approx(whole["p50_ms"] / part["p50_ms"])
    show(Namespace(policy="auto"), "plate", found)
    printed = capsys.readouterr().out
    assert f"{found['ratios']['p50_ms']:.2f} times as fast" in printed and "reach 93.3 mm" in printed


@pytest.mark.parametrize("wrong", [{"frames": 1}, {"repeat": 0}, {"unknowns": 10.0}, {"share": 0.0}, {"share": 0.7}])
def test_what_measures_nothing_is_refused(wrong):
    asked = {"frames": 5, "repeat": 1, "unknowns": 2e3, "share": 0.05}
    check(Namespace(**asked))
    with pytest.raises(UserError):
        check(Namespace(**asked | wrong))
