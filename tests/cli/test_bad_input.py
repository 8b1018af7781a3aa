"""Bad scenes, scripts and command lines: each ends with code 2 and a message that names what and where."""

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from restshape.cli.main import main

DATA = Path(__file__).parents[1] / "data"


@dataclass(frozen=True)
class Case:
    """One mistake in the small scene, in its script, or on the command line.

    Args:
        name: for people.
        says: fragments that the message must hold: what, and where.
        scene: (old, new) text in the scene file.
        script: (old, new) text in the edit script.
        argv: the command line; {scene}, {script} and {folder} are filled in.
        prepare: does something to the folder first.
    """

    name: str
    says: tuple[str, ...]
    scene: tuple[str, str] = ("", "")
    script: tuple[str, str] = ("", "")
    argv: tuple[str, ...] = ("check", "{scene}", "{script}")
    prepare: Callable[[Path], object] = lambda folder: None


def scene_bytes(data: bytes) -> Callable[[Path], object]:
    """Puts these bytes in place of the scene."""
    return lambda folder: (folder / "plate.toml").write_bytes(data)


def script_bytes(data: bytes) -> Callable[[Path], object]:
    """Puts these bytes in place of the script."""
    return lambda folder: (folder / "plate.jsonl").write_bytes(data)


def torn(folder: Path) -> None:
    """Cuts the script in the middle of its last line."""
    path = folder / "plate.jsonl"
    path.write_bytes(path.read_bytes()[:-12])


TOP = 'top = { line = ["c", "d"] }'
WINDOW = "window = { circle = { center = [0.5, 0.5]"
DRAG = '{"t": 0.1, "do": "drag", "to": [520, 500]}'
HEADER = '{"format": "restshape-edits", "version": 1, "scene": "plate.toml", "units": "mm"}\n'

