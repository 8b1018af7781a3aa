"""What `restshape check` warns of though the scene can be simulated, and a thickness that stress needs."""

import json
import math
import shutil
from argparse import Namespace
from pathlib import Path

import ezdxf
import pytest
from pydantic import BaseModel
from small_scenes import HEAD, block, meshed, plate, write_scene

from restshape.cli.check_scene import add_drawing, starting_outline
from restshape.cli.doubts import doubts, script_doubts
from restshape.cli.limits import large_drawing, messages
from restshape.errors import UserError
from restshape.physics.elasticity.inspection import inspect_solid
from restshape.scene.bodies import Body, body_words
from restshape.scene.descriptions import but_rounding, keys_in_words, with_symbol
from restshape.scene.edit_script import read_script
from restshape.scene.expressions import Expression
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec

SCENES = Path(__file__).parents[1] / "scenes"


class Outlet(BaseModel):
    on: tuple[str, ...]
    outflow: bool = True


BODY = """
[material.m]
E = {E}
nu = 0.3
rho = {rho}
thickness = {thickness}
[effects.solid]
model = "plane_stress"
[supports.left]
on = "left"
fix = ["x", "y"]
[loads.right]
on = "right"
force = [1e3, 0]
"""


def scene_of(folder, E="210e9", rho="7850", thickness="0.01", more="", change=("", "")):
    text = HEAD + block(2.0, 1.0) + BODY.format(E=E, rho=rho, thickness=thickness) + more + meshed(0.2)
    return load_scene(write_scene(folder, text.replace(*change)))


def warned(scene):
    outline = outline_from_spec(scene.shape, scene.folder)
    return [*doubts(scene, outline), *inspect_solid(scene, outline).warnings]


def test_nothing_is_odd_about_steel_and_its_mass_is_known(tmp_path):
    scene = scene_of(tmp_path)
    seen = inspect_solid(scene, outline_from_spec(scene.shape, scene.folder))
    assert warned(scene) == [] and seen.data["mass"] == pytest.approx(2.0 * 1.0 * 0.01 * 7850)


def test_a_size_near_an_entity_that_is_coarser_than_all_others_changes_nothing(tmp_path):
    near = "near = { left = {} }\n"
    assert warned(scene_of(tmp_path, change=("size = 0.2\n", "size = 0.2\n" + near.replace("{}", "0.1")))) == []
    found = warned(scene_of(tmp_path, change=("size = 0.2\n", "size = 0.2\n" + near.replace("{}", "0.4"))))
    assert len(found) == 1 and found[0].startswith("mesh.near.left: 0.4 m is more than mesh.size, 0.2 m")


@pytest.mark.parametrize(
    ("quantity", "words"),
    [
        ('{ displacement = "x", at = "right", reduce = "sum" }', 'reduced by "sum"'),
        ('{ displacement = "x", at = "b", reduce = "sum" }', None),
        ('{ reaction = "x", at = "left" }', None),
        ('{ reaction = "x", at = "a" }', None),
        ('{ reaction = "y", at = "top" }', None),
        ('{ reaction = "x", at = "outline" }', None),
        ('{ reaction = "x", at = "all" }', None),
        ('{ reaction = "x", at = "right" }', "no support that fixes x is at right"),
    ],
)
def test_quantities_of_the_mesh_or_of_nothing_are_named(tmp_path, quantity, words):
    found = warned(scene_of(tmp_path, more=f"[quantities]\nr = {quantity}\n"))
    assert len(found) == bool(words) and all(words in one for one in found)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"E": "210"}, "stiffness of 210 Pa"),
        ({"E": "210e12"}, "stiffness of 2.1e+14 Pa"),
        ({"rho": "7.85e-9"}, "density of 7.85e-09"),
        ({"rho": "7.85e6"}, "density of 7.85e+06"),
        ({"E": "1e12", "rho": "2"}, "sound goes at 707107 m/s"),
        ({"thickness": "8"}, "thickness of 8 m is more than the 2 m"),
    ],
)
def test_values_that_no_material_has(tmp_path, values, words):
    (warning,) = [one for one in warned(scene_of(tmp_path, **values)) if not one.startswith("loads:")]
    assert words in warning and "material.m" in warning


