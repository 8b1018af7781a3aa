"""The suite of hard cases: each holds, in a smaller share where it is long; a case that fails says so, a crash too."""

import json
import os
import re
from dataclasses import asdict

import pytest
from restshape_studies.stability.case import Case, Trial, below, near, true, valid
from restshape_studies.stability.known_bounds import (
    BALANCE,
    CONDITIONED,
    CONVERGED,
    DIRECT,
    EXACT,
    LAPACK,
    MESHES,
    SOLVED,
    STATIONARY,
    TOLERANCE,
    TONES,
    Known,
    drifted,
)
from restshape_studies.stability.suite import cases, jobs, run_apart, run_case
from sample_applications import verification

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.policy import POLICIES

KNOWN = cases()


PLAYED = [
    pytest.param(name, policy, marks=[pytest.mark.weekly] if policy in KNOWN[name].weekly else [])
    for name, policy in jobs(KNOWN, [], [])
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "policy"), PLAYED)
def test_case(tmp_path, name, policy):
    case = KNOWN[name]
    row = run_case(name, case, Trial(tmp_path, policy, case.share))
    assert row["holds"], [s for s in row["statements"] if not s["holds"]]
    assert all(s["must"] for s in row["statements"])
    # Of several policies the one that solves least exactly says what bounds are for.
    least = "thesis" if "thesis" in case.policies else policy
    assert policy != least or not loose(row["statements"]), "bounds are far above what is reached: docs/stability.md"
    assert str(tmp_path) not in json.dumps(row, allow_nan=False)


COUNTS, LOOSE = 1.0, 3e-4
"""Bounds from the first on are counts; of others that give no reason the second is reached: rounding of one processor
is several times that of another."""

NUMBER = re.compile(r"\d[\d.]*(e[+-]?\d+)?")


def loose(statements):
    """Statements whose bounds say nothing of what is reached: without a reason, and all their values are far below.

    Those with the same words count together, such as those of plates of several sizes.
    """
    found = {}
    for one in statements:
        if one["bound"] is not None and 0.0 < one["bound"] < COUNTS and not one["why"]:
            words = NUMBER.sub("1", one["must"])
            _, bound, value = found.get(words, ("", 0.0, 0.0))
            found[words] = one["must"], max(bound, one["bound"]), max(value, abs(one["value"]))
    return {must: value for must, bound, value in found.values() if value < LOOSE * bound}


def test_bounds_that_say_nothing_are_found():
    made = [below("a", 1e-9, 1e-2), below("b", 1e-3, 1e-2), near("c", 1.0, 1.0, 1e-3), below("d", 0.0, 1e-6)]
    made += [below("e", 0, 20), below("f", 1e-9, Known(1e-4, "so")), true("g", True), below("h", 0.0, 0.0)]
    made += [below("a", 1e-3, 1e-2)]
    assert loose(map(asdict, made)) == {"c within 0.001": 0.0, "d at most 1e-06": 0.0}


def test_bounds_that_follow_from_something_say_so():
    for bound in (EXACT, DIRECT, CONDITIONED, LAPACK, TONES, TOLERANCE, STATIONARY, BALANCE, MESHES, drifted(100)):
        stated = below("a", 0.0, bound)
        assert stated.why == bound.why and len(stated.why) > 20 and stated.bound == float(bound)
        assert type(stated.bound) is float
    assert near("a", 1.0, 1.0, CONVERGED).why == below("a", 0.0, SOLVED).why == ""


def test_every_case_says_what_it_is():
    for name, case in KNOWN.items():
        assert case.summary.endswith(".") and len(case.summary) > 20, name
        assert set(case.exempt) <= set(POLICIES) and "auto" not in case.exempt, name
        assert not set(case.exempt) & set(case.policies) and 0 < case.share <= 1, name


def test_wrong_numbers_fail():
    nan, inf = float("nan"), float("inf")
    assert not below("x", nan, 1).holds and not below("x", inf, 1).holds and below("x", 1, 1).holds
    assert near("x", [1.0, 2.02], [1.0, 2.0], 0.011).holds and not near("x", [1.0, 2.03], [1.0, 2.0], 0.011).holds
    assert not near("x", [], [], 1).holds and not near("x", nan, 1.0, 1).holds and near("x", 1e-3, 0.0, 1e-2).holds
    rows = [{"refused": "", "q_a": 1.0, "residual": 0.0}, {"refused": "why", "q_a": nan, "residual": nan}]
    assert [s.holds for s in valid(rows, 1, 1e-6)] == [True, True, True]
    assert [s.holds for s in valid(rows, 0)] == [True, False]
    rows[0]["q_a"] = nan
    assert not next(iter(valid(rows, 1))).holds


