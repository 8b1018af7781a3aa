"""Names of tones."""

import pytest

from restshape.analysis.pitch import note


@pytest.mark.parametrize(
    "frequency, name",
    [(440.0, "A4"), (261.6256, "C4"), (523.2511, "C5"), (27.5, "A0"), (4186.009, "C8"), (987.7666, "B5")],
)
def test_tones_of_the_piano(frequency, name):
    found, cents = note(frequency)
    assert found == name and abs(cents) < 1e-3


def test_cents_count_from_the_nearest_tone():
    assert note(440.0 * 2 ** (30 / 1200)) == ("A4", pytest.approx(30.0))
    assert note(440.0 * 2 ** (-30 / 1200)) == ("A4", pytest.approx(-30.0))
    assert note(442.0, 442.0) == ("A4", 0.0)


def test_what_does_not_sound_has_no_name():
    assert note(0.0)[0] == "" and note(float("nan"))[0] == ""
