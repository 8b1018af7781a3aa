"""Singular places of plane solids: exponents against closed forms, and against what refined meshes show."""

import json
import math

import numpy as np
import pytest
from scipy.optimize import brentq
from small_scenes import HEAD, make_replay, write_scene, write_script

from restshape.physics.elasticity.corner_exponents import CLAMPED, FREE, exponent, kolosov, least_root
from restshape.physics.elasticity.singular_places import singular_places, singular_quantities
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec

ARM = (
    HEAD
    + """
[shape]
outline = ["bottom", "tip", "top", "wall"]
vertices = { a = [0, 0], b = [0.3, 0.04], c = [0.3, 0.1], d = [0, 0.12] }
[shape.edges]
bottom = { line = ["a", "b"] }
tip = { line = ["b", "c"] }
top = { line = ["c", "d"] }
wall = { line = ["d", "a"] }
[shape.holes.window]
circle = { center = [0.09, 0.062], radius = 0.022 }
[material.steel]
name = "steel"
thickness = 0.008
[effects.solid]
model = "plane_stress"
[supports.wall]
on = "wall"
fix = ["x", "y"]
[loads.weight]
on = "tip"
force = [0, -2000]
[mesh]
size = 0.016
order = 1
near = { d = NEAR }
[quantities]
peak = { stress = "von_mises" }
corner = { stress = "von_mises", at = "d" }
at_window = { stress = "von_mises", at = "window" }
mean = { stress = "von_mises", at = "wall", reduce = "mean" }
tip = { displacement = "y", at = "c" }
"""
)
NOTCHED = (
    HEAD
    + """
[shape]
outline = ["s1", "s2", "s3", "s4", "s5", "s6"]
vertices = { a = [0, 0], b = [2, 0], c = [2, 1], n = [1, 1], e = [1, 2], f = [0, 2] }
[shape.edges]
s1 = { line = ["a", "b"] }
s2 = { line = ["b", "c"] }
s3 = { line = ["c", "n"] }
s4 = { line = ["n", "e"] }
s5 = { line = ["e", "f"] }
s6 = { line = ["f", "a"] }
[material.m]
E = 1e9
nu = 0.3
thickness = 0.1
[effects.solid]
model = "plane_strain"
[supports.roller]
on = "s6"
fix = ["x"]
[supports.floor]
on = "s1"
fix = ["y"]
[loads.up]
on = "s5"
traction = [0, 1e3]
[loads.poke]
on = "c"
force = [1, 0]
[mesh]
size = 0.2
[quantities]
peak = { stress = "von_mises" }
far = { stress = "von_mises", at = "s6" }
poked = { displacement = "x", at = "c" }
beside = { displacement = "x", at = "b" }
"""
)


def shape_of(scene):
    return outline_from_spec(scene.shape, scene.folder)


@pytest.mark.parametrize(("angle", "known"), [(2 * math.pi, 0.5), (1.5 * math.pi, 0.544484)])
def test_free_corners(angle, known):
    # Williams 1952: a crack has r^(-1/2); at 270 degrees mode I has 0.5445.
    for found in (exponent(angle, FREE, FREE, 2.0), least_root(angle, FREE, FREE, 2.0)):
        assert found.real == pytest.approx(known, abs=1e-6)
        assert math.sin(found.real * angle) == pytest.approx(-found.real * math.sin(angle), abs=1e-6)


def test_a_convex_free_corner_is_regular():
    assert exponent(math.pi / 2, FREE, FREE, 2.0) is None and exponent(math.pi, FREE, FREE, 2.0) is None


