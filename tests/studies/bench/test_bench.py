"""What the benchmarks count and how they sum up. No time is asserted: times here are made up."""

import json
import math
import os
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from counted_replays import begin_log
from restshape_studies.bench import reuse
from restshape_studies.bench.job import Job, Outcome, run, unused_by_all
from restshape_studies.bench.process import pin, play
from restshape_studies.bench.reuse import Plan, compare, event_totals, frames_a_second, medians, ratios, timed, whole
from restshape_studies.bench.size import LARGE, exponents, measure, mesh_size, size_record, sizes
from restshape_studies.bench.size import drag as plate_drag
from restshape_studies.bench.turns import Case
from restshape_studies.commands.bench_reuse import _print_left_out
from restshape_studies.pictures.policies import draw_policies
from restshape_studies.pictures.scaling import draw_scaling
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.algebra.stages import Stages
from restshape.errors import UserError
from restshape.replay.columns import STAGES

PNG = b"\x89PNG\r\n\x1a\n"


def row(level=1, ms=1.0, **other):
    """A frame as a replay reports it."""
    times = {f"ms_{stage}": 0.1 for stage in (*STAGES, "python")}
    counts = {"refused": "", "pc_rebuilt": 0, "iterations": 2, "unknowns": 1000, "elements": 900, "rss_mb": 100.0}
    counts |= {
        "preconditioner": "cholesky",
        "predicted": 0,
        "newton": 0,
        "constraint_status": "",
        "violated_constraints": "",
        "note": "",
    }
    times |= {f"ms_{name}": other.get(f"ms_{name}", 0.0) for name in ("estimate", "record")}
    whole = ms + times["ms_estimate"] + times["ms_record"]
    return {"level": level, "ms": whole, **times, **counts, "events": {"KSPSolve": 1}, **other}


def timed_run(fps, p50):
    return {"fps": fps, "ms": {"all": {"p50": p50, "p95": 2 * p50, "p99": 3 * p50}}}


def run_here(job):
    """What a job reports, run in this process."""
    reported = {"row": []}
    play(job, lambda kind, content: reported[kind].append(content))
    return Outcome(reported["row"])


@pytest.fixture(scope="module")
def counted(tmp_path_factory):
    """Rows with events counted, by policy, of a plate whose hole moves far enough for every level."""
    folder = tmp_path_factory.mktemp("bench")
    scene = write_scene(folder, plate(0.15))
    path = [*across((0.5, 0.5), (0.56, 0.5), 4), (1.4, 0.5), (1.41, 0.5)]
    script = write_script(folder, [*drag("window", (0.5, 0.5), path), {"do": "idle", "frames": 2}])
    begin_log()
    # Counts are taken over the log stages that there are.
    Stages()
    return {
        name: run_here(Job(str(scene), str(script), name, count=True)).rows
        for name in ("rebuild", "refactor", "thesis", "auto")
    }


def test_rebuild_makes_all_again_in_each_frame_that_moves(counted):
    moved = [row for row in counted["rebuild"] if row["level"]]
    assert len(moved) == 7 and {row["level"] for row in moved} == {3}
    for row in moved:
        events = row["events"]
        assert (events["RestshapePattern"], events["RestshapePatch"], events["RestshapeValues"]) == (1, 0, 1)
        assert (events["MatCholFctrSym"], events["MatCholFctrNum"], events["PCApply"]) == (1, 1, 1)


def test_refactor_makes_one_numeric_factor_a_frame(counted):
    levels = [row["level"] for row in counted["refactor"]]
    assert levels.count(1) >= 4 and levels.count(3) == 2
    for row in counted["refactor"]:
        events, moved = row["events"], row["level"] > 0
        assert events["MatCholFctrNum"] == events["RestshapeValues"] == moved
        assert events["RestshapePattern"] == (row["level"] == 3) and events["RestshapePatch"] == (row["level"] == 2)
        assert events["PCApply"] == moved


def test_thesis_factors_at_level_3_only(counted):
    for row in counted["thesis"]:
        events = row["events"]
        assert events["MatILUFactorSym"] == events["MatLUFactorNum"] == (row["level"] == 3)
        assert events["RestshapePatch"] == (row["level"] == 2)
        assert events["MatCholFctrNum"] == 0


def test_auto_factors_where_the_row_says_so(counted):
    for row in counted["auto"]:
        events = row["events"]
        assert events["MatCholFctrNum"] == row["pc_rebuilt"]
        assert events["RestshapeValues"] == (row["level"] > 0)
        # One product a Krylov iteration, and one for the residual that each run begins with.
        assert events["MatMult"] >= row["iterations"]


