"""`restshape sweep`: values in closed form, reuse from run to run, runs without a result, interruption."""

import csv
import json
import math
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from cloths import BALL, CONTACT, write_cloth
from small_scenes import CLAMPED, HEAD, PULLED, QUANTITIES, STEEL, block, drag, meshed, plate, write_scene, write_script

from restshape import bounds
from restshape.analysis.modal.modal import ModalAnalysis
from restshape.calibration import Calibration
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.scene.load import load_scene
from restshape.variation.runs import Sweep
from restshape.variation.sweep_notes import sweep_notes
from restshape.variation.sweep_picture import key_unit
from restshape.variation.sweep_request import SweepRequest
from restshape.variation.swept_key import combinations, swept_keys
from restshape.variation.swept_run import SweptRun

PULL, LENGTH = 100e6, 2.0
BAR = HEAD + block(LENGTH, 0.5) + STEEL.replace("nu = 0.3", "nu = 0.0") + CLAMPED + PULLED + meshed(0.25) + QUANTITIES
"""A bar without lateral contraction: it stretches by the traction times its length over Young's modulus."""
BELLS = Path(__file__).parents[1] / "scenes" / "bar_100.toml"
LARGE = BAR + "[effects.large_deformation]\n"


def runs_of(command, folder, *words):
    """The runs of a sweep that ends with 0, as --json has them."""
    done = command("sweep", *words, "--json", folder / "sweep.json")
    assert done.returncode == 0, done.stderr
    return json.loads((folder / "sweep.json").read_text())["runs"]


def values_of(runs, name, key="last"):
    return [one["quantities"][name][key] for one in runs]


def test_displacements_go_with_the_inverse_of_the_modulus(command, tmp_path):
    scene = write_scene(tmp_path, BAR)
    runs = runs_of(command, tmp_path, scene, "--set", "material.steel.E=100GPa:200GPa:25GPa")
    moduli = [100e9, 125e9, 150e9, 175e9, 200e9]
    assert values_of(runs, "stretch") == pytest.approx([PULL * LENGTH / E for E in moduli], rel=1e-7)
    assert values_of(runs, "wall") == pytest.approx([-PULL * 0.5 * 0.01] * 5, rel=1e-6)
    assert [one["values"]["material.steel.E"] for one in runs] == [100, 125, 150, 175, 200]
    assert [one["analysis"] for one in runs] == ["new"] + 4 * ["reused"]
    assert [one["level"] for one in runs] == [3, 0, 0, 0, 0]


def test_values_of_one_column_have_one_prefix(command, tmp_path):
    """0.1 MPa and 10 MPa on a bar of 2 m: 0.952 and 95.2 um."""
    words = ("--set", "loads.pull.traction=['100 kPa', 0],['10 MPa', 0]")
    ended = command("sweep", write_scene(tmp_path, BAR), *words)
    assert ended.returncode == 0, ended.stderr
    lines = [line for line in ended.stdout.splitlines() if "kPa" in line or "MPa" in line]
    assert len(lines) == 2
    first, second = ([word for word in line.split() if word.endswith("m") and len(word) <= 2] for line in lines)
    assert first == second and first


@pytest.mark.parametrize(
    ("key", "value", "unit"),
    [
        ("material.steel.E", "2e11,2.1e11", "Pa"),
        ("material.steel.E", "200GPa,210GPa", "GPa"),
        ("material.steel.nu", "0.2,0.3", ""),
        ("shape.vertices.b.0", "2,2.1", "m"),
        ("loads.pull.traction.0", "1e6,2e6", "Pa"),
        ("supports.wall.fix.x", "0,0.1", "m"),
        ("effects.gravity.g.1", "-9,-8", "m/s²"),
        ("parameters.nothing", "1,2", ""),
    ],
)
def test_plain_numbers_along_the_axis_have_their_si_unit(tmp_path, key, value, unit):
    scene = load_scene(write_scene(tmp_path, BAR + "[effects.gravity]\ng = [0, -9.81]\n"))
    assert key_unit(scene, swept_keys([f"{key}={value}"])[1][0]) == unit


