"""Eigenproblems whose rows three ranks share: factors that count, modes, and ranks that have little or nothing."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

CASES = ("grid", "empty rank", "alone", "pieces", "held")

pytestmark = pytest.mark.mpi


def chain_values(n: int, count: int) -> np.ndarray:
    """Eigenvalues of a free chain of unit springs, that of the rigid motion left out (closed form)."""
    return 4.0 * np.sin(np.arange(1, count + 1) * np.pi / (2 * n)) ** 2


@pytest.fixture(scope="module")
def found(tmp_path_factory, outside):
    program = str(Path(__file__).with_name("eigen_ranks_program.py"))
    command = ["mpiexec", "-n", "3", sys.executable, program]
    folder = tmp_path_factory.mktemp("ranks")
    done = subprocess.run(command, cwd=folder, env=outside, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize("kind", ["mumps", "plain"])
@pytest.mark.parametrize("case", CASES)
def test_a_shared_factor_solves_and_counts_as_lapack_does(found, kind, case):
    factor = found[kind][case]
    assert factor["counts"] == factor["expected"] and max(factor["counts"]) > 0
    assert factor["error"] < 1e-11 and factor["same"]


@pytest.mark.parametrize("kind", ["mumps", "plain"])
def test_a_shift_that_is_an_eigenvalue_is_refused_on_all_ranks(found, kind):
    assert found[kind]["refused"]


def test_what_is_too_large_is_refused_on_all_ranks_and_more_memory_is_tried(found):
    border, inside, then = found["too large"]
    assert "12 unknowns couple the parts of 3 ranks" in border and "coarser mesh" in border
    assert "more memory than a rank has" in inside
    assert then == "factored: 3"


@pytest.mark.parametrize("method", ["direct", "auto", "ilu"])
def test_modes_of_shared_matrices_are_those_of_the_closed_form(found, method):
    near = {"first": 1.0, "near": 1.01}
    for name, size in near.items():
        one = found["solved"][method]["chain"][name]
        assert one["values"] == pytest.approx(size * chain_values(24, 4), rel=1e-9)
        # The thesis's method never counts, and from nothing a factor below all of them counts none.
        assert method != "auto" or name == "near" or one["checked"]


@pytest.mark.parametrize("method", ["direct", "auto", "ilu"])
def test_pieces_that_ranks_have_alone_have_the_modes_of_each(found, method):
    values = np.sort(np.concatenate([size * chain_values(10, 4) for size in (1.0, 1.7, 2.3)]))[:4]
    assert found["solved"][method]["pieces"]["near"]["values"] == pytest.approx(1.01 * values, rel=1e-9)


def test_products_with_many_rows_are_those_of_the_whole_matrix(found):
    assert max(found["multiplied"]) < 1e-12


def test_load_factors_of_shared_matrices_are_those_of_lapack(found):
    assert found["buckled"][0] < 1e-9


def test_more_ranks_than_elements(found):
    shared, alone = found["tiny"]
    assert len(alone) == 2 and shared == pytest.approx(alone, rel=1e-8)


def test_all_ranks_come_to_the_same_bits(found):
    assert found["alike"]
