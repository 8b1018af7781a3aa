"""Modes, harmonic sweeps and response spectra of a shape, against each other, closed forms and the motion in time."""

import csv
import json

import numpy as np
import pytest
from restshape_apps.vibration import modes, pictures
from restshape_apps.vibration.harmonic_sweep import resonant_sweep, summit, sweep
from restshape_apps.vibration.stage import structure_of
from scipy.signal import StateSpace, lsim
from small_scenes import make_replay, rows_of, write_script

from restshape.analysis.motion.modes_beside import present_modes
from restshape.application import application
from restshape.cli.main import main
from restshape.physics.elasticity.ground_record import GroundRecord, read_record

SCENES = application("vibration").folder / "scenes"
FRAME, RECORD, COLUMN = SCENES / "frame.toml", SCENES / "ground.csv", SCENES / "column.toml"
COARSE = ["mesh.size=1.2", "solve.jumps=false"]


@pytest.fixture(scope="module")
def shape():
    replay = make_replay(FRAME, overrides=COARSE)
    rows_of(replay)
    return structure_of(replay.analysis, replay.session.scene)


@pytest.fixture(scope="module")
def motion(tmp_path_factory):
    """The time history of the roof of the frame that nobody edits, every 0.1 s, and its peak."""
    script = write_script(tmp_path_factory.mktemp("motion"), [{"do": "idle", "frames": 120}])
    replay = make_replay(FRAME, script, overrides=[*COARSE, "solve.tolerance=1e-9"])
    replay.errors.estimating = False
    rows = np.array([(row["q_drift"], row["q_largest_drift"]) for row in replay.frames()])
    return rows[:, 0], rows[:, 1].max()


@pytest.mark.slow
def test_adding_modes_in_time_gives_the_time_history(shape, motion):
    """6 modes, each exact in time, against Newmark's method, which lengthens periods by (w dt)^2 / 12 = 0.1 %."""
    found, record = present_modes(shape.analysis, 6), read_record(RECORD)
    damping = found.damping(shape.analysis.state.integration.damping)
    history = np.zeros(len(record.times))
    for w, z, factor in zip(found.omega, damping, modes.factors(shape, found)["drift"]):
        oscillator = StateSpace([[0, 1], [-(w**2), -2 * z * w]], [[0], [-1]], [[factor, 0]], [[0]])
        history += lsim(oscillator, record.accelerations, record.times, interp=True)[1]
    assert np.abs(history[:1201:10] - motion[0]).max() < 0.03 * motion[1]


@pytest.mark.slow
def test_combinations_come_near_the_peak_of_the_time_history(shape, motion):
    """SRSS and CQC are estimates by random vibration; here, where one mode leads, they are within 10 %."""
    found = modes.peaks(shape, present_modes(shape.analysis, 6), read_record(RECORD))["drift"]
    peak = motion[1]
    assert found.in_time == pytest.approx(peak, rel=0.02)
    assert found.srss == pytest.approx(peak, rel=0.1)
    assert found.cqc == pytest.approx(peak, rel=0.1)


def test_one_mode_peaks_in_time_where_its_spectrum_does(shape):
    """A record with four samples in a period of the mode: its peaks lie between them."""
    found, whole = present_modes(shape.analysis, 1), read_record(RECORD)
    times = np.arange(0.0, 8.0, 0.25 / found.frequencies[0])
    record = GroundRecord(times, np.interp(times, whole.times, whole.accelerations))
    one = modes.peaks(shape, found, record)["drift"]
    assert one.in_time == pytest.approx(one.srss, rel=1e-5)


def test_modes_hold_nearly_all_of_the_mass(shape):
    """The shares of all modes add up to what is not fixed to the ground."""
    found = present_modes(shape.analysis, 60)
    assert 0.93 < found.effective_mass.sum() < 1.0


def test_a_sweep_is_the_sum_of_modes(shape):
    """U = sum of participation phi / (-w_k^2 + w^2 - 2 i z w_k w) for a unit acceleration, near the first resonance."""
    found = present_modes(shape.analysis, 30)
    omega, damping = found.omega, found.damping(shape.analysis.state.integration.damping)
    frequencies = np.array([0.5, 0.9, 1.0, 1.1]) * found.frequencies[0]
    w = 2 * np.pi * frequencies[:, None]
    expected = -(modes.factors(shape, found)["drift"] / (omega**2 - w**2 + 2j * damping * omega * w)).sum(axis=1)
    relative = sweep(shape, frequencies).relative["drift"]
    np.testing.assert_allclose(relative, expected, rtol=2e-3)


