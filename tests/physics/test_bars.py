"""Stretched bars: states of uniform stress, which linear triangles meet exactly."""

import numpy as np
import pytest
from small_scenes import HEAD, block, make_replay, meshed, rows_of, write_scene

from restshape.errors import UserError

E, NU, THICKNESS, LENGTH, HEIGHT, PULL = 2e11, 0.3, 0.01, 2.0, 0.5, 1e8
ROLLERS = """
[supports.left]
on = "left"
fix = ["x"]
[supports.pin]
on = "a"
fix = ["y"]
"""
TRACTION = f'[loads.pull]\non = "right"\ntraction = [{PULL}, 0]\n'
TIGHT = "[solve]\ntolerance = 1e-12\n"
QUANTITIES = """
[quantities]
stretch = { displacement = "x", at = "right", reduce = "mean" }
top = { displacement = "y", at = "top", reduce = "mean" }
xx = { stress = "xx", reduce = "max" }
least = { stress = "xx", reduce = "min" }
xy = { stress = "xy", reduce = "absmax" }
mises = { stress = "von_mises", reduce = "max" }
principal = { stress = "max_principal", reduce = "min" }
energy = { energy = "strain" }
area = { area = true }
reaction = { reaction = "x", at = "left" }
"""


def material(name="steel", e=E, nu=NU, thickness=THICKNESS, region=""):
    """One material's table."""
    return f"[material.{name}]\nE = {e}\nnu = {nu}\nthickness = {thickness}\n{region}\n"


def bar(folder, model="plane_stress", materials=None, loads=TRACTION, supports=ROLLERS, shape="", overrides=()):
    """The first row of a bar on rollers."""
    solid = f'[effects.solid]\nmodel = "{model}"\n'
    text = HEAD + block(LENGTH, HEIGHT) + shape + (materials or material()) + solid + supports + loads
    path = write_scene(folder, text + meshed(0.2) + TIGHT + QUANTITIES)
    return rows_of(make_replay(path, overrides=overrides))[0]


def test_plane_stress(tmp_path):
    row = bar(tmp_path)
    assert row["q_stretch"] == pytest.approx(PULL / E * LENGTH, rel=1e-9)
    assert row["q_top"] == pytest.approx(-NU * PULL / E * HEIGHT, rel=1e-9)
    for name in ("xx", "least", "mises", "principal"):
        assert row[f"q_{name}"] == pytest.approx(PULL, rel=1e-9), name
    assert row["q_xy"] < 1e-6 * PULL
    assert row["q_area"] == pytest.approx(LENGTH * HEIGHT, rel=1e-12)
    assert row["q_energy"] == pytest.approx(PULL**2 / (2 * E) * LENGTH * HEIGHT * THICKNESS, rel=1e-9)
    assert row["q_reaction"] == pytest.approx(-PULL * HEIGHT * THICKNESS, rel=1e-9)


def test_plane_strain(tmp_path):
    row = bar(tmp_path, "plane_strain")
    assert row["q_stretch"] == pytest.approx(PULL * (1 - NU**2) / E * LENGTH, rel=1e-9)
    assert row["q_top"] == pytest.approx(-PULL * NU * (1 + NU) / E * HEIGHT, rel=1e-9)
    zz = NU * PULL
    mises = np.sqrt(0.5 * (PULL**2 + zz**2 + (PULL - zz) ** 2))
    assert row["q_mises"] == pytest.approx(mises, rel=1e-9)


def test_twice_the_thickness_bears_twice_the_force(tmp_path):
    force = '[loads.pull]\non = "right"\nforce = [1e5, 0]\n'
    thin, thick = (bar(tmp_path, materials=material(thickness=t), loads=force) for t in (0.01, 0.02))
    assert thin["q_stretch"] == pytest.approx(1e5 / (0.01 * HEIGHT) / E * LENGTH, rel=1e-9)
    assert thick["q_stretch"] == pytest.approx(thin["q_stretch"] / 2, rel=1e-9)


