"""Two boards that meet in a corner have one joint, whose forces are those of statics."""

import numpy as np
import pytest
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.shape.plank_edits import added
from restshape_apps.furniture.shape.plank_scene import piece_of
from restshape_apps.furniture.shape.planks import NEAR, Piece, Plank, feet_near, joints_near
from restshape_apps.furniture.tests.furniture_scenes import corner_of_boards

from restshape.scene.load import load_scene


def corner(tmp_path, x: float) -> Piece:
    path = tmp_path / "corner.toml"
    path.write_text(corner_of_boards(x))
    return piece_of(load_scene(path))


@pytest.mark.parametrize("x", [0.0, 0.1, -0.037, 0.153, 0.413])
def test_an_l_of_two_boards_has_one_joint_with_the_forces_of_statics(tmp_path, x: float) -> None:
    piece = corner(tmp_path, x)
    assert [(joint.i, joint.side, joint.j, joint.face) for joint in piece.joints] == [(1, 0, 0, 5)]
    furniture = Furniture(piece)
    result, height = furniture.test(), 0.5 - 0.02
    assert result.valid, result.words
    wall = 10.0 * furniture.geometry().mass[1]
    alone, pulled = (furniture.forces(case) for case in (0, 1))
    # The wall and the box press; a force at the top turns the joint by its height over it.
    assert [alone.tension[0], pulled.tension[0]] == pytest.approx([-(20.0 + wall)] * 2)
    assert np.linalg.norm(pulled.shear[0]) == pytest.approx(5.0)
    assert abs(pulled.bending[0]) == pytest.approx(5.0 * height) and abs(alone.bending[0]) < 1e-5


@pytest.mark.parametrize("x", [0.0, 0.1, -0.037, 0.153, 0.413])
def test_a_corner_of_upright_boards_is_joined_by_the_first(x: float) -> None:
    one = Plank.between("one", (x, 0, 0.2), (x + 0.5, 0, 0.2), (0, 0, 0.4), 0.018)
    other = Plank.between("other", (x, 0, 0.2), (x, 0.5, 0.2), (0, 0, 0.4), 0.018)
    for planks in ((one, other), (other, one)):
        joints = joints_near(planks, NEAR)
        assert [(joint.i, joint.j) for joint in joints] == [(0, 1)]
        assert Furniture(Piece(planks, joints, feet_near(planks, NEAR, joints=joints))).test().valid
    # A board that an edit draws meets the other one once too.
    drawn = added(Piece((one,), (), feet_near((one,))), other)
    assert len(drawn.joints) == 1 and Furniture(drawn).test().valid
