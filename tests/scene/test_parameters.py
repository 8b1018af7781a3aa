"""Numbers of scenes by formulas of parameters, and parameters by formulas of each other."""

import re

import pytest
from parametric_scenes import PLATE, scene_of, write_scene

from restshape.errors import UserError
from restshape.scene.given_numbers import edited_number, given_numbers
from restshape.scene.load import load_scene, revise


def refusal(folder, *overrides, body=PLATE):
    with pytest.raises(UserError) as caught:
        scene_of(folder, body, *overrides)
    return caught.value


def test_parameters_may_be_formulas_of_others_in_any_order(tmp_path):
    body = PLATE.replace('width = "30 cm"', 'c = "b + 1 cm"\na = "2*b"\nwidth = "a/2 + c"\nb = "4 cm"')
    known = scene_of(tmp_path, body).parameters
    assert known["a"] == 0.08 and known["c"] == pytest.approx(0.05) and known["width"] == pytest.approx(0.09)


def test_a_circle_of_parameters_is_reported_by_its_chain(tmp_path):
    body = PLATE.replace('width = "30 cm"', 'width = "2*r"')
    found = refusal(tmp_path, body=body)
    assert found.where.startswith("plate.toml: parameters.")
    assert re.search(r"line \d+", found.where)
    for step in ("width = '2*r'", "r = 'height/5'", "height = 'width/3'"):
        assert step in found.what
    chain = re.search(r": ([\w> -]+) \(", found.what)[1].split(" -> ")
    assert chain[0] == chain[-1] and sorted(chain[1:]) == ["height", "r", "width"]


@pytest.mark.slow
def test_a_long_chain_of_parameters_is_read(tmp_path):
    lines = "\n".join(f'p{i} = "p{i + 1}"' for i in range(3000))
    body = PLATE.replace("[parameters]", f"[parameters]\n{lines}\np3000 = 0.25")
    assert scene_of(tmp_path, body).parameters["p0"] == 0.25


@pytest.mark.parametrize(
    ("change", "key", "words"),
    [
        (('["width", 0]', '["widht", 0]'), "shape.vertices.b.0", ("widht", "did you mean 'width'?")),
        (('"height/5"', '"heigth/5"'), "parameters.r", ("heigth", "did you mean 'height'?")),
        (('["width", 0]', '["x", 0]'), "shape.vertices.b.0", ("x or y",)),
        (('"height/5"', '"height/y"'), "parameters.r", ("x or y",)),
        (('["width", 0]', '["width*height", 0]'), "shape.vertices.b.0", ("is an area", "a length is wanted")),
        (('["width", 0]', '["width + P", 0]'), "shape.vertices.b.0", ("adds a length and a force",)),
        (('["width", 0]', '["width + 2 kg", 0]'), "shape.vertices.b.0", ("adds a length and a mass",)),
        (('["width", 0]', '["2*(3 kg)", 0]'), "shape.vertices.b.0", ("is a mass", "a length is wanted")),
        (('thickness = "5 mm"', 'thickness = "P"'), "material.steel.thickness", ("is a force",)),
        (('"height/5"', '"log(0)"'), "parameters.r", ("gives -inf",)),
        (('radius = "r"', 'radius = "r - height"'), "shape.holes.bore.circle.radius", ("greater than 0",)),
    ],
)
def test_what_a_formula_may_not_be_is_refused_at_its_line(tmp_path, change, key, words):
    path = write_scene(tmp_path)
    text = path.read_text(encoding="utf-8")
    assert change[0] in text
    path.write_text(text.replace(*change, 1), encoding="utf-8")
    with pytest.raises(UserError) as caught:
        load_scene(path)
    found = caught.value
    line = next(i for i, one in enumerate(path.read_text(encoding="utf-8").splitlines(), 1) if change[1] in one)
    assert found.where == f"plate.toml: {key} (line {line})"
    assert all(word in str(found) for word in words)


def test_a_sum_of_temperatures_on_a_scale_is_a_temperature_on_it(tmp_path):
    body = PLATE.replace("[parameters]", '[parameters]\nwarm = "40 degC"\nhot = "warm + 10 K"\ntwice = "hot + warm"')
    assert "zero of their own" in refusal(tmp_path, body=body).what