SERIES = f"""
[shape]
outline = ["bottom1", "bottom2", "right", "top2", "top1", "left"]
groups = {{ top = ["top1", "top2"] }}

[shape.vertices]
a = [0, 0]
m = [0.5, 0]
b = [{LENGTH}, 0]
c = [{LENGTH}, {HEIGHT}]
n = [0.5, {HEIGHT}]
d = [0, {HEIGHT}]

[shape.edges]
bottom1 = {{ line = ["a", "m"] }}
bottom2 = {{ line = ["m", "b"] }}
right = {{ line = ["b", "c"] }}
top2 = {{ line = ["c", "n"] }}
top1 = {{ line = ["n", "d"] }}
left = {{ line = ["d", "a"] }}
middle = {{ line = ["m", "n"] }}

[shape.regions]
soft = {{ loop = ["bottom1", "middle", "top1", "left"] }}
"""


def test_two_materials_in_series(tmp_path):
    # Without lateral contraction both parts are stretched uniformly.
    materials = material("hard", nu=0) + material("soft", e=E / 10, nu=0, region='region = ["soft"]')
    solid = '[effects.solid]\nmodel = "plane_stress"\n'
    text = HEAD + SERIES + materials + solid + ROLLERS + TRACTION + meshed(0.2) + TIGHT + QUANTITIES
    row = rows_of(make_replay(write_scene(tmp_path, text)))[0]
    assert row["q_stretch"] == pytest.approx(PULL / E * (1.5 + 0.5 * 10), rel=1e-9)


def test_prescribed_stretch(tmp_path):
    pulled = ROLLERS + '[supports.right]\non = "right"\nfix = { x = 0.002 }\n'
    row = bar(tmp_path, loads="", supports=pulled)
    assert row["q_stretch"] == pytest.approx(0.002, rel=1e-12)
    assert row["q_xx"] == pytest.approx(E * 0.001, rel=1e-9)
    assert row["q_reaction"] == pytest.approx(-E * 0.001 * HEIGHT * THICKNESS, rel=1e-9)


def test_prescribed_by_a_formula_of_a_parameter(tmp_path):
    pulled = ROLLERS + '[supports.right]\non = "right"\nfix = { x = "stretch*x" }\n[parameters]\nstretch = 0.001\n'
    row = bar(tmp_path, loads="", supports=pulled, overrides=["parameters.stretch=3e-3"])
    assert row["q_stretch"] == pytest.approx(3e-3 * LENGTH, rel=1e-12)


def test_a_bar_that_hangs_stores_the_energy_of_its_own_weight(tmp_path):
    # The potential of the weight is no strain energy: with it the sum would be -1 times this.
    length, width, rho, g = 2.0, 0.2, 8000.0, 9.81
    made = f"[material.steel]\nE = {E}\nnu = 0\nrho = {rho}\nthickness = {THICKNESS}\n"
    effects = f'[effects.solid]\nmodel = "plane_stress"\n[effects.gravity]\ng = [0, {-g}]\n'
    held = '[supports.top]\non = "top"\nfix = ["x", "y"]\n'
    asked = (
        '[quantities]\ntip = { displacement = "y", at = "bottom", reduce = "mean" }\nenergy = { energy = "strain" }\n'
    )
    text = HEAD + block(width, length) + made + effects + held + meshed(0.05) + TIGHT + asked
    row = rows_of(make_replay(write_scene(tmp_path, text)))[0]
    assert row["q_tip"] == pytest.approx(-rho * g * length**2 / (2 * E), rel=1e-3)
    energy = (rho * g) ** 2 * length**3 * width * THICKNESS / (6 * E)
    assert row["q_energy"] == pytest.approx(energy, rel=2e-3)


@pytest.mark.parametrize(
    "supports",
    [
        "",
        '[supports.s]\non = "a"\nfix = ["x", "y"]\n',
        '[supports.s]\non = "left"\nfix = ["x"]\n',
        '[supports.s]\non = "bottom"\nfix = ["y"]\n',
    ],
)
def test_a_body_that_may_move_as_a_whole_is_refused(tmp_path, supports):
    with pytest.raises(UserError, match="free to move"):
        bar(tmp_path, supports=supports)


def test_three_rollers_hold_a_body(tmp_path):
    supports = '[supports.s]\non = "a"\nfix = ["x", "y"]\n[supports.r]\non = "b"\nfix = ["y"]\n'
    load = '[loads.f]\non = "top"\nforce = [0, -1000]\n'
    row = bar(tmp_path, supports=supports, loads=load)
    assert np.isfinite(row["q_energy"]) and row["q_energy"] > 0
