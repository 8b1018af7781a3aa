"""Scenes: what a file says is what the models hold, in SI; what is wrong is reported with key, line and suggestion."""

import math
import re

import pytest
from small_scenes import plate, write_scene

from restshape.application import applications
from restshape.cli.check_scene import starting_outline
from restshape.errors import UserError
from restshape.physics.elasticity.elasticity_declaration import PLANE_SOLIDS
from restshape.scene.expressions import Expression
from restshape.scene.load import load_scene, revise
from restshape.scene.model import CircleLoop, Support
from restshape.scene.overrides import parse_override
from restshape.scene.quantity import quantity_type
from restshape.scene.scene_type import load_type, support_type
from restshape.scene.shape_edges import ArcSpec


def test_values_are_si(scene_file):
    scene = load_scene(scene_file)
    assert scene.path == scene_file and scene.folder == scene_file.parent
    assert scene.shape.vertices["b"] == (2.0, 0.0)
    assert scene.shape.holes["window"].circle.radius == pytest.approx(0.12)
    assert scene.material["steel"].E == 210e9
    assert scene.material["steel"].thickness == pytest.approx(0.01)
    assert scene.parameters == {"P": 1e6}
    assert scene.mesh.near == {"window": 0.05}
    assert scene.solve.tolerance == 1e-6 and scene.solve.policy == "auto"


def test_short_forms_are_filled_in(scene_file):
    scene = load_scene(scene_file)
    assert scene.supports["wall"].on == ["left"]
    assert scene.supports["wall"].fix == {"x": 0.0, "y": 0.0}
    assert scene.quantities["peak"].reduce == "max"
    assert scene.quantities["stretch"].reduce == "mean"
    assert scene.effects == {"solid": {"model": "plane_stress", "element": "auto"}}
    assert scene.mesh.order == 2


def test_formulas(scene_file):
    load = load_scene(scene_file).loads["pull"]
    assert load.kind == "traction" and load.traction[1] == 0.0
    assert load.traction[0] == Expression("P*(1 + y)")
    assert load.traction[0].evaluate(2.0, 0.5, {"P": 1e6}) == pytest.approx(1.5e6)


def test_kinds_of_names(scene_file):
    kinds = load_scene(scene_file).shape.kinds()
    assert kinds["a"] == "vertex" and kinds["top"] == "edge" and kinds["window"] == "hole" and kinds["sides"] == "group"
    assert kinds["window.4"] == "edge" and kinds["window.v1"] == "vertex" and "window.5" not in kinds


def test_edges_and_loops_are_distinguished(scene_file):
    scene = load_scene(scene_file, ["shape.edges.top={arc=['c','d'], bulge=0.2}"])
    assert scene.shape.edges["top"] == ArcSpec(arc=("c", "d"), bulge=0.2)
    assert isinstance(scene.shape.holes["window"], CircleLoop)


def test_every_scene_that_ships_loads():
    scenes = [path for app in applications().values() for path in app.scenes()]
    assert scenes
    for path in scenes:
        assert load_scene(path).title


@pytest.mark.parametrize(
    ("override", "read"),
    [
        ("material.steel.E=70e9", lambda s: s.material["steel"].E == 70e9),
        ("material.steel.E=70 GPa", lambda s: s.material["steel"].E == 70e9),
        ('material.steel.E="70 GPa"', lambda s: s.material["steel"].E == 70e9),
        ("mesh.min_quality=0.2", lambda s: s.mesh.min_quality == 0.2),
        ("solve.policy=rebuild", lambda s: s.solve.policy == "rebuild"),
        ("shape.vertices.b.0=3", lambda s: s.shape.vertices["b"] == (3.0, 0.0)),
        ("supports.wall.fix=['x']", lambda s: s.supports["wall"].fix == {"x": 0.0}),
        ("effects.gravity.g=[0, -1]", lambda s: s.effects["gravity"] == {"g": [0.0, -1.0]}),
    ],
)
def test_overrides(scene_file, override, read):
    assert read(load_scene(scene_file, [override]))


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("material.stel.E=1", "did you mean 'steel'"),
        ("material.steel.e=1", "did you mean 'E'"),
        ("mesh.sise=1", "did you mean 'size'"),
        ("shape.outline.7=top", "list of 4 entries"),
        ("title.first=1", "single value|text"),
        (
            "material.steel.orthotropic.E.1=5",
            "leaves out material.steel.orthotropic.E, which cannot be given by its entry 1",
        ),
        ("nonsense", "not key=value"),
        ("=3", "not key=value"),
        ("mesh.size=nan", "not a finite number"),
        ("mesh.size=0", "greater than 0"),
        ("mesh.size=-1 mm", "greater than 0"),
        ("shape.edges.left.line=['d']", "the names of two vertices"),
        ("supports.wall.fix=x", r"are wanted here, not 'x'\n  try: write fix = \[\"x\"\]"),
    ],
)
def test_bad_overrides(scene_file, override, message):
    with pytest.raises(UserError, match=message):
        load_scene(scene_file, [override])


