"""Numbers of tables on the console: unit and prefix, what is said beside them, plural forms."""

from restshape.cli.quantity_cells import cells, shared_size
from restshape.cli.quantity_tables import print_quantities
from restshape.outputs.si_numbers import counted, unit_of


def test_values_have_the_prefix_of_the_largest():
    assert cells([-1.3695e-4, 2e-6, None], "m") == ["-136.95 µm", "2 µm", "–"]
    assert cells([32.346e6, float("nan")], "Pa") == ["32.346 MPa", "–"]
    assert cells([0.25], "") == ["0.25"]
    assert unit_of("m^2") == "m²"


def test_values_that_lie_close_together_have_more_digits():
    assert cells([293.15812, 293.24217], "K") == ["293.158 K", "293.242 K"]
    assert cells([293.158123, 293.158456], "K") == ["293.15812 K", "293.15846 K"]
    # Rounding is no difference.
    assert cells([293.15, 293.15 * (1 + 1e-12)], "K") == ["293.15 K", "293.15 K"]


def test_lengths_of_a_table_are_all_in_millimetres_where_one_is():
    assert shared_size(1.064, [1.064, 0.24]) == 0.1 and shared_size(0.24, [1.064, 0.24]) == 0.24
    # All in metres, far larger ones, and micrometres stay.
    assert shared_size(1.064, [1.064, 2.0]) == 1.064 and shared_size(12.0, [12.0, 0.24]) == 12.0
    assert shared_size(3e-4, [3e-4, 0.24]) == 3e-4 and shared_size(1.2, [1.2, 3e-4]) == 1.2


def test_the_table_of_a_replay_has_units_notes_and_errors(capsys):
    values = {"first": [440.0, 466.16], "sag": [-1e-3, None]}
    beside = {"first": ["A4 +0 cents", "A#4 +0 cents"], "sag": ["", ""]}
    summary = {
        "beside": beside,
        "quantities": values,
        "quantity_errors": {"first": [0.5, 0.25]},
        "jumps": {},
        "singular": {},
    }
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
