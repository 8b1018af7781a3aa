"""What is too large is refused by its place and a remedy, before memory goes into it; a frame has its limits."""

import base64
import csv
import gc
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
from small_scenes import drag, plate, write_scene, write_script

from restshape import bounds
from restshape.errors import UserError
from restshape.mesh import importer
from restshape.replay.recording.recording import Recording
from restshape.scene import units

ROOT = Path(__file__).parents[2]
PLATE = plate(0.25)
LONG = "1" * 400
POINTS = ", ".join(f"[{2 * i / 6000}, 0.0]" for i in range(1, 6000))


def with_value(old: str, new: str) -> str:
    assert old in PLATE
    return PLATE.replace(old, new, 1)


SCENES = {
    "whole number": (with_value("rho = 8000", f"rho = {LONG}"), "rho", "64 bits"),
    "endless number": (with_value("rho = 8000", f"rho = {'1' * 5000}"), "scene.toml (line 26)", "4000 digits"),
    "version": (with_value("version = 1", f"version = {LONG}"), "version (line 2)", "64 bits"),
    "coordinate": (with_value("a = [0, 0]", f"a = [0, {LONG}]"), "shape.vertices.a.1", "64 bits"),
    "float": (with_value("E = 200e9", "E = 1e300"), "material.steel.E", "beyond 1e+60 Pa"),
    "power of a unit": (with_value("thickness = 0.01", 'thickness = "1 mm^-999"'), "thickness", "power beyond 12"),
    "unit that vanishes": (
        with_value("thickness = 0.01", f'thickness = "1 mm/ ({"nm^12 " * 4})"'),
        "thickness",
        "too large a unit",
    ),
    "largest size": (with_value("size = 0.25", "size = 1e308"), "mesh.size", "beyond 1e+09 m"),
    "smallest size": (with_value("size = 0.25", "size = 1e-308"), "mesh.size", "at most 4e+06"),
    "spline": (
        with_value('bottom = { line = ["a", "b"] }', 'bottom = { spline = ["a", "b"], through = [[0.1, 1e17]] }'),
        "edges.bottom",
        "beyond 1e+09 m",
    ),
    "polyline": (
        with_value('bottom = { line = ["a", "b"] }', f'bottom = {{ polyline = ["a", "b"], through = [{POINTS}] }}'),
        "edges.bottom",
        "at most 5000 entries",
    ),
    "bulge": (
        with_value('bottom = { line = ["a", "b"] }', 'bottom = { arc = ["a", "b"], bulge = 1e8 }'),
        "edges.bottom",
        "at most 1e+06",
    ),
    "deep lists": (PLATE + f"z = {'[' * 500}{']' * 500}\n", "scene.toml", "more than 32 tables and lists"),
    "deep keys": (PLATE + f"[{'.'.join('a' * 5000)}]\n", "a.a.a", "more than 32 tables and lists"),
    "name": (PLATE.replace("window", "w" * 300), "shape.holes.www", "200 characters"),
    "text": (with_value("thickness = 0.01", f'thickness = "{"1" * 20000}!"'), "thickness", "2000 are allowed"),
}


@pytest.mark.parametrize("name", list(SCENES))
def test_a_scene_beyond_a_bound_is_refused_with_its_place(command, tmp_path, name):
    text, where, why = SCENES[name]
    ended = command("check", write_scene(tmp_path, text))
    assert ended.returncode == 2
    assert where in ended.stderr and why in ended.stderr


SCRIPTS = {
    "number": (f'{{"t": 0, "do": "set", "key": "mesh.size", "value": {LONG}}}', "value: the whole number"),
    "endless number": (f'{{"t": 0, "do": "set", "key": "mesh.size", "value": {"1" * 5000}}}', "a number that is too"),
    "depth": ('{"t": 0, "do": "set", "key": "a", "value": ' + "[" * 900 + "]" * 900 + "}", "more than 32 tables"),
    "time": ('{"t": 1e300, "do": "idle"}', "beyond 1e+60 s"),
}