def test_totals_are_sums_of_frames(counted):
    for rows in counted.values():
        totals = event_totals(rows)
        for name, total in totals["events"].items():
            later = sum(by_level[name] for by_level in totals["events_by_level"].values())
            assert total == later + rows[0]["events"][name], name


def test_frames_a_second_counts_moved_frames_only():
    rows = [row(3, 100.0), row(1, 2.0), row(0, 50.0, iterations=0), row(2, 6.0)]
    assert frames_a_second(rows) == pytest.approx(2 / 8e-3)
    assert frames_a_second([row(3, 100.0), row(0, 1.0, iterations=0)]) == 0.0


def test_frames_that_are_solved_while_the_mesh_rests_count_as_those_that_move_it():
    rows = [row(3, 100.0), row(1, 2.0), row(0, 8.0, iterations=40), row(0, 0.1, iterations=0)]
    found = timed(rows)
    assert found["fps"] == pytest.approx(2 / 10e-3)
    assert (found["ms"]["1"]["p50"], found["ms"]["still"]["p50"], found["ms"]["all"]["p50"]) == (2.0, 8.0, 5.0)


def test_all_that_a_frame_costs_holds_what_is_done_beside_it():
    rows = [row(3, 100.0), row(1, 2.0, ms_record=3.0), row(1, 4.0, ms_record=1.0), row(0, 0.5, iterations=0)]
    found = whole(rows)
    assert found == {"p50": 5.0, "fps": pytest.approx(200.0), "session_s": pytest.approx(10.5e-3)}


def test_medians_of_runs():
    runs = [{"p50": 3.0, "p95": 9.0}, {"p50": 1.0, "p95": 7.0}, {"p50": 2.0, "p95": 8.0}]
    assert medians(runs) == {"p50": 2.0, "p95": 8.0}
    assert medians(runs[:2]) == {"p50": 2.0, "p95": 8.0}


def test_ratios_compare_runs_of_one_turn():
    # The machine is twice as slow in the second turn and thrice in the third: the ratios do not see it.
    auto, base = [timed_run(100, 1), timed_run(50, 2), timed_run(33, 3)], [timed_run(20, 5), timed_run(10, 10)]
    base.append(timed_run(33 / 5, 15))
    assert ratios(auto, base) == {"fps": pytest.approx(5.0), "p50": pytest.approx(5.0)}
    assert ratios(auto, [timed_run(0, 0)] * 3)["fps"] is None


def test_policies_take_turns_and_the_median_is_reported(tmp_path):
    played, speed = [], {"rebuild": iter((8.0, 30.0, 10.0)), "auto": iter((1.0, 2.0, 4.0))}
    speed = {name: iter([*times, 1.0, 1.0, 1.0]) for name, times in speed.items()}

    def play(job):
        played.append((job.policy, job.estimate if not job.count else "counted"))
        ms = 99.0 if job.count else next(speed[job.policy])
        ms += 7.0 * job.estimate
        rows = [row(3, 500.0), *(row(1, ms, ms_estimate=0.125) for _ in range(2)), row(0, 0.1, iterations=0)]
        return Outcome(rows)

    found = compare(Case("plate", tmp_path, tmp_path), Plan(("rebuild", "auto")), lambda words: None, play)
    assert played[:2] == [("rebuild", "counted"), ("auto", "counted")]
    assert played[2:8] == [("rebuild", False), ("auto", False)] * 3
    assert played[8:] == [("rebuild", True), ("auto", True)] * 3
    assert found["rebuild"]["ms"] == {"p50": 10.0, "p95": 10.0, "p99": 10.0}
    assert found["auto"]["fps"] == pytest.approx(500.0)
    # Turn by turn 8, 15 and 2.5 times as fast.
    assert found["auto"]["ratios"] == {"rebuild": {"fps": pytest.approx(8.0), "p50": pytest.approx(8.0)}}
    assert found["auto"]["levels"] == {"1": 2, "2": 0, "3": 0, "still": 0} and found["auto"]["idle"] == 1
    # Until the answer, with what is done beside it, and with estimates.
    parts = found["auto"]["ms"]["p50"], found["auto"]["whole"]["p50"], found["auto"]["estimated"]["p50"]
    assert parts == (2.0, 2.125, 8.125)
    assert found["auto"]["events"] == {"KSPSolve": 4} and len(found["auto"]["runs"]) == 3


