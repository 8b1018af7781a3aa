"""Scenes of cloth: what they may hold, what is refused in words, and what follows from them."""

import pytest
from cloths import BALL, CONTACT, PIN, cloth, write_cloth
from pydantic import ValidationError
from restshape_studies.explain.without import without

from restshape.application import application
from restshape.errors import UserError
from restshape.physics.cloth.cloth_declaration import CLOTH
from restshape.physics.cloth.sheet.cloth_material_keys import ClothMaterial
from restshape.physics.cloth.support_keys import ClothSupport
from restshape.scene.bodies import Body
from restshape.scene.load import load_scene, revise
from restshape.scene.plan import plan
from restshape.scene.scene_type import support_type

COUTURE = application("cloth")


def evaluated(**keys):
    return Body.model_validate(keys).evaluated({"k": 2.0})


def test_bodies_take_units_and_formulas_of_the_parameters(tmp_path):
    scene = cloth(tmp_path, BALL, CONTACT)
    ball = scene.bodies["ball"].evaluated(scene.parameters)
    assert ball.kind == "sphere" and ball.friction == 0.3
    assert ball.form.center == (0.5, 0.5, -0.3) and ball.form.radius == 0.25
    moved = revise(scene, "parameters.half", 0.75)
    assert moved.bodies["ball"].evaluated(moved.parameters).form.center == (0.5, 0.75, -0.3)


def test_each_kind_of_body():
    assert evaluated(sphere={"center": [0, 0, "k"], "radius": "k/4"}).form.radius == 0.5
    assert evaluated(plane={"point": [0, 0, "1 cm"], "normal": [0, 0, 2]}).form.point[2] == 0.01
    assert evaluated(box={"center": [0, 0, 0], "half": [1, 1, 1]}).form.rotate == (0.0, 0.0, 0.0)
    assert evaluated(capsule={"start": [0, 0, 0], "end": [0, 1, 0], "radius": 1}, friction="k").friction == 2.0
    drum = evaluated(cylinder={"start": [0, 0, 0], "end": [0, "k", 0], "radius": 1, "rounded": "k/4"}).form
    assert (drum.end[1], drum.rounded) == (2.0, 0.5)


@pytest.mark.parametrize(
    ("keys", "what"),
    [
        ({"sphere": {"center": [0, 0, 0], "radius": "k - 2"}}, "greater than 0"),
        ({"plane": {"point": [0, 0, 0], "normal": [0, 0, "k - 2"]}}, "no direction"),
        ({"box": {"center": [0, 0, 0], "half": [1, 0, 1]}}, "greater than 0"),
        ({"box": {"center": [0, 0, 0], "half": [1, 1, 1], "radius": "1.1 m"}}, "at most the smallest half size, 1 m"),
        ({"capsule": {"start": [0, 0, 0], "end": [0, 0, 1], "radius": "1/(k - 2)"}}, "gives inf"),
        ({"cylinder": {"start": [0, 0, "k"], "end": [0, 0, 2], "radius": 1}}, "ends of the cylinder are one place"),
        ({"cylinder": {"start": [0, 0, 0], "end": [0, 0, 1], "radius": 1, "rounded": "k/3"}}, "half length, 0.5 m"),
        ({"cylinder": {"start": [0, 0, 0], "end": [0, 0, 9], "radius": 1, "rounded": "1.1 m"}}, "half length, 1 m"),
        ({"cylinder": {"start": [0, 0, 0], "end": [0, 0, 9], "radius": 0}}, "greater than 0"),
        ({"sphere": {"center": [0, 0, 0], "radius": 1}, "friction": -0.1}, "at least 0"),
    ],
)
def test_bodies_without_a_size_or_a_direction_are_refused(keys, what):
    with pytest.raises(ValueError, match=what):
        evaluated(**keys)


@pytest.mark.parametrize("keys", [{}, {"sphere": {"center": [0, 0, 0], "radius": 1}, "plane": {}}])
def test_a_body_is_of_one_kind(keys):
    with pytest.raises(ValidationError):
        Body.model_validate(keys)


