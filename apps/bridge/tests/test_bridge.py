"""The application `bridge`: two scripts that differ in when the analysis runs, and what is known from each."""

import json

import numpy as np
import pytest
from restshape_studies.pictures.score import draw_score
from restshape_verification.bridge.comparisons import designs, solved
from restshape_verification.bridge.study import WAYS, followed, study

from restshape.application import application
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene
from restshape.shape.session import EditSession

SCENE = application("bridge").folder / "scenes" / "bridge.toml"
SIZE = 'size = "200 mm"'
"""Of the mesh of that scene."""


@pytest.fixture(scope="module")
def ways(tmp_path_factory):
    """The study on a coarse mesh."""
    scene = tmp_path_factory.mktemp("bridge") / "bridge.toml"
    text = SCENE.read_text(encoding="utf-8")
    assert SIZE in text
    scene.write_text(text.replace(SIZE, 'size = "400 mm"'), encoding="utf-8")
    with pytest.MonkeyPatch.context() as changed:
        changed.setattr("restshape_verification.bridge.study.SCENE", scene)
        return study()


def test_the_scripts_differ_in_when_the_analysis_runs_and_in_nothing_else():
    texts = [WAYS[name].read_text().splitlines() for name in ("every frame", "on demand")]
    headers = [json.loads(lines[0]) for lines in texts]
    assert texts[0][1:] == texts[1][1:]
    assert [header.pop("analysis") for header in headers] == ["every frame", "on demand"]
    assert headers[0] == headers[1]


@pytest.mark.slow
def test_the_session_uses_all_tools_and_nothing_is_refused():
    scene = load_scene(SCENE)
    frames = list(EditSession(scene, load_script(WAYS["on demand"], scene)).frames())
    assert {"pull", "smooth", "hole", "press", "drag", "scale", "delete", "analyse"} <= {frame.do for frame in frames}
    assert not any(frame.refused for frame in frames)


@pytest.mark.slow
@pytest.mark.weekly
def test_both_ways_agree_where_both_know(ways):
    always, asked = ways["every frame"], ways["on demand"]
    np.testing.assert_array_equal(always.t, asked.t)
    np.testing.assert_allclose(always.score, asked.score, rtol=1e-12)
    known = asked.holds | asked.fails
    np.testing.assert_array_equal(always.holds[known], asked.holds[known])
    np.testing.assert_allclose(always.stress[known], asked.stress[known], rtol=1e-4)
    assert (always.holds | always.uncertain | always.fails).all() and always.fails.any() and asked.fails.any()
    # Knowing more designs cannot give a worse best one.
    assert (always.best <= asked.best).all() and always.best[-1] < asked.best[-1]
    assert asked.analysed <= 7


def test_the_best_area_counts_designs_that_hold_only():
    keys = ("t", "q_score", "q_strength", "constraint_status", "iterations", "ms")
    table = [(0, 9, 1, "holds", 3, 9), (1, 5, 8, "fails", 2, 1), (2, 7, 3, "holds", 2, 1), (3, 6, 4, "uncertain", 2, 1)]
    way = followed([dict(zip(keys, row)) for row in [*table, (4, 8, 2, "holds", 0, 1)]])
    assert way.best.tolist() == [9, 9, 7, 7, 7] and way.analysed == 4 and way.milliseconds == 4
    assert way.uncertain.tolist() == [False, False, False, True, False]


@pytest.mark.weekly
def test_the_picture_is_drawn(ways, tmp_path):
    draw_score(tmp_path / "study.png", ways, 18e6)
    assert (tmp_path / "study.png").stat().st_size > 20_000


def test_weight_and_banks_are_in_balance():
    """The banks bear the weight on the lane and that of the timber, area x thickness x rho x g."""
    from petsc4py import PETSc

    scene, outline = next(designs())
    found = solved(scene, outline, PETSc.COMM_WORLD)
    assert found["bank_force"] == pytest.approx(2e6 + found["score"] * 1.0 * 500 * 9.81, rel=1e-5)
    assert found["score"] == pytest.approx(outline.area(), rel=1e-5)


@pytest.mark.slow
def test_the_template_runs(command, tmp_path):
    assert command("new", "bridge", str(tmp_path / "mine")).returncode == 0
    scene, edits = tmp_path / "mine" / "scene.toml", tmp_path / "mine" / "edits.jsonl"
    done = command("replay", str(scene), "--edits", str(edits), "--json", str(tmp_path / "a.json"))
    assert done.returncode == 0, done.stderr
    reported = json.loads((tmp_path / "a.json").read_text())
    assert reported["refused"] == 0 and reported["constraint_status"]["last"] == "holds"