def test_override_values_are_toml_or_text():
    assert parse_override("a.b = [1, 2]") == (("a", "b"), [1, 2])
    assert parse_override("a=x*y") == (("a",), "x*y")
    assert parse_override("a=b=c") == (("a",), "b=c")


def test_revise_changes_one_key_of_a_copy(scene_file):
    scene = load_scene(scene_file)
    other = revise(scene, "parameters.P", "3 MPa")
    assert (scene.parameters["P"], other.parameters["P"]) == (1e6, 3e6)
    assert other.path == scene.path
    assert other.material == scene.material and other.shape == scene.shape
    assert revise(other, "parameters.P", "1 MPa").model_dump() == scene.model_dump()


@pytest.mark.parametrize(("key", "value"), [("parameters.Q", 1), ("material.steel.nu", 0.7), ("mesh.siez", 1), ("", 1)])
def test_revise_refuses(scene_file, key, value):
    with pytest.raises(UserError):
        revise(load_scene(scene_file), key, value)


def test_an_error_names_file_key_and_line(scene_file):
    text = scene_file.read_text().replace("nu = 0.3", "nu = 0.5")
    scene_file.write_text(text)
    line = text.splitlines().index("nu = 0.5") + 1
    with pytest.raises(UserError) as caught:
        load_scene(scene_file)
    assert caught.value.where == f"plate.toml: material.steel.nu (line {line})"
    assert "less than 0.5" in caught.value.what


def test_all_findings_are_reported_at_once(scene_file):
    text = scene_file.read_text().replace("nu = 0.3", "nuu = 0.3").replace("[mesh]", "[mesh]\nordr = 2")
    scene_file.write_text(text)
    with pytest.raises(UserError) as caught:
        load_scene(scene_file)
    assert "did you mean 'nu'" in str(caught.value) and "did you mean 'order'" in str(caught.value)


def test_an_error_in_the_shape_is_located(scene_file):
    scene = load_scene(scene_file)
    error = scene.located(UserError("it is wrong", "shape.edges.top", "mend it"))
    line = next(i for i, text in enumerate(scene_file.read_text().splitlines(), 1) if text.startswith("top ="))
    assert error.where == f"plate.toml: shape.edges.top (line {line})"
    elsewhere = UserError("it is wrong", "bracket.dxf")
    assert scene.located(elsewhere) is elsewhere


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('fix = ["x", "y"]', 'fix = ["z"]', "knows no direction 'z'"),
        ('fix = ["x", "y"]', "fix = []", "directions such as"),
        ('traction = ["P*(1 + y)", 0]', "traction = [1, 2]\nforce = [1, 2]", "exactly one of force"),
        ('traction = ["P*(1 + y)", 0]', "", "none of them"),
        ('traction = ["P*(1 + y)", 0]', "body = [1, 2]", "cannot act on 'right'"),
        ('on = "right"', 'on = "a"', "traction cannot act on 'a'"),
        ('on = "right"', "on = []", "name of an entity"),
        ('left = { line = ["d", "a"] }', 'left = { arc = ["d", "a"] }', "exactly one of through, bulge"),
        ('left = { line = ["d", "a"] }', 'left = { lin = ["d", "a"] }', "did you mean 'line'"),
        ('left = { line = ["d", "a"] }', 'left = { line = ["d"] }', "missing|2|entries"),
        ('sides = ["left", "right"]', 'sides = ["left", "rigth"]', "did you mean 'right'"),
        ("near = { window = 0.05 }", "near = { windo = 0.05 }", "did you mean 'window'"),
        ('peak = { stress = "von_mises" }', 'peak = { stress = "mises" }', "did you mean 'von_mises'"),
        ('peak = { stress = "von_mises" }', 'peak = { reduce = "max" }', "none of them"),
        ("[parameters]", "[parameters]\nx = 1", "meaning in formulas"),
        ("a = [0, 0]", "all = [0, 0]", "is a keyword: it stands for everything"),
        ("a = [0, 0]", '"a b" = [0, 0]', "cannot be a name"),
        ("[material.steel]", "[material.rest]\nE = 1\nnu = 0\n[material.steel]", "both fill"),
        ("[material.steel]", '[material.steel]\nregion = "patch"', "outside of the regions"),
        ('size = "100 mm"\n', "", "the mesh has no size"),
        ("outline = [", "outlin = [", "did you mean 'outline'"),
        ('model = "plane_stress"', 'model = "plane_stres"', "did you mean 'plane_stress'"),
        ('model = "plane_stress"', 'modell = "plane_stress"', "did you mean 'model'"),
    ],
)
def test_what_makes_no_sense_is_refused(scene_file, old, new, message):
    text = scene_file.read_text()
    assert old in text
    scene_file.write_text(text.replace(old, new, 1))
    with pytest.raises(UserError, match=message):
        load_scene(scene_file)


