"""Random scenes of flow and random edits never break: a small share; most that are not damaged make sense."""

from collections import Counter

import pytest
from drawn_scenes import look_at_drawn
from hypothesis.strategies import tuples
from restshape_studies.stability.fuzz import fuzz
from restshape_verification.flow.random_scenes import SCENES


@pytest.mark.slow
def test_nothing_breaks(forked_examples):
    tried = fuzz(20, 1, ("flow",))
    assert not tried.found, [vars(found) for found in tried.found.values()]
    assert tried.valid >= 5 and tried.frames > 25 and 3 < tried.largest <= 200


@pytest.mark.slow
def test_scenes_are_of_all_kinds(tmp_path):
    seen: Counter[str] = Counter()

    def look(tables, scene):
        if scene is None:
            seen.update(["refused"])
            return
        seen.update(table.kind for table in scene.boundary.values())
        seen.update(["steady" if SCENES.predictable(tables) else "in time", *scene.effects])
        seen.update(["holes"] if "holes" in tables["shape"] else [])
        seen.update(quantity.kind for quantity in scene.quantities.values())

    look_at_drawn(tuples(SCENES.scenes), 150, tmp_path, look)
    assert seen["refused"] < 75
    wanted = {
        "velocity",
        "wall",
        "slip",
        "outflow",
        "steady",
        "in time",
        "convection",
        "holes",
        "strouhal",
        "drag",
        "flux",
    }
    assert wanted <= set(seen)
