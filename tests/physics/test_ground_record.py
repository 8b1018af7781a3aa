"""Records of the ground's acceleration: what is read, what is refused, and a motion under a sampled sine."""

import json
import math
from argparse import Namespace

import numpy as np
import pytest
from small_scenes import make_replay, rows_of, write_script
from vibrating import SHAKEN, dynamics, tower

from restshape.bounds import RECORD_BYTES
from restshape.cli.main import main
from restshape.cli.options import refuse_files_of_scene
from restshape.errors import UserError
from restshape.outputs.kinds import JsonFile
from restshape.physics.elasticity.base_excitation import base_excitation
from restshape.physics.elasticity.ground_record import STANDARD_GRAVITY, read_record
from restshape.physics.elasticity.motion_effects import GroundKeys
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

AT2 = "PEER NGA STRONG MOTION DATABASE RECORD\nSomewhere, 1979\nACCELERATION TIME SERIES IN UNITS OF G\n"
NEW, OLD = "NPTS=   7, DT=   .0100 SEC\n", "    7    0.0100    NPTS, DT\n"
VALUES = "  .1000E-01  -.2000E-01  .0E+00  .3000E+00  -.1000E+00\n  .5000E-01  0.0\n"


def written(folder, text, name="quake.csv"):
    path = folder / name
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("head", "factors"),
    [
        ("time [s],acceleration [m/s^2]", (1.0, 1.0)),
        ("t [ms], a [g]", (1e-3, 9.80665)),
        ("time of the record [min],ground, east [cm/s^2]".replace("ground, ", "ground "), (60.0, 0.01)),
    ],
)
def test_units_of_a_table_count(tmp_path, head, factors):
    found = read_record(written(tmp_path, f"# made by hand\n{head}\n0,1\n\n2,-3e0\n2.5, 0.5\n"))
    np.testing.assert_allclose(found.times, np.array([0, 2, 2.5]) * factors[0], rtol=1e-15)
    np.testing.assert_allclose(found.accelerations, np.array([1, -3, 0.5]) * factors[1], rtol=1e-15)


def test_between_samples_it_is_linear_and_outside_nothing(tmp_path):
    record = read_record(written(tmp_path, "t [s],a [m/s^2]\n1,2\n3,6\n4,-1\n"))
    assert [record(t) for t in (0.99, 1.0, 1.5, 3.5, 4.0, 4.01)] == [0.0, 2.0, 3.0, 2.5, -1.0, 0.0]
    assert (record.step, record.peak) == (1.0, 6.0)


@pytest.mark.parametrize("counts", [NEW, OLD])
def test_published_records_are_read(tmp_path, counts):
    record = read_record(written(tmp_path, AT2 + counts + VALUES, "RSN1.AT2"))
    np.testing.assert_allclose(record.times, 0.01 * np.arange(7))
    expected = STANDARD_GRAVITY * np.array([0.01, -0.02, 0, 0.3, -0.1, 0.05, 0])
    np.testing.assert_allclose(record.accelerations, expected)


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("q.csv", "", "the record is empty"),
        ("q.csv", "time,acceleration\n0,1\n", r"line 1: this line does not say the units"),
        ("q.csv", "t [s],a [m/s]\n0,1\n1,2\n", r"line 1: 'm/s' is no unit of acceleration"),
        ("q.csv", "t [kg],a [g]\n0,1\n1,2\n", r"line 1: 'kg' is no unit of time"),
        ("q.csv", "t [s],a [g]\n0,1\n1,x\n", r"line 3: 'x' is no number"),
        ("q.csv", "t [s],a [g]\n0,1\n1,nan\n", r"line 3: 'nan' is no finite"),
        ("q.csv", "t [s],a [g]\n0,1\n1,2,3\n", r"line 3: there are 3 values"),
        ("q.csv", "t [s],a [g]\n0,1\n#\n1,2\n1,3\n", r"line 5: the time is not later"),
        ("q.csv", "t [s],a [g]\n0,1\n", "2 to 1000000 are read"),
        ("q.at2", AT2 + "7 points\n" + VALUES, "line 4: the fourth line"),
        ("q.at2", AT2.replace("ACCEL", "VELOCITY ACCEL") + NEW + VALUES, "line 3: this is no record of acc"),
        ("q.at2", AT2 + NEW + VALUES + "1.0\n", "line 4: there are 8 values, and NPTS is 7"),
        ("q.at2", AT2 + "NPTS= 7, DT= 0 SEC\n" + VALUES, "line 4: the step is not positive"),
        ("q.at2", AT2 + NEW + VALUES.replace(".0E+00", "****"), r"line 5: '\*\*\*\*' is no number"),
        ("q.txt", "t [s],a [g]\n0,1\n1,2\n", "a .csv or an .at2 file"),
    ],
)
def test_what_is_no_record_is_refused_with_its_line(tmp_path, name, text, says):
    with pytest.raises(UserError, match=says):
        read_record(written(tmp_path, text, name))


def test_a_record_beyond_its_bound_is_refused(tmp_path):
    path = written(tmp_path, "t [s],a [g]\n")
    with path.open("r+b") as file:
        file.truncate(RECORD_BYTES + 1)
    with pytest.raises(UserError, match=f"longer than {RECORD_BYTES} bytes"):
        read_record(path)


def recorded_tower(folder, keys="", name="quake.csv"):
    return tower(folder, f'\n[effects.ground]\nfile = "{name}"\n{keys}\n', dynamics())


