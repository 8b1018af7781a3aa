"""Mistakes of people at the command line: each is reported in words, and what they asked for is not lost."""

import json
from argparse import Namespace
from pathlib import Path

import pytest
from forked import run_forked

from restshape.cli.main import main
from restshape.cli.options import refuse_overwriting
from restshape.errors import UserError
from restshape.outputs.kinds import CsvFile
from restshape.replay.petsc_options import without_effect
from restshape.replay.recording.recording import Recording

DATA = Path(__file__).parents[1] / "data"


@pytest.fixture
def folder(tmp_path):
    for name in ("plate.toml", "plate.jsonl"):
        (tmp_path / name).write_text((DATA / name).read_text())
    return tmp_path


@pytest.fixture
def replay(restshape):
    """Replays plate.toml in a process of its own, for PETSc takes its options once: code, output, messages."""

    def run(*words):
        done = restshape("replay", "plate.toml", *words)
        return done.returncode, done.stdout, done.stderr

    return run


def change(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("-solid_ksp_type", "nonsense"), "-solid_ksp_type nonsense"),
        (("-solid_ksp_type",), "-solid_ksp_type"),
        (("-solid_ksp_rtol", "abc"), "-solid_ksp_rtol abc"),
        (("-solid_pc_type", "cholesky", "-solid_ksp_type", "preonly"), "-solid_ksp_type preonly"),
    ],
)
def test_what_petsc_refuses_is_reported_with_its_option(folder, replay, words, named):
    code, _, shown_text = replay("--", *words)
    assert code == 2
    assert f"-- {named}: PETSc refuses it" in shown_text
    lines = [line for line in shown_text.splitlines() if not line.startswith("note:")]
    assert "Traceback" not in shown_text and "MPI_ABORT" not in shown_text and len(lines) <= 3


@pytest.mark.slow
def test_words_that_keep_a_solve_from_converging_are_named(folder, replay):
    """GMRES without a preconditioner, restarted after each iteration, does not converge: the scene is not to blame."""
    words = ("-solid_ksp_type", "gmres", "-solid_ksp_gmres_restart", "1", "-solid_pc_type", "none")
    code, _, shown_text = replay("--", *words, "-solid_ksp_converged_reason", "-options_left", "no")
    assert code == 2
    assert f"-- {' '.join(words)}: the linear solve did not converge" in shown_text
    assert "try: leave these words out" in shown_text


@pytest.mark.slow
def test_words_that_petsc_never_used_are_named(folder, replay):
    code, _, shown_text = replay(
        "--", "-solid_ksp_tpye", "cg", "-foo", "3", "nonsense", "-solid_ksp_type", "cg", "-log_viewx"
    )
    assert code == 0
    assert "no use of these words after --: -solid_ksp_tpye -foo -log_viewx nonsense\n" in shown_text


@pytest.mark.slow
def test_a_sweep_names_the_words_that_petsc_never_used_and_those_without_effect(folder, restshape):
    words = ("sweep", "plate.toml", "--set", "material.steel.nu=0.2,0.3", "--")
    done = restshape(*words, "-foo", "3", "-solid_ksp_rtol", "1e-2")
    assert done.returncode == 0
    assert "no use of these words after --: -foo\n" in done.stderr and "no effect here: -solid_ksp_rtol" in done.stderr
    done = restshape(*words, "-solid_ksp_type", "gmres", "-solid_ksp_gmres_restart", "1", "-solid_pc_type", "none")
    assert done.returncode == 2 and "try: leave these words out" in done.stderr


def test_options_that_change_nothing_are_named():
    found = without_effect(["-solid_ksp_max_it", "3", "-solid_ksp_view", "-solid_ksp_monitor"])
    assert [one.split(" ")[0] for one in found] == ["-solid_ksp_max_it", "-solid_ksp_view"]
    assert (
        "-solid_ksp_monitor shows" in found[1] and "(" in found[0] and without_effect(["-solid_ksp_type", "cg"]) == []
    )
    # The scene's tolerance goes over both.
    found = without_effect(["-solid_ksp_rtol", "1e-3", "-solid_ksp_atol", "1e3"])
    assert len(found) == 2 and all("solve.tolerance" in one for one in found)
    assert without_effect(["-drape_step_ksp_rtol", "1e-3"]) == []
    ordering = ["-solid_pc_factor_mat_ordering_type", "natural"]
    assert len(without_effect(ordering)) == 1
    assert without_effect([*ordering, "-solid_pc_factor_mat_solver_type", "petsc"]) == []


