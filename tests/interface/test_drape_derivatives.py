"""Derivatives of quantities of cloth, which rests where its way has led: beside differences of frames from there."""

import pytest
from cloths import BALL, CONTACT, write_cloth

import restshape

LOW = '[quantities]\nlowest = { displacement = "z", reduce = "min" }\npotential = { energy = "potential" }\n'


@pytest.fixture(params=["solve", "effects.drape"])
def sim(tmp_path, request):
    """Cloth on a ball that has gone aside, which is another rest than that of cloth that falls on it there."""
    scene = restshape.load(
        write_cloth(tmp_path, BALL, CONTACT, LOW), "mesh.size=0.15", f"{request.param}.tolerance=1e-9"
    )
    with restshape.open(scene) as opened:
        with opened.press("ball") as hand:
            hand.along([[0.55, 0.52, -0.3]], frames=2)
        yield opened


def differences(ends) -> dict[str, float]:
    """Of quantities at two ends."""
    return {name: ends[0][name] - ends[1][name] for name in ends[0]}


def test_the_derivative_by_a_number_is_that_of_the_rest_that_is_shown(sim):
    found = sim.frame.derivative("material.cotton.E")
    step, ends = 2e3, []
    for value in (2e6 + step, 2e6 - step):
        ends.append(sim.set("material.cotton.E", value).quantities)
        sim.undo()
    for name, difference in differences(ends).items():
        assert found[name] == pytest.approx(difference / (2.0 * step), rel=2e-2)


def test_the_derivative_by_a_drag_is_that_of_the_rest_that_is_shown(sim):
    found = sim.frame.derivative("c")
    step, ends = 1e-5, []
    with sim.press("c") as hand:
        for place in ((1.0 + step, 1.0), (1.0 - step, 1.0)):
            ends.append(hand.to(*place).quantities)
    for name, difference in differences(ends).items():
        assert found[name][0] == pytest.approx(difference / (2.0 * step), rel=1e-2)


def test_a_number_at_the_end_of_what_it_may_be_is_named(sim):
    sim.set("bodies.ball.friction", 0.0)
    with pytest.raises(restshape.UserError, match=r"no derivative at 0, for -0\.0001 is refused"):
        sim.frame.derivative("bodies.ball.friction")
