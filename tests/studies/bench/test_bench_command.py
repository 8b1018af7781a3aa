"""`restshape bench` as people and programs call it; no time is asserted."""

import json
from dataclasses import replace

import pytest
from restshape_studies.bench.turns import OutOfTime
from restshape_studies.commands.bench import KINDS
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.cli.main import main

pytestmark = pytest.mark.cli

PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture
def scene(tmp_path):
    path = write_scene(tmp_path, plate(0.2), "small.toml")
    edits = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.53, 0.5), 3)), "small.jsonl")
    first, *others = edits.read_text().splitlines()
    edits.write_text("\n".join([json.dumps({**json.loads(first), "scene": "small.toml"}), *others, ""]))
    return path


@pytest.mark.slow
def test_reuse_for_programs_and_people(tmp_path, command, scene):
    done = command("bench", "reuse", scene, "--policies", "rebuild,auto", "--repeat", 1, "--json", "a.json")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "a.json").read_text())
    assert set(found) == {"small"} and list(found["small"]) == ["rebuild", "auto"]
    for entry in found["small"].values():
        assert entry["fps"] > 0 and 0 < entry["ms"]["p50"] <= entry["ms"]["p95"] <= entry["ms"]["p99"]
        assert (entry["frames"], entry["idle"], entry["refused"]) == (6, 2, 0)
        assert entry["events"]["RestshapeValues"] == 4 and len(entry["runs"]) == 1
        assert set(entry["times"]) == {"ms", "whole", "estimated"} <= set(entry)
        assert entry["tolerance"] == 1e-6 and 0 < entry["ms"]["p50"] < entry["whole"]["p50"]
        assert entry["estimated"]["p50"] > 0
        assert {"ms_by_level", "python_ms", "stages", "iterations", "refreshes", "ratios"} <= set(entry)
    assert found["small"]["rebuild"]["levels"] == {"1": 0, "2": 0, "3": 3, "still": 0}
    assert found["small"]["auto"]["levels"] == {"1": 3, "2": 0, "3": 0, "still": 0}
    assert set(found["small"]["auto"]["ratios"]) == {"rebuild"}
    for words in (
        "small: 6 frames",
        "frames/s",
        "p99, ms",
        "x rebuild",
        "MatCholFctrNum",
        "stages in all",
        "all that a frame costs",
        "results",
    ):
        assert words in done.stdout
    assert (tmp_path / "results/bench-reuse.png").read_bytes().startswith(PNG)


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
def test_set_frames_and_edits(tmp_path, command, scene):
    (tmp_path / "small.jsonl").rename(tmp_path / "other.jsonl")
    words = ("--policies", "auto", "--repeat", 1, "--frames", 3, "--set", "mesh.size=0.3", "--json", "a.json")
    done = command("bench", "reuse", scene, "--edits", "other.jsonl", *words, "--out", "pictures")
    assert done.returncode == 0, done.stderr
    entry = json.loads((tmp_path / "a.json").read_text())["small"]["auto"]
    assert entry["frames"] == 3 and entry["levels"]["1"] == 1
    assert (tmp_path / "pictures/bench-reuse.png").is_file() and not (tmp_path / "results").exists()


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
def test_size_for_programs_and_people(tmp_path, command):
    done = command("bench", "size", "--from", 300, "--to", 600, "--points", 2, "--json", "a.json")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "a.json").read_text())
    assert "without estimates" in found["times"] and found["tolerance"] == 1e-6
    assert found["policy"] == "auto" and set(found["exponents"]) == {"1", "2", "3"}
    first, second = found["sizes"]
    assert first["unknowns"] < second["unknowns"] and first["levels"]["1"]["ms"]["p50"] > 0
    assert "times are of whole frames with their residual, without estimates" in done.stdout
    for words in ("time a frame", "old factor", "memory", "fitted power", "krylov"):
        assert words in done.stdout
    assert (tmp_path / "results/bench-size.png").read_bytes().startswith(PNG)


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (("reuse", "--policies", "auto,fast"), ("fast", "rebuild")),
        (("reuse", "nowhere.toml"), ("nowhere.toml",)),
        (("reuse", "small.toml", "--out", "small.toml"), ("--out", "cannot be written")),
        (("reuse", "small.toml", "--json", "nowhere/a.json"), ("--json", "cannot be written")),
        (("reuse", "small.toml", "--edits", "nowhere.jsonl"), ("nowhere.jsonl",)),
        (("reuse", "small.toml", "--set", "mesh.sice=1"), ("mesh.sice",)),
        (("reuse", "small.toml", "--repeat", 0), ("--repeat",)),
        (("reuse", "strip"), ("3 installed scenes have this name", "/strip, ")),
        (("reuse", "plait"), ("no such scene", "plait")),
        (("reuse", "small.toml", "--before", "nowhere.json"), ("--before nowhere.json: this cannot be read: No such",)),
        (("reuse", "small.toml", "--before", "small.toml"), ("--before small.toml: this is no JSON",)),
        (("reuse", "small.toml", "--frames", 1), ("--frames",)),
        (("reuse", "--edits", "small.jsonl"), ("--edits", "one scene")),
        (("size", "--from", 1e6, "--to", 1e3), ("--from",)),
        (("size", "--points", 0), ("--points",)),
        (("size", "--to", 2e3, "--out", "small.toml"), ("--out", "cannot be written")),
    ],
)
def test_bad_input(command, scene, words, reported):
    done = command("bench", *words)
    assert done.returncode == 2 and done.stdout == "" and "Traceback" not in done.stderr
    assert " try: " in done.stderr
    for word in reported:
        assert word in done.stderr


