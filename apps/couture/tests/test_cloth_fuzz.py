"""Random scenes of cloth and random edits never break: a small share; most that are not damaged make sense."""

from collections import Counter

import pytest
from drawn_scenes import look_at_drawn
from hypothesis.strategies import tuples
from restshape_studies.stability.fuzz import fuzz
from restshape_verification.couture.random_scenes import cloth_scenes

from restshape.application import application


@pytest.mark.slow
def test_nothing_breaks(forked_examples):
    tried = fuzz(6, 1, ("couture",))
    assert not tried.found, [vars(found) for found in tried.found.values()]
    assert tried.valid >= 3 and tried.frames > 12 and 3 < tried.largest <= 200


@pytest.mark.slow
def test_scenes_are_of_all_kinds(tmp_path):
    seen: Counter[str] = Counter()
    known = application("couture")

    def look(tables, scene):
        if scene is None:
            seen.update(["refused"])
            return
        assert scene.app == known.name
        seen.update(body.kind for body in scene.bodies.values())
        seen.update(list(scene.effects))
        seen.update([scene.effects["cloth"]["bending"], scene.effects["drape"]["strategy"]])
        seen.update({"start": scene.start is not None, "nested": scene.mesh.levels > 1, "bare": not scene.supports})

    look_at_drawn(tuples(cloth_scenes()), 150, tmp_path, look)
    # What makes no sense is refused, and is not most of it.
    assert 0 < seen["refused"] < 75
    drawn = {name for name, count in seen.items() if count}
    kinds = {
        "sphere",
        "plane",
        "box",
        "capsule",
        "cylinder",
        "morley",
        "hinge",
        "nonlinear",
        "none",
        "start",
        "nested",
        "bare",
    }
    assert kinds | set(known.effects) | {"auto", "newton"} <= drawn
