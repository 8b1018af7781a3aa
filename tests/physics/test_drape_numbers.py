"""Derivatives of drapes by numbers of their scene: Taylor remainders from the same anchors, motions of all together."""

import re

import numpy as np
import pytest
from drape_designs import BALL, CONTACT, COTTON, HELD, HOLD, DrapeDesign, folded, sheet
from small_scenes import head, meshed

from restshape.errors import UserError

KNIT = """
[material.cotton]
orthotropic = { E = [3e5, 2e5, 2e5], nu = [0.2, 0.2, 0.2], G = [8e4, 8e4, 8e4] }
grain = "25 deg"
rho = 500
thickness = "0.3 mm"
bending = ["8e-6 N m", "3e-6 N m"]
"""
CLAMPED = """
[parameters]
lift = 0.01
[supports.clamp]
on = "left"
fix = { x = 0, y = "0.02*y*y", z = "lift*(1 + y)", slope = 0 }
[start]
turn = [0, "5 deg", "10 deg"]
about = [0.1, 0.1, 0]
move = [0, 0, 0.01]
"""
BODIES = {
    "box": 'box = { center = [0.1, 0.1, -0.05], half = [0.05, 0.06, 0.048], rotate = ["2 deg", "4 deg", "20 deg"], '
    "radius = 0.02 }",
    "capsule": "capsule = { start = [0.02, 0.1, -0.032], end = [0.18, 0.11, -0.03], radius = 0.03 }",
    "cylinder": "cylinder = { start = [0.1, 0.1, -0.1], end = [0.105, 0.1, -0.002], radius = 0.06, rounded = 0.02 }",
    "plane": "plane = { point = [0.1, 0.1, -0.01], normal = [0.1, 0.05, 1] }",
}
PANEL = """
[parameters]
k = "1 m"
m = "1 m"
twice = "2*k"
[panels.one]
outline = ["bottom", "right", "top", "left"]
vertices = { a = [0, 0], b = [0.2, 0], c = [0.2, 0.2], d = [0, 0.2] }
#
[panels.one.edges]
bottom = { line = ["a", "b"] }
right = { line = ["b", "c"] }
top = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[supports.pins]
on = "one.top"
fix = ["x", "y", "z"]
"""
TWO_FABRICS = """
[panels.upper]
outline = ["bottom", "right", "top", "left"]
vertices = { a = [0, 0], b = [0.2, 0], c = [0.2, 0.1], d = [0, 0.1] }
turn = ["90 deg", 0, 0]
material = "cotton"
grain = "60 deg"
[panels.upper.edges]
bottom = { line = ["a", "b"] }
right = { line = ["b", "c"] }
top = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[panels.lower]
outline = ["bottom", "right", "top", "left"]
vertices = { a = [0, 0], b = [0.2, 0], c = [0.2, 0.1], d = [0, 0.1] }
turn = ["90 deg", 0, 0]
move = [0, 0, -0.1]
angle = "20 deg"
material = "linen"
[panels.lower.edges]
bottom = { line = ["a", "b"] }
right = { line = ["b", "c"] }
top = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[material.linen]
E = "3 MPa"
nu = 0.2
rho = 700
thickness = "0.4 mm"
bending = "2e-5 N m"
[seams.hem]
from = "upper.bottom"
to = "lower.top"
[supports.pins]
on = ["upper.c", "upper.d"]
fix = ["x", "y", "z"]
"""
OTHERS = ("x", "y", "z")


def knit(kind: str, *tables: str, size: float = 0.025) -> str:
    """The sheet, of a fabric with a grain."""
    text = sheet(kind, *tables, size=size)
    return re.sub(r"\[material\.cotton\].*?(?=\[effects)", KNIT, text, flags=re.S)