def test_the_thickness_that_stress_follows_from_is_given(tmp_path):
    with pytest.raises(UserError, match=r"stress is the force of loads\.right by the thickness.*left out"):
        scene_of(tmp_path, change=("thickness = 0.01\n", ""))
    scene_of(tmp_path, change=("force = [1e3, 0]", "traction = [1e3, 0]"))
    traction = HEAD + block(2.0, 1.0) + BODY.format(E="1e9", rho="0", thickness="1") + meshed(0.2)
    traction = traction.replace("thickness = 1\n", "").replace("force", "traction")
    assert load_scene(write_scene(tmp_path, traction)).material["m"].thickness == 1.0
    strain = traction.replace("traction", "force").replace("plane_stress", "plane_strain")
    assert load_scene(write_scene(tmp_path, strain)).material["m"].thickness == 1.0


def test_a_drawing_without_a_unit(tmp_path):
    drawing = ezdxf.new()
    drawing.modelspace().add_lwpolyline([(0, 0), (20, 0), (20, 10), (0, 10)], close=True)
    drawing.header["$INSUNITS"] = 0
    drawing.saveas(tmp_path / "part.dxf")
    text = HEAD + '[shape]\nfile = "part.dxf"\n[material.m]\nE = 1e9\nnu = 0.3\n' + meshed(0.002)
    warning = next(one for one in warned(load_scene(write_scene(tmp_path, text))) if one.startswith("shape.file:"))
    assert "no unit ($INSUNITS), and is read in millimetres: 0.02 m x 0.01 m" in warning
    drawing.header["$INSUNITS"] = 4
    drawing.saveas(tmp_path / "part.dxf")
    assert [one[:6] for one in warned(load_scene(tmp_path / "scene.toml"))] == ["loads:"]


def test_gaps_that_are_closed_are_reported(tmp_path):
    drawing = ezdxf.new("R2010", units=4)
    for ends in (((0, 0), (20, 0)), ((20, 0), (20, 10)), ((20, 10.03), (0, 10)), ((0, 10), (0.02, 0))):
        drawing.modelspace().add_line(*ends, dxfattribs={"layer": "rim"})
    drawing.saveas(tmp_path / "part.dxf")
    text = '[shape]\nfile = "part.dxf"\ntolerance = "0.05 mm"\n[material.m]\nE = 1e9\nnu = 0.3\n'
    data: dict = {}
    rows = [("vertices", "4")]
    add_drawing(load_scene(write_scene(tmp_path, HEAD + text + meshed(0.002))), data, rows)
    assert [gap["size"] for gap in data["gaps"]] == pytest.approx([3e-5, 2e-5])
    assert data["gaps"][0]["between"] == ("LINE on layer rim",) * 2
    assert data["gaps"][0]["at"] == pytest.approx((0.02, 0.010015))
    assert rows[0] == ("gaps closed", "2 of at most 50 µm") and rows[-1] == ("vertices", "4")
    assert rows[1][1].startswith("30 µm at (0.02, 0.010015) m, between LINE on layer rim and")


def test_check_prints_the_box_and_the_mass(tmp_path, command):
    scene_of(tmp_path)
    done = command("check", tmp_path / "scene.toml", "--json", tmp_path / "a.json")
    found = json.loads((tmp_path / "a.json").read_text())
    assert done.returncode == 0 and "2 m x 1 m, lower left corner (0, 0) m" in done.stdout and "157 kg" in done.stdout
    assert found["bounds"] == [[0.0, 0.0], [2.0, 1.0]] and found["mass"] == pytest.approx(157.0)


def test_an_angle_without_a_unit(tmp_path):
    for grain, count in (("90", 1), ("'90 deg'", 0), ("1.5", 0)):
        scene = load_scene(SCENES / "rosewood.toml", [f"material.wood.grain={grain}"])
        found = doubts(scene, starting_outline(scene))
        assert len(found) == count and all("90 is more than a turn" in one for one in found)