SCENES = [
    Case(
        "unknown key",
        ("plate.toml: material.steel.thicknes", "line", "did you mean 'thickness'"),
        ("thickness", "thicknes"),
    ),
    Case("unknown table", ("plate.toml: quantites", "did you mean 'quantities'"), ("[quantities]", "[quantites]")),
    Case("wrong unit", ("mesh.size", "'100 kg' is a mass, but a length is wanted"), ('"100 mm"', '"100 kg"')),
    Case("unknown unit", ("mesh.size", "'mmm' is not a known unit"), ('"100 mm"', '"100 mmm"')),
    Case(
        "open outline",
        ("plate.toml: shape.outline", "line"),
        ('["bottom", "right", "top", "left"]', '["bottom", "right", "top"]'),
    ),
    Case("crossing outline", ("plate.toml: shape", "cross"), ("c = [2, 1]\nd = [0, 1]", "c = [0, 1]\nd = [2, 1]")),
    Case("edge from a vertex to itself", ("shape.edges.top", "zero length"), (TOP, 'top = { line = ["c", "c"] }')),
    Case("zero-length edge", ("shape.edges.top", "zero length"), ("d = [0, 1]", "d = [2, 1]")),
    Case("hole outside", ("plate.toml: shape", "window"), (WINDOW, WINDOW.replace("[0.5, 0.5]", "[5, 0.5]"))),
    Case(
        "hole across the outline",
        ("plate.toml: shape", "window"),
        (WINDOW, WINDOW.replace("[0.5, 0.5]", "[0.05, 0.5]")),
    ),
    Case("name used twice", ("shape.holes.left", "'left' used twice", "shape.edges.left"), ("window = {", "left = {")),
    Case("key twice", ("plate.toml (line", "used twice"), ("nu = 0.3", "nu = 0.3\nnu = 0.3")),
    Case("table twice", ("plate.toml (line", "used twice"), ("[mesh]", "[material.steel]\nE = 1\n[mesh]")),
    Case(
        "edge that is not there",
        ("shape.outline", "no edge 'bottm'", "did you mean 'bottom'"),
        ('["bottom",', '["bottm",'),
    ),
    Case("vertex that is not there", ("shape.edges.top", "no vertex 'z'"), (TOP, 'top = { line = ["c", "z"] }')),
    Case(
        "entity that is not there",
        ("loads.pull.on", "no entity 'rihgt'", "did you mean 'right'"),
        ('on = "right"', 'on = "rihgt"'),
    ),
    Case(
        "unknown kind of edge",
        ("shape.edges.top", "one of line, arc, spline, polyline"),
        (TOP, 'top = { curve = ["c", "d"] }'),
    ),
    Case("NaN", ("material.steel.E", "nan is not a finite number"), ('"210 GPa"', "nan")),
    Case("infinity", ("shape.vertices.c", "inf is not a finite number"), ("c = [2, 1]", "c = [2, inf]")),
    Case("bad nu", ("material.steel.nu", "less than 0.5"), ("nu = 0.3", "nu = 0.5")),
    Case("negative stiffness", ("material.steel.E", "greater than 0"), ('"210 GPa"', "-1")),
    Case("negative size", ("mesh.size", "greater than 0"), ('"100 mm"', '"-100 mm"')),
    Case(
        "no material", ("material", "missing"), ('[material.steel]\nE = "210 GPa"\nnu = 0.3\nthickness = "10 mm"\n', "")
    ),
    Case("bad formula", ("loads.pull.traction", "is not a formula"), ("P*(1 + y)", "P*(1 + y")),
    Case("formula with code in it", ("loads.pull.traction", "may not hold"), ("P*(1 + y)", "x.__class__")),
    Case(
        "formula with an unknown name",
        ("loads.pull.traction", "'Q', which is not in [parameters]"),
        ("P*(1 + y)", "Q*y"),
    ),
    Case(
        "unknown effect",
        ("effects.gravitty", "did you mean 'gravity'"),
        ("[effects.solid]", "[effects.gravitty]\n[effects.solid]"),
    ),
    Case(
        "unknown policy",
        ("solve.policy", "did you mean 'rebuild'"),
        ("[quantities]", '[solve]\npolicy = "rebuilt"\n[quantities]'),
    ),
    Case("unknown application", ("plate.toml: app", "'liquid'", "plane"), ('app = "plane"', 'app = "liquid"')),
    Case("wrong version", ("plate.toml: version", "version 9"), ("version = 1", "version = 9")),
    Case("wrong format", ("plate.toml: format", "not a scene"), ('"restshape-scene"', '"restshape-edits"')),
    Case("two kinds of load", ("loads.pull", "exactly one of force"), ("[loads.pull]", "[loads.pull]\npressure = 1")),
    Case(
        "text where a table is wanted",
        ("supports.wall", "a table of keys"),
        ('[supports.wall]\non = "left"\nfix = ["x", "y"]', '[supports]\nwall = "left"'),
    ),
    Case("not TOML", ("plate.toml (line", "not TOML"), ("nu = 0.3", "nu 0.3")),
    Case("a key with a letter beyond ASCII", ("plate.toml (line", "with 'ß' in quotes"), ("nu = 0.3", "straße = 0.3")),
    Case(
        "a formula that divides by 0",
        ("loads.pull.traction.0 (line", "gives inf"),
        ("P*(1 + y)", "P/0"),
    ),
    Case(
        "crossing outline in a replay",
        ("plate.toml: shape (line", "cross"),
        ("c = [2, 1]\nd = [0, 1]", "c = [0, 1]\nd = [2, 1]"),
        argv=("replay", "{scene}", "{script}"),
    ),
    Case(
        "edits in place of the scene",
        ("plate.jsonl", "JSON, as edits are", "name the scene first"),
        argv=("check", "{script}", "{scene}"),
    ),
    Case("binary scene", ("plate.toml", "not a text file"), prepare=scene_bytes(bytes(range(256)))),
    Case("empty scene", ("plate.toml: format", "not a scene"), prepare=scene_bytes(b"")),
    Case("missing scene", ("nowhere.toml", "no such scene"), argv=("check", "{folder}/nowhere.toml")),
    Case("a folder for a scene", ("is a folder",), argv=("check", "{folder}")),
    Case(
        "missing outline file",
        ("plate.toml: shape.file (line", "part.dxf"),
        ("[shape]\noutline", '[shape]\nfile = "part.dxf"\noutline'),
    ),
]

