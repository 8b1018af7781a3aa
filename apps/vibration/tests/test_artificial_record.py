"""The record that ships: made by its formula, which does what it says."""

from itertools import pairwise

import numpy as np
import pytest
from restshape_apps.vibration.artificial_record import Ground, accelerations, record_text, spectrum

from restshape.application import application
from restshape.cli.main import main
from restshape.physics.elasticity.ground_record import read_record

SHIPPED = application("vibration").folder / "scenes" / "ground.csv"


def test_the_shipped_record_is_what_the_formula_gives(tmp_path):
    assert main(["ground-record", "--out", str(tmp_path / "ground.csv")]) == 0
    made, shipped = read_record(tmp_path / "ground.csv"), read_record(SHIPPED)
    np.testing.assert_array_equal(made.times, shipped.times)
    # The last digit that is written may be another one on another machine.
    np.testing.assert_allclose(made.accelerations, shipped.accelerations, atol=1.1e-5)
    assert shipped.peak == pytest.approx(2.5) and shipped.step == pytest.approx(0.01)


def test_its_spectrum_is_that_of_kanai_and_tajimi():
    """The periodogram over the part of constant strength follows the closed form: within 15 % in broad bands."""
    ground = Ground(rise=1e-9, strong=1e9, seconds=60.0, peak=1.0)
    t = 0.01 * np.arange(6000)
    power = np.abs(np.fft.rfft(accelerations(ground, t))) ** 2
    frequencies = np.fft.rfftfreq(len(t), 0.01)
    expected = spectrum(ground, np.maximum(frequencies, 1e-9))
    edges = (1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 15.0)
    bands = [(frequencies >= low) & (frequencies < high) for low, high in pairwise(edges)]
    shares = np.array([[values[band].sum() for band in bands] for values in (power, expected)])
    shares /= shares.sum(axis=1, keepdims=True)
    np.testing.assert_allclose(shares[0], shares[1], rtol=0.15)


def test_it_replaces_its_own_file_alone(tmp_path, capsys):
    other = tmp_path / "mine.csv"
    other.write_text("time [s],acceleration [g]\n0,0\n")
    assert main(["ground-record", "--out", str(other)]) == 2
    assert "is not a table that restshape wrote" in capsys.readouterr().err
    other.write_text(record_text(Ground(), 0.1))
    assert main(["ground-record", "--out", str(other), "--peak", "1"]) == 0
    assert read_record(other).peak == pytest.approx(1.0)


@pytest.mark.parametrize("words", [["--peak", "-1"], ["--frequency", "nan"]])
def test_numbers_that_make_no_sense_are_refused(tmp_path, words):
    assert main(["ground-record", "--out", str(tmp_path / "a.csv"), *words]) == 2