@pytest.mark.parametrize("other", [[], {}, {"a": {"problem": "none"}}, {"sizes": [1.0]}, {"small": {"auto": 1}}])
def test_results_of_another_study_are_refused_before_anything_is_measured(tmp_path, command, scene, other):
    (tmp_path / "other.json").write_text(json.dumps(other))
    done = command("bench", "reuse", scene, "--before", "other.json")
    assert done.returncode == 2 and done.stdout == ""
    assert "--before other.json: this holds no results of restshape bench reuse" in done.stderr


TIMED = (
    "reuse",
    "limit",
    "size",
    "reach",
    "scaling",
    "large",
    "order",
    "eigen",
    "drags",
    "drape",
    "nested",
    "predict",
    "derivative",
    "body",
    "peers",
    "live",
)


def test_each_study_of_times_says_what_they_include():
    from restshape_studies.commands.bench import KINDS

    # Errors, jumps and counted work are no times.
    assert {name for name, kind in KINDS.items() if kind.times} == set(TIMED)
    assert set(KINDS) - set(TIMED) == {"effectivity", "jumps", "maps", "regret"}


@pytest.mark.parametrize("words", [("bench", "reuse"), ("bench", "regret"), ("tables",)])
def test_ranks_are_refused(monkeypatch, capsys, words):
    """Each would measure all for itself."""
    monkeypatch.setenv("PMI_RANK", "0")
    assert main(list(words)) == 2
    assert "mpiexec: " in (reported := capsys.readouterr().err) and "start it without mpiexec" in reported


def test_a_scene_without_a_script(tmp_path, command, scene):
    (tmp_path / "small.jsonl").unlink()
    done = command("bench", "reuse", scene)
    assert done.returncode == 2 and "--edits" in done.stderr


def test_the_help_names_both_studies(command):
    reported = command("bench", "--help").stdout
    assert "reuse" in reported and "size" in reported


def test_a_scene_that_no_policy_ends_is_left_out_and_the_others_go_on(tmp_path, monkeypatch, capsys):
    def measure(args, case, announce):
        if case.name == "kirsch":
            raise OutOfTime("no policy ends within 1 s", "kirsch.toml", "give more --seconds")
        return {"auto": 7}

    short = replace(KINDS["reuse"], measure=measure, show=lambda *_: None, picture="", draw=None, times="")
    monkeypatch.setitem(KINDS, "reuse", short)
    file = tmp_path / "found.json"
    assert main(["bench", "reuse", "kirsch", "cook", "--json", str(file)]) == 3
    assert "kirsch is left out: kirsch.toml: no policy ends within 1 s" in capsys.readouterr().err
    assert json.loads(file.read_text())["cook"] == {"auto": 7}
    assert main(["bench", "reuse", "kirsch"]) == 2