def test_a_mesh_file_and_a_size(tmp_path):
    shutil.copy(SCENES.parents[1] / "meshes" / "bracket.inp", tmp_path)
    text = (SCENES / "bracket.toml").read_text().replace("../../meshes/", "")
    scene = load_scene(write_scene(tmp_path, text))
    size, new = doubts(scene, starting_outline(scene))
    assert size.startswith("mesh.size") and "takes its place: refinements of the file are lost" in new


HOLED = "shape.holes={window={circle={center=[1,0.5],radius=0.1}}}"


@pytest.mark.parametrize(("shape", "count"), [("", 0), (HOLED, 1)])
def test_the_old_name_of_positive_mean_values(tmp_path, shape, count):
    path = scene_of(tmp_path).path
    for word, many in (("mvc", count), ("pmvc", 0), ("harmonic", 0)):
        scene = load_scene(path, [f"mesh.relocation={word}", *[shape] * bool(shape)])
        found = doubts(scene, starting_outline(scene))
        assert len(found) == many and all('set "pmvc" for those, which "mvc" meant before' in one for one in found)


def test_the_old_name_of_positive_mean_values_that_a_script_sets(tmp_path):
    scene = load_scene(scene_of(tmp_path).path, [HOLED])
    lines = [{"format": "restshape-edits", "version": 1}, {"t": 0, "do": "set", "key": "mesh.relocation"}]
    lines[1]["value"] = "mvc"
    text = "".join(f"{json.dumps(line)}\n" for line in lines)
    (found,) = script_doubts(scene, starting_outline(scene), read_script(text, tmp_path / "edits.jsonl", scene))
    assert found.startswith('line 2: set mesh.relocation: "mvc" is plain')


@pytest.mark.parametrize("size", ["'6 Mm'", "'3 m'"])
def test_triangles_larger_than_the_shape(tmp_path, size):
    scene = load_scene(scene_of(tmp_path).path, [f"mesh.size={size}"])
    (warning,) = doubts(scene, starting_outline(scene))
    assert warning.startswith("mesh.size") and "more than the 2 m of the whole shape" in warning
    near = load_scene(scene.path, ["mesh.near.left='5 m'"])
    assert [one.split(":")[0] for one in doubts(near, starting_outline(near))] == ["mesh.near.left"]
    # Without a unit there is a warning of it already.
    bare = load_scene(scene.path, ["mesh.size=3"])
    assert len(doubts(bare, starting_outline(bare))) == 1


@pytest.mark.parametrize(("limit", "count"), [("19", 1), ("'19 MPa'", 0), ("'40 Pa'", 1), ("'60 Pa'", 0)])
def test_a_limit_far_below_what_the_loads_give(tmp_path, limit, count):
    """1 kN on 10 mm by 2 m is 50 kPa."""
    more = f'[quantities]\ns = {{ stress = "von_mises", at = "bottom", reduce = "mean", max = {limit} }}\n'
    scene = scene_of(tmp_path, more=more)
    found = doubts(scene, starting_outline(scene))
    assert len(found) == count and all("far below the 50 kPa that the loads give" in one for one in found)


def test_a_limit_in_time_without_a_reduction(tmp_path):
    text = plate().replace('app = "plane"', 'app = "moving"').replace("energy = {", "energy = { max = 1, HOW")
    text += "[effects.dynamics]\ntime_step = 1e-4\nsteps = 5\n"
    for how, overrides, count in (("", [], 1), ('reduce = "peak",', [], 0), ("", ["effects.dynamics.steps=1"], 0)):
        scene = load_scene(write_scene(tmp_path, text.replace("HOW", how)), overrides)
        found = [one for one in doubts(scene, starting_outline(scene)) if "quantities.energy" in one]
        assert len(found) == count and all('reduce = "peak"' in one and "the 5 time steps" in one for one in found)


def test_formulas_have_their_values_beside_them(command, tmp_path):
    text = HEAD + block(2.0, 1.0) + BODY.format(E="2*G", rho="7850", thickness="0.01").replace("E = 2*G", "E = 210e9")
    text = text.replace("force = [1e3, 0]", 'force = ["F/2 + 1", "-F*x"]') + meshed(0.2)
    text = text.replace("[shape]", '[parameters]\nF = "2 kN"\nn = 3\n[shape]', 1)
    write_scene(tmp_path, text)
    shown = command("check", "scene.toml").stdout
    assert "force (F/2 + 1 = 1001, -F*x) N on right" in shown
    assert "2 kN = 2000 in SI units" in shown
    assert [line.split()[2:] for line in shown.splitlines() if line.startswith("parameter n")] == [["3"]]


