"""A hand in the template of each application: what is seen live is what replays."""

import json

import pytest
from live_worker import LocalSession, cut, replayed

import restshape
from restshape.application import applications

ROLES = ("plank", "body", "hole", "vertex")
"""Of what is taken hold of, the first that there is."""
WITHOUT_UNIT = {"utilisation", "valid"}
"""Fields of numbers; modes have no size of their own."""
TEMPLATES = {name: one.folder / "template" / "scene.toml" for name, one in sorted(applications().items())}
SHIPPED = [name for name, path in TEMPLATES.items() if path.exists()]


def test_applications_have_templates():
    assert len(SHIPPED) >= 9


@pytest.mark.parametrize("name", SHIPPED)
def test_the_script_of_a_session_replays_to_its_rows(name, tmp_path):
    scene = restshape.load(TEMPLATES[name])
    session = LocalSession(scene, out := tmp_path / "session.jsonl")
    (welcome,) = session.of("welcome")
    labels = [one["label"] for one in welcome["fields"]]
    assert len({*labels}) == len(labels)
    assert {one["name"] for one in welcome["fields"] if not one["unit"] and "mode" not in one["name"]} <= WITHOUT_UNIT
    thing = min((one for one in welcome["things"] if one["role"] in ROLES), key=lambda one: ROLES.index(one["role"]))
    assert (thing["part"], "points") in session.arrays
    (frame,) = session.event("press", on=thing["name"])
    place = frame["held"]["at"]
    for step in (1, 2):
        session.event("drag", to=[place[0] + 2e-4 * step, *place[1:]])
    session.event("release")
    session.rest()
    session.event("undo")
    session.rest()
    session.end()
    assert not session.of("lost") and not session.of("refused")
    assert [cut(row) for row in session.rows()] == replayed(scene, out)


def test_cloth_that_comes_to_rest_is_in_the_script_frame_by_frame(tmp_path):
    cloth = next(path for path in TEMPLATES.values() if path.exists() and "[bodies." in path.read_text())
    few = ("mesh.size='50 mm'", "mesh.levels=1", "effects.drape.levels=1", "effects.drape.steps=3")
    scene = restshape.load(cloth, *few)
    session = LocalSession(scene, out := tmp_path / "session.jsonl")
    assert not session.live.settled
    for frames in (1, 2):
        session.worker.next()
        session.drain()
        # As it would be if the process were killed now.
        assert json.loads(out.read_text().splitlines()[-1]) == {"t": 0.0, "do": "idle", "frames": frames}
        assert json.loads(session.of("resting")[-1]["line"])["frames"] == frames
        assert [cut(row) for row in session.rows()] == replayed(scene, out)
    session.event("set", key="effects.gravity.g", value=[0, 0, -9.0])
    assert [json.loads(line)["do"] for line in out.read_text().splitlines()[1:]] == ["idle", "set"]
    session.end()
