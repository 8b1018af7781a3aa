"""Planks: drawing, joining by nearness, closing of joints, valid design parameters, and overlaps."""

from dataclasses import replace

import numpy as np
import pytest
from restshape_apps.furniture.physics.furniture import LOST, Compliance, Furniture
from restshape_apps.furniture.pieces import chair, table
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.shape.plank_edits import added, connected, loaded, removed
from restshape_apps.furniture.shape.planks import FREEDOMS, Foot, Piece, Plane, Plank, weight
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from restshape.errors import UserError


def freedoms(piece: Piece, name: str) -> set[str]:
    """The valid design parameters of a plank."""
    found = Furniture(piece).kernel.freedoms()
    return {FREEDOMS[number] for plank, number in found if piece.planks[plank].name == name}


def test_a_plank_is_drawn_by_two_lines() -> None:
    plank = Plank.between("p", (0, 0, 0), (2, 0, 0), (1, 0.5, 0), 0.01)
    assert plank.size == pytest.approx([2.0, 0.5, 0.01])
    assert np.linalg.det(plank.axes) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("end", "width", "what", "do"),
    [
        ((2, 0, 0), (1, 0, 0), "its width lies along its middle line", "draw its width across its middle line"),
        ((2, 0, 0), (0, 0, 0), "its width has no length", "as long as the plank is wide"),
        ((0, 0, 0), (0, 1, 0), "its middle line has no length: it ends where it begins", "to another one"),
        ((0, 0, 0), (0, 0, 0), "its middle line has no length: it ends where it begins", "to another one"),
    ],
)
def test_lines_that_make_no_plank_are_distinguished(end, width, what, do) -> None:
    with pytest.raises(UserError) as caught:
        Plank.between("p", (0, 0, 0), end, width, 0.01)
    assert (caught.value.what, caught.value.where) == (what, "p") and do in caught.value.do


def test_a_table_has_a_joint_and_a_foot_for_each_leg() -> None:
    piece = table()
    assert [(joint.i, joint.j, joint.face) for joint in piece.joints] == [(k, 0, 4) for k in (1, 2, 3, 4)]
    assert [foot.plank for foot in piece.feet] == [1, 2, 3, 4]
    for joint in piece.joints:
        end = piece.planks[joint.i].end(joint.side)
        assert end[2] == pytest.approx(0.7)


def test_freedoms_that_would_open_joints_or_lift_feet_are_left_out() -> None:
    piece = table()
    # A leg held at both ends keeps its length, slides along the top, and turns about the edge and upright alone.
    assert freedoms(piece, "leg-1") == {"length y", "move y", "move z", "turn x", "turn y"}
    # The slanted one would lift an edge of its foot if it turned about its own length.
    assert freedoms(piece, "leg-4") == {"length y", "move y", "move z", "turn y"}
    # The top may tip about the edges of its legs' joints alone.
    assert freedoms(piece, "top") == {"length x", "length y", "move x", "move y", "move z", "turn z", "turn y"}


def test_closing_keeps_ends_on_faces_and_feet_on_the_floor() -> None:
    piece = table()
    furniture = Furniture(piece)
    modes = DesignModes.of(piece, furniture.kernel.freedoms())
    rng = np.random.default_rng(2)
    for _ in range(20):
        gamma = (0.1 * rng.normal(size=len(modes)) / np.sqrt(len(modes)) @ modes.directions).reshape(-1, 8)
        geometry = furniture.geometry(gamma)
        top = geometry.axes[0][:, 2]
        if any(geometry.joint_faults) or any(geometry.foot_faults):
            continue
        underside = geometry.centre[0] - 0.006 * top
        assert (geometry.p - underside) @ top == pytest.approx(0.0, abs=1e-12)
        assert geometry.contacts[:, 2] == pytest.approx(0.0, abs=1e-12)
        # Thickness stays, and so do the axes' right angles.
        assert geometry.size[:, 2] == pytest.approx(0.012)
        assert np.einsum("nab,nac->nbc", geometry.axes, geometry.axes) == pytest.approx(np.tile(np.eye(3), (5, 1, 1)))


