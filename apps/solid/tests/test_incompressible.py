"""Nearly incompressible bodies: what locks is seen to lock, and the plan's element is not."""

import pytest
from petsc4py import PETSc
from restshape_verification.solid.incompressible import incompressible, table


def test_first_order_locks_and_the_mean_dilatation_does_not():
    rows = {(row["element"], row["size"]): row for row in table((3.0, 1.5), PETSc.COMM_WORLD)}
    assert rows["order 1", 3.0]["error"] < -0.2 and rows["order 1", 1.5]["error"] < -0.1
    assert abs(rows["order 2, mean dilatation", 3.0]["error"]) < 0.005
    assert abs(rows["order 2, mean dilatation", 1.5]["error"]) < 0.001
    # Against first order with as many unknowns, not as many triangles.
    alike = rows["order 2, mean dilatation", 3.0]["unknowns"], rows["order 1", 1.5]["unknowns"]
    assert alike[0] == pytest.approx(alike[1], rel=0.1)


@pytest.mark.slow
def test_the_case_lists_elements_of_second_order_on_every_mesh():
    checks = incompressible(PETSc.COMM_WORLD)
    assert all(check.passed for check in checks)
    names = [check.quantity for check in checks]
    for element in ("order 2, size", "order 2, mean dilatation,"):
        own = [check for check, name in zip(checks, names) if element in name]
        assert len(own) == 4 and own[0].error > own[-1].error
    # What locks has no tolerance that would mean anything: the test above has it.
    assert not any("order 1" in name for name in names)
