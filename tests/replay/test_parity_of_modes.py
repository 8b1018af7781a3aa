"""Reuse verification of modes: clusters and subspaces, whatever their rank; and what it must notice."""

from dataclasses import replace

import numpy as np
import pytest
from modal import replay, solved

from restshape.analysis.modal.modal_comparison import TOLERANCE
from restshape.replay.parity import Parity

DRAG = """{"format": "restshape-edits", "version": 1, "scene": "bar_100.toml", "units": "m"}
{"t": 0.0, "do": "press", "on": "right"}
{"t": 0.1, "do": "drag", "path": [[0.1045, 0.015], [0.1053, 0.015], [0.106, 0.015]]}
"""


@pytest.fixture(scope="module")
def plate():
    """The modes of a free plate, solved to rounding."""
    return solved("plate")


def changed(analysis, **modes):
    """The difference from a cold solve of modes that are others."""
    state = analysis.state
    analysis.state = replace(state, modes=replace(state.modes, **modes))
    try:
        return analysis.compare_cold().solution
    finally:
        analysis.state = state


def test_what_is_solved_meets_a_cold_solve(plate):
    found = plate.compare_cold()
    assert found.entries <= 1e-13 and found.solution <= 1e-9 and plate.tolerance == TOLERANCE == 1e-6


@pytest.mark.parametrize("factor", [1.0009, 1 + 1e-5, 1 - 1e-5])
def test_a_frequency_that_is_off_is_noticed(plate, factor):
    assert changed(plate, values=plate.state.modes.values * factor**2) > TOLERANCE


def test_a_mode_that_is_turned_is_noticed(plate):
    vectors = plate.state.modes.vectors.copy()
    angle = 2e-3
    vectors[0], vectors[1] = (
        np.cos(angle) * vectors[0] + np.sin(angle) * vectors[1],
        np.cos(angle) * vectors[1] - np.sin(angle) * vectors[0],
    )
    assert changed(plate, basis=vectors) == pytest.approx(np.sin(angle) ** 2, rel=1e-3)


def test_clusters_are_no_wider_where_solves_are_loose():
    """At residuals of 1e-3, which shipped scenes ask for, modes are compared one by one too."""
    loose = solved("plate", "solve.tolerance=1e-3")
    assert loose.compare_cold().solution <= TOLERANCE
    vectors = loose.state.modes.vectors.copy()
    vectors[[0, 1]] = np.array([[np.cos(0.01), np.sin(0.01)], [-np.sin(0.01), np.cos(0.01)]]) @ vectors[[0, 1]]
    assert changed(loose, basis=vectors) == pytest.approx(1e-4, rel=0.01)


def test_a_participation_that_is_off_is_noticed(plate):
    assert changed(plate, participation=plate.state.modes.participation - 1e-5) == pytest.approx(1e-5, rel=1e-3)


def test_a_mode_that_is_missed_is_noticed(plate):
    modes = plate.state.modes
    assert changed(plate, chosen=np.array([*modes.chosen[:1], *(modes.chosen[1:] + 1)])) > 1e-3


def test_modes_of_a_cluster_may_be_any_basis_of_it():
    """A square plate has pairs of modes of one frequency: turned among themselves they are the same subspace."""
    analysis = solved(
        "plate", "shape.vertices.c=[0.1,0.1]", "shape.vertices.d=[0,0.1]", "effects.modal.modes=5", 'mesh.size="5 mm"'
    )
    values = analysis.state.modes.values
    first = int(np.argmin(np.diff(values) / values[1:]))
    assert np.diff(values)[first] < 1e-3 * values[first]
    vectors = analysis.state.modes.vectors.copy()
    vectors[[first, first + 1]] = np.array([[0.6, 0.8], [-0.8, 0.6]]) @ vectors[[first, first + 1]]
    assert changed(analysis, basis=vectors) <= TOLERANCE


def test_a_mode_in_the_plane_may_change_its_rank(tmp_path):
    """While a bar grows longer a mode in the plane rises above the third one out of it: the same three are wanted."""
    edits = tmp_path / "bar.jsonl"
    edits.write_text(DRAG)
    run = replay("bar_100.toml", edits, ["effects.modal.modes=3", 'mesh.size="8 mm"'])
    check, ranks = Parity(run), set()
    for row in run.frames():
        assert not row["refused"]
        check()
        ranks.add(tuple(run.analysis.state.modes.chosen))
    assert check.summary()["holds"] and ranks == {(0, 1, 2), (0, 1, 3)}
    # A solve that knows nothing of the mode in the plane has found the same three.
    modes, three = run.analysis.state.modes, np.array([0, 1, 3])
    run.analysis.state = replace(run.analysis.state, count=3)
    known = {name: getattr(modes, name)[three] for name in ("values", "basis", "participation")}
    assert modes.turn is None and changed(run.analysis, chosen=np.arange(3), **known) <= TOLERANCE
