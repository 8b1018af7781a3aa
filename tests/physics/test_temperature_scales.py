"""Temperatures in degC: what formulas make of them, against sums by hand, and what is no temperature."""

import numpy as np
import pytest
from restshape_studies.stability.scenery import write_scene
from thermal_scenes import COOLING, HEAD, SQUARE, solved

from restshape.errors import ReplayProblem, UserError
from restshape.scene.expressions import Expression, ExpressionError
from restshape.scene.load import load_scene
from restshape.scene.units import UnitError, quantity

ZERO = 273.15


@pytest.mark.parametrize(
    ("text", "kelvins"),
    [
        ("20 degC + 10 K", ZERO + 30),
        ("10 K + 20 degC", ZERO + 30),
        ("-20 degC + 5 K", ZERO - 15),
        ("5 K + -20 degC", ZERO - 15),
        ("30 degC - 20 degC", 10.0),
        ("300 K - 20 degC", 6.85),
        ("20 degC + (30 degC - 20 degC)*x", ZERO + 25),
        ("20 degC + 10*x", ZERO + 25),
        ("20 degC + 40 degC - 30 degC", ZERO + 30),
        ("max(20 °C, 290 K + 8 K)", 298.0),
        ("(20 degC)", ZERO + 20),
        ("T + 10 K", 310.0),
    ],
)
def test_a_zero_counts_once(text, kelvins):
    assert Expression(text).evaluate(0.5, 0.0, {"T": 300.0}) == pytest.approx(kelvins, rel=1e-14)


@pytest.mark.parametrize(
    "text",
    [
        "10 degC + 10 degC",
        "10 degC + x + 10 degC",
        "2*20 degC",
        "20 degC/2",
        "(20 degC + 5 K)*x",
        "exp(20 degC)",
        "(20 degC)^2",
        "-(20 degC + 5 K)",
        "max(10 degC + 10 degC, x)",
    ],
)
def test_other_sums_and_products_are_refused_with_what_to_write(text):
    with pytest.raises(ExpressionError, match='as in "20 degC \\+ 10 K"'):
        Expression(text)


def test_nobody_can_write_the_mark_of_a_scale():
    for text in ("20 @ scale_0", "(20.0@scale_0)"):
        with pytest.raises(ExpressionError):
            Expression(text)
    assert Expression("20 degC + x").names == {"x"}


WALL = HEAD + SQUARE + '[parameters]\nwarm = "40 degC"\ncold = "10 degC"\nd = "5 K"\n[material.m]\nconductivity = 2\n'
WALL += '[supports.w]\non = "left"\nfix = { temperature = "TEXT" }\n[mesh]\nsize = 0.5\n'


@pytest.mark.parametrize(
    "text", ["warm + d", "cold + (warm - cold)*x", "(warm + cold)/2", "warm*0.9", "max(warm, cold)"]
)
def test_parameters_on_a_scale_are_temperatures_in_kelvins(tmp_path, text):
    warm, cold = ZERO + 40, ZERO + 10
    values = {"warm": warm, "cold": cold, "d": 5.0, "x": 0.0, "max": max}
    replay = solved(tmp_path, WALL.replace("TEXT", text))
    left = replay.analysis.space.nodes_of("left")
    np.testing.assert_allclose(replay.analysis.x[left, 0], eval(text, values), rtol=1e-12)


@pytest.mark.parametrize("text", ["warm + cold", "warm + 10 degC"])
def test_parameters_on_a_scale_are_not_added(tmp_path, text):
    with pytest.raises(UserError) as caught:
        load_scene(write_scene(tmp_path, WALL.replace("TEXT", text)))
    assert "supports.w.fix.temperature" in caught.value.where and "20 degC + 10 K" in caught.value.do


@pytest.mark.parametrize("text", ["-300 degC", "-1 K", -1, "-273.16 °C"])
def test_nothing_is_colder_than_absolute_zero(text):
    with pytest.raises(UnitError, match="below absolute zero"):
        quantity(text, "temperature")
    assert quantity("-273.15 degC", "temperature") == 0.0


def test_a_difference_may_be_negative_and_a_parameter_on_a_scale_not():
    assert quantity("-300 K", None) == -300.0
    with pytest.raises(UnitError, match="below absolute zero"):
        quantity("-300 degC", None)


AIR = '[loads.air]\non = "right"\nconvection = { film = 5, ambient = "-300 degC" }\n'


@pytest.mark.parametrize(
    ("text", "key"),
    [
        (WALL.replace("TEXT", "-300 degC"), "supports.w.fix.temperature"),
        (WALL.replace("TEXT", "cold - 300*d"), "supports.w.fix.temperature"),
        (WALL.replace("TEXT", "1") + AIR, "loads.air.convection.ambient"),
        (COOLING.replace("initial = 0", 'initial = "-1 K"'), "effects.storage.initial"),
    ],
)
def test_scenes_below_absolute_zero_are_refused_by_key(tmp_path, text, key):
    with pytest.raises(UserError, match="below absolute zero") as caught:
        load_scene(write_scene(tmp_path, text))
    assert key in caught.value.where


def test_a_list_fixes_no_temperature(tmp_path):
    text = WALL.replace('{ temperature = "TEXT" }', '["temperature"]')
    with pytest.raises(UserError, match="absolute zero") as caught:
        load_scene(write_scene(tmp_path, text))
    assert caught.value.where.startswith("scene.toml: supports.w.fix") and '"20 degC"' in caught.value.do


def test_a_formula_of_places_is_refused_where_it_falls_below(tmp_path):
    with pytest.raises((UserError, ReplayProblem), match=r"supports\.w\.fix\.temperature: a temperature of -5 K"):
        solved(tmp_path, WALL.replace("TEXT", "10 - 15*x - 15"))


def test_units_that_are_listed_hold_the_scale():
    with pytest.raises(UnitError, match="%, cent, degC, or a prefix"):
        quantity("20 warm", "temperature")