@pytest.mark.parametrize("nu", [0.0, 0.2, 0.3, 0.45])
@pytest.mark.parametrize("degrees", [70, 82.4, 90, 120])
def test_a_clamped_side_beside_a_free_one_in_plane_stress(degrees, nu):
    # Williams 1952, clamped-free in plane stress: sin^2(l w) = (4 - (1 + nu)^2 l^2 sin^2 w) / ((3 - nu)(1 + nu)).
    w = math.radians(degrees)

    def williams(lam):
        share = (3 - nu) * (1 + nu)
        return np.sin(lam * w) ** 2 - (4 - (1 + nu) ** 2 * lam**2 * math.sin(w) ** 2) / share

    found = exponent(w, CLAMPED, FREE, kolosov(nu, False))
    grid = np.linspace(0.05, 0.998, 400)
    crossing = next((k for k in range(399) if williams(grid[k]) * williams(grid[k + 1]) < 0), None)
    if found is None:
        # Without contraction the body can go along with the support.
        assert crossing is None and nu == 0.0
        return
    assert abs(williams(found)) < 1e-7
    if crossing is None:
        # Two real roots have met, and those that follow are complex.
        assert found.imag > 0.1
        return
    assert found.real == pytest.approx(brentq(williams, grid[crossing], grid[crossing + 1]), abs=1e-8)


def test_a_punch_oscillates():
    # Muskhelishvili: at the end of a clamped part of a straight edge lambda = 1/2 + i log(kappa) / (2 pi).
    kappa = kolosov(0.3, True)
    assert exponent(math.pi, CLAMPED, FREE, kappa) == pytest.approx(
        complex(0.5, math.log(kappa) / (2 * math.pi)), abs=1e-7
    )


def test_what_slides_mirrors_a_free_corner():
    # A side that slides is the line of symmetry of a corner of twice the angle.
    slides = ((0.0, 1.0),)
    assert exponent(0.75 * math.pi, slides, FREE, 2.0) == pytest.approx(
        exponent(1.5 * math.pi, FREE, FREE, 2.0), abs=1e-8
    )
    assert exponent(math.pi / 2, slides, FREE, 2.0) is None


def test_places_and_quantities(tmp_path):
    scene = load_scene(write_scene(tmp_path, NOTCHED))
    outline = shape_of(scene)
    found = {place.name: place for place in singular_places(scene, outline)}
    assert set(found) == {"n", "c"} and found["c"].exponent == 0.0
    assert found["n"].exponent == pytest.approx(0.544484, abs=1e-6) and found["n"].cause == "re-entrant corner"
    assert {name: place.name for name, place in singular_quantities(scene, outline).items()} == {
        "peak": "c",
        "poked": "c",
    }


def test_the_window_of_an_arm_is_regular_and_its_wall_is_not(tmp_path):
    scene = load_scene(write_scene(tmp_path, ARM.replace("NEAR", "0.004")))
    assert set(singular_quantities(scene, shape_of(scene))) == {"peak", "corner"}


def test_meshes_show_the_exponent(tmp_path):
    sizes, values = [0.004, 0.002, 0.001, 0.0005], []
    for size in sizes:
        made = make_replay(write_scene(tmp_path, ARM.replace("NEAR", str(size))), write_script(tmp_path, []))
        values.append(next(made.frames())["q_corner"])
    scene = load_scene(tmp_path / "scene.toml")
    place = singular_quantities(scene, shape_of(scene))["corner"]
    slope = np.polyfit(np.log(sizes), np.log(values), 1)[0]
    assert slope == pytest.approx(place.exponent - 1.0, abs=0.05)


def test_check_and_replay_mark_them(tmp_path, restshape):
    scene = write_scene(tmp_path, ARM.replace("NEAR", "0.016"))
    reported = restshape("check", scene, "--json", "a.json")
    warnings = json.loads((tmp_path / "a.json").read_text())["warnings"]
    assert reported.returncode == 0 and len(warnings) == 2 and all("end of a support d" in one for one in warnings)
    assert "mass" in reported.stdout and "bounding box" in reported.stdout and 'reduce = "mean"' in reported.stdout
    reported = restshape("replay", scene, "--json", "a.json")
    marked = json.loads((tmp_path / "a.json").read_text())["singular"]
    assert set(marked) == {"peak", "corner"} and "corner is taken at a singular place (r^-0." in reported.stdout
