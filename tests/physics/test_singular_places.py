"""Singular places of plane solids: exponents against closed forms, and against what refined meshes show."""

import json
import math
from types import SimpleNamespace

import meshio
import numpy as np
import pytest
from scipy.optimize import brentq
from small_scenes import HEAD, make_replay, write_scene, write_script

from restshape.physics.elasticity.corner_exponents import (
    CLAMPED,
    FREE,
    Sector,
    bonded_exponent,
    exponent,
    kolosov,
    least_root,
)
from restshape.physics.elasticity.inspection import inspect_solid
from restshape.physics.elasticity.singular_places import (
    SingularPlace,
    exponents_and_points,
    singular_places,
    singular_quantities,
    warning,
)
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
STRIP = (
    HEAD
    + """
[shape]
outline = ["b1", "b2", "right", "t2", "t1", "left"]
vertices = { a = [0, 0], m = [1, 0], b = [2, 0], c = [2, 1], n = [1, 1], d = [0, 1] }
[shape.edges]
b1 = { line = ["a", "m"] }
b2 = { line = ["m", "b"] }
right = { line = ["b", "c"] }
t2 = { line = ["c", "n"] }
t1 = { line = ["n", "d"] }
left = { line = ["d", "a"] }
mid = { line = ["m", "n"] }
[shape.regions.soft]
loop = ["b2", "right", "t2", "mid"]
[shape.regions.inlay]
polygon = [[0.3, 0.3], [0.7, 0.3], [0.7, 0.7], [0.3, 0.7]]
[material.stiff]
E = 1e11
nu = 0.3
thickness = 0.1
[material.soft]
E = 1e9
nu = 0.45
thickness = 0.1
region = "soft"
[effects.solid]
model = "plane_stress"
[supports.roller]
on = "left"
fix = ["x"]
[supports.pin]
on = "a"
fix = ["y"]
[loads.pull]
on = "right"
traction = [1e3, 0]
[mesh]
size = 0.2
near = { n = NEAR }
[quantities]
top = { stress = "von_mises", at = "n", max = "1 GPa" }
inlay = { stress = "von_mises", at = "inlay" }
"""
)
NUMBERS = [(0.3, 0.45, 100.0), (0.2, 0.3, 5.0), (0.1, 0.45, 1.5), (0.45, 0.0, 1000.0)]
"""Poisson's ratios of two materials, and the ratio of their shear moduli."""


def dundurs(nu1, nu2, ratio):
    """Dundurs' parameters in plane stress."""
    k1, k2 = kolosov(nu1, False), kolosov(nu2, False)
    below = (k2 + 1) * ratio + k1 + 1
    return ((k2 + 1) * ratio - k1 - 1) / below, ((k2 - 1) * ratio - k1 + 1) / below


def bonded(degrees, nu1, nu2, ratio):
    """The sectors of two materials with these angles."""
    kinds = ((kolosov(nu1, False), ratio), (kolosov(nu2, False), 1.0))
    return tuple(Sector(math.radians(a), *kind) for a, kind in zip(degrees, kinds, strict=True))


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


@pytest.mark.parametrize("numbers", NUMBERS)
def test_two_quarter_planes_of_two_materials(numbers):
    # Bogy 1968, edge-bonded quarter planes with free edges, by Dundurs' parameters.
    alpha, beta = dundurs(*numbers)

    def bogy(p):
        bent = np.sin(math.pi * p / 2) ** 2 - p**2
        straight = 2 * p**2 * bent * alpha * beta + p**2 * (p**2 - 1) * alpha**2
        return bent**2 * beta**2 + straight + np.sin(math.pi * p) ** 2 / 4

    found = bonded_exponent(bonded((90, 90), *numbers), FREE, FREE)
    grid = np.linspace(0.05, 0.998, 2000)
    crossing = next((k for k in range(1999) if bogy(grid[k]) * bogy(grid[k + 1]) < 0), None)
    if alpha * (alpha - 2 * beta) <= 0:
        # The singularity vanishes there.
        assert crossing is None and (found is None or found.real > 0.99)
    else:
        assert found.real == pytest.approx(brentq(bogy, grid[crossing], grid[crossing + 1]), abs=1e-7)
        assert found.imag == 0.0


@pytest.mark.parametrize("numbers", NUMBERS)
def test_a_crack_between_two_materials_oscillates(numbers):
    # Williams 1959: lambda = 1/2 + i log((1 - beta) / (1 + beta)) / (2 pi).
    _, beta = dundurs(*numbers)
    found = bonded_exponent(bonded((180, 180), *numbers), FREE, FREE)
    assert found == pytest.approx(complex(0.5, abs(math.log((1 - beta) / (1 + beta))) / (2 * math.pi)), abs=1e-6)


