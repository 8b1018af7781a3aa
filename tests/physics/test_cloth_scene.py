"""What scenes of cloth say about a sheet: stiffness, supports, bodies and starts against values by hand."""

import numpy as np
import pytest
from cloths import BALL, CONTACT, PIN, cloth

from restshape.application import application
from restshape.errors import UserError
from restshape.mesh.generate import generate
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.scene import cloth_arguments
from restshape.physics.cloth.sheet.cloth_material_keys import ClothMaterial
from restshape.physics.cloth.sheet.cloth_materials import bending, membrane
from restshape.scene.load import revise
from restshape.scene.plan import plan
from restshape.shape.build import outline_from_spec
from restshape.shape.placement import rotation

COUTURE = application("cloth")
TURNED = """
[start]
turn = [0, "tilt", 0]
about = ["half", 0, 0]
move = [0, 0, 0.1]
"""
WOVEN = {
    "orthotropic": {"E": [4e6, 1e6, 1e6], "nu": [0.4, 0.3, 0.3], "G": [5e5, 1e6, 1e6]},
    "thickness": 2e-3,
}


def meshed(scene):
    return generate(outline_from_spec(scene.shape, scene.folder), scene.mesh)


def arguments(folder, *parts, overrides=()):
    """What the square of cotton with further tables is made from, and its mesh."""
    scene = cloth(folder, *parts, overrides=overrides)
    mesh = meshed(scene)
    return cloth_arguments(scene, plan(scene, COUTURE), mesh), mesh


def test_isotropic_cloth_by_hand():
    """E h/(1 - nu^2) = 1000/0.9375 N/m, and D = E h^3/(12 (1 - nu^2)) = 2.5e-4/11.25 N m, of 2 MPa, 0.5 mm, 0.25."""
    cotton = ClothMaterial(E=2e6, nu=0.25, thickness=5e-4)
    shape = np.array([[1, 0.25, 0], [0.25, 1, 0], [0, 0, 0.375]])
    np.testing.assert_allclose(membrane(cotton), 1000 / 0.9375 * shape, rtol=1e-12)
    np.testing.assert_allclose(bending(cotton), 2.5e-4 / 11.25 * shape, rtol=1e-12)
    own = ClothMaterial(E=2e6, nu=0.25, thickness=5e-4, bending=7e-6)
    np.testing.assert_allclose(bending(own), 7e-6 * shape, rtol=1e-12)
    np.testing.assert_array_equal(bending(ClothMaterial(E=2e6, nu=0.25, bending=0)), np.zeros((3, 3)))


