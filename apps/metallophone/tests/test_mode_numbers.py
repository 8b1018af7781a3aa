"""Numbers of modes: in a sweep they follow the modes, from rest they are those of a replay; undo brings them back."""

import json

import numpy as np
import pytest

import restshape
from restshape.analysis.modal.mode_tracking import ModeIds
from restshape.cli.main import main

BENDS = 2
"""The mode that bends twice at the start, which a torsion crosses where the bar is wider."""


@pytest.fixture
def bar(tmp_path, capsys):
    """The bar that `restshape new` writes, its width a parameter, with a quantity by number and one by rank."""
    assert main(["new", "metallophone", str(tmp_path / "bar")]) == 0
    capsys.readouterr()
    path = tmp_path / "bar" / "scene.toml"
    text = (
        path.read_text().replace("[shape]", '[parameters]\nwide = "30 mm"\n[shape]', 1).replace('"30 mm"]', '"wide"]')
    )
    quantities = f"[quantities]\nnumber = {{ mode = {BENDS} }}\nrank = {{ frequency = {BENDS} }}\n"
    path.write_text(text.partition("[quantities]")[0] + quantities)
    return path


def swept(bar, *words):
    """What a sweep of its width writes."""
    out = bar.parent / "sweep.json"
    assert main(["sweep", str(bar), "--set", "parameters.wide=30mm:40mm:5mm", "--json", str(out), *words]) == 0
    return json.loads(out.read_text())


def values(found, name):
    return [run["quantities"][name]["last"] for run in found["runs"]]


def test_a_number_stays_that_of_its_mode_from_run_to_run(bar):
    found = swept(bar)
    numbers, ranks = values(found, "number"), values(found, "rank")
    assert numbers == pytest.approx(3 * [numbers[0]], rel=5e-3)
    assert ranks[0] == numbers[0] and ranks[2] < 0.95 * numbers[2]
    (note,) = (note for note in found["notes"] if note.startswith("modes keep their numbers"))
    assert "in 1 run these are not their ranks" in note


def test_from_rest_each_run_has_the_numbers_of_a_replay_of_its_own(bar):
    found = swept(bar, "--from-rest")
    assert values(found, "number") == values(found, "rank") and not found["notes"]
    own = bar.parent / "replay.json"
    assert main(["replay", str(bar), "--set", "parameters.wide=40mm", "--json", str(own)]) == 0
    assert values(found, "number")[2] == json.loads(own.read_text())["quantities"]["number"][0]


def test_ranks_alone_need_no_note(bar):
    bar.write_text(bar.read_text().replace(f"number = {{ mode = {BENDS} }}\n", ""))
    assert all("numbers" not in note for note in swept(bar)["notes"])


def test_undo_and_redo_bring_back_the_numbers_of_modes(bar):
    """Of a bar that becomes another one in a single frame some modes look like none that there was."""
    with restshape.open(restshape.load(bar)) as sim:
        start, first = sim.frame.row["mode_ids"], sim.frame.quantities["number"]
        with sim.press("a") as hand:
            hand.to("140 mm", 0)
        lost = sim.frame.row["mode_ids"]
        assert lost != start
        back = sim.undo()
        assert back.row["mode_ids"] == start and back.quantities["number"] == pytest.approx(first, rel=5e-3)
        assert sim.redo().row["mode_ids"] == lost and sim.undo().row["mode_ids"] == start


def test_recalled_ids_are_had_once():
    ids = ModeIds(np.array([7, 2, 8, 3]), 9)
    found = ids.recalled(np.array([1, 2, 3]), np.array([0, 1, 2]))
    assert found.ids.tolist() == [1, 2, 3, 9] and found.free == 10
    assert ids.ids.tolist() == [7, 2, 8, 3]
