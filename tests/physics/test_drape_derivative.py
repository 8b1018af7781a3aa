"""Derivatives of drapes along a hand on the pattern: Taylor remainders, invariances, each part that enters alone."""

import json
import re

import numpy as np
import pytest
from drape_designs import BALL, CLAMPED, CONTACT, HELD, HOLD, DrapeDesign, folded, sheet
from small_scenes import across, drag, write_scene, write_script

from restshape._kernels import Body
from restshape.errors import ReplayProblem
from restshape.physics.cloth.contact.contact import Contact, FrictionHistory
from restshape.physics.cloth.sensitivity.agreed_contact import AgreedContact

WAY = -3e-3
"""Of pins along y [m]."""
KINDS = ("morley", "hinge", "nonlinear")
DRAPES = {
    "pinned": (sheet, (HELD,), 1e-3),
    "clamped": (sheet, (CLAMPED,), 1e-3),
    "on a smooth ball": (sheet, (HELD, BALL.format(friction=0.0), CONTACT), 2e-4),
    "on a rough ball": (sheet, (BALL.format(friction=0.4), CONTACT), 2e-5),
}


def check_order(design: DrapeDesign, dX: np.ndarray, step: float) -> None:
    """The remainder falls with the square of the step, from one that is seen."""
    first, second = design.remainders(dX, step)
    assert second > 1e-10, "nothing to compare with"
    assert 1.8 < np.log2(first / second) < 2.2


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("drape", DRAPES)
def test_remainder_is_of_second_order(tmp_path, drape, kind):
    text, tables, step = DRAPES[drape]
    design = DrapeDesign(tmp_path, text(kind, *tables))
    check_order(design, design.direction(), step)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_remainder_of_cloth_on_itself_with_friction_is_of_second_order(tmp_path, kind):
    design = DrapeDesign(tmp_path, folded(kind))
    check_order(design, design.direction(), 4e-6)


@pytest.mark.parametrize("kind", ["morley", "hinge"])
def test_moving_the_pattern_in_its_plane_moves_what_is_held_with_it(tmp_path, kind):
    # Pins are where the scene lays the flat cloth: all goes with the material.
    design = DrapeDesign(tmp_path, sheet(kind, HELD, size=0.05))
    s = design.hand(np.broadcast_to([0.6, -0.8], design.X.shape).copy())
    expected = np.zeros_like(s)
    expected[design.problem.corner_number] = [0.6, -0.8, 0.0]
    np.testing.assert_allclose(s, expected, atol=1e-8)


def test_what_a_hand_holds_stays_where_that_is_as_the_material_moves(tmp_path):
    design = DrapeDesign(tmp_path, sheet("morley", HELD, HOLD, size=0.05))
    check_order(design, design.direction(), 1e-4)


def test_cloth_that_is_not_at_rest_has_no_derivative(tmp_path):
    design = DrapeDesign(tmp_path, sheet("hinge", HELD, size=0.05))
    design.analysis.state.report.converged = False
    with pytest.raises(ReplayProblem, match="not at rest"):
        design.hand(design.direction())


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["morley", "hinge"])
def test_places_that_slide_have_normal_forces_that_follow(tmp_path, kind):
    design = DrapeDesign(tmp_path, sheet(kind, HELD, BALL.format(friction=0.02), CONTACT))
    # Pulled over the ball by its pins, it ends where most places have come to the end of their slip.
    design.take(design.scene_with("start.move", [0.0, WAY, 0.0]))
    found = design.analysis.derivative(design.direction()[None], 1e-10)
    assert found.sliding > 20
    # Farther along the same way all that slides goes on.
    s = design.analysis.number_derivatives(["start.move.1"], 1e-10).s[0]
    steps = (1e-2 * WAY / 3, 5e-3 * WAY / 3)
    rests = [design.move(np.zeros_like(design.X), design.scene_with("start.move", [0, WAY + h, 0])) for h in steps]
    first, second = (float(np.linalg.norm(x - design.x - h * s)) for x, h in zip(rests, steps))
    assert first < 0.1 * 1e-5 * np.linalg.norm(s)
    assert 1.7 < np.log2(first / second) < 2.3


def test_across_an_edge_of_a_body_the_remainder_is_of_first_order_and_else_of_second():
    # The surface of a box is flat up to where its edge is rounded: its normal begins to turn there.
    box = Body.box([0.0, 0.0, 0.0], [0.1, 0.1, 0.1], radius=0.02)
    for friction in (0.0, 0.3):
        for place, order in ((0.08 - 1e-9, 1.0), (0.09, 2.0)):
            assert _remainder(box, np.array([[place, 0.0, 0.0995]]), friction) == pytest.approx(order, abs=0.2)


def _remainder(body: Body, x: np.ndarray, friction: float) -> float:
    """The order of the remainder of the force on a point at x (1, 3) along x."""
    contact = Contact([body], np.ones(1), 1e4, 2e-3, friction, 1e-2)
    contact.update_friction(x + np.array([[-3e-3, 1e-3, 0.0]]))
    anchor = contact.history.anchors[0].copy()
    way = np.array([[1.0, 0.0, 0.0]])

    def force(at: np.ndarray) -> np.ndarray:
        contact.history = FrictionHistory(anchor[None].copy(), np.zeros((1, 1, 3)), np.ones((1, 1)))
        contact.update_friction(at)
        return contact.forces(at)

    start = force(x)
    rates = AgreedContact(contact, x, np.zeros(1, dtype=int), 1).rates(way)
    found = [float(np.linalg.norm(force(x + h * way) - start - h * rates)) for h in (1e-4, 5e-5)]
    return float(np.log2(found[0] / found[1]))


def test_drapes_of_one_shape_have_one_derivative(tmp_path):
    # k times as large under 1/k of the weight, its membrane as stiff and bending k^2 times as much: the same shape.
    found = []
    for k in (1.0, 2.0):
        text = sheet("morley", HELD, bending=5e-6 * k**2, size=0.05 * k).replace('"0.2 MPa"', "2e5")
        text = re.sub(r"\b0\.2\b", str(0.2 * k), text)
        text = text.replace("[effects.gravity]", f"[effects.gravity]\ng = [0, 0, {-9.81 / k}]")
        design = DrapeDesign(tmp_path, text)
        found.append((design.X / k, design.hand(design.direction())[design.problem.corner_number] / k))
    np.testing.assert_allclose(found[0][0], found[1][0], atol=1e-12)
    np.testing.assert_allclose(*(s for _, s in found), atol=1e-6)


@pytest.mark.slow
def test_two_ranks_predict_what_one_does(tmp_path, on_ranks):
    quantity = '[quantities]\nlowest = { displacement = "z", reduce = "min" }\nenergy = { energy = "membrane" }\n'
    # Without friction, whose rests depend on the way there.
    text = sheet("hinge", HELD, BALL.format(friction=0.0), CONTACT, quantity, size=0.05)
    path = write_scene(tmp_path, text)
    script = write_script(tmp_path, drag("top", (0.1, 0.2), across((0.1, 0.2), (0.1, 0.201), 4))[:-1])
    found = []
    for ranks in (1, 2):
        words = ("replay", path, "--edits", script, "--predict", "linear", "--json", f"{ranks}.json")
        done = on_ranks(ranks, *words)
        assert done.returncode == 0, done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text()))
    assert [one["predicted"] for one in found] == [4, 4]
    for name, value in found[0]["quantities"].items():
        assert found[1]["quantities"][name] == pytest.approx(value, rel=1e-5)
