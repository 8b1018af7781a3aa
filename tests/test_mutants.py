"""Planted faults: each fits its file and names a test; once a week each is planted, and must be noticed."""

import ast
import sys
from dataclasses import replace
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SCRIPT = ROOT / "scripts" / "mutants.py"
LEAST = 40
"""Faults that are planted at least."""


@pytest.fixture(scope="module")
def mutants():
    """The script as a module."""
    spec = spec_from_file_location("mutants", SCRIPT)
    module = sys.modules[spec.name] = module_from_spec(spec)
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


@pytest.mark.slow
def test_every_fault_fits_its_file_and_names_a_test(mutants):
    known = mutants.mutants()
    assert len(known) >= LEAST
    assert len({one.name for one in known}) == len(known)
    assert {one.group for one in known} >= {"analyses", "derivatives", "fem", "kernels", "mesh", "replay", "scene"}
    assert [(one.name, problem) for one in known if (problem := one.problem(ROOT))] == []


@pytest.mark.slow
def test_no_fault_waits_for_a_test_of_a_week(mutants):
    for one in mutants.mutants():
        path, *_, name = one.test.split("::")
        for node in ast.walk(ast.parse((ROOT / path).read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef) and node.name == name:
                assert not [mark for mark in node.decorator_list if "weekly" in ast.unparse(mark)], one.test


def test_outdated_faults_are_found(mutants):
    one = mutants.mutants()[0]
    assert "0 times" in replace(one, text=f"{one.text} that is not there").problem(ROOT)
    assert "is not there" in replace(one, file="lib/nowhere.py").problem(ROOT)
    assert "changes nothing" in replace(one, replacement=one.text).problem(ROOT)
    assert "has no test" in replace(one, test=f"{one.test}_of_nothing").problem(ROOT)
    assert "no test is named" in replace(one, test=one.test.partition("::")[0]).problem(ROOT)


def test_a_planted_fault_is_taken_out_again(mutants, tmp_path):
    one = mutants.mutants()[0]
    path = tmp_path / one.file
    path.parent.mkdir(parents=True)
    path.write_bytes((ROOT / one.file).read_bytes())
    before = path.stat().st_mtime_ns
    with mutants.planted(one, tmp_path):
        assert one.text not in path.read_text() and one.replacement in path.read_text()
    assert path.read_bytes() == (ROOT / one.file).read_bytes()
    assert path.stat().st_mtime_ns == before


def test_the_committed_table_is_of_the_faults_that_there_are(mutants):
    committed = mutants.TABLE.read_text(encoding="utf-8")
    assert mutants.table({one.name: mutants.CAUGHT for one in mutants.mutants()}) == committed


def test_rows_that_were_not_run_stay(mutants, tmp_path, monkeypatch):
    monkeypatch.setattr(mutants, "TABLE", tmp_path / "mutants.md")
    first, second, *_ = mutants.mutants()
    mutants.TABLE.write_text(mutants.table({first.name: mutants.MISSED, second.name: mutants.CAUGHT}))
    after = mutants.table({first.name: mutants.CAUGHT})
    assert f"| {first.fault} |" in after and "MISSED" not in after
    assert "2 were caught" in after and "not run" in after


@pytest.mark.slow
@pytest.mark.cli
def test_a_noticed_fault_and_an_unnoticed_one_are_distinguished(mutants, tmp_path):
    """Of a checkout with one function and two tests, of which one looks at it."""
    (tmp_path / "doubled.py").write_text("def double(x):\n    return 2 * x\n")
    (tmp_path / "test_doubled.py").write_text(
        "from doubled import double\n\n\ndef test_it():\n    assert double(3) == 6\n\n\ndef test_nothing():\n    pass\n"
    )
    one = mutants.Mutant("code", "sum", "it adds", "doubled.py", "2 * x", "2 + x", "test_doubled.py::test_it")
    assert mutants.outcome(one, tmp_path) == (mutants.CAUGHT, "")
    assert mutants.outcome(replace(one, test="test_doubled.py::test_nothing"), tmp_path)[0] == mutants.MISSED
    assert mutants.outcome(replace(one, text="3 * x"), tmp_path)[0] == mutants.OUTDATED