def test_rounding_beside_the_body_is_shown_as_0_and_limits_have_units(command, tmp_path):
    """A quarter of a disc whose corner cos(pi/2) puts at 6e-17 m, under its lower left corner."""
    text = (
        HEAD
        + '[parameters]\nR = "200 mm"\nq = "90 deg"\n[shape]\noutline = ["bottom", "round", "left"]\n'
        + '[shape.vertices]\na = [0, "-R*cos(q)"]\nb = ["R", 0]\nc = ["R*cos(q)", "R*1.0"]\n[shape.edges]\n'
        + 'bottom = { line = ["a", "b"] }\nround = { arc = ["b", "c"], bulge = 0.41421356237309503 }\n'
        + 'left = { line = ["c", "a"] }\n[material.m]\nE = 210e9\nnu = 0.3\n[supports.left]\non = "left"\n'
        + 'fix = { x = "R*cos(q)", y = -0.0 }\n[loads.b]\non = "bottom"\ntraction = [6e-17, "-1 Pa"]\n[quantities]\n'
        + 'sag = { displacement = "y", at = "b", reduce = "mean", reference = "-R/1e4", max = "R/1000" }\n'
    )
    write_scene(tmp_path, text + meshed(0.02))
    shown = command("check", "scene.toml")
    assert shown.returncode == 0, shown.stderr
    lines = {line.split()[0]: " ".join(line.split()[1:]) for line in shown.stdout.splitlines() if line.strip()}
    assert lines["bounding"].endswith("lower left corner (0, 0) mm") and "traction (0, -1) Pa" in lines["load"]
    assert lines["shape.vertices.a.1"] == "-R*cos(q) 0 m" and lines["shape.vertices.c.0"] == "R*cos(q) 0 m"
    assert lines["support"] == "left x = R*cos(q) = 0 m and y = 0 on left"
    assert lines["supports.left.fix.x"] == "R*cos(q) 0 m"
    assert lines["quantities.sag.max"] == "R/1000 0.0002 m" and lines["quantities.sag.reference"] == "-R/1e4 -20 µm"


@pytest.mark.parametrize(
    ("name", "hint"), [("wall", "use one of: "), ("ball", "use one of: "), ("al", "'all'"), ("lefft", "'left'")]
)
def test_all_is_not_meant_by_names_that_begin_otherwise(tmp_path, name, hint):
    with pytest.raises(UserError) as reported:
        scene_of(tmp_path, change=('on = "right"', f'on = "{name}"'))
    assert hint in reported.value.do
    outline = outline_from_spec(scene_of(tmp_path).shape)
    with pytest.raises(UserError) as reported:
        outline.entity(name)
    assert ("did you mean" in reported.value.do) == (hint[0] == "'")


def test_one_entry_is_one(tmp_path):
    with pytest.raises(UserError, match="at least 1 entry is wanted here"):
        scene_of(tmp_path, change=('outline = ["bottom", "right", "top", "left"]', "outline = []"))


def test_a_frame_of_an_edit_that_takes_too_long_may_have_more_frames():
    slow, large = messages("replay", 60.0, 1e9, "", edits=True)
    assert "give an edit that goes far more frames, take a coarser mesh, or raise --frame-limit" in slow
    assert "more frames" not in large + "".join(messages("replay", 60.0, 1e9, ""))


@pytest.mark.parametrize(("size", "named"), [(5_000_000, True), (1000, False)])
def test_a_large_drawing_is_named_where_the_first_frame_takes_too_long(tmp_path, size, named):
    (tmp_path / "part.dxf").write_bytes(b" " * size)
    scene = write_scene(tmp_path, HEAD + '[shape]\nfile = "part.dxf"\n')
    file = large_drawing(Namespace(scene=scene))
    slow, large = messages("check", 60.0, 1e9, "", file)
    assert ("try: part.dxf has 5 MB: read some of its layers alone" in slow) == named and (file in large)
    assert large_drawing(Namespace(scene="/dev/zero")) == ""
    assert large_drawing(Namespace()) == large_drawing(Namespace(scene=tmp_path / "none.toml")) == ""


