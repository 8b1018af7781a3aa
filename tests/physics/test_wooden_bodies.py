"""Scenes whose material has a grain, in each model: slender bars bend with the modulus of their direction."""

from pathlib import Path

import numpy as np
import pytest

from restshape.interface.first_frame import first_frame

LENGTH, WIDTH, THICKNESS = 0.4, 0.02, 0.004
MODULUS, DENSITY = {0: 14.3e9, 90: 1.53e9}, 825.0
"""Young's moduli [Pa] of rosewood by the angle of its grain [deg] to the bar, and its density [kg/m^3]."""

SCENE = """
format = "restshape-scene"
version = 1
app = "modes"
[shape]
outline = ["bottom", "right", "top", "left"]
vertices = {{ a = [0, 0], b = [0.4, 0], c = [0.4, 0.02], d = [0, 0.02] }}
[shape.edges]
bottom = {{ line = ["a", "b"] }}
right = {{ line = ["b", "c"] }}
top = {{ line = ["c", "d"] }}
left = {{ line = ["d", "a"] }}
[material.wood]
name = "rosewood"
grain = "{grain} deg"
thickness = "4 mm"
[effects.modal]
model = "{model}"
modes = 1
[mesh]
size = "10 mm"
order = {order}
[solve]
tolerance = 1e-6
"""


def first(folder: Path, model: str, grain: float) -> float:
    """The lowest frequency [Hz] of the bar."""
    path = folder / "bar.toml"
    path.write_text(SCENE.format(model=model, grain=grain, order=1 if model == "plate" else 2))
    return float(first_frame(path).row["f_1"])


@pytest.mark.parametrize("model", ["solid", "plate", "plane_stress"])
@pytest.mark.parametrize("grain", [0, 90])
def test_bar_bends_with_the_modulus_of_its_direction(tmp_path, model, grain):
    """22.3733/(2 pi) sqrt(E I / rho A) / L^2, less at most 1 % for the shear; in the plane over the width."""
    depth, tolerance = (WIDTH, 0.08) if model == "plane_stress" else (THICKNESS, 0.01)
    beam = 22.3733 / (2 * np.pi) * np.sqrt(MODULUS[grain] / DENSITY / 12) * depth / LENGTH**2
    ours = first(tmp_path, model, grain)
    assert beam * (1 - tolerance) < ours < beam * 1.001


def test_solid_and_plate_agree_between_the_axes(tmp_path):
    solid, plate = (first(tmp_path, model, 40) for model in ("solid", "plate"))
    assert plate == pytest.approx(solid, rel=0.01)
    assert first(tmp_path, "solid", 90) < solid < first(tmp_path, "solid", 0)


@pytest.mark.parametrize(
    "fix, twists", [('["z"]', True), ('["z", "rx"]', True), ('["z", "ry"]', False), ('["rx", "ry"]', False)]
)
def test_sides_twist_where_no_support_holds_their_rotation(tmp_path, fix, twists):
    """Along the bottom, which runs in x, the twisting moment turns the normal about y."""
    path = tmp_path / "held.toml"
    held = f'[supports.ground]\non = "bottom"\nfix = {fix}\n[effects.modal]'
    path.write_text(SCENE.format(model="plate", grain=0, order=1).replace("[effects.modal]", held))
    body = first_frame(path).analysis.state.body
    rim, mesh = body.space.rim(), body.space
    bottom = rim & (np.abs(mesh.X[mesh.cells, 1]) + np.abs(mesh.X[np.roll(mesh.cells, -1, axis=1), 1]) < 1e-12)
    assert bottom.any() and np.all(body.stiffness.parameters[:, 11:][bottom] == twists)
    free = body.stiffness.parameters[:, 11:]
    assert np.all(free[rim & ~bottom] == 1) and not free[~rim].any()
