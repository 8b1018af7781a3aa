"""Complete factors in blocks of nodes that three ranks share, one of which has nothing."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.mpi


@pytest.fixture(scope="module")
def found(tmp_path_factory, outside):
    program = str(Path(__file__).with_name("shared_solves_program.py"))
    command = ["mpiexec", "-n", "3", sys.executable, program]
    folder = tmp_path_factory.mktemp("ranks")
    done = subprocess.run(command, cwd=folder, env=outside, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize(("case", "most"), [("definite", 1e-12), ("indefinite", 1e-5), ("single", 1e-9)])
def test_a_shared_factor_in_blocks_of_nodes_solves_and_counts(found, case, most):
    """Without exchanges of rows indefinite matrices are solved less exactly; their eigenvalues are counted."""
    one = found[case]
    assert one["below"] == one["expected"]
    assert one["left"] < most and one["same"]


def test_as_a_preconditioner_it_takes_up_other_patterns_and_ends_where_there_is_no_factor(found):
    first, other, none = found["taken"]
    assert 0 < first <= 2 and 0 < other <= 2 and none == -1


def test_a_matrix_is_definite_if_all_of_it_is_and_not_where_the_ranks_own_rows_are(found):
    """By the solver, and by the pivots of own rows, which show nothing here."""
    assert found["believed"] == {"definite": [True, True], "indefinite": [False, True]}


def test_panels_substitute_as_rows_do(found):
    by_rows, single, double = found["panels"]
    assert by_rows < 1e-12 and double < 1e-12 and 1e-9 < single < 1e-5


def test_no_copy_of_the_matrix_is_made(found):
    """What is held hangs on unknowns and the border alone, and a refresh takes no more; the last rank has nothing."""
    for now, most, again in found["held"][:-1]:
        assert now < 0.12 and most < 0.25 and again < 0.25


def test_ranks_choose_a_factor_that_they_share_and_keep_it(found):
    """Its first solve takes one application, as that of one rank does; an old factor iterates, to the tolerance."""
    chosen = found["chosen"]
    assert chosen["name"] == "cholesky, shared" and chosen["negative"] == 0
    (first, made, exact), (again, kept, old), (other, stale, left), (after, why, _) = chosen["taken"]
    assert first == 1 and made and exact < 1e-10
    assert again <= 2 and not kept and old < 1e-8
    assert 1 <= other < 8 and not stale and left < 1e-8
    assert chosen["definite"] == [True, False]
    # A node that nothing holds is told at once, and the next system has its factor again.
    assert "has no factor" in why and after == 1