@pytest.mark.parametrize("name", list(SCRIPTS))
def test_an_event_beyond_a_bound_is_refused_with_its_line(command, tmp_path, name):
    scene, script = write_scene(tmp_path, PLATE), tmp_path / "edits.jsonl"
    line, why = SCRIPTS[name]
    script.write_text(f'{{"format": "restshape-edits", "version": 1}}\n{line}\n')
    ended = command("check", scene, script)
    assert ended.returncode == 2
    assert "edits.jsonl: line 2" in ended.stderr and why in ended.stderr


def rows_in(table: Path) -> list[dict[str, str]]:
    with table.open(newline="") as file:
        return list(csv.DictReader(file))


FAR = {
    "a slip of the unit": drag("c", (2, 1), [(606.0, 606.0)]),
    "as far as numbers go": drag("window", (0.5, 0.5), [(1e150, 0.0)]),
    "a hole scaled": [{"do": "scale", "on": "window", "factor": 1e8}],
    "all scaled": [{"do": "scale", "on": "all", "factor": 1e8}],
    "turned far away": [{"do": "rotate", "on": "window", "by": 1.0, "about": [1e200, 0.0]}],
    "an arc through a far point": [{"do": "arc", "on": "top", "through": [1e11, 1e11]}],
    "an arc that is nearly a circle": [{"do": "arc", "on": "top", "bulge": 1e5}],
    "a hole far away": [{"do": "hole", "name": "h", "center": [1e18, 0.0], "radius": 1e17}],
    "a vertex far away": [{"do": "insert", "on": "top", "name": "v", "at": [1e200, 0.0], "note": "at an end"}],
}


@pytest.mark.slow
@pytest.mark.parametrize("name", list(FAR))
def test_an_edit_that_goes_too_far_is_a_refused_frame_and_the_replay_goes_on(command, tmp_path, name):
    scene = write_scene(tmp_path, PLATE)
    near = drag("window", (0.5, 0.5), [(0.52, 0.5)])
    script = write_script(tmp_path, [*FAR[name], *near])
    table = tmp_path / "rows.csv"
    ended = command("replay", scene, "--edits", script, "--csv", table)
    assert ended.returncode == 0, ended.stderr
    rows = rows_in(table)
    assert sum(row["stale"] == "1" for row in rows) == 1 and rows[-1]["stale"] == "0"
    assert float(rows[-1]["q_stretch"]) > 0.0 and rows[-2]["level"] == "1"


def test_an_edit_may_ask_for_a_finer_mesh_and_not_for_a_shape_of_many_more_triangles(command, tmp_path, monkeypatch):
    monkeypatch.setattr("restshape.mesh.sizing.GROWN_TRIANGLES", 200)
    monkeypatch.setattr("restshape.mesh.sizing.GROWTH", 4.0)
    scene, table = write_scene(tmp_path, PLATE), tmp_path / "rows.csv"
    larger = [{"do": "scale", "on": "all", "factor": 8.0}, {"do": "insert", "on": "top", "name": "v", "s": 0.5}]
    script = write_script(tmp_path, [{"do": "set", "key": "mesh.size", "value": 0.05}, *larger])
    assert command("replay", scene, "--edits", script, "--csv", table).returncode == 0
    rows = rows_in(table)
    assert int(rows[1]["elements"]) > 4 * int(rows[0]["elements"])
    assert [row["stale"] for row in rows] == ["0", "0", "0", "1"] and "more than 4 times" in rows[3]["refused"]


@pytest.mark.parametrize("place", ["scene", "script"])
def test_a_file_without_an_end_is_refused(command, tmp_path, place):
    scene = write_scene(tmp_path, PLATE)
    ended = command("check", *(("/dev/zero",) if place == "scene" else (scene, "/dev/zero")))
    assert ended.returncode == 2 and "/dev/zero: this" in ended.stderr and "bytes" in ended.stderr


LONG_NAME = "n" * 300


@pytest.mark.parametrize("option", ["SCENE", "--edits", "--out", "--csv", "--json", "--calibration", "--allow-path"])
def test_a_name_that_no_file_can_have_is_refused(command, tmp_path, option):
    words: list[object] = [write_scene(tmp_path, PLATE), option, LONG_NAME + ".vtkhdf" * (option == "--out")]
    ended = command("replay", *(words if option != "SCENE" else [f"{LONG_NAME}.toml"]))
    assert ended.returncode == 2 and "too long" in ended.stderr.lower()