def test_plane_strain_without_a_thickness_is_of_a_metre_of_depth(command, tmp_path):
    text = HEAD + block(0.2, 0.1) + BODY.format(E="210e9", rho="7850", thickness="0.01") + meshed(0.02)
    strain = text.replace("plane_stress", "plane_strain")
    for change, words in (("", "in plane strain: 1 m of depth"), ("thickness = 0.02", "thickness 20 mm")):
        write_scene(tmp_path, strain.replace("thickness = 0.01", change))
        shown = command("check", "scene.toml").stdout
        assert words in shown and "thickness 1 m" not in shown and "warning" not in shown


def test_what_is_small_is_not_rounding():
    known = {"t": 1e-3, "R": 0.2, "q": math.pi / 2.0, "E": 2e11, "F": 5e6, "near": 0.2 + 1e-12}
    for text, value in (
        ("t^4/12", 1e-12 / 12.0),
        ("R - 0.2 + 1e-12", 1e-12),
        ("1e-16*1", 1e-16),
        ("F*R/E", 5e-6),
        ("t^5/E", 5e-27),
        ("R*E/E + F*t/E - R", 2.5e-8),
        ("(near - R)^2", 1e-24),
        ("exp(-200)/E", math.exp(-200.0) / 2e11),
        ("1 degC - 274.15", 0.0),
        ("atan2(R - 0.2, -1)", math.pi),
    ):
        formula = Expression(text)
        found = but_rounding(formula, float(formula.evaluate(0.0, 0.0, known)), known)
        assert found == pytest.approx(value, rel=1e-3, abs=0.0), text
    for text in ("tan(q)", "1/cos(q)", "1/(R - 0.3 + 0.1)", "atan2(R - 0.3 + 0.1, -1)"):
        formula = Expression(text)
        found = float(formula.evaluate(0.0, 0.0, known))
        assert abs(found) > 3.0 and but_rounding(formula, found, known) == found, text
    for text in (
        "R*cos(q)",
        "R - 0.3 + 0.1",
        "0.1 + 0.2 - 0.3",
        "E*sin(pi)",
        "E*(R + 0.1) - 0.3*E",
        "(R - 0.3 + 0.1)^2",
    ):
        formula = Expression(text)
        found = float(formula.evaluate(0.0, 0.0, known))
        assert found != 0.0 and but_rounding(formula, found, known) == 0.0, text
    root = Expression("sqrt(a)^2 - a")
    assert root.evaluate(0.0, 0.0, {"a": 2.0}) > 0.0 and but_rounding(root, 4.4e-16, {"a": 2.0}) == 0.0


def test_a_support_is_no_place_of_a_quantity(tmp_path):
    more = '[supports.foot]\non = "bottom"\nfix = ["y"]\n[quantities.push]\nreaction = "y"\nat = "foot"\n'
    with pytest.raises(UserError, match="'foot' is a support, which cannot be named here") as refused:
        scene_of(tmp_path, more=more)
    assert refused.value.do.endswith("holds: 'bottom'")


def test_a_table_in_place_of_a_list_has_a_remedy(tmp_path):
    with pytest.raises(UserError, match="a list is wanted here") as refused:
        scene_of(tmp_path, more="[goal.target]\nspline = { points = [[0, 0], [1, 0]] }\n")
    assert refused.value.do == "write a list in brackets in place of the table in braces"


def test_what_check_says_has_units_and_no_words_of_python():
    capsule = Body.model_validate({"capsule": {"start": [0, 0, 0.5], "end": [0.25, 0, 0], "radius": 0.012}})
    words = "capsule, start (0, 0, 500) mm, end (250, 0, 0) mm, radius 12 mm, friction 0"
    assert body_words(capsule) == words
    assert with_symbol(5e-6, "bending stiffness") == "5 µN m"
    assert keys_in_words(Outlet(on=("right",))) == "on right, outflow"
