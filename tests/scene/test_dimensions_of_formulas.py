"""What units in formulas say of their values: which are refused, and which are left alone."""

from pathlib import Path

import pytest

from restshape.scene.expressions import PLACES_AND_TIME, Expression
from restshape.scene.scene_parameters import read_parameters
from restshape.scene.source import Source
from restshape.scene.units import UnitError

WRITTEN = {"h": "6 cm", "u": "0.1 m/s", "n": 3}


def check(text, wanted="velocity"):
    parameters = read_parameters({"parameters": WRITTEN}, Source(Path("scene.toml")))
    return parameters.check_units(Expression(text, wanted, PLACES_AND_TIME))


@pytest.mark.parametrize(
    ("text", "what", "do"),
    [
        ("0.1*y*(0.06 s - y)", "adds a time and y, which is a length", 'write "1*y"'),
        ("0.1*max(3 kg, -x)", "adds a mass and x, which is a length", 'write "1*x"'),
        ("0.1*(t + h)", "adds a length and t, which is a time", 'write "1*t"'),
        ("4*y*(0.06 m - y)/(0.06 m)^2", "is a number, but a velocity is wanted", '[parameters] a = "1.5 m/s"'),
        ("3*(0.06 m)", "is a length, but a velocity is wanted", "multiply by a parameter"),
        ("2*y*(3 Pa)", "is a stiffness, but a velocity is wanted", "multiply by a parameter"),
        ("u*u*y", "but a velocity is wanted", "give the parameter another unit"),
        ("sqrt((4 m)*(1 m))", "is a length, but a velocity is wanted", "multiply by a parameter"),
        ("u*sin(0.06 m)", "takes sin of a length", "divide by another length"),
        ("u*2^(3 s)", "has a time as an exponent", "divide it by another time"),
        ("u*atan2(1 s, h)", "adds a time and a length", "units that fit"),
    ],
)
def test_what_does_not_fit_is_refused_with_what_to_do(text, what, do):
    with pytest.raises(UnitError) as caught:
        check(text)
    assert what in caught.value.what and do in caught.value.do


@pytest.mark.parametrize(
    "text",
    [
        "4*y*(1 - y)",
        "0.1*y*(0.06 m - y)",
        "u*4*y*(h - y)/h^2",
        "u*4*y*(1 - y)",
        "u*(1 + 0.2*x)*sin(2*pi*t)",
        "u*exp(-((t - 1)/0.4)^2)",
        "u*sin(x - t)",
        "u*sin(2*pi*x/h)",
        "u*min(1, t/2)",
        "y/(2 s)",
        "u*(1*y + h)/h",
        "u*n^x",
        "sqrt(u*u)",
    ],
)
def test_coordinates_may_be_numbers_where_nothing_with_a_unit_is_added_to_them(text):
    check(text)


def test_documented_temperatures_stay_temperatures():
    for text in ("20 degC + 10 K*x", "20 degC + 5*x", "300 K + 10 K*x"):
        check(text, "temperature")
    with pytest.raises(UnitError, match="adds a temperature and x, which is a length"):
        check("20 degC + x", "temperature")