def test_nodes_move_where_the_shape_changes(command, tmp_path):
    """The traction on the end of the bar, which gets aslant and so longer, is what the wall holds."""
    runs = runs_of(command, tmp_path, write_scene(tmp_path, BAR), "--set", "shape.vertices.b.0=2:2.3:0.1")
    sides = [math.hypot(0.5, dx) for dx in (0.0, 0.1, 0.2, 0.3)]
    assert values_of(runs, "wall") == pytest.approx([-PULL * 0.01 * side for side in sides], rel=1e-6)
    assert [one["level"] for one in runs] == [3, 1, 1, 1]
    assert {one["analysis"] for one in runs[1:]} == {"reused"}


def test_moved_meshes_are_noted_and_from_rest_each_run_has_its_own(command, tmp_path):
    """Values of moved meshes are others than those of own ones, which are the same up and down."""
    scene = write_scene(tmp_path, plate(size=0.25))

    def swept(values, *words):
        ended = command("sweep", scene, "--set", f"shape.vertices.c.1={values}", *words, "--json", "a.json")
        assert ended.returncode == 0, ended.stderr
        return json.loads((tmp_path / "a.json").read_text()), ended.stdout

    up, said = swept("0.5,0.6,0.7")
    assert [one["level"] for one in up["runs"]][1:] != [3, 3]
    assert up["notes"] and up["notes"][0] in said and "--from-rest" in up["notes"][0]
    assert "level" in said and "3 reconstruction" in said
    own, said = swept("0.5,0.6,0.7", "--from-rest")
    down, _ = swept("0.7,0.6,0.5", "--from-rest")
    assert own["notes"] == [] and "level" not in said
    assert [one["level"] for one in own["runs"]] == [3, 3, 3]
    assert values_of(own["runs"], "peak") == pytest.approx(values_of(down["runs"], "peak")[::-1], rel=1e-9)
    assert values_of(up["runs"], "peak")[1:] != pytest.approx(values_of(own["runs"], "peak")[1:], rel=1e-9)


def test_keys_give_their_product_and_settings_of_the_mesh_a_new_mesh(command, tmp_path):
    words = ("--set", "mesh.size=0.25,0.125", "--set", "loads.pull.traction=['100 MPa', 0], ['50 MPa', 0]")
    runs = runs_of(command, tmp_path, write_scene(tmp_path, BAR), *words)
    assert values_of(runs, "stretch") == pytest.approx([1e-3, 0.5e-3] * 2, rel=1e-7)
    assert [one["level"] for one in runs] == [3, 0, 3, 0]


