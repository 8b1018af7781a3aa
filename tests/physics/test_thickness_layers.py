"""Layers of tetrahedra over thick plates, against exact waves of three-dimensional elasticity."""

import re

import numpy as np
import pytest
from modal import SCENES, solved
from scipy.optimize import brentq

from restshape.interface.first_frame import first_frame
from restshape.physics.elasticity.inspection import inspect_vibrating
from restshape.physics.elasticity.thickness_layers import layers_of, usual_layers
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec

E, NU, RHO = 210e9, 0.3, 7850.0
THICK = 0.35
"""Thickness [m] of a plate of 1 m."""
PLATE = f"""
format = "restshape-scene"
version = 1
app = "modes"
[shape]
outline = ["bottom", "right", "top", "left"]
vertices = {{ a = [0, 0], b = [1, 0], c = [1, 1], d = [0, 1] }}
[shape.edges]
bottom = {{ line = ["a", "b"] }}
right = {{ line = ["b", "c"] }}
top = {{ line = ["c", "d"] }}
left = {{ line = ["d", "a"] }}
[material.steel]
E = {E}
nu = {NU}
rho = {RHO}
thickness = {THICK}
[supports.x]
on = ["bottom", "top"]
fix = ["x", "z"]
[supports.y]
on = ["left", "right"]
fix = ["y", "z"]
[effects.modal]
modes = 1
[mesh]
size = 0.25
[solve]
tolerance = 1e-4
"""
"""A thick square plate whose sides can neither sink nor slide along themselves: each of its waves is one of Lamb's."""


def lamb(k: float, h: float) -> float:
    """Frequency [Hz] of the lowest antisymmetric wave of Rayleigh and Lamb of wave number k in a plate of thickness h.

    Source: J. D. Achenbach, Wave Propagation in Elastic Solids (1973), section 6.7.
    """
    G = E / (2 * (1 + NU))
    shear, pressure = G / RHO, G / RHO * (2 - 2 * NU) / (1 - 2 * NU)

    def residual(omega: float) -> float:
        a, b = np.sqrt(k**2 - omega**2 / pressure), np.sqrt(k**2 - omega**2 / shear)
        return 4 * a * b * k**2 * np.tanh(b * h / 2) - (k**2 + b**2) ** 2 * np.tanh(a * h / 2)

    slow = k * np.sqrt(shear)
    return brentq(residual, 1e-3 * slow, (1 - 1e-9) * slow, xtol=1e-10 * slow) / (2 * np.pi)


@pytest.fixture
def plate(tmp_path):
    path = tmp_path / "plate.toml"
    path.write_text(PLATE)
    return path


def test_thin_waves_are_those_of_kirchhoff():
    """The reference itself, where a closed form is known."""
    D = E * 1e-9 / (12 * (1 - NU**2))
    assert lamb(5.0, 1e-3) == pytest.approx(25.0 * np.sqrt(D / (RHO * 1e-3)) / (2 * np.pi), rel=1e-5)


def test_one_layer_over_a_thick_plate_is_reported_its_error(plate):
    """What one layer leaves is not a matter of the triangles: the estimate has it, and the usual layers do not."""
    exact = lamb(np.sqrt(2.0) * np.pi, THICK)
    one = first_frame(plate, ["mesh.layers=1"]).analysis
    usual = first_frame(plate).analysis
    errors = [analysis.frequencies[0] / exact - 1.0 for analysis in (one, usual)]
    assert usual.state.body.space.layers == 2
    assert errors[0] > 0.015 and 0.0 < errors[1] < 0.3 * errors[0]
    for analysis, error in zip((one, usual), errors):
        assert 0.5 < analysis.errors()["estimate"] / error < 2.0


@pytest.mark.parametrize("mode", ["bending", "torsion"])
@pytest.mark.parametrize("size", ["10 mm", "6 mm"])
def test_modes_of_a_bar(mode, size):
    """Torsion, whose shear decays in a layer at the free sides, is estimated as well as bending."""
    # The first by p-FEM (see the scene), the second of two layers of 2 mm, which its estimate has 0.1 % too high.
    exact = {"bending": 2089.35, "torsion": 4013.35}[mode]
    bar = first_frame(
        SCENES / "bar_100.toml",
        ["mesh.order=2", "mesh.layers=1", f'mesh.size="{size}"', "effects.modal.modes=2", "solve.tolerance=1e-5"],
    ).analysis
    rank = {"bending": 0, "torsion": 1}[mode]
    estimated = bar._estimate(bar.state)[rank]
    assert 0.5 < estimated / (bar.frequencies[rank] / exact - 1.0) < 2.0


