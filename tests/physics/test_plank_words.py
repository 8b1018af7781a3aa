"""What is said of a piece that is not valid: it names planks, joints and loads."""

from dataclasses import replace
from math import ceil

import numpy as np
import pytest
from restshape_apps.furniture.pieces import cantilever, scales, shelf_1, table
from restshape_apps.furniture.small_pieces import block, ladder

from restshape.physics.furniture import Furniture
from restshape.physics.plank_words import without_uses
from restshape.shape.planks import Load

G = 9.80665


def words(piece, gamma=None):
    return Furniture(piece).test(gamma).words


def test_a_valid_piece_has_none():
    assert words(cantilever(kilograms=0.3)) == ()


def test_a_weak_joint_is_named_with_its_use():
    # Moment of the load and of the board itself over what three nails bear; it is told rounded up.
    arm, kilograms = 0.19, 1.8
    own = 700.0 * 0.06 * 0.012 * arm * G
    use = (kilograms * G * arm + own * arm / 2) / (0.02 * 5.2e3 * 0.006 * 3)
    assert words(cantilever(arm=arm, kilograms=kilograms)) == (
        f"weak: joint beam on post at {ceil(100 * use) / 100:.2f} of its strength",
    )


def test_two_weak_joints_are_both_named_worst_first():
    piece = scales()
    loads = [replace(load, force=(0.0, 0.0, -G * (1.6 + 0.2 * k))) for k, load in enumerate(piece.weights)]
    (told,) = words(replace(piece, weights=tuple(loads)))
    assert told.startswith("weak: joint right on post at ") and ", left on post at " in told


def test_a_push_is_named_where_it_alone_breaks_or_topples():
    assert words(table(kilograms=30.0)) == ()
    (weak,) = words(table(kilograms=30.0, push=150.0))
    assert weak.startswith("weak: joint ") and weak.endswith(" of its strength under push push")
    nudge = Load("nudge", 0, (0.0, 0.0, 0.5), (500.0, 0.0, 0.0))
    assert words(replace(block(0.2, 0.4, 0.5), pushes=(nudge,)))[0] == "falls under push nudge"


@pytest.mark.parametrize("share", [0.0, 1e-10, 1e-8])
def test_a_push_that_changes_nothing_is_not_named(share: float) -> None:
    # A force down beside the load, in parts of it: a moment, and so a use, that is larger by about as much.
    piece = cantilever(arm=0.19, kilograms=1.8)
    nudge = Load("nudge", 2, piece.weights[0].place, (0.0, 0.0, -share * 1.8 * G))
    (told,) = words(replace(piece, pushes=(nudge,)))
    assert told.endswith(" of its strength")


@pytest.mark.parametrize("share", [1e-4, 0.2])
def test_a_push_that_makes_a_weak_joint_worse_is_named(share: float) -> None:
    arm, kilograms = 0.19, 1.8
    piece = cantilever(arm=arm, kilograms=kilograms)
    nudge = Load("nudge", 2, piece.weights[0].place, (0.0, 0.0, -share * kilograms * G))
    own = 700.0 * 0.06 * 0.012 * arm * G
    use = ((1 + share) * kilograms * G * arm + own * arm / 2) / (0.02 * 5.2e3 * 0.006 * 3)
    (told,) = words(replace(piece, pushes=(nudge,)))
    assert told == f"weak: joint beam on post at {ceil(100 * use) / 100:.2f} of its strength under push nudge"


def test_what_falls_by_itself_falls_under_its_weights():
    assert words(ladder(0.5, 0.1))[0] == "falls under its weights"


def test_a_part_that_falls_is_named():
    piece = shelf_1()
    bracket = piece.index("bracket-1")
    cut = replace(piece, joints=tuple(joint for joint in piece.joints if joint.i != bracket))
    told = words(cut)
    assert told[:2] == ("in two parts: upright-1 with 7 more, bracket-1", "falls under its weights: bracket-1")


def test_all_joints_that_are_lost_are_named():
    piece = table()
    gamma = np.zeros((5, 8))
    gamma[1, 1], gamma[3, 1] = -0.155, -0.2
    assert words(piece, gamma)[0] == "lost: leg-1 misses top, leg-3 misses top"
    gamma[:] = 0.0
    gamma[4, 3] = 0.1
    assert words(piece, gamma)[0] == "lost: leg-4 is not flush with top, leg-4 does not stand flat on the floor"


def test_planks_in_each_other_are_named_and_many_are_counted():
    piece = table()
    twins = [replace(piece.planks[1], name=f"twin-{k}") for k in range(3)]
    joints = [replace(piece.joints[0], i=5 + k) for k in range(3)]
    feet = [replace(piece.feet[0], plank=5 + k) for k in range(3)]
    crowd = replace(piece, planks=(*piece.planks, *twins), joints=(*piece.joints, *joints), feet=(*piece.feet, *feet))
    told = next(one for one in words(crowd) if one.startswith("overlapping"))
    assert told == "overlapping: leg-1 and twin-0, leg-1 and twin-1, leg-1 and twin-2 and 3 more"


@pytest.mark.parametrize("use", ["1.29", "inf", "1.2e+03"])
def test_uses_can_be_left_out(use):
    told = f"falls under its weights; weak: joint a on b at {use} of its strength, c on d at 1.01 of its shear strength"
    assert without_uses(told) == "falls under its weights; weak: joint a on b, c on d"
