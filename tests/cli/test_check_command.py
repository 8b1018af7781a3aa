"""`check`, `list`, `new` and `schema` on input that is right, and edits that are refused."""

import json
from pathlib import Path

import pytest
from cloths import BALL, PIN, write_cloth

from restshape.application import applications
from restshape.cli.main import main
from restshape.cli.schema import scene_schema

TESTS = Path(__file__).parents[1]
DATA = TESTS / "data"


def check(*words: object) -> int:
    """The exit code of `check`."""
    return main(["check", *(str(word) for word in words)])


def test_check_shows_what_the_scene_holds(tmp_path, capsys):
    out = tmp_path / "check.json"
    assert check(DATA / "plate.toml", DATA / "plate.jsonl", "--json", out) == 0
    held = json.loads(out.read_text())
    assert held["entities"]["vertex"][:4] == ["a", "b", "c", "d"]
    assert held["entities"]["hole"] == ["window"]
    # a 2 x 1 plate less a disc of radius 0.12
    assert held["area"] == pytest.approx(2 - 3.141592653589793 * 0.12**2, rel=1e-12)
    assert held["loads"] == {"pull": {"kind": "traction", "on": ["right"]}}
    # the start, the press, one drag, a path of two, the release
    assert held["edits"]["frames"] == 6 and held["edits"]["refused"] == []
    printed = capsys.readouterr().out
    for word in ("window", "steel", "plane", "wall", "pull", "stretch", "frames"):
        assert word in printed or word == "plane"
    assert held["mesh"]["order"] == 2 and "the default of plane" in held["order_why"]
    assert "second order, the default of plane: " in printed and "mesh.order = 1 asks for first order" in printed


def test_check_says_no_default_where_the_scene_names_the_order(tmp_path, capsys):
    assert check(DATA / "plate.toml", "--set", "mesh.order=1") == 0
    printed = capsys.readouterr().out
    assert "first order, the scene says so in mesh.order" in printed and "asks for" not in printed


def test_overrides_reach_the_scene(tmp_path):
    out = tmp_path / "check.json"
    assert (
        check(DATA / "plate.toml", "--set", "shape.vertices.b.0=3", "--set", "shape.vertices.c.0=3", "--json", out) == 0
    )
    assert json.loads(out.read_text())["area"] == pytest.approx(3 - 3.141592653589793 * 0.12**2, rel=1e-12)


def script(tmp_path: Path, *events: str) -> Path:
    """A script of the small scene's header and these events."""
    path = tmp_path / "edits.jsonl"
    header = (DATA / "plate.jsonl").read_text().splitlines()[0]
    path.write_text("\n".join([header, *events]) + "\n")
    return path


@pytest.mark.parametrize(
    ("events", "line", "why"),
    [
        (['{"t": 0, "do": "press", "on": "windo"}'], 2, "windo"),
        (
            ['{"t": 0, "do": "press", "on": "window", "at": [0, 0]}', '{"t": 1, "do": "drag", "to": [5000, 0]}'],
            3,
            "window",
        ),
        (['{"t": 0, "do": "scale", "on": "window", "factor": 9}'], 2, "window"),
        (['{"t": 0, "do": "set", "key": "material.steel.nu", "value": 0.7}'], 2, "less than 0.5"),
        (['{"t": 0, "do": "set", "key": "material.stel.nu", "value": 0.2}'], 2, "did you mean 'steel'"),
        (['{"t": 0, "do": "set", "key": "supports", "value": {}}'], 2, "free to move as a rigid body"),
        (['{"t": 0, "do": "undo"}'], 2, "undo"),
        (['{"t": 0, "do": "hole", "name": "left", "center": [1500, 500], "radius": 50}'], 2, "left"),
        (['{"t": 0, "do": "hole", "name": "far", "center": [9500, 500], "radius": 50}'], 2, "far"),
        (['{"t": 0, "do": "delete", "on": "nothing"}'], 2, "nothing"),
    ],
)
def test_refused_edits_are_listed_and_the_code_is_1(tmp_path, capsys, events, line, why):
    out = tmp_path / "check.json"
    assert check(DATA / "plate.toml", script(tmp_path, *events), "--json", out) == 1
    refused = json.loads(out.read_text())["edits"]["refused"]
    assert refused and refused[0]["line"] == line
    assert why in refused[0]["why"]
    assert "refused edits" in capsys.readouterr().out