SCRIPTS = [
    Case("torn last line", ("plate.jsonl: line 5", "torn"), prepare=torn),
    Case(
        "drag before press",
        ("plate.jsonl: line 3", "before a press"),
        script=('"do": "press", "on": "window", "at": [500, 500]', '"do": "idle"'),
    ),
    Case(
        "unknown event",
        ("plate.jsonl: line 3", "did you mean 'drag'"),
        script=('"do": "drag", "to"', '"do": "darg", "to"'),
    ),
    Case(
        "unknown key of an event",
        ("plate.jsonl: line 3", "no key 'too'", "did you mean 'to'"),
        script=('"to"', '"too"'),
    ),
    Case("time runs backwards", ("plate.jsonl: line 4", "time runs backwards"), script=('"t": 0.2', '"t": 0.05')),
    Case("header missing", ("plate.jsonl: line 1", "header is missing"), script=(HEADER, "")),
    Case("wrong version of script", ("plate.jsonl: line 1", "version 7"), script=('"version": 1', '"version": 7')),
    Case("unit written out", ("'inches' is not a known unit", "did you mean 'in'?"), ('"100 mm"', '"4 inches"')),
    Case("unknown scale", ("'degF' is not a known unit", "write degC"), ('"100 mm"', '"77 degF"')),
    Case("one number for a vector", ("center", "all of its numbers", '[0, "5 cm"]'), ("[0.5, 0.5]", '"5 cm"')),
    Case("unknown unit of script", ("plate.jsonl: line 1: units", "furlong"), script=('"mm"', '"furlong"')),
    Case("wrong JSON type", ("plate.jsonl: line 3: to", "a list is wanted"), script=("[520, 500]", '"far"')),
    Case(
        "NaN in the script", ("plate.jsonl: line 3", "NaN is not a finite number"), script=("[520, 500]", "[NaN, 500]")
    ),
    Case("not JSON", ("plate.jsonl: line 3", "not JSON"), script=(DRAG, DRAG[:-1])),
    Case("list for a line", ("plate.jsonl: line 3", "JSON object"), script=(DRAG, "[1, 2]")),
    Case("empty script", ("plate.jsonl", "empty"), prepare=script_bytes(b"")),
    Case("binary script", ("plate.jsonl", "not a text file"), prepare=script_bytes(b"\xff\xfe\x00\x01")),
    Case(
        "missing script", ("nowhere.jsonl", "no such edit script"), argv=("check", "{scene}", "{folder}/nowhere.jsonl")
    ),
]

LINES = [
    Case(
        "override of an unknown key",
        ("mesh.siez", "did you mean 'size'"),
        argv=("check", "{scene}", "--set", "mesh.siez=1"),
    ),
    Case("override without a value", ("--set", "not key=value"), argv=("check", "{scene}", "--set", "mesh.size")),
    Case(
        "override of an unknown name",
        ("--set", "did you mean 'steel'"),
        argv=("check", "{scene}", "--set", "material.stel.E=1"),
    ),
    Case(
        "override with text out of quotes",
        ("center", "each text in it in quotes"),
        argv=("check", "{scene}", "--set", "shape.holes.window.circle.center=[0.5, 5 cm]"),
    ),
    Case(
        "unwritable output",
        ("--json", "cannot be written"),
        argv=("check", "{scene}", "--json", "{folder}/no/such/folder/out.json"),
    ),
    Case("a folder for an output", ("--json", "cannot be written"), argv=("check", "{scene}", "--json", "{folder}")),
    Case(
        "unwritable list", ("--json", "cannot be written"), argv=("list", "--json", "{folder}/no/such/folder/out.json")
    ),
    Case(
        "unwritable schema",
        ("--out", "cannot be written"),
        argv=("schema", "scene", "--out", "{folder}/no/such/folder/out.json"),
    ),
    Case(
        "new over a scene",
        ("scene.toml", "there already"),
        argv=("new", "plane", "{folder}"),
        prepare=lambda folder: (folder / "scene.toml").touch(),
    ),
    Case("new of an unknown application", ("APP", "'plame'", "plane"), argv=("new", "plame", "{folder}/x")),
    Case("new under a file", ("plate.toml", "cannot write"), argv=("new", "plane", "{scene}/x")),
]

CASES = [*SCENES, *SCRIPTS, *LINES]


def change(path: Path, old: str, new: str) -> None:
    """Replaces text that must be there."""
    text = path.read_text()
    assert old in text, f"the case does not fit {path.name}"
    path.write_text(text.replace(old, new, 1))


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_bad_input(case: Case, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files = {"scene": tmp_path / "plate.toml", "script": tmp_path / "plate.jsonl", "folder": tmp_path}
    for kind in ("scene", "script"):
        shutil.copy(DATA / files[kind].name, tmp_path)
    change(files["scene"], *case.scene)
    change(files["script"], *case.script)
    case.prepare(tmp_path)
    code = main([word.format(**files) for word in case.argv])
    out, err = capsys.readouterr()
    assert code == 2, out + err
    for fragment in case.says:
        assert fragment in err
    assert "Traceback" not in out + err
    assert "[type=" not in err and "pydantic" not in err


def test_the_cases_are_many_and_different():
    assert len({case.name for case in CASES}) == len(CASES) >= 25


def test_no_output_is_left_behind_by_bad_input(tmp_path, capsys):
    out = tmp_path / "out.json"
    assert main(["check", str(tmp_path / "nowhere.toml"), "--json", str(out)]) == 2
    assert not out.exists()
