"""The command on small scenes: a row an effect, shares that sum to one, reasons, and messages for bad input."""

import json
from pathlib import Path

import pytest
from jobs_here import jobs_run_here
from restshape_studies.commands.explain import kernels
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.application import application
from restshape.cli.main import main

pytestmark = pytest.mark.usefixtures("jobs_here")
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
    with jobs_run_here():
        assert main([*words, "--json", str(folder / "found.json")]) == 0
    return json.loads((folder / "found.json").read_text())


@pytest.mark.slow
def test_every_effect_and_every_part_of_a_frame_has_a_row(found):
    app = application("plane")
    assert [row["effect"] for row in found] == [*app.effects, *app.derived, *PARTS]
    assert sum(row["share"] for row in found) == pytest.approx(1.0, abs=1e-9)
    assert {row["frames"] for row in found} == {4}
    on = {row["effect"]: row["kind"] for row in found if row["on"] and row["kind"] != "part"}
    assert on == {"solid": "named", "gravity": "named", "surface_loads": "follows", "stresses": "follows"}
    for row in found:
        if not row["on"]:
            assert row["share"] == row["unknowns"] == row["entries"] == row["calls"] == 0 and row["why"]


@pytest.mark.slow
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


MOVING = plate(0.25).replace('"plane"', '"moving"') + '[effects.dynamics]\ntime_step = "1 ms"\nsteps = 3\n'


def explained(folder, text):
    """The rows of a scene by effect, from a short drag of its hole."""
    script = write_script(folder, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.54, 0.5), 3)))
    words = ["explain", str(write_scene(folder, text)), "--edits", str(script), "--seconds", "0"]
    assert main([*words, "--json", str(folder / "found.json")]) == 0
    return {row["effect"]: row for row in json.loads((folder / "found.json").read_text())}


def pattern(core):
    """The entries of a matrix on the mesh of a plate with one hole: by Euler's formula it has n + t edges."""
    nodes = core["unknowns"] // 2
    return 4 * (nodes + 2 * (nodes + core["elements"]))


@pytest.mark.slow
def test_each_effect_has_its_kernels_elements_and_matrices(tmp_path):
    rows = explained(tmp_path, MOVING)
    core, motion = rows["solid"], rows["dynamics"]
    # The matrix of a step is the solid's, for its kernels fill it too; that of the mass alone is the motion's.
    # Right sides have one mass matrix, and accelerations have another.
    assert core["entries"] == pattern(core) and motion["entries"] == 2 * pattern(core)
    assert motion["elements"] == core["elements"] and set(motion["kernels"]) == {"mass_tri3"}
    assert "mass_tri3" not in core["kernels"] and motion["how"].startswith("its time is within that of solid")
    assert rows["stresses"]["elements"] == core["elements"] and rows["stresses"]["entries"] == 0


@pytest.mark.slow
def test_an_effect_that_swaps_a_kernel_for_another_has_the_elements_of_its_own(tmp_path):
    rows = explained(tmp_path, plate(0.25) + "[effects.large_deformation]\n")
    core, large = rows["solid"], rows["large_deformation"]
    assert large["elements"] == core["elements"] > 0 == large["entries"] and core["entries"] == pattern(core)
    # What is loaded are edges of the mesh on a side of 1 m.
    assert rows["surface_loads"]["elements"] == 4


@pytest.mark.slow
def test_of_cloth_on_a_ball_all_that_is_known_is_reported(tmp_path):
    scene = Path(__file__).parents[2] / "scenes" / "sphere.toml"
    words = ["explain", str(scene), "--set", "mesh.size=0.1", "--frames", "2", "--seconds", "0"]
    assert main([*words, "--json", str(tmp_path / "found.json")]) == 0
    rows = {row["effect"]: row for row in json.loads((tmp_path / "found.json").read_text())}
    app = application("cloth")
    assert list(rows) == [*app.effects, *app.derived, *PARTS]
    assert [name for name, row in rows.items() if row["on"]] == [*app.effects, "friction", "self_contact", *PARTS]
    assert sum(row["share"] for row in rows.values()) == pytest.approx(1.0, abs=1e-9)
    assert all(-row["spread"] <= row["share"] <= 1.0 + row["spread"] for row in rows.values())
    core = rows["cloth"]
    # Without contact nothing holds the cloth, and without its weight nothing moves it.
    assert "falls through bodies.ball" in rows["contact"]["how"]
    assert rows["gravity"]["how"].startswith("its time is within that of cloth")
    # Morley's triangles have nodes at corners and edges; of a disc edges are one less than corners and cells together.
    nodes, cells = core["unknowns"] // 3, core["elements"]
    edges = (nodes + cells - 1) // 2
    assert core["entries"] == 9 * (nodes + 2 * (3 * edges + 6 * cells))
    times, elements = core["kernels"]["morley_tri6"]["tangent"]
    assert elements == times * cells


def test_several_ranks_are_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "0")
    assert main(["explain", str(write_scene(tmp_path, plate(0.3)))]) == 2
    reported = capsys.readouterr().err
    assert "on one rank" in reported and "without mpiexec" in reported


@pytest.mark.slow
def test_a_scene_without_edits_is_priced_by_its_first_frame(tmp_path, capsys):
    scene = write_scene(tmp_path, plate(0.3))
    assert main(["explain", str(scene), "--seconds", "0"]) == 0
    reported = capsys.readouterr().out
    assert "the first frame, for there is no script" in reported and "nothing calls for it" in reported


@pytest.mark.slow
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
    reported = capsys.readouterr().err
    assert message in reported and "Traceback" not in reported


@pytest.mark.slow
def test_what_check_warns_of_in_a_scene_is_noted(tmp_path, capsys):
    scene = write_scene(tmp_path, plate(0.3).replace("[loads.", '[loads.x]\non = "left"\ntraction = [0, 0]\n[loads.'))
    assert main(["explain", str(scene), "--frames", "1", "--seconds", "0"]) == 0
    warned = capsys.readouterr().err
    assert main(["check", str(scene)]) == 0
    lines = [line.partition("warning")[2].strip() for line in capsys.readouterr().out.splitlines() if "warning" in line]
    assert lines and all(f"note: {line}" in warned for line in lines)


def test_kernels_that_an_effect_replaces_are_no_negative_calls():
    made = {"stvk_tri6": {"tangent": [8, 80]}, "linear_elastic_tri6": {"tangent": [-4, -40], "residual": [0, 0]}}
    row = {"effect": "large_deformation", "frames": 4, "kernels": made}
    words = "stvk_tri6 tangent 2 x 10; in place of linear_elastic_tri6 tangent 1 x 10"
    assert kernels([row]) == [("large_deformation", words)]
