"""A hand in the template of each application: what is seen live is what replays."""

import pytest
from live_worker import LocalSession, cut, replayed

import restshape
from restshape.application import applications

ROLES = ("plank", "body", "hole", "vertex")
"""Of what is taken hold of, the first that there is."""
TEMPLATES = {name: one.folder / "template" / "scene.toml" for name, one in sorted(applications().items())}
SHIPPED = [name for name, path in TEMPLATES.items() if path.exists()]


def test_applications_have_templates():
    assert len(SHIPPED) >= 9


@pytest.mark.parametrize("name", SHIPPED)
def test_the_script_of_a_session_replays_to_its_rows(name, tmp_path):
    scene = restshape.load(TEMPLATES[name])
    session = LocalSession(scene, out := tmp_path / "session.jsonl")
    (welcome,) = session.of("welcome")
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
