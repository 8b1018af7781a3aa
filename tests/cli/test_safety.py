"""Files that try to run code, to be obeyed in silence or to reach others: nothing happens, and a message says why."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import small_scenes
from drape_designs import HELD, sheet
from PIL import Image

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.scene.load import load_scene

SQUARE = """
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Physical Curve("left") = {4}; Physical Curve("right") = {2};
"""
TESTS = Path(__file__).parents[1]
SCENE = """
format = "restshape-scene"
version = 1
app = "plane"
[shape]
file = "{file}"
[material.steel]
E = "210 GPa"
nu = 0.3
rho = 7850
thickness = "1 mm"
[supports.clamp]
on = "left"
fix = {{ x = 0, y = 0 }}
[loads.pull]
on = "right"
force = [1, 0]
[mesh]
size = 0.2
"""


def write_scene(folder: Path, file: str = "x.geo") -> Path:
    folder.mkdir(exist_ok=True)
    path = folder / "scene.toml"
    path.write_text(SCENE.format(file=file))
    return path


def attacks(trace: Path) -> dict[str, str]:
    """Statements by what they are called, most of which would leave a file."""
    return {
        "SystemCall": f'SystemCall "touch {trace}";',
        "Printf": f'Printf("hello") > "{trace}";',
        "Save": f'Save "{trace}.msh";',
        "Print": f'Print "{trace}.msh";',
        "Exit": "Exit;",
        "Include": f'Include "{trace}.in";',
        "Merge": f'Merge "{trace}.in";',
        "While": "While (1) EndWhile",
        "NonBlockingSystemCall": f'NonBlockingSystemCall "touch {trace}";',
        "OnelabRun": f'OnelabRun("a", "touch {trace}");',
        "Plugin": "Plugin(MathEval).Run;",
        "CreateDir": f'CreateDir "{trace}";',
        "Macro": "Macro a Return",
        "Call": "Call a;",
    }


@pytest.mark.parametrize("name", list(attacks(Path())))
def test_a_geo_file_runs_nothing(command, tmp_path, name):
    scene, trace = write_scene(tmp_path), tmp_path / "trace"
    (tmp_path / "x.geo").write_text(SQUARE + attacks(trace)[name])
    before = sorted(tmp_path.iterdir())
    ended = command("check", scene)
    assert ended.returncode == 2
    assert f"x.geo (line {SQUARE.count(chr(10)) + 1}): the statement {name} is not run" in ended.stderr
    assert "--trust-geo" in ended.stderr
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.slow
def test_a_trusted_geo_file_runs_in_a_process_of_its_own(restshape, tmp_path):
    scene, trace = write_scene(tmp_path), tmp_path / "trace"
    (tmp_path / "x.geo").write_text(SQUARE + attacks(trace)["SystemCall"])
    assert restshape("check", scene, "--trust-geo").returncode == 0
    assert trace.exists()
    (tmp_path / "x.geo").write_text(SQUARE + "Exit;")
    ended = restshape("check", scene, "--trust-geo")
    assert ended.returncode == 2 and "before it was done" in ended.stderr


@pytest.mark.slow
def test_petscrc_is_not_obeyed(restshape, tmp_path):
    scene, out = write_scene(tmp_path), tmp_path / "out.vtkhdf"
    (tmp_path / "x.geo").write_text(SQUARE)
    for name in ("petscrc", ".petscrc"):
        (tmp_path / name).write_text(f"-dll_prepend {tmp_path}/none.so\n-ksp_view ascii:{tmp_path}/trace-{name}\n")
    ended = restshape("replay", scene, "--out", out, fresh=True)
    assert ended.returncode == 0, ended.stderr
    assert not list(tmp_path.glob("trace*")) and "PETSC ERROR" not in ended.stderr
    header = header_of(out)
    assert header["petsc_in_effect"] == {"skip_petscrc": ""}


def test_petscrc_is_not_obeyed_by_programs_that_import_petsc(outside, tmp_path):
    (tmp_path / "petscrc").write_text("-trace 1\n")
    program = "import restshape\nfrom petsc4py import PETSc\nprint(PETSc.Options().getAll())"
    ended = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, env=outside, capture_output=True, text=True, timeout=60
    )
    assert ended.returncode == 0 and "trace" not in ended.stdout and "skip_petscrc" in ended.stdout


@pytest.mark.slow
def test_an_options_file_that_is_named_is_read_and_recorded(restshape, tmp_path):
    scene, out = write_scene(tmp_path), tmp_path / "out.vtkhdf"
    (tmp_path / "x.geo").write_text(SQUARE)
    (tmp_path / "mine").write_text("-ksp_rtol 1e-9\n")
    ended = restshape("replay", scene, "--out", out, "--", "-options_file", "mine")
    assert ended.returncode == 0, ended.stderr
    header = header_of(out)
    assert header["petsc_in_effect"]["ksp_rtol"] == "1e-9"
    ended = restshape("replay", scene, "--", "-options_file", "none")
    assert ended.returncode == 2 and "PETSc cannot start" in ended.stderr


@pytest.mark.slow
def test_matplotlibrc_changes_no_picture(command, restshape, tmp_path):
    scene, out = write_scene(tmp_path), tmp_path / "out.vtkhdf"
    (tmp_path / "x.geo").write_text(SQUARE)
    assert command("replay", scene, "--out", out).returncode == 0
    pictures = []
    for text in (None, b"figure.facecolor: red\nfont.family: monospace\naxes.grid: True\n", b"\xff\xfe"):
        if text:
            (tmp_path / "matplotlibrc").write_bytes(text)
        # Files are looked for where a process starts.
        words = ("report", out, "--animation", "none")
        ended = restshape(*words, fresh=True) if text else command(*words)
        assert ended.returncode == 0 and not ended.stderr
        pictures.append(np.asarray(Image.open(tmp_path / "out-report" / "frames.png")))
    assert all(np.array_equal(pictures[0], picture) for picture in pictures[1:])


@pytest.mark.parametrize("where", ["shape", "body"])
def test_a_null_character_is_in_no_name_of_a_file(tmp_path, where):
    scene = write_scene(tmp_path, "a\\u0000b.geo")
    if where == "body":
        body = '[bodies.it]\nmesh = { file = "a\\u0000b.obj" }\n[effects.contact]\n'
        scene = small_scenes.write_scene(tmp_path, sheet("hinge", HELD, body))
    with pytest.raises(UserError, match="null character") as refused:
        load_scene(scene)
    assert "file (line" in refused.value.where


@pytest.mark.slow
def test_files_that_scenes_name_lie_beside_them(command, restshape, tmp_path):
    scene, elsewhere = write_scene(tmp_path / "scene", "../elsewhere/x.geo"), tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "x.geo").write_text(SQUARE)
    inside = tmp_path / "scene" / "sub"
    inside.mkdir()
    (inside / "x.geo").write_text(SQUARE)
    (tmp_path / "scene" / "link.geo").symlink_to(elsewhere / "x.geo")
    (tmp_path / "scene" / "folder").symlink_to(elsewhere)
    ways = ("../elsewhere/x.geo", str(elsewhere / "x.geo"), "link.geo", "folder/x.geo", "sub/../../elsewhere/x.geo")
    for file in ways:
        write_scene(tmp_path / "scene", file)
        ended = command("check", scene)
        assert ended.returncode == 2
        assert "scene.toml: shape.file (line 6)" in ended.stderr and "outside of the scene's folder" in ended.stderr
        assert f"--allow-path {elsewhere}" in ended.stderr
    # What is allowed once is allowed in the whole of a process.
    for file in ways[1:3]:
        write_scene(tmp_path / "scene", file)
        assert restshape("check", scene, "--allow-path", elsewhere).returncode == 0
    assert "through a link" in command("check", write_scene(tmp_path / "scene", "link.geo")).stderr
    assert command("check", write_scene(tmp_path / "scene", "sub/x.geo")).returncode == 0
    ended = command("check", scene, "--allow-path", "none")
    assert ended.returncode == 2 and "there is no such folder" in ended.stderr


def test_an_edit_names_no_file_outside(command, tmp_path):
    scene = write_scene(tmp_path / "scene")
    (tmp_path / "scene" / "x.geo").write_text(SQUARE)
    (tmp_path / "secret.geo").write_text(SQUARE)
    edits = tmp_path / "edits.jsonl"
    head = {"format": "restshape-edits", "version": 1, "units": "m"}
    ways = {
        "shape.file": {"key": "shape.file", "value": "../secret.geo"},
        "mesh.file": {"key": "mesh", "value": {"file": "../secret.geo"}},
    }
    for key, way in ways.items():
        edits.write_text("".join(json.dumps(line) + "\n" for line in (head, {"t": 0.2, "do": "set", **way})))
        for words in (["check", scene, edits], ["replay", scene, "--edits", edits]):
            ended = command(*words)
            assert ended.returncode == 2 and f"edits.jsonl: line 2: {key}" in ended.stderr
            assert "the file '../secret.geo' lies outside of the scene's folder" in ended.stderr
            assert f"--allow-path {tmp_path}" in ended.stderr
    edits.write_text(edits.read_text().replace("../secret.geo", "x.geo"))
    ended = command("check", scene, edits)
    assert ended.returncode == 1 and "refused" in ended.stdout


def test_a_mesh_file_reads_no_other(command, tmp_path):
    source = TESTS / "scenes" / "bracket.toml"
    (tmp_path / "bracket.toml").write_text(source.read_text().replace("../../meshes/", ""))
    (tmp_path / "secret.inp").write_text("*NODE\n")
    deck = (TESTS.parent / "meshes" / "bracket.inp").read_text()
    (tmp_path / "bracket.inp").write_text("*INCLUDE, INPUT=secret.inp\n" + deck)
    ended = command("check", tmp_path / "bracket.toml")
    assert ended.returncode == 2 and "bracket.inp (line 1): *INCLUDE" in ended.stderr


def header_of(path: Path) -> dict:
    with h5py.File(path) as file:
        return json.loads(bytes(file["restshape/header"][()]))


@pytest.fixture(scope="module")
def recorded(tmp_path_factory) -> Path:
    """A recording of a plate, whose report makes the shape again."""
    path = tmp_path_factory.mktemp("plate") / "plate.vtkhdf"
    assert main(["replay", str(TESTS / "data" / "plate.toml"), "--out", str(path)]) == 0
    return path


def test_a_report_follows_no_link(command, tmp_path, recorded):
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["secret"] = np.arange(10.0)
    for name in ("link", "outside", "view"):
        path = tmp_path / f"{name}.vtkhdf"
        shutil.copy(recorded, path)
        with h5py.File(path, "r+") as file:
            if name == "link":
                file["restshape/more"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "secret")
            elif name == "outside":
                file.create_dataset("more", (4,), "u1", external=[(str(tmp_path / "other.h5"), 0, 4)])
            else:
                layout = h5py.VirtualLayout((10,), "f8")
                layout[:] = h5py.VirtualSource(str(tmp_path / "other.h5"), "secret", (10,))
                file.create_virtual_dataset("more", layout)
        ended = command("report", path)
        assert ended.returncode == 2 and "which no recording does" in ended.stderr