def test_materials_of_regions(scene_file):
    text = scene_file.read_text().replace(
        "[material.steel]",
        "[shape.regions]\npatch = { circle = { center = [1.5, 0.5], radius = 0.1 } }\n"
        '[material.brass]\nE = "100 GPa"\nnu = 0.34\nthickness = 0.01\nregion = "patch"\n[material.steel]',
    )
    scene_file.write_text(text)
    assert load_scene(scene_file).material["brass"].region == ["patch"]
    scene_file.write_text(text.replace('region = "patch"', 'region = ["patch", "patch"]'))
    with pytest.raises(UserError, match="two materials"):
        load_scene(scene_file)
    # Left out beside another material's it would be 1 m: a hundred times as stiff.
    scene_file.write_text(text.replace("thickness = 0.01\n", "", 1))
    with pytest.raises(
        UserError, match=r"brass .*: its thickness is left out, which is 1 m, and material\.steel has one"
    ):
        load_scene(scene_file)
    # Edits give one after the other.
    scene_file.write_text(re.sub(r"thickness = .*\n", "", text))
    one = revise(load_scene(scene_file), "material.steel.thickness", 0.02)
    assert revise(one, "material.brass.thickness", 0.02).material["brass"].thickness == 0.02


def test_models_can_be_made_in_code():
    assert support_type(Support, PLANE_SOLIDS.boundary)(on="left", fix=["x"]).fix == {"x": 0.0}
    Load = load_type(PLANE_SOLIDS.loads)
    assert Load(on="left", pressure="1 bar").pressure == pytest.approx(1e5)
    assert quantity_type({})(area=True).reduce == "sum"
    assert math.isclose(Load(on=["a"], force=["1 kN", 0]).force[0], 1000)


@pytest.mark.parametrize("how", ["max", "mean", "absmax"])
def test_a_total_cannot_be_reduced_otherwise(scene_file, how):
    text = scene_file.read_text() + f'\n[quantities.held]\nreaction = "y"\nat = "left"\nreduce = "{how}"\n'
    scene_file.write_text(text)
    with pytest.raises(UserError, match=f"reduced by .sum. or .peak., not by '{how}'"):
        load_scene(scene_file)


def test_a_scene_cannot_be_changed(scene_file):
    scene = load_scene(scene_file)
    with pytest.raises(ValueError, match="frozen"):
        scene.title = "another"


def test_the_file_name_of_a_mesh_stands_for_the_shape(scene_file):
    text = scene_file.read_text()
    start, end = text.index("[shape]"), text.index("[material.steel]")
    body = (text[:start] + text[end:]).replace(
        'size = "100 mm"\nnear = { window = 0.05 }', 'file = "m.msh"\nunit = "mm"'
    )
    scene_file.write_text(body)
    with pytest.raises(UserError, match="there is no file"):
        load_scene(scene_file)
    (scene_file.parent / "m.msh").touch()
    scene = load_scene(scene_file)
    assert scene.mesh.file == "m.msh" and scene.mesh.unit == 1e-3 and not scene.shape.edges


def test_a_unit_without_a_mesh_file_is_refused(scene_file):
    scene_file.write_text(scene_file.read_text().replace('size = "100 mm"', 'size = "100 mm"\nunit = "mm"'))
    with pytest.raises(UserError, match=r"mesh\.unit.*unit of the numbers of mesh\.file"):
        load_scene(scene_file)


