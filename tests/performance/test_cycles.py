"""Cloth that cycles for ever with contact as in the author's program, and what cures it."""

import pytest
from restshape_apps.couture import cycles

STEPS = 150


@pytest.fixture(scope="module")
def courses():
    return cycles.study(['mesh.size="50 mm"'], STEPS, 2 * STEPS)


def test_either_cause_alone_keeps_the_cloth_moving(courses):
    for name, manner in cycles.MANNERS.items():
        course = courses[name]
        assert course.at_rest == (not manner.kink and not manner.anew), name
        if not course.at_rest:
            # It moves on and on, however long: not less at the end than in the middle.
            late, middle = (max(course.speeds[part]) for part in (slice(-50, None), slice(100, 150)))
            assert late > 0.3 * middle and late > 1e-2 and min(course.residuals) > 0.1, name


def test_descent_rests_from_the_cycle(courses):
    assert courses[cycles.OURS].at_rest and courses[cycles.OURS].residuals[-1] <= cycles.REST
