"""Random scenes of furniture and random edits never break: a small share; what is checked of a frame can fail."""

from collections import Counter
from dataclasses import replace

import pytest
from drawn_scenes import look_at_drawn
from furniture_scenes import write_bench, write_edits
from restshape_apps.furniture.scene.plank_events import PLANK_EVENTS
from restshape_studies.stability.fuzz import fuzz
from restshape_studies.stability.strategies import scripts
from restshape_verification.furniture.frame_check import plank_problem
from restshape_verification.furniture.random_scenes import SCENES
from small_scenes import make_replay

from restshape.application import application


@pytest.mark.slow
def test_nothing_breaks(forked_examples):
    tried = fuzz(30, 1, ("furniture",))
    assert not tried.found, [vars(found) for found in tried.found.values()]
    assert tried.valid >= 10 and tried.frames > 50


@pytest.mark.slow
def test_scenes_and_edits_are_of_all_kinds(tmp_path):
    seen: Counter[str] = Counter()

    def look(tables, lines, scene):
        seen.update(event["do"] for event in lines[1:])
        if scene is None:
            seen.update(["refused"])
            return
        seen.update(list(scene.effects))
        seen.update(["named joint"] if scene.joints.named else [])
        seen.update("drawn" if plank.drawn else "centred" for plank in scene.planks.values())
        seen.update({"smooth": scene.floor.friction == 0.0, "pushes": bool(scene.pushes), "loads": bool(scene.weights)})

    drawn = SCENES.scenes.flatmap(
        lambda tables: scripts(tables, SCENES, formulas=False).map(lambda lines: (tables, lines))
    )
    look_at_drawn(drawn, 120, tmp_path, look)
    # What makes no sense is refused, and is not most of it.
    assert 0 < seen["refused"] < 60
    wanted = {"named joint", "drawn", "centred", "smooth", "pushes", "loads"}
    effects = set(application("furniture").effects) - {"nails"}
    assert wanted | effects | set(PLANK_EVENTS) <= {k for k, n in seen.items() if n}


@pytest.fixture
def frame(tmp_path):
    """A replay that holds a leg of a bench, and its last row."""
    grabbed = {"do": "press", "on": "left", "parameter": "move z"}, {"do": "drag", "by": 0.1}
    replay = make_replay(write_bench(tmp_path), write_edits(tmp_path, *grabbed))
    return replay.analysis, list(replay.frames())[-1]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"constraint_status": "fails"}, "the status is fails"),
        ({"flaws": 8}, "the status is holds"),
        ({"constraint_status": "uncertain"}, "the status is uncertain, ''"),
        ({"utilisation": float("inf")}, "infinite"),
        ({"utilisation": float("nan")}, "no number"),
        ({"at": -0.58}, "at -0.58 the piece holds"),
    ],
)
def test_a_frame_that_says_what_is_not_so_is_seen(frame, change, words):
    analysis, row = frame
    assert plank_problem(analysis, row) == ""
    assert words in plank_problem(analysis, {**row, **change})


def test_a_piece_that_holds_may_depend_on_what_nobody_knows(frame):
    analysis, row = frame
    doubted = {**row, "constraint_status": "uncertain", "violated_constraints": "depends on joints"}
    assert plank_problem(analysis, doubted) == ""
    assert "the status is uncertain" in plank_problem(analysis, {**doubted, "flaws": 8})


def test_contacts_that_bear_something_else_are_seen(frame):
    analysis, row = frame
    analysis.forces[0] = replace(analysis.forces[0], contacts=1.01 * analysis.forces[0].contacts)
    assert "contacts leave" in plank_problem(analysis, row)
