"""Cloth that cycles for ever with contact as in the author's program, and what cures it."""

import pytest
from restshape_verification.couture import cycles

STEPS = 150


@pytest.fixture(scope="module")
def courses():
    return cycles.study(['mesh.size="50 mm"'], STEPS, 2 * STEPS)


@pytest.mark.slow
def test_either_cause_alone_keeps_the_cloth_moving(courses):
    for name, manner in cycles.MANNERS.items():
        course = courses[name]
        if manner.kink or manner.refreshed:
            # It moves on and on: of the same order at the end as a hundred steps before.
            late, earlier = (max(course.speeds[part]) for part in (slice(-50, None), slice(-150, -100)))
            assert not course.converged and late > 0.1 * earlier and late > 1e-2, name
            assert min(course.residuals[-50:]) > 0.1, name


def test_without_both_the_cloth_rests_from_the_cycle(courses):
    checked = next(name for name, manner in cycles.MANNERS.items() if manner.checked)
    for name in (checked, cycles.OURS):
        assert courses[name].converged and courses[name].residuals[-1] <= cycles.REST, name