def put(design: DrapeDesign, key: str, step: float) -> np.ndarray:
    """The unknowns (n, 3) at rest with a number of the scene, or of a list in it, larger by a step."""
    whole, _, place = key.rpartition(".")
    values = design.analysis.state.plan.settings("gravity").g if whole == "effects.gravity.g" else None
    if not place.isdigit():
        return design.change(key, number_at(design, key) + step)
    values = list(values or number_at(design, whole))
    values[int(place)] += step
    return design.change(whole, values)


def number_at(design: DrapeDesign, key: str):
    """What stands at a key of the scene, or of its effects."""
    first, *rest = key.split(".")
    here = design.analysis.state.plan.settings(rest.pop(0)) if first == "effects" else getattr(design.scene, first)
    for part in rest:
        here = here[part] if isinstance(here, dict) else getattr(here, part)
    return here


def check(design: DrapeDesign, key: str, step: float) -> None:
    """The remainder of a step of a number falls with its square, and is small beside the derivative times the step."""
    s = design.analysis.number_derivatives([key], 1e-10).s[0]
    found = [float(np.linalg.norm(put(design, key, h) - design.x - h * s)) for h in (step, 0.5 * step)]
    size = step * float(np.linalg.norm(s))
    assert size > 1e-9, f"{key}: nothing to compare with"
    assert found[0] < 0.25 * size, f"{key}: {found} beside {size}"
    assert found[1] < 1e-10 or 1.6 < np.log2(found[0] / found[1]) < 2.4, f"{key}: {found}"


MATERIAL = {
    "material.cotton.E": 200.0,
    "material.cotton.nu": 1e-3,
    "material.cotton.rho": 0.5,
    "material.cotton.thickness": 3e-7,
    "material.cotton.bending": 1e-8,
    "effects.gravity.g.2": 0.01,
    "effects.gravity.g.0": 0.002,
    "effects.contact.thickness": 1e-6,
    "effects.contact.stiffness": 100.0,
    "effects.contact.slip": 1e-7,
    "bodies.ball.friction": 1e-3,
    "bodies.ball.sphere.radius": 2e-6,
    "bodies.ball.sphere.center.2": 1e-5,
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["morley", "hinge"])
def test_numbers_of_cloth_that_lies_on_a_rough_ball(tmp_path, kind):
    design = DrapeDesign(tmp_path, sheet(kind, BALL.format(friction=0.4), CONTACT))
    assert design.analysis.derivative(design.direction()[None], 1e-8).sticking > 50
    for key, step in MATERIAL.items():
        check(design, key, step)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["morley", "hinge", "nonlinear"])
def test_numbers_of_cloth_with_a_grain_that_is_clamped(tmp_path, kind):
    design = DrapeDesign(tmp_path, knit(kind, CLAMPED))
    steps = {
        "material.cotton.grain": 1e-2,
        "material.cotton.orthotropic.E.1": 2e3,
        "material.cotton.bending.0": 2e-7,
        "material.cotton.bending.1": 2e-7,
        "start.turn.1": 1e-3,
        "start.turn.2": 1e-3,
        "parameters.lift": 1e-3,
    }
    for key, step in steps.items():
        check(design, key, step)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "keys"),
    {
        "box": ("center.0", "center.2", "half.2", "rotate.0", "radius"),
        "capsule": ("start.2", "end.0", "end.1", "radius"),
        "cylinder": ("start.0", "end.2", "end.1", "radius", "rounded"),
        "plane": ("point.2", "normal.0"),
    }.items(),
)
def test_numbers_of_bodies(tmp_path, kind, keys):
    tables = (HELD, f"[bodies.it]\n{BODIES[kind]}\nfriction = 0.3\n", CONTACT)
    design = DrapeDesign(tmp_path, sheet("hinge", *tables))
    for key in keys:
        check(design, f"bodies.it.{kind}.{key}", 2e-6)


