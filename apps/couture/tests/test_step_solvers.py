"""Solvers of implicit steps on the same systems: by counted iterations, for times are not held."""

import pytest
from restshape_verification.couture.thesis import Falling


@pytest.mark.slow
def test_solvers_of_steps_are_compared_on_the_same_systems():
    cloth = Falling("60 mm")
    table = cloth.compared(1.0 / 200.0, steps=2)
    iterations: dict[str, list[float]] = {}
    for row, _, count, ms in table:
        iterations.setdefault(row, []).append(count)
        assert ms > 0.0
    one, ssor, ilu, stale, fresh, nested = iterations.values()
    # Three tolerances each, of which a factor of the very matrix needs none.
    assert fresh == [1.0, 1.0, 1.0] and all(counts == sorted(counts) for counts in iterations.values())
    # Over-relaxation is hardly another method, and what is left of it by the readings of the matrix is half.
    assert all(a <= b + 1 for a, b in zip(one, ssor))
    # The first system is that of the stale factor.
    assert stale[0] == 1.0 and nested[-1] < ilu[-1] <= ssor[-1]
    assert "nested meshes" in list(iterations)[-1]


@pytest.mark.slow
def test_steps_are_timed_at_either_tolerance():
    cloth = Falling("60 mm")
    assert all(cloth.stepped(1.0 / 200.0, tolerance, steps=3) > 0.0 for tolerance in (1e-2, 1e-6))