@pytest.mark.slow
def test_a_sweep_of_an_edit_gives_what_replays_give(command, tmp_path):
    """Also after an edit that moves the shape: each run begins on the mesh of a replay of its own."""
    scene = write_scene(tmp_path, plate(size=0.25))
    script = write_script(tmp_path, drag("window", (0.5, 0.5), [(0.5 + 0.05 * k, 0.5) for k in range(1, 5)]))
    words = (scene, "--edits", script, "--set", "material.steel.nu=0.2,0.3,0.4", "--csv", "sweep.csv")
    runs = runs_of(command, tmp_path, *words)
    assert [one["analysis"] for one in runs] == ["new", "reused", "reused"]
    assert [one["level"] for one in runs] == [3, 3, 3]
    for one, nu in zip(runs, ("0.2", "0.3", "0.4")):
        own = command("replay", scene, "--edits", script, "--set", f"material.steel.nu={nu}", "--json", "own.json")
        assert own.returncode == 0
        known = json.loads((tmp_path / "own.json").read_text())
        assert one["frames"] == known["frames"] > 5
        for name, values in known["quantities"].items():
            found = one["quantities"][name]
            wanted = [values[-1], min(values), max(values)]
            assert [found["last"], found["min"], found["max"]] == pytest.approx(wanted, rel=1e-6)
    with (tmp_path / "sweep.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["material.steel.nu"] for row in rows] == ["0.2", "0.3", "0.4"]
    assert [float(row["q_peak_max"]) for row in rows] == values_of(runs, "peak", "max")


def test_twenty_values_cost_one_mesh_and_one_pattern(command, tmp_path):
    """Counts of what a first frame costs; times are in docs/commands.md."""
    from petsc4py import PETSc

    from restshape.replay.event_counts import EventCounts

    scene = write_scene(tmp_path, BAR)
    PETSc.Log.begin()
    counts = EventCounts(("RestshapePattern", "MatCholFctrSym", "MatCholFctrNum", "RestshapeValues"))
    counts.since_last()
    runs_of(command, tmp_path, scene, "--set", "material.steel.E=100GPa,200GPa")
    two = counts.since_last()
    runs = runs_of(command, tmp_path, scene, "--set", "material.steel.E=100GPa:195GPa:5GPa")
    twenty = counts.since_last()
    assert len(runs) == 20
    assert twenty["RestshapePattern"] == two["RestshapePattern"] > 0
    assert twenty["MatCholFctrSym"] == two["MatCholFctrSym"]
    assert sum(one["level"] == 3 for one in runs) == 1


def test_modes_of_another_thickness_cost_one_factor_on_the_pattern_there_is(monkeypatch):
    """Each run is counted by the factor that it is solved with, and begins with the modes of the runs before."""
    from petsc4py import PETSc

    from restshape.replay.event_counts import EventCounts

    PETSc.Log.begin()
    counts = EventCounts(("MatCholFctrSym", "MatCholFctrNum", "RestshapePattern"))
    monkeypatch.setattr(ModalAnalysis, "residual_norm", lambda self: pytest.fail("no run shows a residual"))
    monkeypatch.setattr(ModalAnalysis, "errors", lambda self: pytest.fail("no run shows an error"))
    fixed = ["mesh.size=0.015", "mesh.order=2", "mesh.layers=1", "effects.modal.modes=3"]
    _, swept = swept_keys(["material.aluminium.thickness=4mm:4.9mm:0.1mm"])
    found, costs, iterations = [], [], []
    sweep = Sweep(SweepRequest(BELLS, fixed, swept, None, None, None, Calibration.load()))
    counts.since_last()
    for one in sweep.runs():
        costs.append(counts.since_last())
        found.append(one.quantities["q_pitch"].last)
        assert sweep._last.replay.analysis.state.report.inertia_checked
        iterations.append(sweep._last.replay.analysis.state.report.iterations)
    assert [cost["MatCholFctrNum"] for cost in costs[1:]] == 9 * [1]
    assert all(cost["MatCholFctrSym"] == 0 for cost in costs[1:])
    # Modes of the thickness before, or of several, leave a correction or two of each mode.
    assert max(iterations[1:]) <= 5
    monkeypatch.undo()
    # A thin plate's frequency goes with its thickness.
    assert found[-1] / found[0] == pytest.approx(4.9 / 4.0, rel=0.02)
    own = first_frame(BELLS, [*fixed, "material.aluminium.thickness=4.9mm"]).row
    assert found[-1] == pytest.approx(own["q_pitch"], rel=1e-6)


def test_limits_of_a_sweep_are_compared_with_errors(command, tmp_path):
    """Errors are not shown, but make a status uncertain where a limit is nearer than the value is known."""
    scene = write_scene(tmp_path, plate(size=0.25))
    words = ("--set", "loads.pull.traction=['100 MPa', 0],['5 MPa', 0]", "--set", 'quantities.peak.at="window"')
    peak = values_of(runs_of(command, tmp_path, scene, *words), "peak")[0]
    limited = (*words, "--set", f"quantities.peak.max={1.01 * peak}")
    assert [one["constraint_status"] for one in runs_of(command, tmp_path, scene, *limited)] == ["uncertain", "holds"]


@pytest.mark.slow
def test_twenty_values_cost_at_most_eight_first_frames(command, tmp_path):
    """Processor time in one process, in which all that is imported has been; of three each the least."""
    scene = write_scene(tmp_path, plate(size=0.06))

    def seconds(*words):
        found = []
        for _ in range(4):
            start = time.process_time()
            assert command(*words).returncode == 0
            found.append(time.process_time() - start)
        return min(found[1:])

    one = seconds("replay", scene)
    assert seconds("sweep", scene, "--set", "material.steel.E=100GPa:195GPa:5GPa") < 8.0 * one


def test_settings_of_a_mesh_give_the_mesh_of_a_replay_of_its_own(command, tmp_path):
    scene = write_scene(tmp_path, plate(size=0.25))
    runs = runs_of(command, tmp_path, scene, "--set", "mesh.size=0.3,0.2")
    assert runs[1]["analysis"] == "reused" and runs[1]["level"] == 3
    assert command("replay", scene, "--set", "mesh.size=0.2", "--json", "own.json").returncode == 0
    own = json.loads((tmp_path / "own.json").read_text())["quantities"]
    assert values_of(runs, "peak")[1] == pytest.approx(own["peak"][0], rel=1e-9)


def test_a_mesh_file_is_read_again_where_settings_of_the_mesh_change(command, tmp_path):
    """An edit of the size would give a new mesh of the outline; the first shape is the file's mesh at any size."""
    corners = "1, 0, 0\n2, 1, 0\n3, 2, 0\n4, 0, 0.5\n5, 1, 0.5\n6, 2, 0.5\n"
    cells = "1, 1, 2, 5\n2, 1, 5, 4\n3, 2, 3, 6\n4, 2, 6, 5\n"
    sets = "*NSET, NSET=left\n1, 4\n*NSET, NSET=right\n3, 6\n"
    (tmp_path / "bar.inp").write_text(f"*NODE\n{corners}*ELEMENT, TYPE=CPS3\n{cells}{sets}")
    text = HEAD + STEEL.replace("nu = 0.3", "nu = 0.0") + CLAMPED + PULLED + QUANTITIES
    scene = write_scene(tmp_path, text + '[mesh]\nfile = "bar.inp"\nunit = "m"\nsize = 0.25\norder = 1\n')
    ended = command("sweep", scene, "--set", "mesh.size=0.25,0.1", "--json", "a.json")
    assert ended.returncode == 0, ended.stderr
    runs = json.loads((tmp_path / "a.json").read_text())["runs"]
    assert [one["analysis"] for one in runs] == ["new", "new"] and runs[0]["quantities"] == runs[1]["quantities"]
    runs = runs_of(command, tmp_path, scene, "--set", "material.steel.E=200e9,100e9")
    assert [one["analysis"] for one in runs] == ["new", "reused"]
    assert values_of(runs, "stretch") == pytest.approx([1e-3, 2e-3], rel=1e-7)


def test_nonlinear_runs_continue_unless_they_shall_start_from_rest(command, tmp_path):
    words = (write_scene(tmp_path, LARGE), "--set", "loads.pull.traction.0=1GPa,5GPa,1GPa")
    from_rest = runs_of(command, tmp_path, *words, "--from-rest")
    assert [one["analysis"] for one in from_rest] == 3 * ["new"]
    assert values_of(from_rest, "stretch")[0] == values_of(from_rest, "stretch")[2]
    on = runs_of(command, tmp_path, *words)
    assert [one["analysis"] for one in on] == ["new", "reused", "reused"]
    # The solution is unique here.
    assert values_of(on, "stretch") == pytest.approx(values_of(from_rest, "stretch"), rel=1e-5)


@pytest.mark.parametrize(
    ("frictions", "begins", "ends"),
    [
        ((0.2, 0.4), "each run starts from rest: ", "(friction)"),
        ((0.0, 0.4), "1 run of 2 starts from rest: ", "(friction)"),
        ((0.4, 0.0), "1 run of 2 starts from rest: ", "; so does 1 run right after one of them"),
        ((0.4, 0.0, 0.2, 0.0), "2 runs of 4 start from rest: ", "; so do 2 runs right after one of them"),
        ((0.4, None), "each run starts from rest: ", "(friction)"),
    ],
)
def test_runs_that_start_from_rest_are_counted(frictions, begins, ends):
    """Of the runs that have a result; None has none."""
    runs = [
        SweptRun(k, {}, {}, frames=int(one is not None), remembered=["friction"] if one else [])
        for k, one in enumerate(frictions)
    ]
    (note,) = sweep_notes(runs)
    assert note.startswith(begins) and note.endswith(ends)


@pytest.mark.slow
def test_runs_start_from_rest_where_friction_remembers_the_path(command, tmp_path):
    """Each value is that of a replay of its own, to the bit; cloth on smooth bodies goes on."""
    scene = write_cloth(tmp_path, BALL, CONTACT, "[quantities]\nlow = { position = 'z', reduce = 'min' }\n")
    words = ("--set", "mesh.size=0.5", "--set", "effects.drape.tolerance=1e-2")
    ended = command("sweep", scene, *words, "--set", "bodies.ball.friction=0.0,0.8,0.2", "--json", "a.json")
    assert ended.returncode == 0, ended.stderr
    found = json.loads((tmp_path / "a.json").read_text())
    assert [one["analysis"] for one in found["runs"]] == 3 * ["new"]
    (note,) = found["notes"]
    assert "2 runs of 3 start from rest: " in note and "friction" in note and note in ended.stdout
    assert command("replay", scene, *words, "--set", "bodies.ball.friction=0.2", "--json", "b.json").returncode == 0
    own = json.loads((tmp_path / "b.json").read_text())["quantities"]["low"][0]
    assert values_of(found["runs"], "low")[2] == own
    smooth = ("--set", "bodies.ball.friction=0", "--set", "supports.pin={on='a',fix=['x','y','z']}")
    runs = runs_of(command, tmp_path, scene, *words, *smooth, "--set", "material.cotton.E=2e6,3e6")
    assert [one["analysis"] for one in runs] == ["new", "reused"]


@pytest.mark.slow
def test_a_value_without_a_result_leaves_the_others(command, tmp_path):
    scene = write_scene(tmp_path, BAR)
    ended = command("sweep", scene, "--set", "material.steel.E=200e9,-1,oops,100e9", "--csv", "a.csv", "--out", "a.png")
    assert ended.returncode == 0
    assert "too small" in ended.stderr and "oops" in ended.stderr
    with (tmp_path / "a.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == ["done", "invalid", "invalid", "done"]
    assert [row["q_stretch"] for row in rows][1:3] == ["", ""]
    assert float(rows[3]["q_stretch"]) == pytest.approx(2 * float(rows[0]["q_stretch"]), rel=1e-7)
    assert "material.steel.E" in rows[1]["why"]
    assert (tmp_path / "a.png").stat().st_size > 10_000
    assert command("sweep", scene, "--set", "material.steel.E=1e9,2e9", "--csv", "a.csv").returncode == 0
    (tmp_path / "mine.csv").write_text("run,mine\n")
    assert command("sweep", scene, "--set", "material.steel.E=1e9,2e9", "--csv", "mine.csv").returncode == 2


def test_errors_of_one_run_are_apart_and_say_once_what_to_do(command, tmp_path):
    """One parameter is a mass where two places want a length."""
    text = BAR.replace("c = [2.0, 0.5]", 'c = [2.0, "h"]').replace("d = [0, 0.5]", 'd = [0, "h"]')
    scene = write_scene(tmp_path, text + '[parameters]\nh = "0.5 m"\n')
    ended = command("sweep", scene, "--set", "parameters.h=0.5m,2kg")
    (line,) = [line for line in ended.stderr.splitlines() if ", invalid: " in line]
    assert "but a length is wanted; also scene.toml: " in line and line.count("another unit") == 1
    assert line.endswith('; try: give the parameter another unit, as in "12 mm"')


def test_a_first_shape_without_a_solution_is_one_run_without_a_result(command, tmp_path):
    """Without the support in x the bar slides: the scene is valid, and has no solution."""
    scene = write_scene(tmp_path, BAR)
    runs = runs_of(command, tmp_path, scene, "--set", "supports.wall.fix=['x', 'y'], ['y'], ['x', 'y']")
    assert [bool(one["frames"]) for one in runs] == [True, False, True]
    assert runs[1]["status"] in ("invalid", "unsolved") and runs[1]["why"]
    assert runs[2]["quantities"] == runs[0]["quantities"]


@pytest.mark.slow
def test_limits_are_held_against_each_run(command, tmp_path):
    scene = write_scene(tmp_path, BAR.replace('at = "right", reduce = "mean" }', 'at = "right", max = "1.5 mm" }'))
    runs = runs_of(command, tmp_path, scene, "--set", "material.steel.E=200e9,100e9", "--out", "limits.svg")
    assert [one["constraint_status"] for one in runs] == ["holds", "fails"]
    assert "</svg>" in (tmp_path / "limits.svg").read_text()


def test_where_no_run_has_a_result_the_message_says_why(command, tmp_path):
    scene = write_scene(tmp_path, BAR)
    ended = command("sweep", scene, "--set", "material.steel.Q=1,2")
    assert ended.returncode == 2 and "there is no key 'Q'" in ended.stderr
    ended = command("sweep", scene, "--set", "material.steel.E=1e9")
    assert ended.returncode == 2 and "no key takes several values" in ended.stderr


def test_an_interrupted_sweep_keeps_its_runs(command, tmp_path, monkeypatch):
    @contextmanager
    def stopping(quiet, total, what):
        frames = iter(range(2))

        def count(steps):
            # A run counts when it is done, its frames only show that there is life.
            if steps and next(frames, None) is None:
                raise KeyboardInterrupt

        yield count

    monkeypatch.setattr("restshape.cli.progress.progress", stopping)
    words = ("--set", "material.steel.E=100e9:200e9:10e9", "--json", "a.json", "--csv", "a.csv")
    ended = command("sweep", write_scene(tmp_path, BAR), *words)
    assert ended.returncode == 130
    found = json.loads((tmp_path / "a.json").read_text())
    assert found["interrupted"] and len(found["runs"]) == 3
    assert len((tmp_path / "a.csv").read_text().splitlines()) == 4


def test_ranges_are_decimal_numbers_with_units():
    fixed, swept = swept_keys(["a.b=0:0.3:0.1", "c=1", "d=60GPa:50GPa:-5GPa", "e=1:2:1 mm", "f=[0, 1],[2, 3]"])
    assert fixed == ["c=1"]
    assert [one.values for one in swept] == [
        ("0.0", "0.1", "0.2", "0.3"),
        ('"60 GPa"', '"55 GPa"', '"50 GPa"'),
        ('"1 mm"', '"2 mm"'),
        ("[0, 1]", "[2, 3]"),
    ]
    assert swept[1].numbers == (60.0, 55.0, 50.0) and swept[1].unit == "GPa" and swept[3].numbers == ()
    assert list(combinations(swept[2:])) == [(0, 0), (0, 1), (1, 0), (1, 1)]
    assert swept_keys(["a=0,6mm"])[1][0].values == ("0", '"6 mm"')
    assert swept_keys(["a=0.2,50%"])[1][0].values == ("0.2", '"50 %"')
    assert swept_keys(["a=300 mm/m,0.2"])[1][0].values == ('"300 mm/m"', "0.2")
    assert swept_keys(["a=2*L,3"])[1][0].values[1] == "3"
    assert swept_keys(["a=1:4:1"])[1][0].values == ("1", "2", "3", "4")


@pytest.mark.parametrize(
    ("word", "what"),
    [
        ("a=1:2:0", "STEP is 0"),
        ("a=1mm:2mm:0", "STEP is 0"),
        ("a=10mm:20mm:5", "STEP has no unit.*\n.*a=10mm:20mm:5mm"),
        ("a=4,6mm", "4 has no unit.*\n.*--set a=4mm,6mm"),
        ("a=4,6mm", "--set a=4mm,6mm or --set a=4m,6mm$"),
        ("a=4mm,6,0.1 m,7", "6 has no unit.*\n.*--set a=4mm,6m,0.1m,7m$"),
        ("a=300,20degC", "300 has no unit.*\n.*--set a=300degC,20degC or --set a=300K,20degC$"),
        ("a=7850,2.7 g/cm^3", "--set 'a=7850g/cm.3,2.7g/cm.3' or --set 'a=7850kg/m.3,2.7g/cm.3'$"),
        ("a=1,2 mA/s", "--set a=1mA/s,2mA/s or --set a=1A/s,2mA/s$"),
        ("a=0.2,50%,3mm", "--set a=0.2mm,50%,3mm or --set a=0.2m,50%,3mm$"),
        ("a=1:2:-1", "no number of these steps"),
        ("a=1mm:2m:1mm", "several units"),
        ("a=1,,2", "empty value"),
        ("a=0:1e30:1", "more than"),
        ("a=0:1e-3:1e-999", "STEP is 0"),
        ("a=1e999:2:1", "larger than"),
        ("a", "key=value"),
    ],
)
def test_what_is_no_range_is_refused(word, what):
    with pytest.raises(UserError, match=what):
        swept_keys([word])


def test_the_product_of_all_values_is_bounded(monkeypatch):
    monkeypatch.setattr(bounds, "SWEEP_VALUES", 11)
    assert len(swept_keys(["a=1:3:1", "b=1:3:1"])[1]) == 2
    with pytest.raises(UserError, match="12 runs"):
        swept_keys(["a=1:3:1", "b=1:4:1"])
    with pytest.raises(UserError, match="swept twice"):
        swept_keys(["a=1,2", "a=3,4"])


@pytest.mark.slow
def test_two_ranks_give_the_same_table(on_ranks, tmp_path):
    scene = write_scene(tmp_path, BAR)
    ended = [on_ranks(ranks, "sweep", scene, "--set", "material.steel.E=100e9,-1,200e9") for ranks in (1, 2)]
    assert [one.returncode for one in ended] == [0, 0]
    tables = [[line.split() for line in one.stdout.splitlines()[1:]] for one in ended]
    assert [row[:3] for row in tables[0]] == [row[:3] for row in tables[1]]
    assert float(tables[1][-1][2]) == pytest.approx(1.0, rel=1e-5) and tables[1][-1][3] == "mm"


@pytest.mark.parametrize(("key", "value", "counts"), [("E", "50e9", 1), ("thickness", "0.008", 2)])
def test_modes_go_on_where_values_change(key, value, counts, caplog):
    """Frequencies are those of a replay of its own; modes of a scaled system are not counted again."""
    fixed = ["effects.modal.model=plate", "effects.modal.modes=3", 'mesh.size="8 mm"']
    caplog.set_level("INFO", "restshape")
    first = {"E": "70e9", "thickness": "0.004"}[key]
    _, swept = swept_keys([f"material.aluminium.{key}={first},{value}"])
    runs = list(Sweep(SweepRequest(BELLS, fixed, swept, None, None, None, Calibration.load())).runs())
    assert [(one.analysis, one.level) for one in runs] == [("new", 3), ("reused", 0)]
    assert sum(" are counted " in record.getMessage() for record in caplog.records) == counts
    own = first_frame(BELLS, [*fixed, f"material.aluminium.{key}={value}"]).row
    assert "q_pitch" in runs[1].quantities
    for name, extent in runs[1].quantities.items():
        assert extent.last == pytest.approx(own[name], rel=1e-6), name


PULLED_AND_LET_GO = [{"do": "set", "key": "loads.pull.traction", "value": [pull, 0]} for pull in (2 * PULL, PULL)]


def test_frames_beyond_a_limit_are_reported_though_the_last_one_holds(command, tmp_path):
    """A bar stretches by PULL * LENGTH / E, 1 mm, then 2 mm, then 1 mm again; the limit is between, or follows E."""
    scene = write_scene(tmp_path, BAR.replace("stretch = {", 'stretch = { max = "1.5 mm",'))
    script = write_script(tmp_path, PULLED_AND_LET_GO)
    words = ("--edits", script, "--set", "material.steel.E=200e9,400e9", "--csv", "a.csv", "--out", "a.svg")
    done = command("sweep", scene, *words, "--json", tmp_path / "sweep.json")
    assert done.returncode == 0 and "done, fails in 1 of 3 frames" in done.stdout and "done, holds " in done.stdout
    runs = json.loads((tmp_path / "sweep.json").read_text())["runs"]
    assert [(one["constraint_status"], one["violating"]) for one in runs] == [("holds", 1), ("holds", 0)]
    with (tmp_path / "a.csv").open() as file:
        assert [row["violating"] for row in csv.DictReader(file)] == ["1", "0"]


def test_a_value_beyond_its_limit_is_held_against_the_limit_of_its_frame():
    """The limit of the last frame, 5, would find none of them beyond."""
    run = SweptRun(0, {}, {}, limits={"sag": {"max": 5.0}})
    for value, limit in ((1.0, 2.0), (3.0, 2.5), (2.7, 2.5), (4.0, 5.0)):
        status = "fails" if value > limit else "holds"
        run.add({"level": 1, "refused": "", "constraint_status": status, "q_sag": value, "sag_max": limit}, ["q_sag"])
    assert run.quantities["q_sag"].beyond == 3.0 and run.outcome == "done, fails in 2 of 4 frames"
    held = SweptRun(0, {}, {}, limits={"sag": {"max": 5.0}})
    held.add({"level": 1, "refused": "", "constraint_status": "holds", "q_sag": 4.0}, ["q_sag"])
    assert np.isnan(held.quantities["q_sag"].beyond) and held.outcome == "done, holds"