@pytest.mark.parametrize(
    ("parts", "override", "where", "what"),
    [
        ((BALL, CONTACT), "bodies.ball.sphere.radius=-1", "bodies.ball (line", "is -1 m"),
        ((BALL, CONTACT), 'bodies.ball.sphere.center=[0, 0, "x"]', "bodies.ball.sphere.center", "cannot name x or y"),
        ((BALL, CONTACT), 'bodies.ball.friction="mu"', "bodies.ball.friction", "names 'mu'"),
        ((BALL.replace("ball", "patch"), CONTACT), "title=a", "bodies.patch", "a part of the shape, which is 'region'"),
        ((BALL, CONTACT), "bodies.bal.friction=1", "set bodies.bal.friction", "there is no bodies.bal"),
        ((PIN, "[start]\nmove = [0, 0, 'tall']"), "title=a", "start.move", "names 'tall'"),
        ((PIN, CONTACT), "title=a", "effects.contact", "no body that could be touched"),
        ((), "title=a", "effects.gravity", "falls for ever"),
        ((PIN, "[loads.l]\non = 'a'\nforce = [0, 1]"), "title=a", "loads.l (line", "no [loads.NAME]"),
        (
            (PIN, "[quantities]\nq = { stress = 'xx' }"),
            "title=a",
            "quantities.q.stress (line",
            "no quantity of the kind 'stress'",
        ),
        ((PIN, "[quantities]\nq = { energy = 'kinetic' }"), "title=a", "quantities.q.energy", "not 'kinetic'"),
        ((PIN,), "material.cotton={E=1e6,nu=0.3,rho=1}", "material.cotton", "no thickness"),
        ((PIN,), 'supports.pin.fix=["rx"]', "supports.pin.fix", "no direction 'rx'"),
        ((BALL, CONTACT), "material.cotton.rho=0", "effects.contact.stiffness", "which has none"),
        ((PIN,), "effects.gravity.g=[0, -9.81]", "effects.gravity.g", "at least 3"),
    ],
)
def test_what_makes_no_sense_is_refused_in_words(tmp_path, parts, override, where, what):
    with pytest.raises(UserError) as refused:
        cloth(tmp_path, *parts, overrides=(override,))
    assert where in refused.value.where and what in refused.value.what


@pytest.mark.parametrize(
    ("text", "key"),
    [
        (BALL, "bodies.ball (line"),
        ("[start]\nmove = [0, 0, 1]\n", "start (line"),
        ("[material.steel.bending]\n", "material.steel.bending"),
        ('[supports.mirror]\non = "left"\nsymmetry = "x"\n', "supports.mirror.symmetry (line"),
        ('[quantities.down]\ndisplacement = "z"\n', "quantities.down.displacement (line"),
        ('[quantities.held]\nreaction = "z"\n', "quantities.held.reaction (line"),
        ('[quantities.bent]\nenergy = "bending"\n', "quantities.bent.energy (line"),
    ],
)
def test_other_applications_know_nothing_of_cloth(scene_file, text, key):
    if "bending]" in text:
        written = scene_file.read_text().replace("[material.steel]\n", "[material.steel]\nbending = 1\n")
    else:
        written = scene_file.read_text() + "\n" + text.replace('"half"', "0.5")
    scene_file.write_text(written)
    with pytest.raises(UserError) as refused:
        load_scene(scene_file)
    assert key in refused.value.where
    assert any(what in refused.value.what for what in ("the application 'plane' has no", "is wanted here, not"))


def test_supports_of_cloth():
    Support = support_type(ClothSupport, CLOTH.boundary)
    assert Support(on="left", fix=["x", "slope"]).fix == {"x": 0.0, "slope": 0.0}
    assert Support(on="left", symmetry="y").fix == {}
    for keys in ({}, {"fix": ["x"], "symmetry": "x"}, {"fix": {"slope": 1}}, {"symmetry": "z"}):
        with pytest.raises(ValidationError):
            Support(on="left", **keys)


def test_a_bending_stiffness_of_its_own():
    assert ClothMaterial(E=1e6, nu=0.3, bending="5 mN mm").bending == pytest.approx(5e-6)
    wood = {"E": [2e6, 1e6, 1e6], "nu": [0.3, 0.3, 0.3], "G": [1e6, 1e6, 1e6]}
    assert ClothMaterial(orthotropic=wood, bending=["1e-5 N m", 2e-6]).bending == (1e-5, 2e-6)
    assert ClothMaterial(E=1e6, nu=0.3, bending=0).bending == 0.0
    for keys in ({"bending": [1, 1]}, {"bending": -1}, {"bending": "1 N"}, {"bending": [1]}):
        with pytest.raises(ValidationError):
            ClothMaterial(E=1e6, nu=0.3, **keys)


def test_the_stiffness_of_contact_comes_from_the_weight(tmp_path):
    """k s^2/(2 t) at s = t/2 is k t/8: ten times 400 kg/m^3 * 0.5 mm * 9.81 m/s^2, for t = 4 mm."""
    scene = cloth(tmp_path, BALL, CONTACT, overrides=('effects.contact.thickness="4 mm"',))
    assert plan(scene, COUTURE).settings("contact").stiffness == pytest.approx(10 * 1.962 * 8 / 4e-3, rel=1e-12)
    why = next(effect.why for effect in plan(scene, COUTURE).effects if effect.name == "contact")
    assert "stiffness 3.92e+04 N/m^3, so that cloth pressed everywhere through half of contact.thickness (4 mm)" in why
    assert why.endswith("is pushed back by 10 times its weight")
    given = revise(scene, "effects.contact.stiffness", "70 kN/m^3")
    assert plan(given, COUTURE).settings("contact").stiffness == 70e3


