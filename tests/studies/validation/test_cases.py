"""Every validation case of every application passes, and a wrong value fails."""

import json

import pytest
from petsc4py import PETSc
from restshape_studies.validation.case import Check
from restshape_studies.verification import verifications

from restshape.application import applications
from restshape.cli.main import main

CASES = {
    f"{app}.{name}": case for app, known in verifications().items() for name, case in known.load_validation().items()
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_case(name):
    checks = CASES[name](PETSc.COMM_WORLD)
    assert checks
    for check in checks:
        assert check.passed, check
        assert check.source and (check.tolerance <= 0.1 or "which locks" in check.quantity)


def test_errors_are_relative_or_absolute():
    assert Check("a", 1.02, 1.0, 0.021, "here").passed and not Check("a", 1.02, 1.0, 0.019, "here").passed
    assert Check("a", -1e-9, 0.0, 1e-8, "here").error == 1e-9
    assert Check("a", -3.3, -3.0, 0.2, "here").error == pytest.approx(0.1)
    assert not Check("a", float("nan"), 1.0, 0.1, "here").passed


def test_command(tmp_path, capsys):
    assert main(["validate", "--case", "plane.patch", "--json", str(tmp_path / "a.json")]) == 0
    (row,) = json.loads((tmp_path / "a.json").read_text())
    assert set(row) == {"case", "quantity", "value", "reference", "source", "error", "tolerance", "passed"}
    assert row["case"] == "plane.patch" and row["passed"] is True and row["error"] < 1e-12
    assert "passed" in capsys.readouterr().out


def test_a_failing_check_ends_with_1(monkeypatch, capsys, tmp_path):
    cases = verifications()["plane"].load_validation()
    wrong = Check("tip [m]", 1.0, 1.1, 0.01, "a beam that is not there")
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