@pytest.mark.parametrize(
    ("keys", "says"),
    [
        ("frequency = 2", "a record has no frequency"),
        ("displacement = 1", "exactly one of displacement, acceleration, file"),
        ("direction = [0, 0]", "direction"),
    ],
)
def test_a_record_excludes_a_harmonic_motion(tmp_path, keys, says):
    written(tmp_path, "t [s],a [g]\n0,0\n1,1\n")
    with pytest.raises(UserError, match=says):
        load_scene(recorded_tower(tmp_path, keys))


def test_scale_and_start_need_a_record(tmp_path):
    with pytest.raises(UserError, match="scale and start are those of a record"):
        load_scene(tower(tmp_path, SHAKEN + "scale = 2\n", dynamics()))


def test_scale_and_start_count(tmp_path):
    path = written(tmp_path, "t [s],a [m/s^2]\n0,1\n1,3\n")
    settings = GroundKeys(file=str(path), scale=-2.0, start="0.5 s", direction=(3.0, 4.0))
    excitation = base_excitation(settings, None, 0.0)
    np.testing.assert_allclose(excitation.acceleration(1.0), -2.0 * 2.0 * np.array([0.6, 0.8]))
    np.testing.assert_array_equal(excitation.acceleration(0.4), 0.0)


def test_a_harmonic_motion_after_a_record_begins_from_nothing(tmp_path):
    path = written(tmp_path, "t [s],a [m/s^2]\n0,1\n1,3\n")
    before = base_excitation(GroundKeys(file=str(path)), None, 0.0)
    after = base_excitation(GroundKeys(acceleration=2.0, frequency=3.0), before, 0.7)
    np.testing.assert_allclose(after.acceleration(0.7), 0.0, atol=1e-13)
    np.testing.assert_allclose(after.acceleration(0.7 + 1 / 12), [2.0, 0.0], atol=1e-12)


@pytest.fixture
def folders(tmp_path):
    """A folder for scenes, and one beside it with a record."""
    home, other = tmp_path / "home", tmp_path / "other"
    home.mkdir()
    other.mkdir()
    written(other, "t [s],a [g]\n0,0\n1,1\n")
    return home, other


def test_a_record_elsewhere_needs_permission(folders, monkeypatch):
    home, other = folders
    scene = recorded_tower(home, name="../other/quake.csv")
    with pytest.raises(UserError, match=r"effects\.ground\.file \(line \d+\)[\s\S]*--allow-path"):
        load_scene(scene)
    monkeypatch.setenv("RESTSHAPE_ALLOW_PATH", str(other.resolve()))
    assert load_scene(scene).effects["ground"]["file"] == "../other/quake.csv"


def test_a_record_of_the_command_line_needs_none(folders):
    home, other = folders
    written(home, "t [s],a [g]\n0,0\n1,1\n")
    path = str(other / "quake.csv")
    assert load_scene(recorded_tower(home), [f"effects.ground.file={path}"]).effects["ground"]["file"] == path


def test_a_script_cannot_lead_to_a_record_elsewhere(folders):
    home, _ = folders
    written(home, "t [s],a [g]\n0,0\n1,1\n")
    scene = load_scene(recorded_tower(home))
    script = write_script(home, [{"do": "set", "key": "effects.ground.file", "value": "../other/quake.csv"}])
    with pytest.raises(UserError, match=r"effects\.ground\.file: the file '\.\./other/quake\.csv' lies outside"):
        load_script(script, scene)


def test_a_record_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(UserError, match="there is no file"):
        load_scene(recorded_tower(tmp_path))


def test_no_output_replaces_the_record(tmp_path):
    path = written(tmp_path, "t [s],a [g]\n0,0\n1,1\n")
    with pytest.raises(UserError, match=r"effects\.ground\.file\) reads"):
        refuse_files_of_scene(Namespace(json=JsonFile(path)), load_scene(recorded_tower(tmp_path)))


def test_check_reports_it_and_warns_of_long_steps(tmp_path):
    written(tmp_path, "t [s],a [m/s^2]\n0,0\n0.001,2\n0.004,-3\n")
    out = tmp_path / "check.json"
    assert main(["check", str(recorded_tower(tmp_path, "scale = 2")), "--json", str(out)]) == 0
    found = json.loads(out.read_text())
    assert found["ground"] == {"samples": 3, "step": 0.001, "duration": 0.004, "peak": 6.0}
    assert any("passes over samples of the record" in warning for warning in found["warnings"])


def test_a_sampled_sine_moves_a_body_as_the_sine_does(tmp_path):
    """Newmark's method sees the ground at the ends of steps alone: with a sample at each they must agree."""
    amplitude, frequency, step, steps = 3.0, 4.0, 0.01, 4
    times = step * np.arange(40)
    sine = amplitude * np.sin(2 * math.pi * frequency * times)
    text = "\n".join(["t [s],a [m/s^2]", *(f"{t!r},{a!r}" for t, a in zip(times.tolist(), sine.tolist()))])
    written(tmp_path, text)
    script = write_script(tmp_path, [{"do": "idle", "frames": 6}])
    settings = [f"effects.dynamics.time_step={step}", f"effects.dynamics.steps={steps}", "solve.tolerance=1e-12"]
    by_record = rows_of(make_replay(recorded_tower(tmp_path, "direction = [2, 1]"), script, overrides=settings))
    by_sine = rows_of(make_replay(tower(tmp_path, SHAKEN, dynamics()), script, overrides=settings))
    names = [name for name in by_sine[0] if name.startswith("q_")]
    found, expected = (np.array([[row[name] for name in names] for row in rows]) for rows in (by_record, by_sine))
    assert np.abs(expected).max() > 0
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-9 * np.abs(expected).max())