EVERYWHERE = [
    ("mesh.size", '"r/4"', 0.005),
    ("mesh.edges_per_circle", '"4*n"', 12),
    ("mesh.near", '{bore = "r/10"}', {"bore": 0.002}),
    ("mesh.min_quality", '"n/10"', 0.3),
    ("solve.tolerance", '"n/3000"', 1e-3),
    ("material.steel.E", '"stiff"', 2e11),
    ("material.steel.nu", '"n/10"', 0.3),
    ("material.steel.thickness", '"r/4"', 0.005),
    ("quantities.tip.max", '"r/20"', 1e-3),
    ("effects.gravity.g", '[0, "-fall"]', [0.0, -9.81]),
    ("effects.large_deformation.load_steps", '"5*n"', 15),
    ("shape.points", '{gauge = ["r", "2*r"]}', {"gauge": (0.02, 0.04)}),
]


@pytest.mark.parametrize(("key", "formula", "number"), EVERYWHERE, ids=[case[0] for case in EVERYWHERE])
def test_a_formula_is_as_good_as_its_number(tmp_path, key, formula, number):
    body = PLATE.replace('r = "height/5"', 'r = "2 cm"\nn = 3\nstiff = "200 GPa"\nfall = "9.81 m/s^2"')
    table, *_ = key.split(".")
    by_formula = getattr(scene_of(tmp_path, body, f"{key}={formula}"), table)
    written = str(number).replace("'", '"').replace("(", "[").replace(")", "]").replace(": ", "=")
    by_number = getattr(scene_of(tmp_path, body, f"{key}={written}"), table)
    assert by_formula == by_number


def test_a_formula_of_a_whole_number_gives_one(tmp_path):
    found = refusal(tmp_path, 'mesh.edges_per_circle="25/2"')
    assert "12.5" in found.what and "whole number" in found.what


def test_formulas_follow_a_parameter_that_is_revised(tmp_path):
    scene = scene_of(tmp_path)
    wider = revise(scene, "parameters.width", "60 cm")
    assert wider.shape.vertices["c"] == (0.6, 0.6 / 3) and wider.shape.holes["bore"].circle.radius == 0.6 / 3 / 5
    assert wider.loads is scene.loads and wider.shape is not scene.shape


def test_given_numbers_have_keys_values_and_dimensions(tmp_path):
    found = {".".join(one.key): one for one in given_numbers(scene_of(tmp_path))}
    assert found["shape.holes.bore.circle.radius"].value == pytest.approx(0.02)
    assert found["shape.vertices.c.1"].symbol == "m" and found["loads.pull.force.1"].symbol == "N"
    assert "parameters.height" in found and "parameters.width" not in found and "shape.vertices.a.0" not in found


def test_setting_a_given_number_sets_its_parameter_or_says_which(tmp_path):
    scene = scene_of(tmp_path)
    assert edited_number(scene, "shape.vertices.b.0", 0.4) == "parameters.width"
    assert edited_number(scene, "shape.vertices.a.0", 0.4) == "shape.vertices.a.0"
    assert edited_number(scene, "shape.holes.bore.circle.radius", "r/2") == "shape.holes.bore.circle.radius"
    for key, names in (
        ("shape.holes.bore.circle.center.0", ("parameters.width",)),
        ("shape.holes.bore.circle.radius", ("parameters.r", "parameters.height")),
        ("loads.pull.force", ("loads.pull.force.1", "parameters.P")),
    ):
        with pytest.raises(UserError) as caught:
            edited_number(scene, key, [0, 1] if key.endswith("force") else 1)
        assert all(name in str(caught.value) for name in names)
    # A quantity is no formula: it would take the place of one without a word.
    with pytest.raises(UserError, match=r"parameters\.P"):
        edited_number(scene, "loads.pull.force", [0, "-3 kN"])
    assert edited_number(scene, "loads.pull.force", [0, "2*P"]) == "loads.pull.force"
