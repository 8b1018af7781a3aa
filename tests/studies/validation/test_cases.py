"""Every validation case of every application passes, and a wrong value fails; tolerances say what is reached."""

import json
import sys
from collections import defaultdict
from importlib import import_module
from importlib.util import find_spec
from typing import get_args

import pytest
from petsc4py import PETSc
from restshape_studies.each_week import daily_values
from restshape_studies.validation.case import CLOSED_FORM, OWN, REFERENCE_KINDS, ROUNDING, Case, Check, Kind
from restshape_studies.verification import verifications

from restshape.application import applications
from restshape.cli.main import main

CASES = {
    f"{app}.{name}": case for app, known in verifications().items() for name, case in known.load_validation().items()
}


LOOSE = 1e-3
"""The least share of a tolerance that the largest error of the rows with this tolerance in a case may have."""


def own_comparisons() -> dict[str, Case]:
    """What applications compare with restshape's own values, which is no validation."""
    names = [f"restshape_verification.{app}.comparisons" for app in verifications()]
    modules = {name: import_module(name) for name in names if find_package(name) and find_spec(name)}
    return {
        f"{module.split('.')[1]}.{name}": case
        for module, found in modules.items()
        for name, case in found.COMPARISONS.items()
    }


def find_package(module: str) -> bool:
    """Whether the package of a module is there: applications of the tests have none."""
    return find_spec(module.rpartition(".")[0]) is not None


COMPARISONS = own_comparisons()


def loose(checks: list[Check]) -> list[str]:
    """What rows whose tolerance says nothing of what is reached are: their largest error is far below it.

    One row may be right by chance, so those of a case with the same tolerance count together. Rounding is exempt: how
    much of it there is depends on the processor.
    """
    groups = defaultdict(list)
    for check in checks:
        if check.tolerance > ROUNDING:
            groups[check.tolerance].append(check)
    return [
        f"{found[0].quantity} and {len(found) - 1} more: {tolerance:g}"
        for tolerance, found in groups.items()
        if max(check.error for check in found) < LOOSE * tolerance
    ]


def played(cases):
    """Cases, and the values of their modules that make them short: those of a week run as they are then."""
    for name, case in cases.items():
        daily = daily_values(case)
        if daily != {}:
            yield pytest.param(name, daily or {}, id=name)
        if daily is not None:
            yield pytest.param(name, {}, marks=[pytest.mark.weekly], id=f"{name}-whole")


def run(case, values, monkeypatch):
    """The rows of a case with other values of its module."""
    for name, value in values.items():
        monkeypatch.setattr(sys.modules[case.__module__], name, value)
    return case(PETSc.COMM_WORLD)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "values"), list(played(CASES)))
def test_case(name, values, monkeypatch):
    checks = run(CASES[name], values, monkeypatch)
    assert checks
    for check in checks:
        assert check.passed, check
        assert check.source and check.tolerance <= 0.1
        assert check.kind in REFERENCE_KINDS, f"{check.quantity} is no validation"
    assert loose(checks) == [], "set these tolerances again: docs/validation.md"


@pytest.mark.slow
@pytest.mark.parametrize(("name", "values"), list(played(COMPARISONS)))
def test_comparison_with_own_values(name, values, monkeypatch):
    checks = run(COMPARISONS[name], values, monkeypatch)
    assert checks
    for check in checks:
        assert check.passed and check.kind == OWN, check


def test_own_values_are_no_references():
    assert {*REFERENCE_KINDS, OWN} == set(get_args(Kind)) and OWN not in REFERENCE_KINDS


def test_a_tolerance_that_says_nothing_is_found():
    def check(error, tolerance):
        return Check("a", 1.0 + error, 1.0, tolerance, "here", CLOSED_FORM)

    assert loose([check(1e-9, 1e-3), check(1e-5, 1e-3)]) == []
    assert loose([check(1e-9, 1e-3), check(1e-8, 1e-3), check(1e-4, 1e-2)]) == ["a and 1 more: 0.001"]
    assert loose([check(0.0, ROUNDING), check(0.0, 0.0)]) == []


def test_errors_are_relative_or_absolute():
    def made(value, reference, tolerance):
        return Check("a", value, reference, tolerance, "here", CLOSED_FORM)

    assert made(1.02, 1.0, 0.021).passed and not made(1.02, 1.0, 0.019).passed
    assert made(-1e-9, 0.0, 1e-8).error == 1e-9
    assert made(-3.3, -3.0, 0.2).error == pytest.approx(0.1)
    assert not made(float("nan"), 1.0, 0.1).passed


def test_command(tmp_path, capsys):
    assert main(["validate", "--case", "plane.patch", "--json", str(tmp_path / "a.json")]) == 0
    (row,) = json.loads((tmp_path / "a.json").read_text())
    assert set(row) == {"case", "quantity", "value", "reference", "source", "kind", "error", "tolerance", "passed"}
    assert row["case"] == "plane.patch" and row["passed"] is True and row["error"] < 1e-12
    assert "passed" in capsys.readouterr().out


def test_a_failing_check_ends_with_1(monkeypatch, capsys, tmp_path):
    cases = verifications()["plane"].load_validation()
    wrong = Check("tip [m]", 1.0, 1.1, 0.01, "a beam that is not there", CLOSED_FORM)
    monkeypatch.setitem(cases, "patch", lambda comm: [wrong])
    assert main(["validate", "--case", "plane.patch", "--json", str(tmp_path / "a.json")]) == 1
    assert "FAILED" in capsys.readouterr().out
    assert json.loads((tmp_path / "a.json").read_text())[0]["passed"] is False


def test_a_case_that_is_not_there(capsys):
    assert main(["validate", "--case", "plane.nothing"]) == 2
    assert "plane.patch" in capsys.readouterr().err


def test_a_case_of_an_application_that_is_not_installed(monkeypatch, capsys):
    known = {name: app for name, app in applications().items() if name != "plane"}
    monkeypatch.setattr("restshape_studies.verification.applications", lambda: known)
    found = {name: case for name, case in verifications().items() if name in known}
    monkeypatch.setattr("restshape_studies.verification.verifications", lambda: found)
    name = next(name for name in CASES if name.startswith("plane."))
    assert main(["validate", "--case", name]) == 2
    assert "'plane' is not installed" in capsys.readouterr().err
    assert main(["validate", "--list"]) == 0 and "plane." not in capsys.readouterr().out


def test_the_list_names_all_cases(capsys):
    assert main(["validate", "--list"]) == 0
    reported = capsys.readouterr().out.splitlines()
    assert [line.partition(":")[0] for line in reported] == list(CASES) and all(
        line.partition(": ")[2] for line in reported
    )