def test_an_edit_that_is_refused_in_each_of_its_frames_is_one_row(tmp_path, capsys):
    out = tmp_path / "check.json"
    bad = '{"t": 0, "do": "set", "key": "material.steel.nu", "value": 0.7, "frames": 7}'
    assert check(DATA / "plate.toml", script(tmp_path, bad, bad), "--json", out) == 1
    # programs have each frame
    assert [one["frame"] for one in json.loads(out.read_text())["edits"]["refused"]] == list(range(1, 15))
    rows = [line.split()[:4] for line in capsys.readouterr().out.splitlines() if "less than 0.5" in line]
    assert rows == [["2", "1", "7", "set"], ["3", "8", "7", "set"]]


def test_a_script_of_another_scene_is_a_warning(tmp_path, capsys):
    path = tmp_path / "edits.jsonl"
    path.write_text((DATA / "plate.jsonl").read_text().replace("plate.toml", "other.toml"))
    assert check(DATA / "plate.toml", path) == 0
    assert "other.toml" in capsys.readouterr().err


SHIPPED = [scene for app in applications().values() for scene in app.scenes()]

SPACED = {"shirt": ("bodies.body.mesh",), "stool": ("bodies.stool.mesh",)}
"""Bodies of triangles whose grids are made coarser here, by scene: at their own spacing these take half a minute."""
WEEKLY = {"growing"}
"""Scenes whose scripts take long to check: each edit of this one makes the grid of a body."""


@pytest.mark.slow
@pytest.mark.parametrize(
    "scene",
    [pytest.param(one, id=one.name, marks=[pytest.mark.weekly] if one.stem in WEEKLY else []) for one in SHIPPED],
)
def test_every_scene_that_ships_is_right_and_so_is_its_script(scene):
    script = scene.parents[1] / "edits" / f"{scene.stem}.jsonl"
    coarse = [word for key in SPACED.get(scene.stem, ()) for word in ("--set", f'{key}.spacing="20 mm"')]
    assert check(scene, *([script] if script.exists() else []), *coarse) == 0


WITH_TEMPLATE = [name for name, app in applications().items() if TESTS not in app.folder.parents or name == "plane"]


@pytest.mark.parametrize("app", WITH_TEMPLATE)
def test_new_writes_what_passes_check(app, tmp_path, capsys):
    folder = tmp_path / "fresh" / "start"
    assert main(["new", app, str(folder)]) == 0
    assert check(folder / "scene.toml", folder / "edits.jsonl") == 0
    assert sum("#" in line for line in (folder / "scene.toml").read_text().splitlines()) > 15
    capsys.readouterr()
    assert main(["new", app, str(folder)]) == 2
    assert "there already" in capsys.readouterr().err


def test_list_names_scenes_and_their_scripts(tmp_path, capsys):
    out = tmp_path / "list.json"
    assert main(["list", "--json", str(out)]) == 0
    scenes = {Path(s["path"]).name: s["scripts"] for s in json.loads(out.read_text())["plane"]["scenes"]}
    assert scenes["plate.toml"] == ["plate.jsonl"]
    assert "plate.jsonl" in capsys.readouterr().out


def test_schemas_name_every_key(tmp_path, capsys):
    out = tmp_path / "schema.json"
    assert main(["schema", "scene", "--out", str(out)]) == 0
    scene = json.loads(out.read_text())
    assert {"shape", "material", "effects", "supports", "loads", "mesh"} <= set(scene["properties"])
    assert scene["properties"]["app"]["enum"] == sorted(applications())
    assert "gravity" in scene["properties"]["effects"]["properties"]
    capsys.readouterr()
    assert main(["schema", "script"]) == 0
    script_schema = json.loads(capsys.readouterr().out)
    names = {definition["properties"].get("do", {}).get("const") for definition in script_schema["$defs"].values()}
    assert {"press", "drag", "release", "hole", "undo"} <= names
    assert "line" not in script_schema["$defs"]["Press"]["properties"]