@pytest.mark.parametrize("key", ["shape.file", "mesh.file"])
@pytest.mark.parametrize("name", [LONG_NAME, "a\0b"])
def test_a_scene_names_no_such_file_either(command, tmp_path, key, name):
    scene = write_scene(tmp_path, PLATE)
    ended = command("check", scene, "--set", f"{key}={name}.msh")
    assert ended.returncode == 2 and f"scene.toml: {key}" in ended.stderr


def test_a_calibration_without_end_is_refused(command, tmp_path):
    ended = command("replay", write_scene(tmp_path, PLATE), "--calibration", "/dev/zero")
    assert ended.returncode == 2 and "not JSON" in ended.stderr


def test_long_texts_are_not_searched_for_numbers(monkeypatch):
    class Unused:
        def match(self, text: str) -> None:
            assert len(text) <= bounds.QUANTITY_CHARACTERS

    monkeypatch.setattr(units, "NUMBER_UNIT", Unused())
    assert not units.reads_as_quantity("1" * 20000)
    with pytest.raises(units.UnitError, match="is not a number with a unit"):
        units.quantity("1" * 20000, "length")


MSH = """$MeshFormat
4.1 0 8
$EndMeshFormat
$Nodes
1 10000000000 1 10000000000
2 1 0 10000000000
1
0 0 0
$EndNodes
"""


def vtu(size: int) -> str:
    """A .vtu file whose coordinates unpack to so many bytes."""
    packed = zlib.compress(bytes(size), 1)
    head = np.array([1, size, size, len(packed)], dtype="<u4").tobytes()
    data = (base64.b64encode(head) + base64.b64encode(packed)).decode()
    return (
        '<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian" header_type="UInt32" '
        'compressor="vtkZLibDataCompressor"><UnstructuredGrid>'
        f'<Piece NumberOfPoints="{size // 24}" NumberOfCells="1"><Points>'
        f'<DataArray type="Float64" NumberOfComponents="3" format="binary">{data}</DataArray></Points>'
        "</Piece></UnstructuredGrid></VTKFile>"
    )


@pytest.mark.parametrize(("name", "text"), [("claims.msh", MSH), ("packed.vtu", vtu(150_000_000))])
def test_a_mesh_file_that_would_take_more_memory_than_there_is_is_refused(tmp_path, monkeypatch, name, text):
    monkeypatch.setattr(importer, "READING_MEMORY", 20 << 20)
    path = tmp_path / name
    path.write_text(text)
    gc.collect()  # garbage of other tests that is freed meanwhile would make room
    with pytest.raises(UserError, match="would take more than"):
        importer.read_mesh(path)


def test_a_list_of_nodes_by_thru_is_as_long_as_the_nodes_that_there_are(tmp_path):
    grids = "".join(f"GRID,{i + 1},,{x},{y},0.\n" for i, (x, y) in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)]))
    path = tmp_path / "x.bdf"
    path.write_text(f"BEGIN BULK\n{grids}CTRIA3,1,1,1,2,3\nCTRIA3,2,1,1,3,4\nSPC1,7,12,1,THRU,99999999999\nENDDATA\n")
    mesh, _ = importer.read_mesh(path)
    assert len(mesh.nodes_of("SPC_7")) == 4


HANG = """
import sys
from restshape import _kernels
{before}
_kernels.watch({seconds}, {memory}, 3, {text})
{outlet}
for _ in range(12):
    _kernels.begin_frame()
{work}
"""
TEXT = '"frame %d takes too long\\n", "frame %d takes too much memory\\n"'
POWER = "3 ** (10 ** 9)"
"""Minutes in one call that never looks for signals."""


def ended_of(outside, **parts: object) -> subprocess.CompletedProcess:
    program = HANG.format(**{"before": "", "outlet": "", "seconds": 0.0, "memory": 0, "text": TEXT, **parts})
    return subprocess.run(
        [sys.executable, "-c", program], env=outside, capture_output=True, text=True, timeout=100, check=False
    )