def test_a_body_alone_takes_cloth_that_lies_on_it_along(tmp_path):
    # Anchors go with the body: nothing else holds the cloth.
    design = DrapeDesign(tmp_path, sheet("hinge", BALL.format(friction=0.4), CONTACT, size=0.05))
    found = design.analysis.number_derivatives([f"bodies.ball.sphere.center.{k}" for k in range(3)], 1e-10)
    for axis, s in enumerate(found.s):
        np.testing.assert_allclose(s, np.broadcast_to(np.eye(3)[axis], s.shape), atol=1e-7)


@pytest.mark.slow
def test_body_pins_and_cloth_that_move_together_give_that_motion(tmp_path):
    design = DrapeDesign(tmp_path, sheet("hinge", HELD, BALL.format(friction=0.3), CONTACT))
    for k in range(3):
        keys = [f"bodies.ball.sphere.center.{k}", f"start.move.{k}"]
        s = design.analysis.number_derivatives(keys, 1e-10).s.sum(axis=0)
        np.testing.assert_allclose(s, np.broadcast_to(np.eye(3)[k], s.shape), atol=1e-6)


def test_stiffness_and_weight_that_grow_together_change_nothing(tmp_path):
    design = DrapeDesign(tmp_path, sheet("morley", HELD, size=0.05))
    cotton = design.scene.material["cotton"]
    keys = [f"material.cotton.{name}" for name in ("E", "rho", "bending")]
    s = design.analysis.number_derivatives(keys, 1e-10).s
    change = cotton.E * s[0] + cotton.rho * s[1] + cotton.bending * s[2]
    assert np.abs(change).max() < 1e-7 * np.abs(cotton.rho * s[1]).max()


def test_numbers_of_panels_of_two_fabrics(tmp_path):
    text = re.sub(r"\[shape\].*?(?=\[material)", TWO_FABRICS, knit("hinge", size=0.05), count=1, flags=re.S)
    design = DrapeDesign(tmp_path, text)
    steps = {
        "material.cotton.rho": 5.0,
        "material.cotton.orthotropic.E.0": 3e3,
        "material.cotton.orthotropic.G.0": 8e2,
        "material.linen.rho": 5.0,
        "material.linen.E": 3e4,
    }
    for key, step in steps.items():
        check(design, key, step)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["morley", "hinge"])
def test_numbers_of_cloth_that_lies_on_itself_with_friction(tmp_path, kind):
    design = DrapeDesign(tmp_path, folded(kind))
    # Pulled on over itself, most of its layers come to the end of their slip.
    for pulled in (-0.103, -0.1035):
        design.take(design.scene_with("supports.right.fix.x", pulled))
    history = design.problem.self_contact.history
    slid = np.linalg.norm(history.offsets[history.touching.forces > 0.0], axis=1) / 1e-4
    assert (slid > 0.99).sum() > 5 and (slid < 0.9).sum() > 1, "some layers slide, and some stick"
    found = design.analysis.derivative(design.direction()[None], 1e-8)
    assert not found.note and found.sliding + found.sticking > 10
    steps = {
        "material.cotton.rho": 0.5,
        "material.cotton.bending": 1e-9,
        "supports.right.fix.x": 1e-6,
        "effects.contact.self_friction": 8e-4,
        "effects.contact.slip": 4e-8,
        "effects.gravity.g.1": 1e-3,
    }
    for key, step in steps.items():
        check(design, key, step)


