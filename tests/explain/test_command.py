"""The command on small scenes: a row an effect, shares that sum to one, reasons, and messages for bad input."""

import json

import pytest
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.application import application
from restshape.cli.main import main

PARTS = ["edit", "mesh", "observation", "record"]


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The rows of a plate with gravity besides its load, and what is printed."""
    folder = tmp_path_factory.mktemp("explain")
    scene = write_scene(folder, plate(0.12))
    script = write_script(folder, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.6, 0.5), 8)))
    words = [
        "explain",
        str(scene),
        "--edits",
        str(script),
        "--frames",
        "4",
        "--seconds",
        "0",
        "--set",
        "effects.gravity={}",
    ]
    assert main([*words, "--json", str(folder / "found.json")]) == 0
    return json.loads((folder / "found.json").read_text())


def test_every_effect_and_every_part_of_a_frame_has_a_row(found):
    app = application("solid")
    assert [row["effect"] for row in found] == [*app.effects, *app.implied, *PARTS]
    assert sum(row["share"] for row in found) == pytest.approx(1.0, abs=1e-9)
    assert {row["frames"] for row in found} == {4}
    on = {row["effect"]: row["kind"] for row in found if row["on"] and row["kind"] != "part"}
    assert on == {"solid": "named", "gravity": "named", "surface_loads": "follows", "stresses": "follows"}
    for row in found:
        if not row["on"]:
            assert row["share"] == row["unknowns"] == row["entries"] == row["calls"] == 0 and row["why"]


def test_counts_are_those_of_the_mesh(found):
    rows = {row["effect"]: row for row in found}
    core, stresses = rows["solid"], rows["stresses"]
    # The number of unknowns is twice that of nodes, which Euler's formula ties to the triangles of a plate with a hole.
    assert core["unknowns"] % 2 == 0 and core["unknowns"] / 2 < core["elements"] < core["unknowns"]
    assert core["entries"] > 10 * core["unknowns"]
    assert stresses["kernels"]["recover"]["field"] == [4, 4 * core["elements"]]
    assert rows["surface_loads"]["kernels"].keys() == {"traction_edge2"}
    assert core["kernels"]["linear_elastic_tri3"]["tangent"] == [4, 4 * core["elements"]]
    assert core["solver"]["systems"][0] | {"why": ""} == {
        "of": "displacement",
        "matrix": "symmetric positive definite",
        "krylov": "cg",
        "factor": "cholesky",
        "why": "",
    }
    assert core["solver"]["elements"] == ["linear_elastic_tri3"]


def test_a_scene_without_edits_is_priced_by_its_first_frame(tmp_path, capsys):
    scene = write_scene(tmp_path, plate(0.3))
    assert main(["explain", str(scene), "--seconds", "0"]) == 0
    told = capsys.readouterr().out
    assert "the first frame, for there is no script" in told and "nothing calls for it" in told


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--frames", "-1"], "-1 frames measure nothing"),
        (["--set", "effects.heat={}"], "no effect 'heat'"),
        (["--edits", "none.jsonl"], "no such edit script"),
        (["--set", "supports.wall.fix=['x']"], "free to"),
    ],
)
def test_bad_input_is_refused(tmp_path, capsys, words, message):
    scene = write_scene(tmp_path, plate(0.3))
    assert main(["explain", str(scene), *words]) == 2
    told = capsys.readouterr().err
    assert message in told and "Traceback" not in told
