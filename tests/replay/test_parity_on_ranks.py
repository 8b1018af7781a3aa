"""Reuse equals rebuild on two ranks as on one: a scene of each application; rates of convergence on two and four."""

import json

import pytest
from test_parity import shortened, smaller

from restshape.application import applications

pytestmark = pytest.mark.slow

SCENES = ("bridge", "cantilever", "sphere", "flow", "shelf-1", "square", "column", "fins", "frame")
"""One of each application, whose frames are few; plates and bars are in files of their own."""
EVERY_DAY = ("fins",)


def shipped():
    """The applications that are installed with scenes, but those of the tests."""
    known = applications().values()
    return [app for app in known if app.scenes() and not any("tests" in path.parts for path in app.scenes())]


def test_every_application_has_a_scene():
    assert all(any(path.stem in SCENES for path in app.scenes()) for app in shipped())


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name in EVERY_DAY else [pytest.mark.weekly]) for name in SCENES]
)
def test_parity_on_two_ranks(tmp_path, on_ranks, name):
    scene = next(path for app in shipped() for path in app.scenes() if path.stem == name)
    script = shortened(tmp_path, scene)
    words = [scene, *([script] if script else []), *(word for key in smaller(scene) for word in ("--set", key))]
    done = on_ranks(2, "replay", *words, "--parity", "--json", "a.json")
    assert done.returncode == 0, done.stdout + done.stderr
    found = json.loads((tmp_path / "a.json").read_text())
    assert found["ranks"] == 2 and found["parity"]["holds"] and sum(found["parity"]["compared"].values()) > 0


@pytest.mark.weekly
@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [2, 4])
def test_rates_of_convergence(tmp_path, restshape, ranks):
    cases = ("solid.manufactured", "solid.quadratic_rates")
    words = [word for case in cases for word in ("--case", case)]
    done = restshape("validate", *words, "--json", "v.json", ranks=ranks)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = json.loads((tmp_path / "v.json").read_text())
    assert {row["case"] for row in rows} == set(cases) and all(row["passed"] for row in rows)
