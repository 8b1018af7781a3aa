"""Derivatives of frequencies by numbers of the scene: homogeneity, closed forms, full solves, and refusals."""

import json

import numpy as np
import pytest
from modal import SMALL, solved
from restshape_apps.metallophone import application

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.sensitivity.parameter_derivative import parameter_derivatives

PLATE = ["effects.modal.model=plate", "effects.modal.modes=3", 'mesh.size="10 mm"', "solve.tolerance=1e-9"]

SCENES = application.folder / "scenes"


@pytest.mark.parametrize("model", SMALL)
def test_modulus_and_density_as_homogeneity_wants_them(model):
    analysis = solved(model)
    (name,) = analysis.state.scene.material
    material, f = analysis.state.scene.material[name], analysis.frequencies
    assert material.E * parameter_derivatives(analysis, f"material.{name}.E") == pytest.approx(0.5 * f, rel=1e-7)
    assert material.rho * parameter_derivatives(analysis, f"material.{name}.rho") == pytest.approx(-0.5 * f, rel=1e-7)


@pytest.mark.parametrize("key, value", [("nu", 0.33), ("thickness", 0.004)])
@pytest.mark.parametrize("model", ["tet4", "tet10", "plate"])
def test_other_numbers_as_full_solves_have_them(model, key, value):
    key = f"material.aluminium.{key}"
    h = 1e-3 * value
    ahead, behind = (solved(model, f"{key}={value + step}").frequencies for step in (h, -h))
    found = parameter_derivatives(solved(model), key)
    assert found == pytest.approx((ahead - behind) / (2 * h), rel=1e-4)


def test_parameter_in_the_formula_of_a_thickness_is_the_thickness(tmp_path):
    scene = tmp_path / "bar.toml"
    text = (SCENES / "bar_100.toml").read_text()
    scene.write_text(text.replace("[shape]", "[parameters]\ndepth = 0.004\n\n[shape]", 1))
    formula = [*PLATE, "material.aluminium.thickness='depth + 0*x'"]
    by_parameter = parameter_derivatives(first_frame(scene, formula).analysis, "parameters.depth")
    direct = parameter_derivatives(first_frame(SCENES / "bar_100.toml", PLATE).analysis, "material.aluminium.thickness")
    assert by_parameter == pytest.approx(direct, rel=1e-6)


@pytest.mark.parametrize("value", ["0", "1e-12", "-1e-7", "1e-5"])
def test_what_is_added_to_a_thickness_is_the_thickness_however_small(tmp_path, value):
    """Near 0 a number does not show its scale: steps of 1e-4 of it, or of 0.1 mm, would be too short or too long."""
    scene = tmp_path / "bar.toml"
    text = (SCENES / "bar_100.toml").read_text()
    scene.write_text(text.replace("[shape]", f"[parameters]\nmore = {value}\n\n[shape]", 1))
    formula = [*PLATE, f"material.aluminium.thickness='0.004 - ({value}) + more + 0*x'"]
    by_parameter = parameter_derivatives(first_frame(scene, formula).analysis, "parameters.more")
    direct = parameter_derivatives(first_frame(SCENES / "bar_100.toml", PLATE).analysis, "material.aluminium.thickness")
    assert by_parameter == pytest.approx(direct, rel=5e-6)


def test_number_without_effect(tmp_path):
    scene = tmp_path / "bar.toml"
    text = (SCENES / "bar_100.toml").read_text()
    scene.write_text(text.replace("[shape]", "[parameters]\nidle = 0\n\n[shape]", 1))
    assert not parameter_derivatives(first_frame(scene, PLATE).analysis, "parameters.idle").any()


def test_moduli_of_wood_add_up_to_half_the_frequency():
    plate = first_frame(SCENES / "rosewood.toml", ["effects.modal.modes=2", 'mesh.size="20 mm"']).analysis
    wood = plate.state.scene.material["wood"].orthotropic
    total = np.zeros(2)
    for which, moduli in (("E", wood.E), ("G", wood.G)):
        for k, modulus in enumerate(moduli):
            total += modulus * parameter_derivatives(plate, f"material.wood.orthotropic.{which}.{k}")
    assert total == pytest.approx(0.5 * plate.frequencies, rel=1e-6)


def test_pair_of_a_square_plate_has_the_rate_of_its_thickness_twice():
    square = first_frame(SCENES / "supported.toml", ["mesh.size=0.8", "effects.modal.modes=3"]).analysis
    found = 0.05 * parameter_derivatives(square, "material.steel.thickness")
    assert found == pytest.approx(square.frequencies, rel=2e-3)


@pytest.mark.parametrize("key", ["shape.vertices.a", "material.aluminium.name", "parameters.none", "material.tin.E"])
def test_what_is_no_number_or_moves_the_mesh_is_refused(key):
    with pytest.raises(UserError, match=r"number|parameter"):
        parameter_derivatives(solved("tet4"), key)


def test_command_prints_numbers_and_the_outline(tmp_path, capsys):
    scene, out = str(SCENES / "bar_100.toml"), tmp_path / "d.json"
    settings = [word for override in PLATE for word in ("--set", override)]
    assert main(["rates", scene, *settings, "--outline", "--json", str(out)]) == 0
    assert "0.1 mm off edge" in capsys.readouterr().out
    reported = json.loads(out.read_text())
    assert set(reported["by"]) == {f"material.aluminium.{key}" for key in ("E", "nu", "rho", "thickness")}
    first = reported["outline"][0]
    assert set(first["edges"]) == {"bottom", "right", "top", "left"}
    ends = sum(np.dot(first["edges"][k]["density"], first["edges"][k]["length"]) for k in ("left", "right"))
    # f ~ 1/L^2, and both ends move.
    assert ends == pytest.approx(-4.0 * first["frequency"] / 0.1, rel=0.02)


def test_command_refuses_what_is_no_number(capsys):
    assert main(["rates", str(SCENES / "bar_100.toml"), "--by", "material.aluminium.colour"]) == 2
    assert "no number" in capsys.readouterr().err