def test_json_round_trip(scene_file):
    scene = load_scene(scene_file)
    again = type(scene).model_validate_json(scene.model_dump_json(exclude_none=True))
    assert again.model_dump() == scene.model_dump()


@pytest.mark.parametrize(
    ("region", "place", "words"),
    [
        ('[shape.regions]\npatch = ["left", "top"]', r"shape\.regions\.patch", r"write { loop = \[.left., .top.\] }"),
        ("[shape.regions]\npatch = { loops = ['left'] }", r"shape\.regions\.patch", "did you mean 'loop'"),
        ("[regions]\npatch = { loop = ['left'] }", "regions", r"write \[shape\.regions\]"),
        ("[shape.regions]\npatch = { polygon = [[0.9, 0.9], [1, 0.9], [9, 1]] }", r"shape\.regions\.patch", "cross"),
    ],
)
def test_a_wrong_region_is_refused_at_its_place(scene_file, region, place, words):
    text = scene_file.read_text()
    scene_file.write_text(text.replace("[material.steel]", region + "\n[material.steel]", 1))
    with pytest.raises(UserError, match=rf"(?s){place}.*{words}"):
        starting_outline(load_scene(scene_file))


def test_a_table_after_set_is_a_new_entry(tmp_path):
    path = write_scene(tmp_path, plate())
    added = [
        'supports.roller={on="top",fix=["y"]}',
        'quantities.lift={displacement="y",at="top"}',
        'material.other={E="1 GPa",nu=0.3,thickness="1 mm",region="patch"}',
        "shape.regions.patch={polygon=[[0.1,0.1],[0.2,0.1],[0.2,0.2]]}",
    ]
    scene = load_scene(path, added)
    assert scene.supports["roller"].fix == {"y": 0.0} and scene.quantities["lift"].displacement == "y"
    assert scene.material["other"].region == ["patch"] and "patch" in scene.shape.regions
    # What stands in the file is still there.
    assert set(load_scene(path).supports) < set(scene.supports)


def test_an_entry_needs_a_table_and_its_own_keys(tmp_path):
    path = write_scene(tmp_path, plate())
    for words in ("supports.roller=3", "supports.roller.on=top", "parameters.width=3"):
        with pytest.raises(UserError, match="there is no"):
            load_scene(path, [words])
    for key in ("points.p", "groups.p"):
        with pytest.raises(UserError) as refused:
            load_scene(path, [f"shape.{key}=[1.2,0.3]"])
        whole = key.removesuffix(".p")
        assert refused.value.do == f"set the whole table: shape.{whole} = {{ p = ... }}"
    assert load_scene(path, ["shape.points={p=[1.2,0.3]}"]).shape.points["p"] == (1.2, 0.3)
    with pytest.raises(UserError, match="no key 'axis'"):
        load_scene(path, ['supports.roller={on="top",axis="y"}'])
    with pytest.raises(UserError, match="'roof'"):
        load_scene(path, ['supports.roller={on="roof",fix=["y"]}'])


def test_a_script_adds_an_entry_by_its_table_alone(tmp_path):
    scene = load_scene(write_scene(tmp_path, plate()))
    assert revise(scene, "supports.roller", {"on": "top", "fix": ["y"]}).supports["roller"].on == ["top"]
    assert "roller" not in scene.supports
    for key, value in (("supports.roller", 3), ("supports.roller.on", "top")):
        with pytest.raises(UserError, match="there is no supports"):
            revise(scene, key, value)


@pytest.mark.parametrize("region", ["patch", "sides"])
def test_a_region_that_is_not_there_is_no_material(scene_file, region):
    """Nor is a group that holds edges alone."""
    scene_file.write_text(f'{scene_file.read_text()}\n[material.pad]\nE = 1e11\nnu = 0.3\nregion = "{region}"\n')
    with pytest.raises(UserError, match=f"no region '{region}'\n.*add it to the regions, of which there are none"):
        load_scene(scene_file)


def test_a_group_of_regions_has_a_material(scene_file):
    groups = 'groups = { sides = ["left", "right"], pads = ["patch"] }'
    text = scene_file.read_text().replace('groups = { sides = ["left", "right"] }', groups)
    text += "[shape.regions]\npatch = { circle = { center = [1.5, 0.5], radius = 0.1 } }\n"
    scene_file.write_text(f'{text}[material.pad]\nE = 1e11\nnu = 0.3\nthickness = 0.01\nregion = "pads"\n')
    assert load_scene(scene_file).material["pad"].region == ["pads"]