def test_what_is_no_number_is_refused(tmp_path):
    design = DrapeDesign(tmp_path, sheet("hinge", HELD, size=0.05))
    for key in ("material.cotton", "material.silk.E", "mesh.size", "effects.gravity.g.7", "effects.drape.tolerance"):
        with pytest.raises(UserError, match=r"drapes have no derivative|is no number"):
            design.analysis.number_derivatives([key], 1e-8)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("{}", 'at = ["k", 0]'), "panels.one.at.0"),
        (("{}", 'angle = "k/m"'), "panels.one.angle"),
        (("{}", 'radius = "twice"'), "panels.one.radius"),
        (("{}", 'move = ["k", 0, 0]'), "panels.one.move.0"),
        (('"0.3 mm"', '"0.3 mm + 0*k"'), "material.cotton.thickness"),
        (("self = true", 'self = true\nslip = "k"'), "effects.contact.slip"),
    ],
)
def test_a_parameter_of_what_is_settled_is_refused(tmp_path, given, said):
    """Of what lays a panel, or where reading the scene leaves no formula; also through another parameter."""
    text = (
        head("cloth")
        + PANEL
        + COTTON.format(kind="hinge", bending=5e-6)
        + "[effects.contact]\nself = true\n"
        + meshed(0.1)
    )
    old, new = given
    text = text.replace("#", new) if old == "{}" else text.replace(old, new)
    design = DrapeDesign(tmp_path, text)
    with pytest.raises(UserError, match=re.escape(said)):
        design.analysis.number_derivatives(["parameters.k"], 1e-8)


@pytest.mark.parametrize("key", ["parameters.k", "parameters.m", "bodies.post.capsule.end.2"])
def test_a_body_that_places_what_is_held_is_refused(tmp_path, key):
    """A panel that begins on a body is held where it begins; the friction of the body has a derivative."""
    body = 'capsule = { start = [0, 0, "m - 1"], end = [0, 0, 1], radius = "0.05*k" }\nfriction = 0.2\n'
    tables = f"[bodies.post]\n{body}[effects.contact]\n"
    text = head("cloth") + PANEL.replace("#", 'around = "post"') + COTTON.format(kind="hinge", bending=5e-6)
    analysis = DrapeDesign(tmp_path, text + tables + meshed(0.1)).analysis
    with pytest.raises(UserError, match="wrapped around post"):
        analysis.number_derivatives([key], 1e-8)
    assert np.isfinite(analysis.number_derivatives(["bodies.post.friction"], 1e-8).s).all()


def test_a_parameter_acts_through_others(tmp_path):
    """A clamp that is lifted by twice a parameter lifts a sheet without weight by as much."""
    table = '[parameters]\nk = 0\ntwice = "2*k"\nlift = "twice + k"\n[supports.clamp]\non = "left"\n'
    table += 'fix = { x = 0, y = 0, z = "lift", slope = 0 }\n'
    text = sheet("hinge", table, size=0.05).replace("[effects.gravity]", "")
    found = DrapeDesign(tmp_path, text, ["effects.drape.tolerance=1e-3"]).analysis
    s = found.number_derivatives(["parameters.k"], 1e-8).s[0]
    np.testing.assert_allclose(s, np.broadcast_to([0.0, 0.0, 3.0], s.shape), atol=1e-6)


@pytest.mark.parametrize("kind", ["morley", "hinge"])
def test_a_singular_tangent_is_stiffened_in_bending_and_says_so(tmp_path, kind):
    # Limp flat cloth without weight: nothing but its bending holds it across its plane. It goes where its clamp goes.
    table = '[parameters]\nlift = 0\n[supports.clamp]\non = "left"\nfix = { x = 0, y = 0, z = "lift", slope = 0 }\n'
    for bending, note in ((1e-8, False), (1e-16, True)):
        text = sheet(kind, table, bending=bending).replace("[effects.gravity]", "")
        design = DrapeDesign(tmp_path, text, ["effects.drape.tolerance=1e-3"])
        found = design.analysis.number_derivatives(["parameters.lift"], 1e-8)
        assert ("1/100" in found.note) == note
        corners = design.problem.corners(found.s[0])
        np.testing.assert_allclose(corners, np.broadcast_to([0.0, 0.0, 1.0], corners.shape), atol=1e-6)
    assert design.problem.fabric.bending[0, 0] == 1e-16


def test_what_a_hand_holds_stays_as_the_scene_moves_its_cloth(tmp_path):
    check(
        DrapeDesign(tmp_path, sheet("morley", HELD, HOLD, "[start]\nmove = [0, 0, 0]\n", size=0.05)),
        "start.move.2",
        1e-5,
    )