@pytest.mark.slow
def test_the_tolerances_of_a_solve_are_those_of_the_scene(folder, replay):
    def iterations(*words):
        code, _, shown_text = replay(
            "--json", "out.json", "--", "-solid_ksp_type", "cg", "-solid_pc_type", "jacobi", *words
        )
        assert code == 0
        return json.loads((folder / "out.json").read_text())["iterations"], shown_text

    usual, _ = iterations()
    other, said = iterations("-solid_ksp_rtol", "0.5", "-solid_ksp_atol", "1e9")
    assert usual == other > 10 and "-solid_ksp_rtol (solve.tolerance" in said


@pytest.mark.slow
def test_words_that_petsc_used_leave_no_note(folder, replay):
    assert "no use of" not in replay("--", "-solid_ksp_type", "cg", "-options_left", "no")[2]


def test_a_table_that_cannot_be_written(folder, command):
    done = command("replay", "plate.toml", "--csv", "/dev/full")
    shown_text = done.stderr
    assert done.returncode == 2 and "/dev/full: cannot write" in shown_text and "Traceback" not in shown_text


def test_a_recording_is_named_for_what_it_is(folder, capsys):
    assert main(["replay", str(folder / "plate.toml"), "--out", str(folder / "x.vtk")]) == 2
    assert "x.vtkhdf" in capsys.readouterr().err


@pytest.mark.cli
@pytest.mark.parametrize("rank", ["0", "1"])
def test_one_rank_speaks_for_all(folder, outside, rank):
    done = run_forked(["check", "nowhere.toml"], folder, {**outside, "OMPI_COMM_WORLD_RANK": rank}, 60.0)
    assert done.returncode == 2
    assert ("no such scene" in done.stderr) == (rank == "0")


def test_an_output_is_probed_by_one_rank(tmp_path, monkeypatch):
    files = Namespace(csv=CsvFile(tmp_path / "none" / "a.csv"))
    with pytest.raises(UserError):
        refuse_overwriting(files)
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "1")
    refuse_overwriting(files)


@pytest.mark.parametrize("support", ["", '[supports.wall]\non = "left"\nfix = ["y"]\n'])
def test_a_body_that_nothing_holds(folder, capsys, support):
    change(folder / "plate.toml", '[supports.wall]\non = "left"\nfix = ["x", "y"]\n', support)
    assert main(["check", str(folder / "plate.toml")]) == 2
    assert "free to move as a rigid body" in capsys.readouterr().err


def test_two_points_hold_a_body(folder):
    change(
        folder / "plate.toml",
        '[supports.wall]\non = "left"\nfix = ["x", "y"]\n',
        '[supports]\npin = { on = "a", fix = ["x", "y"] }\nroller = { on = "b", fix = ["y"] }\n',
    )
    assert main(["check", str(folder / "plate.toml")]) == 0


def test_check_shows_values_of_supports_and_loads(folder, capsys):
    change(folder / "plate.toml", 'fix = ["x", "y"]', 'fix = { x = 0, y = "0.02 mm" }')
    change(folder / "plate.toml", 'traction = ["P*(1 + y)", 0]', 'force = [0, "-2 kN"]')
    assert main(["check", str(folder / "plate.toml")]) == 0
    printed = capsys.readouterr().out
    assert "y = 20 µm" in printed and "force (0, -2) kN" in printed


@pytest.mark.parametrize(("key", "size"), [("mesh.size", "10 um"), ("mesh.near.window", "1 nm")])
@pytest.mark.parametrize("command", ["check", "replay"])
def test_a_mesh_without_end_is_not_begun(folder, capsys, command, key, size):
    assert main([command, str(folder / "plate.toml"), "--set", f"{key}={size}"]) == 2
    shown_text = capsys.readouterr().err
    assert f"plate.toml: {key}" in shown_text and "triangles" in shown_text and "a larger size" in shown_text


