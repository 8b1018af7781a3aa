"""`restshape bench scaling`: what is compared, the model, the job script, and bad input; no time is asserted."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import pytest
from restshape_studies.bench import rank_job, rank_process, scaling
from restshape_studies.bench.cluster_script import Measured, job_script
from restshape_studies.bench.job import Job, Outcome, read_reports
from restshape_studies.bench.scaling_model import Load, frame_ms, model
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.outputs.kinds import JobScriptFile

STAGES = {**dict.fromkeys(scaling.PARTS, 0.0), "values": 4.0, "krylov": 8.0, "observe": 2.0}
MACHINE = {
    "1": {"bandwidth": 10e9, "latency_s": 0.0, "message_s": 0.0, "message_bandwidth": 0.0},
    "2": {"bandwidth": 16e9, "latency_s": 1e-6, "message_s": 1e-6, "message_bandwidth": 1e9},
}


def small(tmp_path):
    scene = write_scene(tmp_path, plate(0.2), "small.toml")
    edits = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.53, 0.5), 3)), "small.jsonl")
    first, *others = edits.read_text().splitlines()
    edits.write_text("\n".join([json.dumps({**json.loads(first), "scene": "small.toml"}), *others, ""]))
    return scene


def ran(ranks, ms, iterations=4.0, bandwidth=10e9, cells=1000, whole=1000, observed=0):
    """An entry of so many ranks whose frames are of level 1."""
    sent = {"reductions": 3.0 * iterations, "messages": 2.0 * iterations, "message_bytes": 8e3} if ranks > 1 else {}
    level = {"frames": 9, "ms": ms, "iterations": iterations, "refreshes": 0, "stages": dict(STAGES)}
    level |= {"reductions": 0.0, "messages": 0.0, "message_bytes": 0.0} | sent
    one = {
        "ranks": ranks,
        "elements": whole,
        "all_cells": whole,
        "cells": [cells] * ranks,
        "observed": [observed or whole] * ranks,
        "iteration_bytes": 1e6 / ranks,
    }
    return one | {"bandwidth": bandwidth, "levels": {"1": level, "2": None, "3": None, "still": None}}


def test_speed_up_is_compared_with_the_bandwidth_of_as_many_ranks():
    entries = [ran(1, 10.0), ran(2, 8.0, bandwidth=16e9)]
    scaling.compare(entries, "strong", {1: 10e9, 2: 18e9})
    two = entries[1]["levels"]["1"]
    assert (two["speed_up"], two["efficiency"]) == (1.25, 0.625)
    assert (entries[1]["limit"], entries[1]["stream_limit"]) == (1.6, 1.8)
    assert two["of_limit"] == pytest.approx(1.25 / 1.6)
    # What no cache holds, where the working set is not known; and never more than the ranks.
    entries = [ran(1, 10.0, bandwidth=None), ran(2, 8.0, bandwidth=None)]
    scaling.compare(entries, "strong", {1: 10e9, 2: 21e9})
    assert entries[1]["limit"] == 2.0


def test_weak_scaling_is_the_part_of_its_bandwidth_that_a_rank_keeps():
    entries = [ran(1, 10.0), ran(2, 12.5, bandwidth=16e9, whole=2000)]
    scaling.compare(entries, "weak", {1: 10e9, 2: 16e9})
    two = entries[1]["levels"]["1"]
    assert two["speed_up"] == two["efficiency"] == 0.8 and entries[1]["limit"] == 0.8 and two["of_limit"] == 1.0


def test_times_are_of_the_slowest_rank():
    ranks = [{"ms": [{"ms": 3.0, "ms_krylov": 1.0}]}, {"ms": [{"ms": 2.0, "ms_krylov": 2.0}]}]
    assert scaling.slowest(ranks, 0) == {"ms": 3.0, "ms_krylov": 2.0}


def test_the_model_shares_what_is_shared_and_adds_messages():
    alone = Load(1000, 1000, 1000, 4.0, 1e6, 10e9, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    two = Load(510, 1000, 1000, 6.0, 0.5e6, 8e9, 18.0, 12.0, 1e6, 1e-6, 2e-6, 1e9)
    modelled = frame_ms(STAGES, alone, two)
    assert modelled["values"] == pytest.approx(4.0 * 0.51 * 10 / 8)
    assert modelled["krylov"] == pytest.approx(8.0 * 0.75 * 10 / 8)
    assert modelled["observe"] == 2.0
    assert modelled["messages"] == pytest.approx(1e3 * (18e-6 + 24e-6 + 1e-3))
    assert frame_ms(STAGES, alone, replace(two, observed=520))["observe"] == pytest.approx(2.0 * 0.52 * 10 / 8)


def test_the_model_is_checked_on_what_was_run_and_its_error_is_reported():
    entries = [ran(1, 14.0), ran(2, 9.0, bandwidth=20e9, cells=500)]
    found = model(entries, MACHINE, "strong")
    (checked,) = found["checked"]
    assert checked["error"] == pytest.approx(checked["ms"] / 9.0 - 1.0) and checked["ranks"] == 2
    assert checked["ms"] == pytest.approx(2.0 + 2.0 + 4.0 + checked["stages"]["messages"])
    ranks = [one["ranks"] for one in found["beyond"]]
    assert ranks == [4, 8, 16, 32, 64, 128]
    # What is whole on each rank, and messages, end what more of them bring.
    assert all(one["ms"] > 2.0 for one in found["beyond"])
    assert model(entries[:1], MACHINE, "strong") is None
    weak = model([ran(1, 14.0), ran(2, 16.0, bandwidth=20e9, cells=1000, whole=2000)], MACHINE, "weak")
    whole = [one["stages"]["observe"] for one in (*weak["checked"], *weak["beyond"])]
    assert whole[:3] == [4.0, 8.0, 16.0]


def test_what_is_observed_is_shared_beyond_what_was_run_where_it_was_so():
    found = model([ran(1, 14.0), ran(2, 9.0, bandwidth=20e9, cells=500, observed=520)], MACHINE, "strong")
    parts = [one["stages"]["observe"] for one in (*found["checked"], *found["beyond"][:2])]
    # 20 cells around the 500 of a rank: as the root of these.
    assert parts == pytest.approx([2.0 * 0.52, 2.0 * (0.25 + 0.02 * 0.5**0.5), 2.0 * (0.125 + 0.02 * 0.5)])


def test_iterations_grow_beyond_what_was_run_where_parts_have_made_them_grow():
    def krylov(iterations):
        found = model([ran(1, 14.0), ran(2, 9.0, iterations, 20e9, 500)], MACHINE, "strong")
        return [one["stages"]["krylov"] for one in found["beyond"]]

    assert krylov(4.0)[1] / krylov(4.0)[0] == pytest.approx(0.5)
    assert krylov(8.0)[1] / krylov(8.0)[0] == pytest.approx(0.5 * 2**0.25)


def test_the_job_script_is_one_that_bash_takes(tmp_path):
    measured = Measured("a b.toml", "e.jsonl", ("mesh.size=1 mm",), ("strong",), "2000", (1, 2, 64))
    path = JobScriptFile(tmp_path / "scaling.sbatch")
    path.write_text(job_script(measured, 90))
    text = path.read_text()
    assert "#SBATCH --ntasks=64\n" in text and "#SBATCH --time=01:30:00\n" in text
    assert "restshape bench scaling 'a b.toml' --edits e.jsonl --ranks 1,2,64 --strong --triangles 2000" in text
    assert "srun --ntasks=64 restshape replay 'a b.toml' --edits e.jsonl --set 'mesh.size=1 mm'" in text
    assert path.ours() and subprocess.run(["bash", "-n", str(path)]).returncode == 0
    path.write_text("#!/bin/bash\necho mine\n")
    assert not path.ours()


def test_slurm_starts_its_own_ranks(monkeypatch):
    monkeypatch.setattr(rank_job.shutil, "which", lambda name: f"/usr/bin/{name}")
    monkeypatch.setenv("SLURM_JOB_ID", "7")
    monkeypatch.setenv("SLURM_NTASKS", "96")
    assert rank_job.cores() == 96 and rank_job.launcher(8, False) == ["srun", "--ntasks", "8"]
    monkeypatch.delenv("SLURM_JOB_ID")
    assert rank_job.cores() == len(os.sched_getaffinity(0)) and rank_job.launcher(8, False)[0] == "mpiexec"


def test_what_a_rank_says_of_its_end_is_found_among_words_of_launchers():
    said = "Traceback (most recent call last):\n  File\nValueError: 7\n" + "-" * 74 + "\nMPI_ABORT was invoked\n"
    assert rank_job.ending(1, rank_job.cause(said)) == "ended with code 1: ValueError: 7"
    assert rank_job.cause("mpiexec: no slots") == "mpiexec: no slots"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--ranks", "0"), ("--ranks", "'0' is no list")),
        (("--ranks", "1,two"), ("--ranks", "--ranks 1,2")),
        (("--ranks", "1,4096"), ("more than the", "--oversubscribe")),
        (("--frames", 1), ("--frames",)),
        (("--triangles", "few"), ("--triangles",)),
        (("--out", "mine"), ("--out mine", "not a page that restshape wrote")),
    ],
)
def test_bad_input(tmp_path, command, words, said):
    scene = small(tmp_path)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "README.md").write_text("# mine\n")
    done = command("bench", "scaling", scene, *words)
    assert done.returncode == 2 and done.stdout == "" and " try: " in done.stderr
    for word in said:
        assert word in done.stderr
    assert not (tmp_path / "results").exists()


def test_within_mpiexec_it_is_refused(monkeypatch, capsys):
    monkeypatch.setenv("PMIX_RANK", "0")
    assert main(["bench", "scaling", "plate", "--ranks", "1,2"]) == 2
    assert "it starts the ranks itself, as many as --ranks names" in capsys.readouterr().err


@pytest.fixture
def one_rank_here(tmp_path, monkeypatch):
    """Jobs on one rank run in this process, and what two ranks have of the machine is made up."""

    def play(job, ranks, *settings):
        if ranks > 1:
            made_up = Outcome([], found={**MACHINE["2"], "bandwidth": 9e9})
            return made_up if job.measure == "rates" else rank_job.run_on_ranks(job, ranks, *settings)
        given, reports = tmp_path / "job.json", tmp_path / "reports.jsonl"
        given.write_text(job.dumps())
        with monkeypatch.context() as changed:
            changed.setattr(sys, "argv", ["", str(given), str(reports)])
            changed.setattr(rank_process, "start_petsc", lambda words: None)
            code = rank_process.main()
        return read_reports(reports, rank_job.ending(code, ""))

    monkeypatch.setattr(scaling, "run_on_ranks", play)
    return play


def measured(tmp_path, command, monkeypatch, mode):
    """What the command gives of a small scene on one and two ranks."""
    monkeypatch.setattr(scaling, "LARGE_SET", 4e6)
    scene = small(tmp_path)
    words = ("--ranks", "1,2", mode, "--oversubscribe", "--out", "found", "--json", "a.json")
    done = command("bench", "scaling", scene, *words)
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "a.json").read_text())
    (run,) = found["runs"]
    one, two = run["entries"]
    assert (one["ranks"], two["ranks"], len(two["peak_mb"])) == (1, 2, 2)
    for entry in (one, two):
        level = entry["levels"]["1"]
        assert level["frames"] == 3 and level["ms"] > 0.0 and entry["working_set"] > 0.0
        assert level["stages"]["krylov"] > 0.0 and min(entry["stored_mb"]) > 0.0
    assert two["levels"]["1"]["reductions"] > 0.0 and two["levels"]["1"]["messages"] > 0.0
    assert found["machine"]["2"]["latency_s"] > 0.0 and run["model"]["checked"][0]["ranks"] == 2
    for words in ("STREAM", "limit by memory", "error of the model", "cores are what there is here"):
        assert words in done.stdout
    return scene, one, two


@pytest.mark.slow
@pytest.mark.mpi
@pytest.mark.usefixtures("one_rank_here")
def test_for_programs_and_people(tmp_path, command, monkeypatch):
    scene, one, two = measured(tmp_path, command, monkeypatch, "--weak")
    assert two["elements"] == pytest.approx(2 * one["elements"], rel=0.3)
    assert (tmp_path / "found/scaling.png").is_file() and JobScriptFile(tmp_path / "found/scaling.sbatch").ours()
    page = (tmp_path / "found/README.md").read_text()
    assert "```sh\nrestshape bench scaling " in page and "a model of level 1, not a measurement" in page
    again = command("bench", "scaling", scene, "--redraw", "a.json", "--out", "again")
    assert again.returncode == 0 and (tmp_path / "again/README.md").read_text() == page


@pytest.mark.weekly
@pytest.mark.mpi
def test_all_in_processes_of_their_own(tmp_path, command, monkeypatch):
    _, one, two = measured(tmp_path, command, monkeypatch, "--strong")
    assert one["unknowns"] == two["unknowns"] and sum(two["cells"]) >= two["all_cells"] == max(one["cells"])
    with pytest.raises(UserError, match="nowhere"):
        rank_job.run_on_ranks(Job(str(tmp_path / "nowhere.toml"), "", "auto"), 2, oversubscribe=True)


def test_a_job_that_cannot_be_run_says_why(tmp_path, one_rank_here):
    with pytest.raises(UserError, match="nowhere"):
        one_rank_here(Job(str(tmp_path / "nowhere.toml"), "", "auto"), 1)


def test_a_run_without_an_end_is_reported(tmp_path):
    job = Job(str(small(tmp_path)), "", "auto")
    outcome = SimpleNamespace(rows=[], found=None, problem="stopped after 3 s")
    with pytest.raises(UserError, match="on 2 ranks the replay stopped after 3 s"):
        scaling.study("a", job, scaling.Plan((2,)), lambda words: None, lambda job, ranks: outcome)