@pytest.mark.parametrize(("thickness", "layers"), [("2 mm", 1), ("4 mm", 1), ("10 mm", 2), ("20 mm", 2), ("30 mm", 3)])
def test_layers_by_thickness(thickness, layers):
    overrides = ["effects.modal.modes=5", f'material.aluminium.thickness="{thickness}"']
    scene = load_scene(SCENES / "bar_100.toml", overrides)
    assert usual_layers(scene).count == layers
    assert layers_of(scene) == 2  # of the scene itself
    assert usual_layers(load_scene(SCENES / "bar_100.toml", [*overrides, "effects.modal.modes=1"])).count <= layers


def test_wood_that_shears_easily_gets_more_layers():
    scene = load_scene(SCENES / "bar_100.toml", ["effects.modal.modes=5"])
    stiff = scene.material["aluminium"]
    G = stiff.E / (2 * (1 + stiff.nu))
    constants = f"E=[{stiff.E},{stiff.E},{stiff.E}],nu=[0.33,0.33,0.33],G=[{G},{G / 10},{G / 10}]"
    wood = f'material.aluminium={{orthotropic={{{constants}}},rho=600,thickness="4 mm"}}'
    found = usual_layers(load_scene(SCENES / "bar_100.toml", ["effects.modal.modes=5", wood]))
    assert found.count == 2 and found.shear > 5 * usual_layers(scene).shear


def test_check_says_what_layers_there_are(tmp_path, plate):
    scenes = [load_scene(plate, more) for more in ([], ["mesh.layers=1"])]
    outline = outline_from_spec(scenes[0].shape, plate.parent)
    usual, named = (inspect_vibrating(scene, outline) for scene in scenes[:2])
    assert usual.data["layers"] == 2 and dict(usual.rows)["layers"].startswith("2: the thickness is 0.35 m")
    assert not usual.warnings and named.data["layers"] == 1
    assert any("mesh.layers" in warning and "leave it out" in warning for warning in named.warnings)
    thin = tmp_path / "thin.toml"
    thin.write_text(re.sub(r"fix = \[.*?\]", 'fix = ["z"]', plate.read_text()))
    assert "layers" not in inspect_vibrating(load_scene(thin, ["effects.modal.model=plate"]), outline).data


def test_displacements_that_are_quadratic_over_the_thickness_stay_the_same_polynomial():
    """On a body of another thickness, whose nodes lie at other heights."""
    thin, thick = (solved("tet10", f"material.aluminium.thickness={t}").state.body for t in (0.004, 0.007))
    a, b, c = np.random.default_rng(1).uniform(-1.0, 1.0, (3, len(thin.plane.X), 1, 3))

    def displacements(body):
        z = body.space.X.reshape(len(a), -1, 3)[:, :, 2:]
        return (a + 1e3 * b * z + 1e6 * c * z**2).reshape(1, -1)

    assert not np.allclose(displacements(thin), displacements(thick), rtol=0.1)
    np.testing.assert_allclose(thick.taken_over(displacements(thin), thin), displacements(thick), atol=1e-12)
    modes = np.random.default_rng(2).uniform(-1.0, 1.0, displacements(thin).shape)
    assert thin.taken_over(modes, thin) is modes


def test_modes_that_are_taken_over_to_another_thickness_have_nearly_its_eigenvalues():
    """On the same nodes, as displacements, they have a multiple of them."""
    thin, thick = (solved("tet10", f"material.aluminium.thickness={t}") for t in (0.004, 0.0042))
    pencil, modes = thick.solver.pencil, thin.state.modes.vectors[:3]
    known = thick.state.modes.values[:3]

    def quotients(rows):
        stiff = np.empty_like(rows)
        pencil.apply(pencil.stiffness, rows, stiff)
        return np.einsum("ki,ki->k", rows, stiff) / pencil.norms(rows) / known

    assert quotients(modes).max() > 1.5
    np.testing.assert_allclose(quotients(thick.state.body.taken_over(modes, thin.state.body)), 1.0, atol=1e-3)