def shown_text(monkeypatch, **made):
    """The rows of cases made up here, by name."""
    monkeypatch.setattr(verification, "HARD", {name: Case(run) for name, run in made.items()})
    return cases()


def test_a_case_that_fails_ends_with_1(monkeypatch, tmp_path):
    def good(trial):
        """Good."""
        return [true("so", True)]

    def bad(trial):
        """Bad."""
        return [true("first", True), below("second", 2.0, 1.0)]

    def refused(trial):
        """Refused."""
        raise UserError("no", "there", "that")

    known = shown_text(monkeypatch, good=good, bad=bad, refused=refused)
    rows = {n: run_case(n, known[f"plane.{n}"], Trial(tmp_path)) for n in ("good", "bad", "refused")}
    assert [row["holds"] for row in rows.values()] == [True, False, False]
    assert rows["bad"]["must"] == "second at most 1" and rows["bad"]["value"] == 2.0
    assert "there: no" in rows["refused"]["value"]


@pytest.mark.slow
def test_command(tmp_path, capfd):
    words = ["stability", "--case", "plane.still", "--case", "plane.jump", "--policy", "thesis"]
    assert main([*words, "--json", str(tmp_path / "a.json")]) == 0
    held, left = json.loads((tmp_path / "a.json").read_text())
    assert (held["case"], held["policy"], held["holds"]) == ("plane.still", "thesis", True)
    assert {"must", "value", "statements", "seconds"} <= set(held) and len(held["statements"]) == 1
    assert left["holds"] is None and "two sweeps" in left["left_out"]
    printed = capfd.readouterr().out
    assert "holds     plane.still  thesis" in printed and "1 hold, 0 fail, 1 left out" in printed


def test_the_list_and_names_that_are_not_there(capsys):
    assert main(["stability", "--list"]) == 0
    assert [line.partition(":")[0] for line in capsys.readouterr().out.splitlines()] == list(KNOWN)
    assert main(["stability", "--case", "plane.nothing"]) == 2
    assert "plane.nothing" in capsys.readouterr().err


DYING = """
import os, sys, time
from restshape_studies.stability import suite
from restshape_studies.stability.case import Case, true

def dies(trial):
    "Dies."
    os.kill(os.getpid(), 11)

def hangs(trial):
    "Hangs."
    while True:
        time.sleep(1.0)

suite.cases = lambda: {"dies": Case(dies), "hangs": Case(hangs), "good": Case(lambda trial: [true("so", True)])}
from restshape_studies.stability.case_process import main
main()
"""


@pytest.mark.cli
def test_a_case_that_kills_or_hangs_its_process_fails_alone(tmp_path, monkeypatch):
    (tmp_path / "dying_cases.py").write_text(DYING)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path) + os.pathsep + os.environ.get("PYTHONPATH", ""))
    monkeypatch.setattr("restshape_studies.stability.suite.PROCESS", "dying_cases")
    rows = run_apart([(name, "auto") for name in ("dies", "good", "hangs", "good")], 1.5, 1.0, 60.0, (), lambda r: None)
    assert [row["holds"] for row in rows] == [False, True, False, True]
    assert "reported nothing for 1.5 s" in rows[2]["value"]


@pytest.mark.slow
def test_no_more_time(monkeypatch, tmp_path):
    rows = run_apart([("plane.still", "auto")], 30.0, 1.0, 0.0, (), lambda row: None)
    assert rows[0]["holds"] is None and "0 s" in rows[0]["left_out"]


@pytest.mark.mpi
def test_no_more_time_on_two_ranks(tmp_path, on_ranks):
    words = ("stability", "--case", "plane.still", "--case", "plane.jump", "--policy", "auto", "--seconds")
    done = on_ranks(2, *words, "0", "--json", "a.json")
    assert done.returncode == 0 and "0 hold, 0 fail, 2 left out" in done.stdout, done.stdout + done.stderr
    rows = json.loads((tmp_path / "a.json").read_text())
    assert [row["left_out"] for row in rows] == ["no more than 0 s were wanted"] * 2
    # The first one begins, and takes longer than that.
    done = on_ranks(2, *words, "0.001")
    assert done.returncode == 0 and "0 fail" in done.stdout, done.stdout + done.stderr
    assert done.stdout.count("left out  ") >= 1
