"""Units of parameters are looked at where formulas use them."""

import pytest
from furniture_scenes import BENCH, write_bench

from restshape.errors import UserError
from restshape.scene.load import load_scene


def bench(folder, parameters: str, thickness: str):
    """A bench whose boards are as thick as a formula says."""
    return write_bench(folder, f"[parameters]\n{parameters}\n{BENCH}".replace("thickness = 0.02", thickness))


@pytest.mark.parametrize(
    ("parameters", "formula", "reported"),
    [
        ('t = "18 kg"', "t", "'t' is a mass (t = '18 kg'), but a length is wanted"),
        ('t = "18 kg"', "t/2", "'t/2' is a mass"),
        ('t = "18 mm"', "t*t", "'t*t' is an area"),
        ('t = "18 mm"\na = "200 deg"', "t + a", "adds a length and a number"),
        ('t = "18 mm"\nm = "2 kg"', "max(t, m)", "adds a length and a mass"),
        ('t = "18 mm"\nm = "2 kg"', "t + 2*m", "adds a length and a mass"),
    ],
)
def test_a_parameter_of_another_dimension_is_refused(tmp_path, parameters, formula, reported):
    with pytest.raises(UserError) as caught:
        load_scene(bench(tmp_path, parameters, f'thickness = "{formula}"'))
    assert reported in caught.value.what and "wood.thickness" in caught.value.where


@pytest.mark.parametrize(
    ("parameters", "formula", "metres"),
    [
        ('t = "18 mm"', "t/2 + 0.01", 0.019),
        ('t = "18 mm"\nL = "9 mm"', "t*L/(t + L)", 0.006),
        ('t = "18 mm"', "sqrt(t^2)", 0.018),
        ('m = "2 kg"', "0.01*m", 0.02),
        ('r = "20 mm"\na = "90 deg"', "2*r*a/pi", 0.02),
        ('t = "18 mm"\nk = 2', "k*t", 0.036),
        ('t = "18 mm"', "t - 3 mm", 0.015),
    ],
)
def test_what_may_be_a_length_is_taken(tmp_path, parameters, formula, metres):
    scene = load_scene(bench(tmp_path, parameters, f'thickness = "{formula}"'))
    assert float(scene.wood.thickness.evaluate(0, 0, scene.parameters)) == pytest.approx(metres, rel=1e-12)


def test_a_place_wants_three_numbers(tmp_path):
    text = BENCH.replace('mass = "20 kg"', 'mass = "20 kg"\nat = [0.5, 0]')
    with pytest.raises(UserError, match=r"three numbers \[x, y, z\]"):
        load_scene(write_bench(tmp_path, text))


def test_an_unknown_unit_lists_those_that_are_known(tmp_path):
    with pytest.raises(UserError) as caught:
        load_scene(write_bench(tmp_path, BENCH.replace("20 kg", "20 stone")))
    assert "stone" in caught.value.what and all(f" {unit}," in caught.value.do for unit in ("g", "ft", "psi"))
