"""Numbers of tables on the console: unit and prefix, notes, plural forms."""

import pytest

from restshape.cli.quantity_cells import cells, tone, unit_of
from restshape.cli.quantity_tables import print_quantities
from restshape.outputs.si_numbers import counted
from restshape.report.recorded_quantities import recorded_tuning


def test_values_have_the_prefix_of_the_largest():
    assert cells([-1.3695e-4, 2e-6, None], "m") == ["-136.95 µm", "2 µm", "–"]
    assert cells([32.346e6, float("nan")], "Pa") == ["32.346 MPa", "–"]
    assert cells([0.25], "") == ["0.25"]
    assert unit_of("m^2") == "m²"


@pytest.mark.parametrize(
    ("frequency", "a4", "words"),
    [
        (440.0, 440.0, "A4 +0 cents"),
        (442.0, 440.0, "A4 +8 cents"),
        (261.63, 440.0, "C4 +0 cents"),
        (432.0, 440.0, "A4 −32 cents"),
        (442.0, 442.0, "A4 +0 cents"),
        (2.0, 440.0, ""),
    ],
)
def test_notes(frequency, a4, words):
    assert tone(frequency, "Hz", a4) == words


def test_what_is_no_frequency_has_no_note():
    assert tone(440.0, "Pa") == "" and tone(None, "Hz") == ""


@pytest.mark.parametrize(
    ("header", "a4"),
    [
        ({"a4": 443.5}, 443.5),
        ({"scene_values": {"effects": {"modal": {"a4": "442 Hz"}}}}, 442.0),
        ({"scene_values": {"effects": {"modal": {"a4": 442}}}}, 442.0),
        ({"scene_values": {"effects": {"modal": {"a4": "pitch"}}}}, 440.0),
        ({"scene_values": {"effects": {}}}, 440.0),
        ({}, 440.0),
    ],
)
def test_recordings_know_their_tuning(header, a4):
    assert recorded_tuning(header) == a4


def test_the_table_of_a_replay_has_units_notes_and_errors(capsys):
    values = {"first": [440.0, 466.16], "sag": [-1e-3, None]}
    summary = {"quantities": values, "quantity_errors": {"first": [0.5, 0.25]}, "jumps": {}, "singular": {}}
    print_quantities(
        summary | {"predicted": 0, "scales": {"first": 440.0, "sag": 1e-3}, "units": {"first": "Hz", "sag": "m"}}
    )
    head, *rows = [line.split("  ") for line in capsys.readouterr().out.splitlines()[1:]]
    table = [[cell.strip() for cell in row if cell.strip()] for row in rows]
    assert table[0] == [
        "first",
        "440 Hz",
        "466.16 Hz",
        "440 Hz",
        "466.16 Hz",
        "about 500 mHz",
        "A4 +0 cents",
        "A#4 +0 cents",
    ]
    assert table[1][:3] == ["sag", "-1 mm", "–"]
    assert "last note" in " ".join(head)


def test_one_is_singular():
    assert [counted(k, "frame") for k in (0, 1, 2)] == ["0 frames", "1 frame", "2 frames"]