def test_woven_cloth_by_hand():
    """In plane stress Q11 = E1/(1 - nu12 nu21), nu21 = nu12 E2/E1 = 0.1, Q12 = nu12 Q22, Q66 = G12; 1 - 0.04 = 0.96."""
    woven = ClothMaterial(**WOVEN)
    Q = np.array([[4e6, 0.4e6, 0], [0.4e6, 1e6, 0], [0, 0, 0.48e6]]) / 0.96
    np.testing.assert_allclose(membrane(woven), 2e-3 * Q, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(bending(woven), 8e-9 / 12 * Q, rtol=1e-12, atol=1e-18)
    one = bending(woven.model_copy(update={"bending": 2e-5}))
    np.testing.assert_allclose(one, 2e-5 / (4e6 / 0.96) * Q, rtol=1e-12, atol=1e-18)
    # Along 4 times, across 9 times what is 1 by 1/4: the rest by 6.
    two = bending(woven.model_copy(update={"bending": (4 * 8e-9 / 12 * 4e6 / 0.96, 9 * 8e-9 / 12 * 1e6 / 0.96)}))
    scale = np.array([[4, 6, 0], [6, 9, 0], [0, 0, 6]])
    np.testing.assert_allclose(two, 8e-9 / 12 * Q * scale, rtol=1e-12, atol=1e-18)


def test_a_grain_turns_stretching_and_bending():
    """At 90 degrees 1 and 2 change places; at an angle a strip along the grain pulls as it did along x."""
    woven, across = (
        ClothMaterial(**WOVEN, bending=(2e-5, 1e-5)),
        ClothMaterial(**WOVEN, bending=(2e-5, 1e-5), grain="90 deg"),
    )
    swap = [1, 0, 2]
    for stiffness in (membrane, bending):
        np.testing.assert_allclose(stiffness(across), stiffness(woven)[np.ix_(swap, swap)], rtol=1e-12, atol=1e-12)
    angle = 0.4
    skew = ClothMaterial(**WOVEN, bending=(2e-5, 1e-5), grain=angle)
    c, s = np.cos(angle), np.sin(angle)
    strain = np.array([c * c, s * s, 2 * c * s])
    for stiffness in (membrane, bending):
        assert strain @ stiffness(skew) @ strain == pytest.approx(stiffness(woven)[0, 0], rel=1e-12)


def test_one_material_gives_one_matrix_and_two_give_one_a_cell(tmp_path):
    alone, mesh = arguments(tmp_path, PIN)
    assert alone.fabric.membrane.shape == alone.fabric.bending.shape == (3, 3)
    assert alone.fabric.density == pytest.approx(0.2)
    tape = '[material.tape]\nE = "8 MPa"\nnu = 0.25\nrho = 1200\nthickness = "0.5 mm"\nregion = "patch"\n'
    both, mesh = arguments(tmp_path, PIN, tape)
    inside = mesh.cell_region == 1
    assert inside.any() and not inside.all()
    np.testing.assert_allclose(both.fabric.density, np.where(inside, 0.6, 0.2), rtol=1e-12)
    stiffness = np.where(inside, 4.0, 1.0)[:, None, None]
    np.testing.assert_allclose(both.fabric.membrane, stiffness * alone.fabric.membrane, rtol=1e-12)
    np.testing.assert_allclose(both.fabric.bending, stiffness * alone.fabric.bending, rtol=1e-12)
    mass = ClothProblem(mesh, both.fabric, both.supports, both.g).lumped.mass.sum()
    assert mass == pytest.approx(0.75 * 0.2 + 0.25 * 0.6, rel=1e-12)


def test_a_group_of_regions_has_a_material_and_a_place_without_one_is_reported(tmp_path):
    tape = '[material.tape]\nE = "8 MPa"\nnu = 0.25\nrho = 1200\nthickness = "0.5 mm"\nregion = "taped"\n'
    grouped = ('shape.groups={taped=["patch"]}',)
    found, mesh = arguments(tmp_path, PIN, tape, overrides=grouped)
    np.testing.assert_allclose(found.fabric.density, np.where(mesh.cell_region == 1, 0.6, 0.2), rtol=1e-12)
    scene = cloth(tmp_path, PIN, tape, overrides=grouped)
    tape_only = scene.model_copy(update={"material": {"tape": scene.material["tape"]}})
    with pytest.raises(UserError, match="triangles lie outside of the regions that have a material"):
        cloth_arguments(tape_only, plan(scene, COUTURE), mesh)


def test_settings_of_the_cloth_are_handed_on(tmp_path):
    found, _ = arguments(
        tmp_path, PIN, '[effects.cloth]\nbending = "hinge"\nhinges = "strip"\nmembrane = "corotated"\n'
    )
    assert (found.fabric.kind, found.fabric.hinge_factor, found.fabric.law) == ("hinge", 0.375, "corotated")
    np.testing.assert_array_equal(found.g, [0, 0, -9.81])
    assert found.contact is None and found.bodies == []


def test_cloth_starts_turned_and_moved(tmp_path):
    """About (1/2, 0, 0) by 30 degrees about y: x - 1/2 goes to (cos, 0, -sin), then all rises by 0.1 m."""
    found, mesh = arguments(tmp_path, PIN, TURNED)
    X, Y = mesh.X.T
    c, s = np.sqrt(0.75), 0.5
    expected = np.column_stack([0.5 + c * (X - 0.5), Y, 0.1 - s * (X - 0.5)])
    np.testing.assert_allclose(found.start, expected, atol=1e-15)
    corner = mesh.nodes_of("a")
    np.testing.assert_allclose(found.supports.places[corner], [[0.5 - 0.5 * c, 0, 0.35]], atol=1e-15)
    assert found.supports.mask.sum() == 3


def test_turns_follow_each_other_about_x_then_y_then_z():
    quarter = np.pi / 2
    np.testing.assert_allclose(rotation((quarter, 0, 0)) @ [0, 1, 0], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(rotation((0, quarter, 0)) @ [0, 0, 1], [1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(rotation((0, 0, quarter)) @ [1, 0, 0], [0, 1, 0], atol=1e-15)
    # y goes to z, then to x, then to y.
    np.testing.assert_allclose(rotation((quarter, quarter, quarter)) @ [0, 1, 0], [0, 1, 0], atol=1e-15)


def test_scatter_is_the_same_each_time_and_leaves_what_is_held(tmp_path):
    overrides = ("start.scatter=0.05", "start.seed=3")
    found, mesh = arguments(tmp_path, PIN, TURNED, overrides=overrides)
    again, _ = arguments(tmp_path, PIN, TURNED, overrides=overrides)
    other, _ = arguments(tmp_path, PIN, TURNED, overrides=("start.scatter=0.05", "start.seed=4"))
    smooth, _ = arguments(tmp_path, PIN, TURNED)
    np.testing.assert_array_equal(found.start, again.start)
    assert not np.allclose(found.start, other.start)
    off = np.abs(found.start - smooth.start)
    assert 0.04 < off.max() <= 0.05 and not off[mesh.nodes_of("a")].any()


def test_supports_move_what_they_constrain_from_its_initial_placement(tmp_path):
    lift = '[supports.lift]\non = "top"\nfix = { z = "0.1*x", y = "-2 cm" }\n'
    found, mesh = arguments(tmp_path, TURNED, lift)
    nodes = mesh.nodes_of("top")
    mask = np.zeros((len(mesh.X), 3))
    mask[nodes, 1:] = 1
    np.testing.assert_array_equal(found.supports.mask, mask)
    x = mesh.X[nodes, 0]
    np.testing.assert_allclose(found.supports.places[nodes, 1], 0.98, atol=1e-15)
    np.testing.assert_allclose(found.supports.places[nodes, 2], 0.1 - 0.5 * (x - 0.5) + 0.1 * x, atol=1e-15)
    np.testing.assert_array_equal(found.start[nodes, 1:], found.supports.places[nodes, 1:])


def test_a_clamp_holds_the_slope_out_of_the_cloth(tmp_path):
    """Left and bottom edges: outwards is -x and -y; the first turns with the cloth."""
    clamp = '[supports.clamp]\non = ["left", "bottom"]\nfix = ["x", "y", "z", "slope"]\n'
    found, mesh = arguments(tmp_path, TURNED, clamp)
    held = found.supports
    assert len(held.clamped) == len(mesh.facets_of("left")) + len(mesh.facets_of("bottom"))
    middles = mesh.X[mesh.edge_nodes[held.clamped]].mean(axis=1)
    expected = np.where(middles[:, :1] == 0.0, [[-np.sqrt(0.75), 0, 0.5]], [[0, -1, 0]])
    np.testing.assert_allclose(held.slopes, expected, atol=1e-15)
    # The flat sheet, as it is laid, has these slopes by itself.
    free, _ = arguments(tmp_path, TURNED, PIN)
    sheets = [ClothProblem(mesh, found.fabric, one.supports, found.g) for one in (found, free)]
    np.testing.assert_allclose(*(sheet.flat(found.start) for sheet in sheets), atol=1e-14)


def test_a_plane_of_symmetry_holds_one_coordinate(tmp_path):
    mirror = '[supports.mirror]\non = "right"\nsymmetry = "x"\n'
    found, mesh = arguments(tmp_path, mirror)
    nodes = mesh.nodes_of("right")
    assert found.supports.mask[nodes].tolist() == [[1, 0, 0]] * len(nodes) and found.supports.mask.sum() == len(nodes)
    np.testing.assert_array_equal(found.supports.places[nodes, 0], 1.0)
    assert set(found.supports.axes) == {0} and len(found.supports.mirrored) == len(mesh.facets_of("right"))
    assert (mesh.X[mesh.edge_nodes[found.supports.mirrored], 0] == 1.0).all()


@pytest.mark.parametrize(
    ("parts", "what"),
    [
        (('[supports.mirror]\non = "bottom"\nsymmetry = "x"\n',), "no plane of symmetry with that normal"),
        (('[supports.clamp]\non = "a"\nfix = ["slope"]\n',), "where no edge is"),
        (('[supports.clamp]\non = "patch"\nfix = ["slope"]\n',), "which is no edge of the border"),
        (
            (PIN, '[supports.up]\non = "left"\nfix = { z = 0.1 }\n'),
            "another displacement than one before it at (0, 0)",
        ),
    ],
)
def test_supports_that_make_no_sense_are_refused(tmp_path, parts, what):
    with pytest.raises(UserError) as refused:
        arguments(tmp_path, *parts)
    assert what in refused.value.what and "supports." in refused.value.where


def test_weight_wants_a_density(tmp_path):
    with pytest.raises(UserError, match="no density"):
        arguments(tmp_path, PIN, overrides=("material.cotton.rho=0",))


BODIES = """
[bodies.box]
box = { center = [2, 0, 0], half = [0.3, 0.1, 0.2], rotate = [0, 0, "tilt"], radius = "1 cm" }
[bodies.floor]
plane = { point = [0, 0, -1], normal = [0, 0, 3] }
friction = "half"
[bodies.bar]
capsule = { start = [0, 0, 3], end = [1, 0, 3], radius = 0.5 }
[bodies.drum]
cylinder = { start = [0, 0, 6], end = [0, 0, "6 + 2*half"], radius = 0.5, rounded = "10 cm" }
"""


def test_bodies_are_where_the_scene_says(tmp_path):
    found, _ = arguments(tmp_path, BALL, BODIES, CONTACT)
    ball, box, floor, bar, drum = (body for body, _ in found.bodies)
    assert [friction for _, friction in found.bodies] == [0.3, 0.0, 0.5, 0.0, 0.0]
    assert ball.distance(np.array([[0.5, 0.5, 0.0]]))[0][0] == pytest.approx(0.05, abs=1e-15)
    assert floor.distance(np.array([[5.0, 7.0, 0.5]]))[0][0] == pytest.approx(1.5, abs=1e-15)
    assert bar.distance(np.array([[2.0, 0.0, 3.0]]))[0][0] == pytest.approx(0.5, abs=1e-15)
    # Above its end, beside it, and diagonally off the circle of radius 0.4 in its rim.
    places = np.array([[0.1, 0.2, 7.5], [0.0, 2.0, 6.5], [0.4 + 0.3, 0.0, 6.9 + 0.4]])
    np.testing.assert_allclose(drum.distance(places)[0], [0.5, 1.5, 0.4], atol=1e-14)
    # The long axis of the box points to 30 degrees from x towards y.
    along = np.array([np.sqrt(0.75), 0.5, 0.0])
    value, gradient, _ = box.distance(np.array([[2.0, 0.0, 0.0] + 0.8 * along]))
    assert value[0] == pytest.approx(0.5, abs=1e-15)
    np.testing.assert_allclose(gradient[0], along, atol=1e-15)


def test_bodies_follow_the_parameters(tmp_path):
    scene = revise(cloth(tmp_path, BALL, CONTACT), "parameters.half", 2.5)
    found = cloth_arguments(scene, plan(scene, COUTURE), meshed(scene))
    assert found.bodies[0][0].distance(np.array([[0.5, 0.5, -0.3]]))[0][0] == pytest.approx(1.75, abs=1e-15)
    assert found.contact.thickness == 2e-3