def test_a_slender_column_with_its_mass_on_top_is_one_oscillator():
    """Amplitude and transmissibility are those of one mass: T = sqrt((1 + (2 z r)^2) / ((1 - r^2)^2 + (2 z r)^2))."""
    heavy = [
        "shape.regions={head={polygon=[[0.05,3.6],[0.45,3.6],[0.45,3.95],[0.05,3.95]]}}",
        'material.lead={E="700 GPa",nu=0.3,rho="2e6 kg/m^3",thickness="20 mm",region="head"}',
        "material.aluminium.rho=1",
        'effects.damping={beta="2 ms"}',
    ]
    replay = make_replay(COLUMN, overrides=[*heavy, "mesh.order=2", "mesh.size=0.25"])
    rows_of(replay)
    shape = structure_of(replay.analysis, replay.session.scene)
    found = present_modes(shape.analysis, 1)
    z, r = float(found.damping(shape.analysis.state.integration.damping)[0]), np.array([0.05, 0.5, 1.0])
    factor = modes.factors(shape, found)["sway"][0]
    swept = sweep(shape, r * found.frequencies[0])
    one = factor / found.omega[0] ** 2 / np.hypot(1 - r**2, 2 * z * r)
    np.testing.assert_allclose(np.abs(swept.relative["sway"]), one, rtol=0.02)
    ratio = np.sqrt((1 + (2 * z * r) ** 2) / ((1 - r**2) ** 2 + (2 * z * r) ** 2))
    # The top sways a little more than the centre of the mass below it: by `factor`.
    np.testing.assert_allclose(swept.transmissibility["sway"][:1], ratio[:1], rtol=0.01)
    assert swept.transmissibility["sway"][2] == pytest.approx(factor * ratio[2], rel=0.02)


