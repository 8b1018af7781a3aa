"""Points that stick to bodies which move, turn and grow."""

import numpy as np
import pytest

from restshape.physics.cloth.body_path import between
from restshape.physics.cloth.contact.body_motion import moved_with, turn_of, turned_share, turning_of
from restshape.scene.bodies import Body

POINTS = np.random.default_rng(0).normal(size=(6, 3))


def capsule(start, end, radius=0.1):
    return Body.model_validate({"capsule": {"start": start, "end": end, "radius": radius}})


def plane(normal):
    return Body.model_validate({"plane": {"point": [0.0, 0.0, 0.0], "normal": normal}})


def test_they_move_and_grow_with_a_sphere():
    before = Body.model_validate({"sphere": {"center": [1.0, 0.0, 0.0], "radius": 1.0}})
    after = Body.model_validate({"sphere": {"center": [0.0, 2.0, 0.0], "radius": 3.0}})
    np.testing.assert_allclose(moved_with(before, after, POINTS), 3.0 * (POINTS - [1, 0, 0]) + [0, 2, 0], atol=1e-14)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        # Another coordinate becomes the least one of the axis.
        (capsule([0, 0, 0], [1, 1 - 1e-6, 2]), capsule([0, 0, 0], [1 - 1e-6, 1, 2])),
        (plane([0.0, 0.0, 1.0]), plane([1e-6, 0.0, 1.0])),
        (plane([1.0, 1.0 - 1e-6, 1.0]), plane([1.0, 1.0, 1.0 - 1e-6])),
    ],
)
def test_a_small_turn_takes_them_no_farther(before, after):
    assert np.abs(moved_with(before, after, POINTS) - POINTS).max() < 1e-5


def test_a_turned_capsule_keeps_its_points_on_itself():
    before, after = capsule([0, 0, 0], [0, 0, 2]), capsule([0, 0, 0], [2, 0, 0])
    np.testing.assert_allclose(
        moved_with(before, after, np.array([[0.1, 0, 1], [0, 0.1, 1], [0, 0, 0.5]])),
        [[1, 0, -0.1], [1, 0.1, 0], [0.5, 0, 0]],
        atol=1e-14,
    )


def test_half_a_turn_is_one():
    found = moved_with(plane([0.0, 0.0, 1.0]), plane([0.0, 0.0, -1.0]), POINTS)
    np.testing.assert_allclose(found[:, 2], -POINTS[:, 2], atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), np.linalg.norm(POINTS, axis=1), atol=1e-14)


def test_a_capsule_whose_ends_pass_each_other_does_not_turn():
    """Its ends go straight: it gets shorter until it is a ball, and longer again."""
    before, after = capsule([-1, 0, 0], [1, 0, 0]), capsule([1, 0, 0], [-1, 1e-3, 0])
    assert turning_of(before, after) < 1e-3
    assert np.abs(moved_with(before, after, POINTS) - POINTS).max() < 5e-3
    # An axis that looks the other way of a half-space has turned.
    np.testing.assert_allclose(np.trace(turn_of(plane([0, 0, 1]), plane([0, 0, -1]))), -1.0, atol=1e-12)


def test_a_body_turns_by_all_that_its_numbers_say():
    """By more than half a turn, too, which would be a shorter one the other way."""
    boxes = [{"box": {"center": [0, 0, 0], "half": [1, 1, 1], "rotate": [0, 0, angle]}} for angle in (0.0, 5.0)]
    assert turning_of(*map(Body.model_validate, boxes)) == pytest.approx(5.0)
    assert turning_of(capsule([0, 0, 0], [2, 0, 0]), capsule([0, 0, 0], [0, 3, 0])) == pytest.approx(np.pi / 2)


@pytest.mark.parametrize("lengths", [(2.0, 2.0), (1.0, 3.0)])
@pytest.mark.parametrize("kind", ["capsule", "cylinder", "box"])
def test_a_body_turns_by_even_parts(kind, lengths):
    """Ends of a capsule go straight: on even thirds of its way it would turn by 24, 74 and 53 of 150 degrees."""
    angle = np.radians(150.0)
    if kind == "box":
        forms = [{"center": [0, 0, 0], "half": [1, 1, 1], "rotate": [0, 0, by]} for by in (0.0, angle)]
    else:
        ends = [[lengths[0], 0, 0], [lengths[1] * np.cos(angle), lengths[1] * np.sin(angle), 0]]
        forms = [{"start": [0, 0, 0], "end": end, "radius": 0.1} for end in ends]
    now, after = (Body.model_validate({kind: form}) for form in forms)
    for parts in (3, 2, 1):
        then = between(now, after, turned_share(now, after, parts))
        assert turning_of(now, then) == pytest.approx(angle / 3)
        now = then
    assert now == after