def test_a_corner_within_a_body_tends_to_a_free_one_and_to_none():
    # A wedge of next to nothing in a body is a notch; one of the same stuff is not there.
    soft = bonded_exponent(bonded((270, 90), 0.3, 0.3, 1e9), None, None)
    assert soft.real == pytest.approx(0.544484, abs=1e-5)
    assert bonded_exponent(bonded((270, 90), 0.3, 0.3, 1.0), None, None) is None


def test_points_within_polylines_are_examined(tmp_path):
    whole = 's3 = { polyline = ["c", "e"], through = [[1, 1]] }\n'
    text = NOTCHED.replace('s3 = { line = ["c", "n"] }\ns4 = { line = ["n", "e"] }\n', whole)
    text = text.replace(', "s4"', "").replace(" n = [1, 1],", "").replace('at = "s6" }', 'at = "s3" }')
    for loop in ("s3", "backwards"):
        if loop == "backwards":
            text = text.replace('polyline = ["c", "e"]', 'polyline = ["e", "c"]')
        scene = load_scene(write_scene(tmp_path, text))
        outline = shape_of(scene)
        found = {place.name: place for place in singular_places(scene, outline)}
        assert set(found) == {"s3, point 1", "c"} and found["s3, point 1"].cause == "re-entrant corner"
        assert found["s3, point 1"].exponent == pytest.approx(0.544484, abs=1e-6)
        assert "far" in singular_quantities(scene, outline)


@pytest.mark.parametrize(("points", "singular"), [(7, False), (4, True)])
def test_polylines_of_smooth_curves_have_no_corners(tmp_path, points, singular):
    # A round cut of a quarter circle: 90 degrees in so many turns and two half ones at its ends, which are vertices.
    angles = -np.pi / 2 - np.linspace(0.0, np.pi / 2, points + 1)
    through = [[float(2 + np.cos(a)), float(2 + np.sin(a))] for a in angles[1:-1]]
    curve = f's3 = {{ polyline = ["c", "e"], through = {through} }}\n'
    text = NOTCHED.replace('s3 = { line = ["c", "n"] }\ns4 = { line = ["n", "e"] }\n', curve)
    text = text.replace(', "s4"', "").replace(" n = [1, 1],", "")
    scene = load_scene(write_scene(tmp_path, text))
    found = {place.name for place in singular_places(scene, shape_of(scene))} - {"c", "e"}
    assert found == ({f"s3, point {k}" for k in range(1, points)} if singular else set())


@pytest.mark.slow
def test_materials_that_meet_at_a_free_edge_or_in_a_corner(tmp_path, command):
    text = STRIP.replace("NEAR", "0.2")
    scene = load_scene(write_scene(tmp_path, text))
    found = {place.name: place for place in singular_places(scene, shape_of(scene))}
    known = bonded_exponent(bonded((90, 90), 0.3, 0.45, 100 * 1.45 / 1.3), FREE, FREE)
    assert set(found) == {"m", "n"} and {place.cause for place in found.values()} == {"meeting of materials"}
    assert [place.exponent for place in found.values()] == pytest.approx([known.real] * 2, abs=1e-6)
    # A region without a material of its own is none for stress; one of another thickness is, at its corners.
    inlay = '[material.thin]\nE = 1e11\nnu = 0.3\nthickness = 0.02\nregion = "inlay"\n'
    scene = load_scene(write_scene(tmp_path, text.replace("[material.soft]", inlay + "[material.soft]")))
    assert len(singular_places(scene, shape_of(scene))) == 6
    assert set(singular_quantities(scene, shape_of(scene))) == {"top", "inlay"}
    reported = command("check", tmp_path / "scene.toml")
    assert "at the meeting of materials n" in reported.stdout
    assert command("replay", tmp_path / "scene.toml", "--csv", "a.csv").returncode == 0
    assert "uncertain" in (tmp_path / "a.csv").read_text()


@pytest.mark.slow
def test_meshes_show_the_exponent_of_two_materials(tmp_path):
    sizes, values = [0.01, 0.005, 0.0025, 0.00125], []
    for size in sizes:
        made = make_replay(write_scene(tmp_path, STRIP.replace("NEAR", str(size))), write_script(tmp_path, []))
        values.append(next(made.frames())["q_top"])
    scene = load_scene(tmp_path / "scene.toml")
    place = singular_quantities(scene, shape_of(scene))["top"]
    assert np.polyfit(np.log(sizes), np.log(values), 1)[0] == pytest.approx(place.exponent - 1.0, abs=0.05)