def test_the_peak_of_a_lightly_damped_oscillator_is_found_between_coarse_points(tmp_path, capsys):
    """One mass on a spring: its static amplitude grows by 1 / (2 z sqrt(1 - z^2)) at f sqrt(1 - 2 z^2).

    Of C = beta K the damping is z = pi f beta. Here it is 0.4 %, and the points are 30 bandwidths apart.
    """
    heavy = (
        "shape.regions={head={polygon=[[0.05,3.6],[0.45,3.6],[0.45,3.95],[0.05,3.95]]}}",
        'material.lead={E="700 GPa",nu=0.3,rho="2e6 kg/m^3",thickness="20 mm",region="head"}',
        "material.aluminium.rho=1",
        'effects.damping={beta="1 ms"}',
    )
    file = tmp_path / "a.json"
    words = [word for value in heavy for word in ("--set", value)]
    assert main(["harmonic", str(COLUMN), "--range", "0.01", "4", "--points", "17", "--json", str(file), *words]) == 0
    data = json.loads(file.read_text())
    frequencies, amplitudes = np.array(data["frequency"]), np.array(data["quantities"]["sway"]["amplitude"])
    assert (frequencies[0], frequencies[-1]) == (0.01, 4.0) and set(np.linspace(0.01, 4, 17)) <= set(frequencies)
    peak = int(np.argmax(amplitudes))
    z = np.pi * frequencies[peak] * 1e-3
    assert 0.003 < z < 0.01
    assert amplitudes[peak] / amplitudes[0] == pytest.approx(0.5 / z / np.sqrt(1 - z**2), rel=5e-3)
    assert f"{1e3 * amplitudes[peak]:.4g}" in capsys.readouterr().out
    # Half of the power at f (1 -+ z): the refined points resolve the peak.
    inside = np.abs(frequencies / frequencies[peak] - 1) < 1.01 * z
    assert inside.sum() >= 5
    assert (amplitudes[inside].min() / amplitudes[peak]) ** 2 == pytest.approx(0.5, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(("high", "more"), [(60.0, True), (9.0, False)])
def test_a_range_with_more_modes_says_up_to_which_frequency_peaks_are_resolved(
    shape, tmp_path, capsys, monkeypatch, high, more
):
    """Of the first eight modes, where no more of them are looked for."""
    monkeypatch.setattr("restshape_apps.vibration.harmonic_sweep.MOST_MODES", 8)
    known = present_modes(shape.analysis, 8).frequencies
    assert (known[-1] < high) == more
    words = [word for value in COARSE for word in ("--set", value)]
    file = tmp_path / "a.json"
    assert main(["harmonic", str(FRAME), "--range", "1", str(high), "--points", "3", "--json", str(file), *words]) == 0
    data = json.loads(file.read_text())
    if more:
        assert data["resolved_to"] == pytest.approx(known[-1], rel=1e-6)
        assert f"resonances up to {known[-1]:.4g} Hz have points of their own" in capsys.readouterr().out
    else:
        assert data["resolved_to"] is None and "points of their own" not in capsys.readouterr().out


@pytest.mark.slow
def test_peaks_of_overlapping_modes_are_those_of_a_fine_grid(shape):
    """200 frequencies about the largest amplitude within 1 % of it, each solved by itself."""
    found = resonant_sweep(shape, 1.0, 12.0, 6)
    amplitudes = np.abs(found.relative["drift"])
    place = found.frequencies[np.argmax(amplitudes)]
    fine = np.abs(sweep(shape, place * np.linspace(0.99, 1.01, 200)).relative["drift"]).max()
    assert amplitudes.max() == pytest.approx(fine, rel=1e-5)


def test_without_damping_no_peak_is_looked_for(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["harmonic", str(COLUMN), "--range", "1", "40", "--points", "5", "--json", "a.json"]) == 0
    assert "no damping" in capsys.readouterr().out
    assert len(json.loads((tmp_path / "a.json").read_text())["frequency"]) == 5


@pytest.mark.parametrize(("z", "points"), [(0.01, [0.9, 1.0, 1.2]), (0.2, [0.5, 0.9, 1.5])])
def test_three_points_of_one_mode_give_its_summit(z, points):
    """|U| of one oscillator of 1 Hz is largest at sqrt(1 - 2 z^2) Hz."""
    r = np.array(points)
    found = summit(r, 1 / np.hypot(1 - r**2, 2 * z * r))
    assert found == pytest.approx(np.sqrt(1 - 2 * z**2), rel=1e-9)


COMMON = ["--set", "mesh.size=2", "--json", "a.json"]


def test_modes_are_printed_with_peaks(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["participation", str(FRAME), "--modes", "2", *COMMON]) == 0
    data = json.loads((tmp_path / "a.json").read_text())
    assert len(data["frequency"]) == 2 and data["peaks"]["drift"]["cqc"] > 0.01
    assert "SRSS" in capsys.readouterr().out


@pytest.mark.slow
def test_tables_begin_with_their_columns_and_are_replaced(tmp_path):
    """Readers take the first line of a table for the names of its columns."""
    file = tmp_path / "a.csv"
    words = ["harmonic", str(FRAME), "--range", "1", "3", "--points", "3", "--set", "mesh.size=2", "--csv", str(file)]
    assert main(words) == 0 and main(words) == 0
    with file.open(newline="") as lines:
        rows = list(csv.DictReader(lines))
    assert float(rows[0]["frequency [Hz]"]) == 1.0 and float(rows[0]["drift [m]"]) > 0.0
    words = ["participation", str(FRAME), "--modes", "2", "--set", "mesh.size=2", "--csv", str(tmp_path / "b.csv")]
    assert main(words) == 0 and main(words) == 0
    assert (tmp_path / "b.csv").read_text().startswith("mode,frequency [Hz],")
    words = ["spectrum", str(RECORD), "--points", "2", "--csv", str(tmp_path / "c.csv")]
    assert main(words) == 0 and main(words) == 0
    assert (tmp_path / "c.csv").read_text().startswith("damping,period [s],")
    file.write_text("frequency [Hz],mine\n")
    assert main(["spectrum", str(RECORD), "--points", "2", "--csv", str(file)]) == 2


def test_modes_are_written_and_drawn_as_they_are_printed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    drawn = []
    monkeypatch.setattr(pictures, "save_picture", lambda figure, path: drawn.append(figure))
    assert main(["participation", str(FRAME), "--modes", "3", *COMMON, "--csv", "a.csv", "--picture", "a.png"]) == 0
    table = np.genfromtxt("a.csv", delimiter=",", skip_header=1)
    data = json.loads((tmp_path / "a.json").read_text())
    for column, key in ((1, "frequency"), (2, "damping"), (3, "participation"), (4, "effective_mass")):
        np.testing.assert_allclose(table[:, column], data[key], rtol=1e-7)
    np.testing.assert_allclose(table[:, 5], np.cumsum(data["effective_mass"]), rtol=1e-7)
    above, below, beside = drawn[0].axes
    assert above.get_ylabel() == "effective mass [%]" and below.get_ylabel() == "damping [%]"
    assert below.get_xlabel() == "frequency [Hz]" and "under the record [" in beside.get_xlabel()
    assert [text.get_text() for text in above.get_legend().get_texts()] == ["mode", "modes so far"]
    np.testing.assert_allclose(above.lines[0].get_ydata(), 100.0 * table[:, 5], rtol=1e-7)
    factor = {"mm": 1e3, "cm": 1e2, "m": 1.0}[beside.get_xlabel()[:-1].rpartition("[")[2]]
    widths = [bar.get_width() for bar in beside.patches]
    assert factor * data["peaks"]["drift"]["cqc"] == pytest.approx(widths[len(widths) // 3])


def test_modes_that_the_ground_does_not_excite_are_shown_without_participation(capsys):
    """The mode that bends a straight column, under ground that moves along it: of 14.6 kg^1/2 it has 4e-10."""
    values = ("effects.ground.direction=[0, 1]", "material.aluminium.nu=0", "mesh.order=2", "mesh.size=0.25")
    words = [word for value in values for word in ("--set", value)]
    assert main(["participation", str(COLUMN), "--modes", "1", *words]) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines() if line.split()[0].isdigit()]
    assert [row[3:] for row in rows] == [["0", "0", "0"]]


def test_a_sweep_is_written_as_it_is_printed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    files = [tmp_path / "a.csv", tmp_path / "a.png"]
    words = ["--csv", str(files[0]), "--picture", str(files[1])]
    assert main(["harmonic", str(FRAME), "--range", "1", "3", "--points", "5", *COMMON, *words]) == 0
    table = np.genfromtxt(files[0], delimiter=",", skip_header=1)
    data = json.loads((tmp_path / "a.json").read_text())
    np.testing.assert_allclose(table[:, 0], data["frequency"])
    np.testing.assert_allclose(table[:, 1], data["quantities"]["drift"]["amplitude"], rtol=1e-7)


@pytest.mark.slow
def test_a_spectrum_is_written_as_it_is_printed(tmp_path):
    files = [tmp_path / "a.csv", tmp_path / "a.png"]
    words = ["--csv", str(files[0]), "--picture", str(files[1])]
    words = ["--points", "4", "--damping", "0.02", "0.05", *words, "--json", str(tmp_path / "a.json")]
    assert main(["spectrum", str(RECORD), *words]) == 0
    data = json.loads((tmp_path / "a.json").read_text())
    assert [one["damping"] for one in data] == [0.02, 0.05]
    assert len(np.genfromtxt(files[0], delimiter=",", skip_header=1)) == 8


@pytest.mark.parametrize(
    ("command", "words", "says"),
    [
        ("harmonic", [FRAME, "--range", "3", "1"], "the frequencies are no range"),
        ("harmonic", [SCENES / "csm3.toml", "--range", "1", "3"], "linear solids"),
        ("participation", [FRAME, "--modes", "0"], "1 to 40 modes"),
        ("participation", [FRAME, "--record", "nowhere.csv"], "there is no such record"),
        ("spectrum", [RECORD, "--damping", "1"], "below 1"),
        ("spectrum", [RECORD, "--periods", "0", "1"], "the periods are no range"),
        ("spectrum", [FRAME], "a .csv or an .at2 file"),
    ],
)
def test_what_makes_no_sense_ends_with_2(capsys, command, words, says):
    assert main([command, *map(str, words)]) == 2
    assert says in capsys.readouterr().err