def test_time_that_a_scene_has_bounds_turns_and_leaves_out_what_takes_longer(tmp_path, monkeypatch, capsys):
    """Each run takes 10 s, of which 25 hold two turns of one policy; one begins after 20."""
    clock, played = [0.0], []

    def play(job):
        played.append((job.policy, job.seconds))
        clock[0] += 10.0
        rows = [row(3, 500.0), row(1, 1.0), row(0, 0.1, iterations=0)]
        return Outcome(rows, "stopped after 25 s" if job.policy == "thesis" else "")

    monkeypatch.setattr("time.monotonic", lambda: clock[0])
    plan = Plan(("thesis", "auto"), repeat=10, seconds=25.0)
    found = compare(Case("plate", tmp_path, tmp_path), plan, lambda words: None, play)
    assert played == [("thesis", 25.0), ("auto", 25.0), *[("auto", None)] * 6]
    assert list(found) == ["auto"] and len(found["auto"]["runs"]) == 3 and found["auto"]["turns"] == 10
    with pytest.raises(UserError, match="no policy ends within 25 s"):
        compare(Case("plate", tmp_path, tmp_path), replace(plan, policies=("thesis",)), lambda words: None, play)
    _print_left_out(found["auto"])
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("3 of the 10 runs") and said[1].startswith("thesis is left out: stopped after 25 s")


def test_a_replay_that_ends_early_is_no_result(tmp_path):
    with pytest.raises(UserError, match=r"auto.*killed"):
        compare(
            Case("plate", tmp_path, tmp_path),
            Plan(("auto",)),
            lambda words: None,
            lambda job: Outcome([row()], "killed by the system"),
        )


def test_the_frames_asked_for(tmp_path):
    scene = write_scene(tmp_path, plate(0.3))
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.6, 0.5), 10)))
    assert len(run_here(Job(str(scene), str(script), "auto", frames=4)).rows) == 4
    assert [row["level"] for row in run_here(Job(str(scene), str(script), "auto", enough={"1": 3})).rows] == [
        3,
        0,
        1,
        1,
        1,
    ]


@pytest.mark.slow
def test_a_folder_with_the_name_of_the_package_is_not_taken_for_it(tmp_path, monkeypatch):
    """As when somebody works in the folder that holds a clone."""
    (tmp_path / "restshape").mkdir()
    monkeypatch.chdir(tmp_path)
    scene, script = write_scene(tmp_path, plate(0.3)), write_script(tmp_path, [{"do": "idle"}])
    outcome = run(Job(str(scene), str(script), "auto"))
    assert len(outcome.rows) == 2 and not outcome.problem


@pytest.mark.slow
def test_a_process_says_which_words_petsc_never_used(tmp_path):
    scene, script = write_scene(tmp_path, plate(0.3)), write_script(tmp_path, [{"do": "idle"}])
    assert run(Job(str(scene), str(script), "auto")).unused is None
    words = ("-solid_ksp_type", "cg", "-foo", "3")
    assert run(Job(str(scene), str(script), "auto", petsc=words)).unused == ["-foo"]
    assert unused_by_all(words) == ["-foo"]


def test_words_that_no_process_used_are_those_that_each_one_left():
    words = ("-a", "-b", "-c")
    assert unused_by_all(words) == []
    for left, by_all in ((["-a", "-b"], ["-a", "-b"]), (["-b", "-c"], ["-b"]), (None, ["-b"]), (["-a"], [])):

        def start(command, *, left=left, **_):
            Path(command[-1]).write_text("" if left is None else json.dumps(["unused", left]) + "\n")
            return SimpleNamespace(communicate=lambda *_, **__: ("", ""), returncode=0, poll=lambda: 0)

        run(Job("plate.toml", "", "auto", petsc=words), start=start)
        assert unused_by_all(words) == by_all


@pytest.mark.slow
def test_a_process_that_takes_too_long_is_ended(tmp_path):
    scene, script = write_scene(tmp_path, plate(0.3)), write_script(tmp_path, [{"do": "idle", "frames": 1_000_000}])
    outcome = run(Job(str(scene), str(script), "auto"), seconds=3.0)
    assert outcome.problem == "stopped after 3 s"
    assert all(set(row) >= {"level", "ms"} for row in outcome.rows)


@pytest.mark.slow
def test_a_bad_script_is_reported_as_in_a_replay(tmp_path):
    scene, script = write_scene(tmp_path, plate(0.3)), write_script(tmp_path, [{"do": "fly"}])
    with pytest.raises(UserError, match="line 2"):
        run(Job(str(scene), str(script), "auto"))


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="this system does not pin processes")
def test_pinned_to_one_core():
    before = os.sched_getaffinity(0)
    try:
        pin()
        assert len(os.sched_getaffinity(0)) == 1
    finally:
        os.sched_setaffinity(0, before)