def l_of_triangles(path):
    """A mesh file of an L, 100 mm wide, of right-angled triangles of 10 mm, with its left and right sides as groups."""
    nodes = {(i, j): k for k, (i, j) in enumerate((i, j) for i in range(11) for j in range(11 if i < 6 else 6))}
    squares = [(i, j) for i, j in nodes if (i + 1, j + 1) in nodes]
    triangles = [
        [nodes[i, j], nodes[p], nodes[q]]
        for i, j in squares
        for p, q in (((i + 1, j), (i + 1, j + 1)), ((i + 1, j + 1), (i, j + 1)))
    ]
    sides = [[[nodes[i, j], nodes[i, j + 1]] for j in range(n)] for i, n in ((0, 10), (10, 5))]
    tags = [np.full(len(block), tag) for tag, block in ((3, triangles), (1, sides[0]), (2, sides[1]))]
    cells = [("triangle", np.array(triangles)), *(("line", np.array(one)) for one in sides)]
    points = 0.01 * np.array([[i, j, 0] for i, j in nodes], dtype=float)
    made = meshio.Mesh(points, cells, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags})
    made.field_data = {
        name: np.array([tag, dim]) for name, tag, dim in (("left", 1, 1), ("right", 2, 1), ("body", 3, 2))
    }
    meshio.write(path, made, file_format="gmsh22", binary=False)


def test_places_of_a_mesh_file_are_marked(tmp_path, restshape):
    l_of_triangles(tmp_path / "l.msh")
    text = ARM[ARM.index("[material.steel]") : ARM.index("[supports.wall]")]
    text += '[supports.wall]\non = "left"\nfix = ["x", "y"]\n[loads.pull]\non = "right"\nforce = [1e4, 0]\n'
    text += '[mesh]\nfile = "l.msh"\n[quantities]\npeak = { stress = "von_mises" }\n'
    text += 'held = { stress = "von_mises", at = "left" }\npulled = { stress = "von_mises", at = "right" }\n'
    scene = write_scene(tmp_path, HEAD + text)
    assert restshape("check", scene, "--json", "a.json").returncode == 0
    peak, held = (one for one in json.loads((tmp_path / "a.json").read_text())["warnings"] if "converge" in one)
    # The angle of the L, and a clamped side's end at a right angle (Williams 1952).
    assert "quantities.peak: stress goes as r^-0.456 at the re-entrant corner" in peak
    clamped = exponent(math.pi / 2, CLAMPED, FREE, kolosov(0.3, False))
    assert f"quantities.held: stress goes as r^{clamped.real - 1.0:.3f} at the end of a support" in held
    assert restshape("replay", scene, "--json", "b.json").returncode == 0
    marked = json.loads((tmp_path / "b.json").read_text())["singular"]
    assert set(marked) == {"peak", "held"} and marked["peak"] == pytest.approx(0.544484, abs=1e-6)


@pytest.mark.parametrize(
    ("corners", "says"),
    [
        (1, "at the re-entrant corner A:"),
        (2, "corner A (and so, or less, at B): "),
        (5, "corner A (and so, or less, at B, C and 2 more): "),
    ],
)
def test_a_warning_names_three_places_and_counts_the_others(corners, says):
    places = [SingularPlace(k, "ABCDE"[k], "re-entrant corner", 0.5 + 0.01 * k) for k in range(corners)]
    words = warning("peak", SimpleNamespace(stress="von_mises"), places)
    assert says in words
    away = {1: "A:", 2: "A, B:", 5: "A, B, C and 2 more:"}[corners]
    assert f"take it away from {away}" in words


def test_no_wedge_is_looked_at_where_no_stress_is_asked_for(tmp_path, monkeypatch):
    text = "\n".join(line for line in NOTCHED.splitlines() if "von_mises" not in line)
    scene = load_scene(write_scene(tmp_path, text))
    outline = outline_from_spec(scene.shape, scene.folder)
    seen = inspect_solid(scene, outline)
    monkeypatch.setattr("restshape.physics.elasticity.singular_places.wedges", None)
    exponents, points = exponents_and_points(scene, outline)
    assert (exponents, points) == (seen.singular, seen.singular_points)
    assert exponents == {"poked": 0.0} and [outline.vertex_names[k] for k in points] == ["c"]


def test_no_place_is_looked_at_where_displacements_alone_are_asked_for_and_no_force_acts(tmp_path, monkeypatch):
    text = "\n".join(line for line in NOTCHED.splitlines() if "von_mises" not in line)
    text = text.replace("force = [1, 0]", "pressure = 1").replace('on = "c"', 'on = "s2"')
    scene = load_scene(write_scene(tmp_path, text))
    monkeypatch.setattr("restshape.physics.elasticity.singular_places.singular_places", None)
    assert exponents_and_points(scene, outline_from_spec(scene.shape, scene.folder)) == ({}, ())


def test_mirrored_corners_of_clamped_and_free_sides_are_solved_for_once():
    """However the axes of a side that is constrained all around lie."""
    turned = ((0.6, 0.8), (-0.8, 0.6))
    found = exponent(1.3, FREE, CLAMPED, 2.1)
    before = least_root.cache_info().misses
    assert exponent(1.3, turned, FREE, 2.1) == found and least_root.cache_info().misses == before
    mirrored = least_root(1.3, CLAMPED, FREE, 2.1)
    assert mirrored == pytest.approx(found, abs=1e-9)
