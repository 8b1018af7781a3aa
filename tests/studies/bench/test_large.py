"""`restshape bench large` on small meshes: drags in the plane, in space and in motion; no time is asserted."""

import json
from pathlib import Path

import pytest
from restshape_studies.bench.job import Outcome
from restshape_studies.bench.large import CASES, ENOUGH, ratios, study

from restshape.application import applications
from restshape.cli.shipped import named_scenes
from restshape.errors import UserError


def of_case(name, tmp_path, command, unknowns=1000):
    done = command("bench", "large", "--cases", name, "--unknowns", unknowns, "--json", "a.json")
    assert done.returncode == 0, done.stderr
    for words in (CASES[name].title, "over auto", "rest over these"):
        assert words in done.stdout
    found = json.loads((tmp_path / "a.json").read_text())[name]
    for one in found["policies"].values():
        assert one["unknowns"] == pytest.approx(unknowns, rel=0.5) and one["stored_mb"] > 0.0
        assert one["ms"] > 0.0 and one["cpu_ms"] > 0.0 and one["first_cpu_ms"] > 0.0
    return found["policies"]


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
def test_a_shape_in_the_plane(tmp_path, command):
    found = of_case("plane", tmp_path, command)
    assert list(found) == ["auto", "refactor", "rebuild", "predicted"]
    assert (found["auto"]["frames"], found["rebuild"]["frames"]) == (50, 3)
    assert found["auto"]["refreshes"] < 10 and found["refactor"]["refreshes"] == 3
    assert set(found["rebuild"]["levels"]) == {3} and found["predicted"]["iterations"] == 0.0


@pytest.mark.weekly
@pytest.mark.parametrize("name", ["space", "motion"])
@pytest.mark.usefixtures("jobs_here")
def test_a_body_in_space_and_one_in_motion(tmp_path, command, name):
    found = of_case(name, tmp_path, command, 2000)
    assert found["auto"]["frames"] == CASES[name].frames and set(found["auto"]["levels"]) == {1}


@pytest.mark.parametrize(
    ("words", "said"), [(("plate",), "SCENE"), (("--unknowns", 1), "--unknowns"), (("--cases", "sphere"), "sphere")]
)
def test_bad_input_of_large(command, words, said):
    done = command("bench", "large", *words)
    assert done.returncode == 2 and said in done.stderr and done.stdout == ""


def test_ratios_are_of_what_came_to_an_end():
    """Of processor time, which does not hang on what else runs."""
    auto, refactor = {"ms": 9.0, "cpu_ms": 2.0}, {"ms": 9.0, "cpu_ms": 8.0}
    assert ratios({"auto": auto, "refactor": refactor, "rebuild": {"problem": "stopped"}}) == {"refactor": 4.0}
    assert ratios({"auto": {"problem": "stopped"}, "refactor": refactor}) == {}


def test_a_case_without_a_first_frame_says_why(tmp_path):
    given = (CASES["plane"], tmp_path / "a.toml", 500.0, tmp_path, (), 9.0, lambda words: None)
    with pytest.raises(UserError, match="killed by the system"):
        study(*given, lambda job, seconds: Outcome([], "killed by the system, as when memory runs out"))


def test_what_a_policy_took_is_said_before_the_next_one_begins(tmp_path):
    """So that it is known though a later one is stopped; frames of slow policies are fewer where each takes minutes."""
    said, asked = [], []

    def play(job, seconds):
        asked.append(job.details)
        if job.policy == "rebuild":
            return Outcome([], "stopped after 9 s")
        found = {"unknowns": 500, "frames": 2, "first_cpu_ms": 1500.0, "cpu_ms": 40.0, "peak_mb": 90.0}
        return Outcome([], "", found)

    case, installed = CASES["space"], [path for app in applications().values() for path in app.scenes()]
    (scene,) = named_scenes([Path(case.scene)], installed)
    study(case, scene, 500.0, tmp_path, (), 9.0, said.append, play)
    assert said[1] == "auto: first frame 1,500 ms of the processor; 2 frames, each 40 ms; 90 MB"
    assert said[5] == "rebuild: stopped after 9 s" and "predicted" in said[6]
    assert [one["frames"] for one in asked] == [0, 50, 1, 1, 50]
    assert {one["seconds"] for one in asked[1:]} == {ENOUGH * 9.0}
