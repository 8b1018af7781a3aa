"""An exported scene is the edited one: same names, same curves, same first frame, and edits go on from there."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from edited_shapes import ALL_KINDS, EDITS, edited
from small_scenes import BLOCK, CLAMPED, HEAD, HOLE, STEEL, meshed, write_script

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.export import toml_scene
from restshape.export.edited_frame import frame_of_script
from restshape.export.toml_scene import write_toml
from restshape.replay.recording.recording import Recording
from restshape.replay.sessions import session_of
from restshape.scene.edit_script import Script, load_script
from restshape.scene.load import load_scene
from restshape.scene.model import ShapeSpec
from restshape.shape.build import outline_from_spec


@pytest.mark.parametrize("number", [0, 5, -1])
def test_a_scene_has_the_edited_shape(tmp_path, number):
    frame = edited(tmp_path, number)
    write_toml(frame, tmp_path / "out.toml")
    back = load_scene(tmp_path / "out.toml")
    outline = outline_from_spec(back.shape)
    assert outline.area() == pytest.approx(frame.outline.area(), rel=1e-13)
    for kind in ("vertex", "edge", "hole", "region", "group"):
        assert set(outline.names(kind)) == set(frame.outline.names(kind)), kind
    s = np.linspace(0.0, 1.0, 41)
    for i, edge in enumerate(frame.outline.edges):
        (j,) = [j for j, other in enumerate(outline.edges) if other.name == edge.name]
        assert (outline.edges[j].kind, outline.edges[j].parent) == (edge.kind, edge.parent)
        if edge.kind != "polyline":
            np.testing.assert_allclose(outline.point(j, s), frame.outline.point(i, s), atol=1e-13)
    assert back.material["steel"].E == frame.scene.material["steel"].E
    if number == -1:
        assert back.material["steel"].E == 70e9
        assert len(outline.entity("top").edges) == 2


def test_edits_go_on_from_there(tmp_path):
    half = next(i for i, event in enumerate(EDITS) if event["do"] == "insert") + 1
    write_toml(edited(tmp_path), tmp_path / "whole.toml")
    whole = outline_from_spec(load_scene(tmp_path / "whole.toml").shape)
    scene = load_scene(tmp_path / "plate.toml")
    first = list(session_of(scene, load_script(write_script(tmp_path, EDITS[:half]), scene)).frames())[-1]
    write_toml(edited(tmp_path, first.index), tmp_path / "half.toml")
    on = load_scene(tmp_path / "half.toml")
    last = list(session_of(on, load_script(write_script(tmp_path, EDITS[half:]), on)).frames())[-1]
    assert last.outline.area() == pytest.approx(whole.area(), rel=1e-12)
    np.testing.assert_allclose(np.sort(last.outline.points, axis=0), np.sort(whole.points, axis=0), atol=1e-12)


@pytest.mark.slow
def test_its_first_frame_is_the_recorded_one(tmp_path, command):
    stretch = '[quantities]\nstretch = { displacement = "x", at = "right" }\n'
    (tmp_path / "plate.toml").write_text(ALL_KINDS.replace("size = 0.1", "size = 0.25\norder = 1") + stretch)
    script = write_script(tmp_path, EDITS[:7])
    words = ("--edits", script, "--policy", "rebuild", "--out", "plate.vtkhdf")
    assert command("replay", "plate.toml", *words).returncode == 0
    done = command("export", "plate.vtkhdf", "--as", "toml")
    assert done.returncode == 0, done.stderr
    assert command("check", "plate-edited.toml").returncode == 0
    assert command("replay", "plate-edited.toml", "--out", "again.vtkhdf").returncode == 0
    with Recording(tmp_path / "plate.vtkhdf") as before, Recording(tmp_path / "again.vtkhdf") as after:
        assert after.table["q_stretch"][0] == pytest.approx(before.table["q_stretch"][-1], rel=1e-6)
        assert after.table["elements"][0] == before.table["elements"][-1]
        assert before.table["q_stretch"][-1] != pytest.approx(before.table["q_stretch"][0], rel=1e-2)


@pytest.mark.parametrize(
    ("edge", "why"),
    [
        ('{ spline = ["c", "d"], through = [[1.5, 1.1], [0.5, 1.1]], knots = [0.3] }', "1 knots for 2 points"),
        ('{ spline = ["c", "d"], through = [[1.5, 1.1], [0.5, 1.1]], knots = [0.6, 0.3] }', "do not rise"),
        ('{ spline = ["c", "d"], through = [[1.5, 1.1]], ends = ["smooth", "smooth"] }', "two points or more"),
        ('{ spline = ["c", "d"], through = [[1.5, 1.1]], ends = ["flat", "smooth"] }', "natural"),
        ('{ line = ["c", "d"], part_of = "a" }', "part of 'a', which names a vertex"),
    ],
)
def test_knots_ends_and_parts_without_sense_are_refused(tmp_path, edge, why):
    old = '{ spline = ["c", "d"], through = [[1.5, 1.1], [0.5, 1.1]] }'
    assert old in ALL_KINDS
    (tmp_path / "plate.toml").write_text(ALL_KINDS.replace(old, edge))
    with pytest.raises(UserError, match=why):
        outline_from_spec(load_scene(tmp_path / "plate.toml").shape)


def test_smooth_ends_trace_one_polynomial(tmp_path):
    """Four points, both ends smooth: the cubic through them, whose area under the edge is known."""
    xs = np.array([0.0, 1.0, 2.0, 3.0]) / 3.0
    points = {"a": [0.0, -1.0], "b": [1.0, -1.0], "c": [0.0, 1.0], "d": [1.0, 2.0]}
    through = [[float(x), float(1.0 + x**3)] for x in xs[1:3]]
    spline = {"spline": ["c", "d"], "through": through, "knots": xs[1:3].tolist(), "ends": ["smooth", "smooth"]}
    edges = {"low": {"line": ["a", "b"]}, "right": {"line": ["b", "d"]}, "top": spline, "left": {"line": ["c", "a"]}}
    spec = ShapeSpec.model_validate({"vertices": points, "edges": edges, "outline": ["low", "right", "top", "left"]})
    assert outline_from_spec(spec).area() == pytest.approx(2.25, rel=1e-13)


def test_the_command_says_what_it_cannot_do(tmp_path, capsys):
    edited(tmp_path)
    scene = str(tmp_path / "plate.toml")
    for words, why in [
        (["--as", "dxf", "--frame", "1"], "the script has one frame, 0"),
        (["--as", "dxf", "--out", str(tmp_path / "a.svg")], "ends in .dxf"),
        (["--as", "toml", "--out", scene], "the file that source"),
        (["--as", "toml", "--edits", "none.jsonl"], "no such edit script"),
    ]:
        assert main(["export", scene, *words]) == 2
        assert why in capsys.readouterr().err


def test_a_shape_that_has_grown_too_large_for_its_gaps_is_noted(tmp_path, capsys):
    block = HEAD + BLOCK.format(width=2, height=1) + HOLE + STEEL + CLAMPED + meshed(0.2)
    (tmp_path / "block.toml").write_text(block)
    down = [{"do": "press", "on": "window"}, {"do": "drag", "to": [0.5, 0.1508]}, {"do": "release"}]
    out = [{"do": "press", "on": "right"}, {"do": "drag", "to": [8, 0.5]}, {"do": "release"}]
    for events, noted in ((down, 0), (down + out, 1)):
        script = write_script(tmp_path, [{"t": 0.1 * k, **event} for k, event in enumerate(events)])
        saved = ["--as", "toml", "--out", str(tmp_path / f"grown-{noted}.toml")]
        assert main(["export", str(tmp_path / "block.toml"), str(script), *saved]) == 0
        assert capsys.readouterr().out.count("a scene of this shape is refused") == noted
        assert main(["check", saved[-1]]) == 2 * noted
        capsys.readouterr()


@pytest.mark.parametrize("what, noted", [("edge a would collapse: shorter than 1 m", True), ("hole h is odd", False)])
def test_a_refusal_is_put_down_to_the_size_where_it_is_one_of_distances(tmp_path, monkeypatch, what, noted):
    def refuse(scene):
        raise UserError(what, "shape", "mend it")

    monkeypatch.setattr(toml_scene, "outline_of", refuse)
    (note,) = write_toml(edited(tmp_path), tmp_path / "out.toml")
    why = f", for distances are measured by its size now: {what}" if noted else f": {what}; mend it"
    assert note == f"a scene of this shape is refused{why}"


def test_a_scene_of_a_mesh_file_gets_the_size_of_new_meshes(tmp_path):
    """About 2,000 triangles on its area; a size of its own stays."""
    shutil.copy(Path(__file__).parents[2] / "meshes" / "bracket.inp", tmp_path)
    for given in (None, 0.02):
        size = "" if given is None else f"size = {given}\n"
        scene = tmp_path / "part.toml"
        scene.write_text(f'{HEAD}[mesh]\nfile = "bracket.inp"\nunit = "mm"\n{size}{STEEL}', encoding="utf-8")
        read = load_scene(scene)
        write_toml(frame_of_script(read, Script.empty(read), 0), tmp_path / "out.toml")
        back = load_scene(tmp_path / "out.toml")
        area = outline_from_spec(back.shape).area()
        assert back.mesh.file is None
        assert back.mesh.size == given or area / (back.mesh.size**2 * 3**0.5 / 4) == pytest.approx(2000, rel=0.15)
