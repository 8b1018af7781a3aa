"""Random scenes of heat and random edits never break: a small share; most that are not damaged make sense."""

from collections import Counter

import pytest
from drawn_scenes import look_at_drawn
from hypothesis.strategies import tuples
from restshape_studies.stability.fuzz import fuzz
from restshape_verification.thermal.random_scenes import SCENES


@pytest.mark.slow
def test_nothing_breaks(forked_examples):
    tried = fuzz(20, 1, ("thermal",))
    assert not tried.found, [vars(found) for found in tried.found.values()]
    assert tried.valid >= 5 and tried.frames > 25 and 3 < tried.largest <= 200


@pytest.mark.slow
def test_scenes_are_of_all_kinds(tmp_path):
    seen: Counter[str] = Counter()

    def look(tables, scene):
        if scene is None:
            seen.update(["refused"])
            return
        if "fluid" in tables:
            seen.update(["fluid", *scene.effects])
            assert SCENES.predictable(tables) == ("time_step" not in tables["effects"]["flow"])
            return
        seen.update(load.kind for load in scene.loads.values())
        seen.update(["stored" if "storage" in scene.effects else "steady"])
        seen.update(["held" if scene.supports else "free", "parts" if len(scene.material) > 1 else "whole"])
        assert SCENES.predictable(tables) == ("storage" not in scene.effects)

    look_at_drawn(tuples(SCENES.scenes), 150, tmp_path, look)
    assert seen["refused"] < 75
    assert {"source", "flux", "convection", "steady", "stored", "held", "free", "parts", "whole"} <= set(seen)
    assert {"fluid", "heat", "buoyancy", "convection"} <= set(seen)
