"""Names of tones."""

import pytest

from restshape.analysis.modal.pitch import cents_between, frequency_of, note, tone_words, tuned
from restshape.errors import UserError
from restshape.physics.elasticity.elasticity_declaration import QUANTITIES
from restshape.physics.elasticity.tones import tone


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


@pytest.mark.parametrize("a4", [415.0, 440.0, 443.5])
@pytest.mark.parametrize("frequency", [31.7, 440.0, 1234.5, 9999.0])
def test_a_note_says_how_it_is_tuned(frequency, a4):
    assert tuned(frequency, *note(frequency, a4)) == pytest.approx(a4, rel=1e-12)


@pytest.mark.parametrize(
    ("frequency", "a4", "words"),
    [
        (440.0, 440.0, "A4 +0 cents"),
        (442.0, 440.0, "A4 +8 cents"),
        (261.63, 440.0, "C4 +0 cents"),
        (432.0, 440.0, "A4 \N{MINUS SIGN}32 cents"),
        (442.0, 442.0, "A4 +0 cents"),
        (2.0, 440.0, ""),
    ],
)
def test_notes_beside_frequencies_are_tuned_as_their_frame(frequency, a4, words):
    """Its row says by the tone of the first frequency."""
    name, cents = note(777.0, a4)
    assert tone(frequency, {"f_1": 777.0, "tone": name.encode(), "cents": cents}) == words
    if a4 == 440.0:
        assert tone(frequency, {"f_1": float("nan"), "tone": "", "cents": 0.0}) == words


def test_frequencies_of_what_is_no_instrument_have_no_note():
    """As eigenfrequencies beside the motion of a building, whose frames have no column of tones."""
    assert tone(440.0, {"f_1": 440.0}) == tone(440.0, {}) == ""


def test_what_is_no_frequency_has_no_note():
    row = {"tone": ""}
    assert QUANTITIES["frequency"].said(440.0, row) == QUANTITIES["mode"].said(440.0, row) == "A4 +0 cents"
    assert QUANTITIES["stress"].said(440.0, row) == "" and QUANTITIES["mode"].said(None, row) == ""


@pytest.mark.parametrize("name", ["C-1", "A0", "F#4", "C5", "G5", "B9"])
def test_frequency_of_is_the_inverse_of_note(name):
    found, cents = note(frequency_of(name, 442.0), 442.0)
    assert found == name and abs(cents) < 1e-9


def test_flats_sound_as_the_sharps_below():
    assert frequency_of("Bb3") == frequency_of("A#3") and frequency_of("Cb4") == frequency_of("B3")
    assert frequency_of("G5") == pytest.approx(783.99, abs=0.005)


@pytest.mark.parametrize("name", ["H5", "C", "c5", "C55", "C##5", "", "C5 "])
def test_other_names_are_refused_with_those_there_are(name):
    with pytest.raises(UserError, match="C5, F#4, Bb3"):
        frequency_of(name, where="--to")


def test_an_octave_has_1200_cents():
    assert cents_between(880.0, 440.0) == 1200.0 and cents_between(frequency_of("A#4"), 440.0) == pytest.approx(100.0)


@pytest.mark.parametrize(
    ("frequency", "words"),
    [(16.4, "C0 +5 cents"), (15.5, "below C0"), (0.3, "below C0")],
)
def test_tones_below_the_octave_0_are_written_in_words(frequency, words):
    assert tone_words(*note(frequency)) == words
