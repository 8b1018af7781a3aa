"""What is said of a piece that is not valid: it names planks, joints and loads."""

from dataclasses import replace
from math import ceil

import numpy as np
import pytest
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.physics.plank_findings import PULL, SHEAR, WEAK, WEIGHTS
from restshape_apps.furniture.physics.plank_phrases import phrases
from restshape_apps.furniture.pieces import cantilever, scales, shelf_1, table
from restshape_apps.furniture.shape.plank_gaps import gap_of
from restshape_apps.furniture.shape.planks import Foot, Joint, Load, Piece, Plank
from restshape_apps.furniture.small_pieces import block, ladder

from restshape.findings import Finding, decode_findings, encode_findings

G = 9.80665


def words(piece, gamma=None):
    return Furniture(piece).test(gamma).words


def test_a_valid_piece_has_none():
    assert words(cantilever(kilograms=0.3)) == ()


def test_a_weak_joint_is_named_with_its_use():
    # Moment of the load and of the board itself over what three nails bear; it is reported rounded up.
    arm, kilograms = 0.19, 1.8
    own = 700.0 * 0.06 * 0.012 * arm * G
    utilisation = (kilograms * G * arm + own * arm / 2) / (0.02 * 5.2e3 * 0.006 * 3)
    assert words(cantilever(arm=arm, kilograms=kilograms)) == (
        f"weak: joint beam on post at {ceil(100 * utilisation) / 100:.2f} of its strength",
    )


def test_two_weak_joints_are_both_named_worst_first():
    piece = scales()
    loads = [replace(load, force=(0.0, 0.0, -G * (1.6 + 0.2 * k))) for k, load in enumerate(piece.weights)]
    (printed,) = words(replace(piece, weights=tuple(loads)))
    assert printed.startswith("weak: joint right on post at ") and ", left on post at " in printed


def test_a_push_is_named_where_it_alone_breaks_or_topples():
    assert words(table(kilograms=30.0)) == ()
    (weak,) = words(table(kilograms=30.0, push=150.0))
    assert weak.startswith("weak: joint ") and weak.endswith(" of its strength under push push")
    nudge = Load("nudge", 0, (0.0, 0.0, 0.5), (500.0, 0.0, 0.0))
    assert words(replace(block(0.2, 0.4, 0.5), pushes=(nudge,)))[0] == "falls under push nudge"


@pytest.mark.parametrize("share", [0.0, 1e-10, 1e-8])
def test_a_push_that_changes_nothing_is_not_named(share: float) -> None:
    # A force down beside the load, in parts of it: a moment, and so a utilisation, that is larger by about as much.
    piece = cantilever(arm=0.19, kilograms=1.8)
    nudge = Load("nudge", 2, piece.weights[0].place, (0.0, 0.0, -share * 1.8 * G))
    (printed,) = words(replace(piece, pushes=(nudge,)))
    assert printed.endswith(" of its strength")


@pytest.mark.parametrize("share", [1e-4, 0.2])
def test_a_push_that_makes_a_weak_joint_worse_is_named(share: float) -> None:
    arm, kilograms = 0.19, 1.8
    piece = cantilever(arm=arm, kilograms=kilograms)
    nudge = Load("nudge", 2, piece.weights[0].place, (0.0, 0.0, -share * kilograms * G))
    own = 700.0 * 0.06 * 0.012 * arm * G
    utilisation = ((1 + share) * kilograms * G * arm + own * arm / 2) / (0.02 * 5.2e3 * 0.006 * 3)
    (printed,) = words(replace(piece, pushes=(nudge,)))
    assert (
        printed == f"weak: joint beam on post at {ceil(100 * utilisation) / 100:.2f} of its strength under push nudge"
    )


def test_what_slides_by_itself_slides_under_its_weights():
    # At half a radian it needs a friction of 0.92: cot(0.5) / 2.
    assert all(
        words(ladder(0.5, mu))[0].startswith("slides under its weights (needs friction of 0.916") for mu in (0.1, 0.91)
    )


def test_a_part_that_falls_is_named():
    piece = shelf_1()
    bracket = piece.index("bracket-1")
    cut = replace(piece, joints=tuple(joint for joint in piece.joints if joint.i != bracket))
    printed = words(cut)
    assert printed[:2] == ("in two parts: upright-1 with 7 more, bracket-1", "falls under its weights: bracket-1")


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
    printed = next(one for one in words(crowd) if one.startswith("overlapping"))
    # Legs of 12 mm that are in one place.
    pairs = ", ".join(f"leg-1 and twin-{k} by 12 mm along x at (-450, -200, 350) mm" for k in range(3))
    assert printed == f"overlapping: {pairs} and 3 more"