def test_a_thickness_without_a_sign_is_refused_and_a_thin_one_is_not(capsys):
    """The undercut 4 mm - d sin(pi x / L) leaves 4 mm - d in the middle."""
    bar = TESTS / "scenes" / "bar_100.toml"
    key = "material.aluminium.thickness"
    assert check(bar, "--set", f'{key}="4e-3 - 3.9e-3 * sin(pi * x / 0.1)"') == 0
    assert check(bar, "--set", f'{key}="4e-3 - 4.1e-3 * sin(pi * x / 0.1)"') == 2
    reported = capsys.readouterr().err
    assert key in reported and "the thickness is -" in reported


def test_check_shows_bodies_supports_and_starts_of_cloth(tmp_path, capsys):
    clamp = '[supports.clamp]\non = "left"\nfix = ["x", "slope"]\n[supports.mirror]\non = "right"\nsymmetry = "x"\n'
    start = '[start]\nmove = [0, 0, "half"]\nscatter = "1 mm"\n'
    path = write_cloth(tmp_path, BALL, clamp, start)
    assert check(path, "--json", tmp_path / "check.json") == 0
    reported = " ".join(capsys.readouterr().out.split())
    assert "sphere, center (0.5, half, -0.3) m, radius 250 mm, friction 0.3" in reported
    # A formula alone is no number of metres.
    assert check(path, "--set", 'bodies.ball.sphere.radius="half/2"') == 0
    assert "m, radius half/2, friction 0.3" in " ".join(capsys.readouterr().out.split())
    assert "x = 0 and slope = 0 on left" in reported and "symmetry x on right" in reported
    assert "moved by (0, 0, half) m, scattered by 0.001 m with the seed 0" in reported
    # 1 m^2 of 0.5 mm at 400 kg/m^3
    assert "mass 0.2 kg, weight 1.962 N; 200 g/m^2, which is rho times thickness" in reported
    found = json.loads((tmp_path / "check.json").read_text())
    assert found["bodies"] == {"ball": {"sphere": {"center": [0.5, "half", -0.3], "radius": 0.25}, "friction": 0.3}}
    assert [found[key] for key in ("mass_by_area", "mass", "weight")] == pytest.approx([0.2, 0.2, 1.962], rel=1e-12)
    assert found["start"]["move"] == [0.0, 0.0, "half"] and "falls through bodies.ball" in found["warnings"][0]


def test_check_shows_seams_by_the_keys_of_the_scene(tmp_path, capsys):
    path = write_cloth(tmp_path, BALL, PIN, '[seams.side]\nfrom = "left"\nto = "right"\n')
    assert check(path, "--json", tmp_path / "check.json") == 0
    assert "from left, to right, ease 0.02" in capsys.readouterr().out
    found = json.loads((tmp_path / "check.json").read_text())
    assert found["seams"] == {"side": {"from": ["left"], "to": ["right"], "ease": 0.02, "slack": 0.0, "pleats": {}}}


def test_the_schema_takes_gravity_in_the_plane_and_in_space():
    gravity = scene_schema()["properties"]["effects"]["properties"]["gravity"]
    assert {model["properties"]["g"]["minItems"] for model in gravity["anyOf"]} == {2, 3}


def test_a_title_is_printed_as_plain_text(tmp_path, capsys):
    scene = tmp_path / "titled.toml"
    text = (DATA / "plate.toml").read_text()
    scene.write_text(text.replace('app = "plane"', 'app = "plane"\ntitle = "a\\u001b[2Jb\\u009b31mc\\u202e"'))
    assert check(scene) == 0
    printed = capsys.readouterr().out
    assert "a[2Jb31mc" in printed and not {"\x1b", "\x9b", "\u202e"} & set(printed)


def test_check_finds_supports_that_disagree(capsys):
    """As the first frame of a replay does; where they agree, all is well."""
    second = "supports.second={on='left',fix={x='%s'}}"
    assert check(DATA / "plate.toml", "--set", second % "0") == 0
    assert check(DATA / "plate.toml", "--set", second % "1 mm") == 2
    assert "supports.second.fix.x: two supports prescribe different values" in capsys.readouterr().err


def test_what_to_do_is_said_of_points_on_edges_and_of_lists_of_names(capsys):
    assert check(DATA / "plate.toml", "--set", "shape.points={q=[0,0.5]}") == 2
    assert "on an edge let it be a vertex" in capsys.readouterr().err
    assert check(DATA / "plate.toml", "--set", "quantities.tip={displacement='x',at=['left','right']}") == 2
    assert "[shape.groups]" in capsys.readouterr().err