def test_sizes_and_the_mesh_for_them():
    assert sizes(1e3, 1e5, 3) == pytest.approx([1e3, 1e4, 1e5])
    # A quarter of the size: sixteen times the unknowns.
    assert mesh_size(1e3) / mesh_size(16e3) == pytest.approx(4.0)


@pytest.mark.parametrize("unknowns", [1e3, 1e5, LARGE, 1e6])
def test_each_frame_of_the_drag_has_a_phase(unknowns):
    events, phases = plate_drag(unknowns)
    assert len(phases) == 1 + len(events) and phases[0] == "first"
    assert {"small", "approach", "flip"} <= set(phases) and ("jump" in phases) == (unknowns < LARGE)
    # The hole, of radius 0.12, stays in the plate of 2 m.
    assert all(0.12 < event["to"][0] < 1.88 for event in events if event["do"] == "drag")


def test_exponents_are_those_of_the_upper_half():
    def record(n):
        # Linear below 1e4 unknowns, to the power 1.5 above.
        ms = n * 1e-3 if n < 1e4 else 10.0 * (n / 1e4) ** 1.5
        return {"unknowns": n, "levels": {"1": {"ms": {"p50": ms}}, "2": None, "3": None}}

    fits = exponents([record(n) for n in np.geomspace(1e2, 1e6, 9)])
    assert fits["1"]["exponent"] == pytest.approx(1.5) and fits["1"]["points"] == 5
    assert fits["1"]["coefficient_ms"] == pytest.approx(10.0 / 1e4**1.5)
    assert fits["2"] is None and fits["3"] is None


def test_a_size_that_runs_out_of_time_or_memory_is_reported(tmp_path):
    outcomes = iter([Outcome([row(3, 9.0)], "stopped after 3 s"), Outcome([], "killed by the system")])
    small, large = measure(tmp_path, [1e3, 1e6], tmp_path, 60.0, play=lambda job, seconds: next(outcomes))
    assert small["problem"] == "stopped after 3 s" and small["first_frame_ms"] == 9.0
    assert small["levels"] == {"1": None, "1_old": None, "2": None, "3": None}
    assert large["problem"] == "killed by the system" and large["unknowns"] is None and large["memory_mb"] is None
    (late,) = measure(tmp_path, [1e3], tmp_path, 0.5, play=lambda job, seconds: pytest.fail("no time was left"))
    assert late["problem"] == "no time was left"


def test_levels_are_taken_from_their_phases():
    phases = ["first", "press", "small", "small", "jump", "approach", "flip", "flip"]
    levels, times = (3, 0, 1, 1, 3, 1, 1, 2), (90.0, 5.0, 1.0, 3.0, 40.0, 7.0, 4.0, 6.0)
    rows = [row(level, ms) for level, ms in zip(levels, times)]
    found = size_record(1e3, Outcome(rows), phases)
    p50 = {level: entry["ms"]["p50"] for level, entry in found["levels"].items()}
    assert p50 == {"1": 2.0, "1_old": 4.0, "2": 6.0, "3": 40.0}
    assert not found["first_frame_serves_as_level_3"] and found["problem"] == ""
    large = size_record(1e6, Outcome([r for r, phase in zip(rows, phases) if phase != "jump"]), phases[:4] + phases[5:])
    assert large["first_frame_serves_as_level_3"] and large["levels"]["3"]["ms"]["p50"] == 90.0


@pytest.mark.slow
def test_one_size_for_real(tmp_path):
    from restshape_studies.commands.bench import installed_scene

    (found,) = measure(installed_scene("plate"), [400.0], tmp_path, 60.0)
    assert 200 < found["unknowns"] < 800
    assert found["levels"]["1"]["frames"] == 20 and found["levels"]["3"]["frames"] >= 1
    assert found["memory_mb"] > 20


@pytest.mark.slow
def test_pictures_are_written_with_holes_in_the_data(tmp_path):
    times = {"p50": 1.0, "p95": 30.0, "p99": 40.0}
    still = dict.fromkeys(times, 0.0)
    found = {"plate": {"rebuild": {"ms": times, "fps": 9.0}, "mine": {"ms": still, "fps": 0.0}}, "idle": {}}
    draw_policies(found, tmp_path / "a.png")
    none = {"levels": dict.fromkeys(("1", "1_old", "2", "3")), "unknowns": None, "memory_mb": None, "wanted": 1e6}
    draw_scaling([{**none, "problem": "killed"}], dict.fromkeys("123"), "auto", tmp_path / "b.png")
    for name in ("a.png", "b.png"):
        assert (tmp_path / name).read_bytes().startswith(PNG)


def test_bases_are_policies():
    from restshape.policy import POLICIES

    assert set(reuse.BASES) < set(POLICIES) and math.isfinite(LARGE)
