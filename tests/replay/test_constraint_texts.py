"""Violated constraints in words: a limit is the one that was written, and the value can be reported from it."""

import pytest

from restshape.outputs.si_numbers import si
from restshape.replay.constraints import Limit, formatted_constraint, violated_constraints
from restshape.scene.descriptions import with_symbol
from restshape.scene.quantity import in_unit, limit_in_unit
from restshape.shape.drawings.gaps import Gap


@pytest.mark.parametrize(
    ("value", "limit", "text"),
    [
        (373.1123, Limit(most=363.15, unit="K"), "q is 373.11 K, at most 363.15 K"),
        (363.1512, Limit(most=363.15, unit="K"), "q is 363.1512 K, at most 363.15 K"),
        (270.0, Limit(least=273.15, unit="K"), "q is 270 K, at least 273.15 K"),
        (-12.34567, Limit(least=-12.345, unit="W"), "q is -12.346 W, at least -12.345 W"),
        (0.0032137, Limit(most=0.003, unit="m"), "q is 3.214 mm, at most 3 mm"),
        (0.35, Limit(most=1 / 3), "q is 0.35, at most 0.333333"),
        (1 + 1e-15, Limit(most=1.0, unit="N"), "q is 1.000000000000001 N, at most 1 N"),
        (1e-3, Limit(most=0.0, unit="m"), "q is 1 mm, at most 0 m"),
    ],
)
def test_value_and_limit_are_distinguished(value, limit, text):
    (found,) = violated_constraints({"q": limit}, {"q": value})
    assert formatted_constraint(found) == text


def test_units_have_the_prefixes_of_reports():
    assert in_unit("Pa", 6.111e7, 4) == "61.11 MPa" and limit_in_unit("Pa", 3e7) == "30 MPa"
    assert in_unit("m", 5.39e-5) == si(5.39e-5, "m", 6) == "53.9 µm"
    # What has a prefix of its own, or would be read otherwise, stays.
    assert in_unit("kg", 0.05) == "0.05 kg" and limit_in_unit("K", 1363.15) == "1363.15 K"
    assert with_symbol(7850.0, "density") == "7850 kg/m^3" and with_symbol(2.1e11, "pressure") == "210 GPa"
    assert str(Gap((0.1, 0.2), 5.39e-5, ("a", "b"))) == "53.9 µm at (0.1, 0.2) m, between a and b"
