"""Distances between a goal and deformed edges, against closed forms."""

import numpy as np
import pytest
from small_scenes import BLOCK, CLAMPED, HEAD, STEEL, make_replay, rows_of

from restshape import _kernels
from restshape.errors import UserError
from restshape.physics.elasticity.goal import Goal
from restshape.physics.elasticity.target_curves import CurveDistances, GoalDistance, goal_curve
from restshape.scene.load import load_scene

MESH = "\n[mesh]\nsize = 0.1\n"


def edge(n=40):
    """Nodes and facets of the edge from (0, 0) to (1, 0)."""
    x = np.column_stack([np.linspace(0.0, 1.0, n + 1), np.zeros(n + 1)])
    return x, np.column_stack([np.arange(n), np.arange(1, n + 1)]).astype(np.int32)


def test_distances_from_pieces_are_those_of_geometry():
    starts, ends = np.array([[0.0, 0.0], [5.0, 5.0]]), np.array([[1.0, 0.0], [5.0, 5.0]])
    points = np.array([[0.5, 2.0], [-3.0, 4.0], [4.0, 4.0], [2.0, 1.0]])
    np.testing.assert_allclose(_kernels.distances(points, starts, ends), [2.0, 5.0, np.sqrt(2), np.sqrt(2)], rtol=1e-15)


@pytest.mark.parametrize(("take", "found"), [("mean", 0.25), ("max", 0.25)])
def test_a_parallel_goal_is_as_far_as_it_is_moved(take, found):
    x, facets = edge()
    distance = GoalDistance(CurveDistances(Goal(polyline=[(0.0, 0.25), (1.0, 0.25)]), facets), take)
    assert distance(x) == pytest.approx(found, rel=1e-12)


def test_what_the_goal_does_not_reach_counts_as_well_as_what_does_not_reach_it():
    x, facets = edge()
    # Half of the edge lies on the goal, the other half is up to 1/2 away: 1/8 in the mean, and 0 the other way.
    short = Goal(polyline=[(0.0, 0.0), (0.5, 0.0)])
    assert GoalDistance(CurveDistances(short, facets), "mean")(x) == pytest.approx(1 / 16, rel=1e-12)
    assert GoalDistance(CurveDistances(short, facets), "max")(x) == pytest.approx(0.5, rel=1e-12)
    # Of the longer goal 2 of 3 are beyond the edge, up to 2 away: 2/3 in the mean, and 0 the other way.
    long = Goal(polyline=[(0.0, 0.0), (3.0, 0.0)])
    assert GoalDistance(CurveDistances(long, facets), "mean")(x) == pytest.approx(1 / 3, rel=1e-3)
    assert GoalDistance(CurveDistances(long, facets), "max")(x) == pytest.approx(2.0, rel=1e-12)


def test_an_edge_of_unequal_facets_has_the_same_mean():
    x, facets = edge()
    bent = Goal(polyline=[(0.0, 0.1), (1.0, 0.3)])
    uneven = np.column_stack([x[:, 0] ** 2, x[:, 1]])
    even = GoalDistance(CurveDistances(bent, facets), "mean")
    assert even(uneven) == pytest.approx(even(x), rel=1e-3)


def test_second_order_facets_count_their_middles():
    x = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.2]])
    goal = Goal(polyline=[(0.0, 0.0), (0.5, 0.2), (1.0, 0.0)])
    side = CurveDistances(goal, np.array([[0, 1, 2]], dtype=np.int32))
    assert GoalDistance(side, "mean")(x) == pytest.approx(0.0, abs=1e-15)


def test_a_goal_goes_through_its_points():
    points = [(0.0, 0.0), (1.0, 0.4), (3.0, 0.0), (3.5, -1.0)]
    for goal in (Goal(spline=points), Goal(polyline=points)):
        curve = goal_curve(goal)
        for point in points:
            assert np.hypot(*(curve - point).T).min() < 1e-12


def test_the_quantity_measures_the_deformed_edge(tmp_path):
    """The block is carried up by 20 mm as a whole: the mean distance from a goal 50 mm above it is 30 mm."""
    wall = "\n[supports.held]\non = 'all'\nfix = { x = 0, y = '20 mm' }\n"
    goal = "\n[goal.roof]\npolyline = [[1, 1.05], ['500 mm', 1.05], [0, 1.05]]\n"
    watched = "\n[quantities]\nmiss = { distance = 'roof', at = 'top' }\n"
    watched += "far = { distance = 'roof', at = 'outline', reduce = 'max' }\n"
    path = tmp_path / "block.toml"
    path.write_text(HEAD + BLOCK.format(width=1, height=1) + STEEL + wall + goal + watched + MESH)
    row = rows_of(make_replay(path))[0]
    assert row["q_miss"] == pytest.approx(0.03, rel=1e-9)
    assert row["q_far"] == pytest.approx(1.03, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[goal.g]\npolyline = [[0, 0], [1, 0]]\n[quantities]\nd = { distance = 'h' }", "there is no goal 'h'"),
        ("[goal.g]\npolyline = [[0, 0]]", "polyline"),
        ("[goal.g]\npolyline = [[0, 0], [1, 0]]\nspline = [[0, 0], [1, 0]]", "exactly one of spline, polyline"),
        ("[goal.g]\nspline = [[0, 0], [0, 0]]", "are the same"),
        (
            "[goal.g]\nspline = [[0, 0], [1, 0]]\n[quantities]\nd = { distance = 'g', reduce = 'sum' }",
            '"mean" or "max"',
        ),
    ],
)
def test_goals_that_make_no_sense_are_refused(tmp_path, text, says):
    path = tmp_path / "block.toml"
    path.write_text(HEAD + BLOCK.format(width=1, height=1) + STEEL + CLAMPED + f"\n{text}\n" + MESH)
    with pytest.raises(UserError, match=says):
        load_scene(path)


def test_distances_of_the_last_places_serve_twice_and_no_others():
    side = CurveDistances(Goal(polyline=[(0.0, 0.0), (1.0, 0.0)]), np.array([[0, 1]], dtype=np.int32))
    x = np.array([[0.0, 0.5], [1.0, 0.5]])
    found = side(x)
    assert side(x.copy()) is found
    x[:, 1] = 0.25
    np.testing.assert_allclose(side(x)[0], 0.25)