@pytest.mark.parametrize(("utilisation", "shown"), [(1.281, "1.29"), (np.inf, "inf"), (1234.0, "1.23e+03")])
def test_uses_are_no_part_of_what_a_finding_is(utilisation, shown):
    one, other = (Finding(WEAK, PULL, ("a", "b"), value, 1.0, case=WEIGHTS) for value in (utilisation, 1.5))
    assert one.identity == other.identity != replace(one, detail=SHEAR).identity
    sheared = Finding(WEAK, SHEAR, ("c", "d"), 1.01, 1.0, case="push wind")
    assert phrases([one, sheared]) == (
        f"weak: joint a on b at {shown} of its strength, c on d at 1.01 of its shear strength under push wind",
    )


def test_findings_are_those_of_the_words():
    crowd = Furniture(table(kilograms=300.0)).test()
    assert crowd.findings and phrases(decode_findings(encode_findings(crowd.findings))) == crowd.words


def bracket(start, end, width=(0, 0.1, 0), reach=0.015, joints=()):
    """A post of 20 mm with an arm beside it."""
    post = Plank.between("post", (0, 0, 0), (0, 0, 1.6), (0, 0.2, 0), 0.02)
    arm = Plank.between("arm", start, end, width, 0.02)
    return Piece((post, arm), joints, (Foot(0, 0),), reach=reach)


@pytest.mark.parametrize(
    ("start", "reach", "printed"),
    [
        ((0.03, 0, 1.5), 0.015, " (arm -x is 20 mm from post, beyond the reach of 15 mm of joints)"),
        ((0.03, 0, 1.5), 0.0199996, " (arm -x is 20 mm from post, beyond the reach of 19.9996 mm of joints)"),
        ((0.03, 0, 1.5), 0.02 + 1e-9, ""),
        # Before the post by 30 mm and beside it by 40 mm.
        ((0.04, 0.19, 1.5), 0.015, " (arm -x is 50 mm from post, beyond the reach of 15 mm of joints)"),
        # Before it by 80 mm and above it by 60 mm.
        ((0.09, 0.0, 1.66), 0.015, " (arm -x is 100 mm from post, beyond the reach of 15 mm of joints)"),
        ((1.01, 0, 1.5), 0.015, " (arm -x is 1000 mm from post, beyond the reach of 15 mm of joints)"),
    ],
)
def test_parts_that_joints_do_not_reach_report_their_gap(start, reach, printed):
    end = (2.0, start[1], start[2])
    assert words(bracket(start, end, reach=reach))[0] == f"in two parts: post, arm{printed}"
    # Its other end looks away.
    assert words(bracket(end, start, reach=reach))[0] == f"in two parts: post, arm{printed.replace('-x', '+x')}"


def test_planks_that_no_end_of_looks_at_a_face_report_no_gap():
    # An arm along the post's face, 40 mm before it.
    assert words(bracket((0.06, 0.5, 1.5), (0.06, 1.0, 1.5), (0, 0, 0.1)))[0] == "in two parts: post, arm"
    # One whose end is not level with the face, by more than joints reach: 100 mm on edge at 30 degrees.
    lean = (0.1 * np.sin(np.pi / 6), 0.1 * np.cos(np.pi / 6), 0)
    assert words(bracket((0.1, 0, 1.5), (0.5, -0.231, 1.5), lean))[0] == "in two parts: post, arm"


def test_gaps_are_those_of_dense_sampling():
    rng = np.random.default_rng(3)
    s = np.linspace(-0.5, 0.5, 20001)[:, None]
    for _ in range(100):
        boards = [
            Plank(name, 0.7 * rng.normal(size=3), np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.uniform(0.05, 1.0, 3))
            for name in "ab"
        ]
        side, (one, other) = int(rng.integers(4)), boards
        across = 1 - side // 2
        places = (one.end(side) + s * one.axes[:, across] * one.size[across] - other.centre) @ other.axes
        outside = np.maximum(np.abs(places) - 0.5 * other.size, 0.0)
        least = np.linalg.norm(outside, axis=1).min()
        assert gap_of(Piece(tuple(boards), (), ()), 0, side, 1).size == pytest.approx(least, abs=1e-4)


@pytest.mark.parametrize(
    ("start", "end", "printed"),
    [
        # At right angles to the post's normal, 300 mm before its face and 400 mm above it.
        ((0.31, 0, 2.0), (0.31, 0, 2.5), "arm does not point at post, 500 mm from it"),
        # Right in front of its face.
        ((0.01, 0, 1.5), (0.01, 0, 1.2), "arm lies too flat on post"),
        # Straight towards the post, but past it: its end is closed to the plane of the face.
        ((0.31, 0.45, 1.5), (0.5, 0.45, 1.5), "arm misses post, 300 mm from it"),
        ((0.31, 0.15001, 1.5), (0.5, 0.15001, 1.5), "arm misses post"),
        ((-0.11, 0.0, 1.5), (-0.31, 0.0, 1.5), "arm comes to post from behind, 100 mm from it"),
    ],
)
def test_joints_of_planks_farther_apart_than_reach_report_how_far(start, end, printed):
    piece = bracket(start, end, (0, 0.1, 0), joints=(Joint(1, 0, 0, 4),))
    closed = Furniture(piece).moved()
    assert words(closed)[0] == f"lost: {printed}"