def test_nails_count_by_spacing_and_a_leg_beside_the_top_is_lost() -> None:
    piece = table()
    furniture = Furniture(piece)
    furniture.test()
    assert furniture.nails().tolist() == [6, 6, 6, 6]
    gamma = np.zeros((5, 8))
    gamma[1, 1] = -0.13
    geometry = furniture.geometry(gamma)
    # The leg's edge hangs over the top by 30 + 60 - 100 mm, and more as it moves.
    assert geometry.length[0] == pytest.approx(0.12 - 0.09)
    gamma[1, 1] = -0.155
    result = furniture.test(gamma)
    assert result.flaws & LOST and result.words[0] == "lost: leg-1 misses top"


def test_an_end_that_is_not_flush_is_a_fault() -> None:
    piece = table()
    turn = Rotation.from_euler("x", 2, degrees=True).as_matrix()
    planks = (*piece.planks[:1], replace(piece.planks[1], axes=turn @ piece.planks[1].axes), *piece.planks[2:])
    assert Furniture(replace(piece, planks=planks)).test().flaws & LOST


def inside_both(a: Plank, b: Plank) -> float:
    """How far the deepest point that two boxes share lies inside both [m], by a linear program."""
    rows, bounds = [], []
    for plank in (a, b):
        for k in range(3):
            for sign in (1.0, -1.0):
                axis = sign * plank.axes[:, k]
                rows.append([*axis, 1.0])
                bounds.append(axis @ plank.centre + 0.5 * plank.size[k])
    answer = linprog([0, 0, 0, -1], A_ub=np.array(rows), b_ub=bounds, bounds=[(None, None)] * 4)
    return float(answer.x[3])


def test_overlaps_are_those_of_a_linear_program() -> None:
    rng, seen = np.random.default_rng(8), set()
    for _ in range(150):
        planks = [
            Plank(name, 0.5 * rng.normal(size=3), Rotation.random(random_state=rng.integers(2**31)).as_matrix(), size)
            for name, size in (("a", np.array([1.0, 0.4, 0.05])), ("b", np.array([0.8, 0.3, 0.02])))
        ]
        shared = inside_both(*planks)
        if abs(shared) < 1e-5:
            continue
        deep = (Plane((0.0, 0.0, -9.0)),)
        model = Furniture(Piece(tuple(planks), (), (Foot(0, 4),), deep), Compliance(interference=0.0))
        assert bool(model.geometry().overlaps) is (shared > 0.0)
        seen.add(shared > 0.0)
    assert seen == {True, False}


def test_planks_come_and_go() -> None:
    piece = chair()
    stretcher = piece.index("stretcher")
    without = removed(piece, stretcher)
    assert len(without.joints) == len(piece.joints) - 2
    assert Furniture(without).test().flaws == 0
    back = added(without, piece.planks[stretcher])
    assert len(back.joints) == len(piece.joints)
    one, other = Furniture(piece), Furniture(back)
    assert other.test().pull == pytest.approx(one.test().pull, rel=1e-6)
    assert connected(back, len(back.planks) - 1) == back
    with pytest.raises(UserError, match="already"):
        added(back, piece.planks[0])
    with pytest.raises(UserError, match="at least one"):
        removed(Piece(piece.planks[:1], (), ()), 0)


def test_a_weight_is_replaced_by_its_name() -> None:
    piece = loaded(table(), weight("weight", 0, 7.0))
    assert len(piece.weights) == 1
    assert piece.weights[0].force[2] == pytest.approx(-7.0 * 9.80665)


def test_modes_are_dimensionless() -> None:
    piece = table()
    small = replace(piece, planks=tuple(replace(p, centre=p.centre / 2, size=p.size / 2) for p in piece.planks))
    for one in (piece, small):
        modes = DesignModes.of(one, Furniture(one, Compliance(least_overlap=1e-3)).kernel.freedoms())
        moved = np.abs(modes.directions).max(axis=1)
        turns = (modes.freedoms[:, 1] >= 3) & (modes.freedoms[:, 1] < 6)
        assert moved[turns] == pytest.approx(1.0)
        assert moved[~turns] == pytest.approx(one.size)
