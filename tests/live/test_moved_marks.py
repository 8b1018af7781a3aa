"""Marks go with the deformed shape that is drawn, also those that do not say how."""

import numpy as np

from restshape.live import moved_marks
from restshape.live.frame_arrays import PicturePart, sent_points
from restshape.live.moved_marks import MovedMarks
from restshape.live.shown_marks import Arrows, Lines, Words

POINTS = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
CELLS = np.array([[0, 1, 2], [0, 2, 3]], dtype="<u4")
SLOPES = np.array([[0.1, -0.2, 0.3], [0.05, 0.4, -0.1]])


def shape(**arrays: np.ndarray) -> PicturePart:
    """A rectangle whose displacement is linear."""
    moved = sent_points(POINTS @ SLOPES)
    known = {"points": sent_points(POINTS), "cells": CELLS, "displacement": moved} | arrays
    return PicturePart("shape", "surface", "shape", known)


def test_marks_have_the_displacement_of_the_shape_where_they_are():
    at = np.array([[0.5, 0.4], [1.7, 0.1], [0.3, 0.9]])
    given = [Lines("a", at, (0,)), Arrows("b", at, at, "N"), Words("c", at[0]), Words("no place")]
    lines, arrows, word, nowhere = MovedMarks()(given, [shape()])
    for moved in (lines.moved, arrows.moved):
        np.testing.assert_allclose(moved, at @ SLOPES, atol=1e-7)
    np.testing.assert_allclose(word.moved, at[0] @ SLOPES, atol=1e-7)
    assert nowhere.moved is None


def test_marks_that_say_how_they_move_or_where_the_shape_should_be_stay_as_they_are():
    own = Lines("own", POINTS, (0,), moved=np.ones((4, 2)))
    goal = Lines("goal", POINTS, (0,), "goal")
    assert [*MovedMarks()([own, goal], [shape()])] == [own, goal]
    beside = Lines("beside", np.array([[2.5, 1.2]]), (0,))
    np.testing.assert_allclose(MovedMarks()([beside], [shape()])[0].moved, POINTS[2:3] @ SLOPES, atol=1e-7)
    still = PicturePart("shape", "surface", "shape", {"points": sent_points(POINTS)})
    assert MovedMarks()([beside], [still]) == [beside]


def test_what_stays_is_the_same_object_and_follows_when_the_shape_moves():
    follow, part, mark = MovedMarks(), shape(), Words("here", (1.0, 0.5))
    (first,) = follow([mark], [part])
    assert follow([mark], [part])[0] is first
    (then,) = follow([mark], [shape(displacement=sent_points(2.0 * POINTS @ SLOPES))])
    np.testing.assert_allclose(then.moved, 2.0 * np.array(first.moved), atol=1e-7)


def test_a_place_that_goes_to_another_triangle_is_found_again():
    follow = MovedMarks()
    for place in ((1.7, 0.1), (1.6, 0.2), (0.3, 0.9), (0.2, 0.95), (1.7, 0.1)):
        (word,) = follow([Words("here", place)], [shape(displacement=sent_points(POINTS @ SLOPES))])
        np.testing.assert_allclose(word.moved, np.array(place) @ SLOPES, atol=1e-7)
    few = {"points": sent_points(POINTS[:3]), "cells": CELLS[:1], "displacement": sent_points(POINTS[:3] @ SLOPES)}
    (word,) = follow([Words("here", (1.5, 0.5))], [shape(**few)])
    np.testing.assert_allclose(word.moved, np.array((1.5, 0.5)) @ SLOPES, atol=1e-7)


def test_in_space_a_mark_goes_with_the_nearest_node_however_many_points_it_has(monkeypatch):
    dice = np.random.default_rng(4)
    X, moved, at = dice.random((40, 3)), dice.random((40, 3)), dice.random((9, 3))
    part = PicturePart("shape", "surface", "shape", {"points": X, "cells": CELLS, "displacement": moved})
    nearest = ((at[:, None] - X) ** 2).sum(axis=2).argmin(axis=1)
    for most in (moved_marks.AT_ONCE, 0):
        monkeypatch.setattr(moved_marks, "AT_ONCE", most)
        lines, word = MovedMarks()([Lines("a", at, (0,), words=["b"]), Words("c", at[3])], [part])
        np.testing.assert_array_equal(lines.moved, moved[nearest])
        assert list(word.moved) == moved[nearest[3]].tolist() and lines.words == ["b"]


def test_the_nearest_nodes_of_all_marks_are_found_at_once(monkeypatch):
    dice = np.random.default_rng(4)
    X, moved = dice.random((40, 3)), dice.random((40, 3))
    part = PicturePart("shape", "surface", "shape", {"points": X, "cells": CELLS, "displacement": moved})
    looks, nearest = [], moved_marks._DrawnShape._nearest
    monkeypatch.setattr(
        moved_marks._DrawnShape, "_nearest", lambda self, places: (looks.append(len(places)), nearest(self, places))[1]
    )
    # A place in the plane is one at z = 0.
    given = [Lines("a", X[:3], (0,)), Words("b", (0.5, 0.5)), Arrows("c", X[3:5], X[3:5], "N"), Words("none")]
    lines, word, arrows, none = MovedMarks()(given, [part])
    assert looks == [6] and none.moved is None
    np.testing.assert_array_equal(np.vstack([lines.moved, arrows.moved]), moved[:5])
    assert list(word.moved) == moved[((X - [0.5, 0.5, 0.0]) ** 2).sum(axis=1).argmin()].tolist()
