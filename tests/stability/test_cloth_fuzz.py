"""Random scenes of cloth and random edits never break: a small share; most that are not damaged make sense."""

from collections import Counter

from hypothesis import HealthCheck, given, seed, settings

from restshape.application import application
from restshape.errors import UserError
from restshape.scene.load import load_scene
from restshape.stability.cloth_strategies import cloth_scenes
from restshape.stability.fuzz import fuzz
from restshape.stability.strategies import toml


def test_nothing_breaks():
    tried = fuzz(40, 1, ("couture",))
    assert not tried.found, [vars(found) for found in tried.found.values()]
    assert tried.valid >= 10 and tried.frames > 50 and 3 < tried.largest <= 200


def test_scenes_are_of_all_kinds(tmp_path):
    seen: Counter[str] = Counter()
    known = application("couture")

    @seed(3)
    @settings(max_examples=150, database=None, deadline=None, suppress_health_check=list(HealthCheck))
    @given(cloth_scenes())
    def look(tables):
        path = tmp_path / "scene.toml"
        path.write_text(toml(tables))
        try:
            scene = load_scene(path)
        except UserError:
            seen.update(["refused"])
            return
        assert scene.app == known.name
        seen.update(body.kind for body in scene.bodies.values())
        seen.update(list(scene.effects))
        seen.update([scene.effects["cloth"]["bending"], scene.effects["drape"]["way"]])
        seen.update({"start": scene.start is not None, "nested": scene.mesh.levels > 1, "bare": not scene.supports})

    look()
    # What makes no sense is refused, and is not most of it.
    assert 0 < seen["refused"] < 50
    drawn = {name for name, count in seen.items() if count}
    kinds = {"sphere", "plane", "box", "capsule", "morley", "hinge", "nonlinear", "none", "start", "nested", "bare"}
    assert kinds | set(known.effects) | {"auto", "newton"} <= drawn