def test_compiled_code_that_does_not_return_is_ended_with_the_number_of_the_frame(outside):
    ended = ended_of(outside, seconds=0.5, work=POWER)
    assert (ended.returncode, ended.stdout, ended.stderr) == (3, "", "frame 12 takes too long\n")


def test_only_computing_counts_but_a_frame_that_waits_is_ended_by_the_clock(outside):
    """As on a machine that others load: a frame of 0.25 s by the clock computes for less than 0.1 s."""
    ended = ended_of(outside, seconds=0.1, work="import time\ntime.sleep(0.25)")
    assert (ended.returncode, ended.stderr) == (0, "")
    text = '"frame %d: %c s%s; ", "", 3.0'
    ended = ended_of(
        outside, seconds=0.1, text=text, work='_kernels.set_stage(", in a grid")\nimport time\ntime.sleep(60)'
    )
    assert (ended.returncode, ended.stderr) == (3, "frame 12: 0.3 s, in a grid; ")


def test_memory_that_grows_ends_a_run(outside):
    ended = ended_of(outside, memory=300 << 20, work=f"kept = bytearray(b'1' * {400 << 20})\n{POWER}")
    assert (ended.returncode, ended.stderr) == (3, "frame 12 takes too much memory\n")


def test_frames_before_the_limit_are_in_the_recording(outside, tmp_path):
    before = f"""
import numpy as np
from restshape.replay.recording.recorder import Recorder
recorder = Recorder.start({str(tmp_path / "x.vtkhdf")!r}, {{"a": 1}}, {{"t": "f8"}})
recorder.topology(np.array([[0, 1, 2]]))
for t in range(5):
    recorder.frame(t, np.zeros((3, 2)), {{}}, {{}}, {{"t": t}})
"""
    outlet = "_kernels.watch_outlet(*recorder.outlet)"
    ended = ended_of(outside, seconds=0.5, before=before, outlet=outlet, work=POWER)
    assert ended.returncode == 3, ended.stderr
    with Recording(tmp_path / "x.vtkhdf") as recording:
        assert (recording.n, recording.status, recording.verify()) == (5, "frame limit", [])


def test_a_replay_ends_at_its_limit_and_says_what_to_do(restshape, tmp_path):
    scene = write_scene(tmp_path, PLATE)
    ended = restshape("replay", scene, "--frame-limit", "0.01", "--out", tmp_path / "x.vtkhdf")
    assert ended.returncode == 3
    assert "frame 0 takes longer than 0.01 s" in ended.stderr and "--frame-limit" in ended.stderr
    ended = restshape("check", scene, "--memory-limit", "1MB")
    assert ended.returncode == 3 and "more than 0.001 GB" in ended.stderr


@pytest.mark.parametrize("words", [("--frame-limit", "none"), ("--memory-limit", "none"), ("--memory-limit", "50 GB")])
def test_limits_can_be_lifted(command, tmp_path, words):
    assert command("check", write_scene(tmp_path, PLATE), *words).returncode == 0


@pytest.mark.parametrize("words", [("--frame-limit", "-1"), ("--frame-limit", "soon"), ("--memory-limit", "5 apples")])
def test_what_is_no_limit_is_refused(command, tmp_path, words):
    ended = command("check", write_scene(tmp_path, PLATE), *words)
    assert ended.returncode == 2 and "is no limit" in ended.stderr


def test_every_bound_is_documented_with_its_value():
    text = (ROOT / "docs" / "safety.md").read_text(encoding="utf-8")
    names = [name for name in vars(bounds) if name.isupper()]
    assert len(names) > 20
    for name in names:
        value = getattr(bounds, name)
        row = next((line for line in text.splitlines() if line.startswith(f"| `{name}` |")), "")
        assert shown(name, value) in row, f"{name}: {shown(name, value)} is not in {row!r}"


def shown(name: str, value: float) -> str:
    """A bound as the page shows it."""
    if (name.endswith("_BYTES") and value > 255) or name.endswith("_MEMORY"):
        return f"{value >> 20} MB" if value < 1 << 30 else f"{value >> 30} GB"
    if name == "WHOLE_NUMBER":
        return "2^63"
    return f"{value:,}" if isinstance(value, int) else f"{value:g}".replace("e+0", "e").replace("e+", "e")
