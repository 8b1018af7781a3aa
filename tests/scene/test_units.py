"""Units: against the definitions of the units themselves."""

import math

import pytest

from restshape.errors import UserError
from restshape.outputs.si_numbers import si
from restshape.scene.expressions import Expression, NoFormula
from restshape.scene.units import DIMENSIONS, EXAMPLES, UnitError, length_unit, quantity, reads_as_quantity, unit


@pytest.mark.parametrize("power", range(-12, 13, 3))
def test_what_is_printed_with_a_prefix_can_be_written(power):
    printed = si(3.5 * 10.0**power, "Pa")
    assert quantity(printed, "pressure") == pytest.approx(3.5 * 10.0**power, rel=1e-12)


@pytest.mark.parametrize(
    ("made", "of"),
    [
        ("C", "A s"),
        ("V", "W/A"),
        ("ohm", "V/A"),
        ("F", "C/V"),
        ("Wb", "V s"),
        ("V A", "W"),
        ("C V", "J"),
        ("F ohm", "s"),
    ],
)
def test_electrical_units_are_those_of_the_si(made, of):
    assert unit(made) == unit(of)


@pytest.mark.parametrize(
    ("text", "dimension", "si"),
    [
        ("12 mm", "length", 0.012),
        ("12mm", "length", 0.012),
        ("-1.5e1 cm", "length", -0.15),
        ("1 in", "length", 0.0254),
        ("1 ft", "length", 12 * 0.0254),
        ("2.5", "length", 2.5),
        (2, "length", 2.0),
        ("210 GPa", "pressure", 210e9),
        ("1 N/mm^2", "pressure", 1e6),
        ("1 lb", "mass", 0.45359237),
        ("1 lbf", "force", 0.45359237 * 9.80665),
        ("1 lbf/in^2", "pressure", 6894.757293168361),
        ("1 ksi", "pressure", 6894757.293168361),
        ("1 N/mm²", "pressure", 1e6),
        ("7850 kg/m^3", "density", 7850.0),
        ("7.85 g/cm^3", "density", 7850.0),
        ("7.85 t/m^3", "density", 7850.0),
        ("30 deg", "angle", math.pi / 6),
        ("180°", "angle", math.pi),
        ("5 kN", "force", 5000.0),
        ("3 N m", "moment", 3.0),
        ("3 N*m", "moment", 3.0),
        ("9.81 m/s^2", "acceleration", 9.81),
        ("9.81 m/s/s", "acceleration", 9.81),
        ("35 kN/m", "stiffness", 35e3),
        ("440 Hz", "frequency", 440.0),
        ("1 min", "time", 60.0),
        ("30 %", "number", 0.3),
        ("77 kN/m^3", "body force", 77e3),
        ("12 MPa", None, 12e6),
        ("3 W/(cm K)", None, 300.0),
        ("2 kJ/(g K)", None, 2e6),
    ],
)
def test_text_becomes_si(text, dimension, si):
    assert quantity(text, dimension) == pytest.approx(si, rel=1e-14)


def test_wrong_dimension_names_both():
    with pytest.raises(UnitError, match="is a length, but a pressure is wanted"):
        quantity("12 mm", "pressure")


@pytest.mark.parametrize(
    ("text", "remedy"), [("\u2212100 N", "minus sign of the keyboard"), ("-100,5 N", "decimal point, as in 2.5")]
)
def test_signs_of_word_processors_and_decimal_commas_have_a_remedy(text: str, remedy: str):
    with pytest.raises(NoFormula) as caught:
        Expression(text)
    assert remedy in caught.value.do


@pytest.mark.parametrize("text", ["max(1,2", "max(1,2)[0]"])
def test_commas_between_arguments_are_no_decimal_commas(text: str):
    with pytest.raises(NoFormula) as caught:
        Expression(text)
    assert "decimal point" not in (caught.value.do or "")


def test_both_letters_for_micro_are_read():
    assert quantity("5000 \u03bcm", "length") == quantity("5000 \u00b5m", "length") == pytest.approx(5e-3)
    assert float(Expression("1 \u03bcm + 1 mm").evaluate(0.0, 0.0, {})) == pytest.approx(1.001e-3)


def test_an_angle_is_no_number():
    with pytest.raises(UnitError, match="is an angle, but a length is wanted"):
        quantity("30 deg", "length")


def test_a_dimension_without_a_name_is_spelled_out():
    with pytest.raises(UnitError, match="a quantity in kg m, but a force"):
        quantity("1 kg m", "force")
    with pytest.raises(UnitError, match=r"a quantity in kg/m, but a pressure"):
        quantity("1 Pa s^2", "pressure")
    with pytest.raises(UnitError, match=r"a quantity in 1/m\^2, but a length"):
        quantity("1 m^-2", "length")


def test_a_mass_by_area_is_reported_what_density_it_makes():
    with pytest.raises(UnitError) as reported:
        quantity("500 g/m^2", "density")
    assert "is a quantity in kg/m^2, but a density is wanted: divide it by the thickness" in str(reported.value)
    # half a kilogram on 0.4 litres
    assert '0.4 mm thick have rho = "1250 kg/m^3"' in str(reported.value)