def test_what_follows_from_a_scene_of_cloth(tmp_path):
    bare = plan(cloth(tmp_path, PIN), COUTURE)
    assert [effect.name for effect in bare.derived if effect.on] == ["self_contact"]
    mirror = '[supports.mirror]\non = "left"\nsymmetry = "x"\n'
    held = "[supports.up]\non = 'c'\nfix = { z = 0.1 }\n[supports.still]\non = 'b'\nfix = ['x', 'y']\n"
    full = cloth(tmp_path, BALL, CONTACT, mirror, held)
    assert {effect.name for effect in plan(full, COUTURE).derived if effect.on} == {
        "friction",
        "self_contact",
        "symmetry",
        "moving_supports",
    }
    smooth = without(full, COUTURE, ["friction", "moving_supports"])
    assert smooth.bodies["ball"].friction == 0 and smooth.supports["mirror"].symmetry == "x"
    assert smooth.supports["up"].fix == {"z": 0.0} and smooth.supports["still"].fix == {"x": 0.0, "y": 0.0}


def test_bodies_without_contact_are_warned_of(tmp_path):
    reported = plan(cloth(tmp_path, PIN, BALL), COUTURE).warnings
    assert len(reported) == 1 and "falls through bodies.ball" in reported[0]
    assert plan(cloth(tmp_path, BALL, CONTACT), COUTURE).warnings == ()


@pytest.mark.parametrize(
    ("way", "systems"),
    [
        ("auto", ["steps in time", "quasi-Newton steps", "Newton's steps"]),
        ("rayleigh", ["steps in time"]),
        ("newton", ["Newton's steps"]),
        ("cg", ["steps along gradients"]),
    ],
)
def test_the_solver_of_each_way(tmp_path, way, systems):
    solver = plan(cloth(tmp_path, PIN, overrides=(f"effects.drape.strategy={way}",)), COUTURE).solver
    assert solver.equations == "nonlinear" and solver.symmetric
    assert [system.of for system in solver.systems] == systems


def test_a_line_is_named_for_a_bad_body(tmp_path):
    path = write_cloth(tmp_path, BALL.replace("radius", "radios"), CONTACT)
    with pytest.raises(UserError, match="radios") as refused:
        load_scene(path)
    line = path.read_text().splitlines()[int(refused.value.where.split("line ")[1].rstrip(")")) - 1]
    assert "radios" in line and "'radius'" in refused.value.do


@pytest.mark.parametrize(
    ("given", "what", "do"),
    [
        ('["22 cm", "16 cm"]', "three numbers", 'write 3, as in ["22 cm", "16 cm", "16 cm"]'),
        ("[1, 2, 3, 4]", "at most 3 entries", "write 3, as in [1, 2, 3]"),
        ("[]", "three numbers", ""),
    ],
)
def test_a_list_of_another_length_is_reported_by_its_key_with_an_example(tmp_path, given, what, do):
    with pytest.raises(UserError) as reported:
        cloth(tmp_path, CONTACT, f"[bodies.top]\nbox = {{ center = [0, 0, 0], half = {given} }}\n")
    assert "bodies.top.box.half (line " in reported.value.where
    assert what in reported.value.what and reported.value.do == do


def test_one_level_of_the_mesh_leads_to_rest_unless_more_are_asked_for(tmp_path):
    scene = cloth(tmp_path, PIN, overrides=("mesh.levels=3",))
    assert plan(scene, COUTURE).settings("drape").levels == 1
    assert plan(revise(scene, "effects.drape.levels", 2), COUTURE).settings("drape").levels == 2
    with pytest.raises(UserError, match="the mesh has 3 levels"):
        revise(scene, "effects.drape.levels", 4)


def test_bodies_that_nothing_touches_ask_for_contact_alone(tmp_path):
    with pytest.raises(UserError, match=r"nothing holds the cloth, and it falls through bodies\.ball") as refused:
        plan(cloth(tmp_path, BALL), COUTURE)
    assert refused.value.do == "add [effects.contact]"
    with pytest.raises(UserError, match="nothing catches it") as refused:
        plan(cloth(tmp_path), COUTURE)
    assert "[supports.NAME]" in refused.value.do and "[bodies.NAME]" in refused.value.do


def test_a_body_holds_no_cloth_by_its_name(tmp_path):
    with pytest.raises(UserError, match="'ball' is a body") as refused:
        cloth(tmp_path, BALL, CONTACT, '[supports.up]\non = "ball"\nfix = ["z"]')
    assert "supports.up.on" in refused.value.where and "bodies.ball" in refused.value.do