@pytest.mark.slow
def test_a_hole_goes_with_its_mesh_size_and_comes_back_with_it(folder, command):
    lines = [{"do": "delete", "on": "window"}, {"do": "undo"}]
    header = (folder / "plate.jsonl").read_text().splitlines()[0]
    events = [json.dumps({"t": t, **line}) for t, line in enumerate(lines)]
    (folder / "cut.jsonl").write_text("\n".join([header, *events]) + "\n")
    done = command("replay", "plate.toml", "--edits", "cut.jsonl", "--out", "cut.vtkhdf")
    assert done.returncode == 0, done.stderr
    with Recording(folder / "cut.vtkhdf") as recording:
        first, without, again = recording.table["elements"].tolist()
        assert list(recording.table["refused"]) == ["", "", ""]
    assert without < first == again


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("hole window by 0.01 0 in 0 frames", "one frame at least"),
        ("hole window by 0.01 0 in 2 frames, hand-like, pause 50", "50 frames does not fit into 2"),
        ("insert n on top at 2", "it must be less than 1"),
    ],
)
def test_lines_of_a_script_that_cannot_be(folder, capsys, line, says):
    assert main(["script", str(folder / "plate.toml"), line]) == 2
    assert says in capsys.readouterr().err


def test_a_unit_in_wrong_case(folder, capsys):
    change(folder / "plate.toml", "210 GPa", "210 GPA")
    assert main(["check", str(folder / "plate.toml")]) == 2
    assert "did you mean 'GPa'?" in capsys.readouterr().err


SQUARE = """*NODE
1, 0, 0
2, 1, 0
3, 2, 0
4, 0, 1
5, 1, 1
6, 2, 1
*ELEMENT, TYPE=CPS3, ELSET=LEFT
1, 1, 2, 5
2, 1, 5, 4
*ELEMENT, TYPE=CPS3, ELSET=RIGHT
3, 2, 3, 6
4, 2, 6, 5
*NSET, NSET=WALL
1, 4
"""
PARTS = """format = "restshape-scene"
version = 1
app = "plane"
[material]
soft = { E = "1 GPa", nu = 0.3, region = ["LEFT"] }
hard = { E = "2 GPa", nu = 0.3, region = ["RIGHT"] }
[effects]
solid = { model = "plane_stress" }
[supports]
wall = { on = "WALL", fix = ["x", "y"] }
[mesh]
file = "parts.inp"
size = 1
"""


def test_a_mesh_whose_parts_all_have_materials(tmp_path, command):
    (tmp_path / "parts.inp").write_text(SQUARE)
    (tmp_path / "plate.toml").write_text(PARTS)
    done = command("replay", "plate.toml")
    assert done.returncode == 0, done.stderr
    assert "4 elements" in done.stdout


def test_a_part_without_a_material(tmp_path, command):
    (tmp_path / "parts.inp").write_text(SQUARE)
    (tmp_path / "plate.toml").write_text(PARTS.replace('hard = { E = "2 GPa", nu = 0.3, region = ["RIGHT"] }\n', ""))
    done = command("replay", "plate.toml")
    assert done.returncode == 2 and "2 triangles lie outside of the regions" in done.stderr


@pytest.mark.parametrize(("across", "code"), [(0.0, 2), (1.0, 0)])
def test_a_column_that_buckles_at_once_goes_to_the_side_of_a_small_load(folder, capsys, across, code):
    """Its critical load is 514 N; what the message says to add leads past it."""
    column = ["shape.vertices.b.0=20", "shape.vertices.c.0=20", "effects.large_deformation={}", "mesh.size=1"]
    pushed = [f"loads.pull={{on='right',force=['-750 N','{across} * 0.75 N']}}", "material.steel.E='0.1 GPa'"]
    words = [part for one in (*column, *pushed) for part in ("--set", one)]
    assert main(["replay", str(folder / "plate.toml"), *words]) == code
    said = capsys.readouterr()
    if code:
        assert "such an equilibrium is unstable" in said.err and "a thousandth as large" in said.err


def test_a_column_that_an_edit_makes_buckle_is_said_what_to_do_about(folder, capsys):
    column = ["shape.vertices.b.0=20", "shape.vertices.c.0=20", "effects.large_deformation={}", "mesh.size=1"]
    pushed = ["loads.pull={on='right',force=['-400 N',0]}", "material.steel.E='0.1 GPa'"]
    header = {"format": "restshape-edits", "version": 1, "scene": "plate.toml"}
    event = {"t": 0, "do": "set", "key": "loads.pull.force.0", "value": "-750 N"}
    (folder / "push.jsonl").write_text("\n".join(map(json.dumps, (header, event))) + "\n")
    words = [part for one in (*column, *pushed) for part in ("--set", one)]
    assert main(["replay", str(folder / "plate.toml"), str(folder / "push.jsonl"), *words]) == 0
    said = capsys.readouterr().out
    assert "such an equilibrium is unstable (lower the loads, or add one across them" in said