@pytest.mark.parametrize(
    ("text", "dimension", "remedy"),
    [
        ("25 C", "temperature", 'write "25 degC"'),
        ("77 F", "temperature", 'write "25 degC"'),
        ("0.1 m/s*t", "velocity", 'write a = "0.1 m/s" in [parameters], and "a*t/(1 s)" here'),
    ],
)
def test_a_unit_that_looks_like_another_thing_is_reported_with_what_was_meant(text: str, dimension: str, remedy: str):
    with pytest.raises(UnitError) as reported:
        quantity(text, dimension)
    assert remedy in str(reported.value)


@pytest.mark.parametrize(
    "text", ["12 parsec", "12 mm mm/", "twelve mm", "", "nan", "inf", "1e999", "12 m//s", "1 m**2"]
)
def test_what_is_no_quantity_is_refused(text):
    with pytest.raises(UnitError):
        quantity(text, "length")


@pytest.mark.parametrize("value", [float("nan"), float("inf"), True, None, [1.0]])
def test_what_is_no_number_is_refused(value):
    with pytest.raises(UnitError):
        quantity(value, "length")


def test_examples_have_the_dimension_they_stand_for():
    for dimension, example in EXAMPLES.items():
        assert math.isfinite(quantity(example.strip('"'), dimension))
    assert set(EXAMPLES) == set(DIMENSIONS)


def test_a_slash_holds_for_one_factor():
    assert unit("N/m s")[1] == (0, 1, -1, 0, 0, 0, 0)


def test_formulas_do_not_read_as_quantities():
    assert reads_as_quantity("12 mm") and reads_as_quantity("1e3")
    assert not any(reads_as_quantity(text) for text in ("x", "-P*y", "2*x", "3/x", "1 + 2"))
    # A minus in a unit stands before an exponent; a name with one is a unit that is not known.
    assert all(map(reads_as_quantity, ("1 m-3", "2 kg m^-3", "1e-3 m", "3 N-m")))
    assert not any(map(reads_as_quantity, ("25 mm - t", "-90 deg - lean", "1 m - 0.1*t", "2 m - 3 m", "5 mm-lean")))


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("100 N*mu", '"(100 N)*mu"'),
        ("-100 N*mu", '"-(100 N)*mu"'),
        ("-1000 kg/m^3*mu", 'a = "1000 kg/m^3" in [parameters], and "-a*mu" here'),
        ("100 N*2*mu", '"(100 N)*2*mu"'),
        ("100 N-mu*20 N", '"(100 N)-mu*(20 N)"'),
        ("1000 kg/m^3*mu", 'a = "1000 kg/m^3" in [parameters], and "a*mu" here'),
        ("1000 kg/m^3*9.81 m/s^2", 'a = "1000 kg/m^3", b = "9.81 m/s^2" in [parameters], and "a*b" here'),
    ],
)
def test_messages_say_how_formulas_that_begin_with_a_unit_are_written(text, written):
    with pytest.raises(UnitError) as reported:
        quantity(text, "force")
    assert "reads as one number with the unit" in reported.value.what
    assert reported.value.do == f"if it is a formula, write {written}"


def test_what_is_proposed_for_formulas_is_one():
    known = {"a": 1000.0, "b": 9.81, "mu": 0.3}
    for text, value in (("(100 N)*mu", 30.0), ("(100 N)-mu*(20 N)", 94.0), ("a*b", 9810.0)):
        assert float(Expression(text).evaluate(0.0, 0.0, known)) == pytest.approx(value)
    name, do = Expression("2*1000 kg/m^3").missing(known)
    assert name == "m" and "compound unit" in do


def test_length_unit():
    assert length_unit("mm", "units") == 1e-3
    with pytest.raises(UserError, match="units"):
        length_unit("kg", "units")


@pytest.mark.parametrize("written", ["5: furlong", "a: b", "3 mm: 2"])
def test_a_colon_in_what_was_written_does_not_tear_the_message(written):
    with pytest.raises(UnitError) as found:
        quantity(written, "length")
    assert repr(written) in found.value.what and "mm" in found.value.do


def test_a_unit_may_be_one_over_another():
    """Not so where the one belongs to the number: 21/s is a formula."""
    assert unit("1/s") == unit("Hz") and unit("1/(m s)") == unit("Pa s/kg") != unit("1/m")
    assert quantity("50 1/s", "frequency") == 50.0
    assert reads_as_quantity("3.4e-3 1/K") and not reads_as_quantity("21/s")
    with pytest.raises(UnitError, match="which is no unit"):
        quantity("3.4e-3 1/degC", None)
    with pytest.raises(UnitError, match=r"quantity in 1/K|expansion"):
        quantity("3.4e-3 1/K", "length")


def test_a_temperature_on_a_scale_is_no_other_number_of_kelvins():
    with pytest.raises(UnitError, match="'5 degC' is a temperature, but a length is wanted"):
        quantity("5 degC", "length")
    assert quantity("5 degC", "temperature") == pytest.approx(278.15)
