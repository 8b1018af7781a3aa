"""`restshape bench drape`: strategies find an equilibrium of one cloth, or say that they do not; times are not held."""

import json
from pathlib import Path

import pytest

pytestmark = pytest.mark.cli

SCENES = Path(__file__).parents[2] / "scenes"
COARSE = ("--set", 'mesh.size="70 mm"', "--set", "effects.cloth.bending=hinge")
PNG = b"\x89PNG\r\n\x1a\n"


@pytest.mark.slow
def test_ways_bending_and_policies(tmp_path, command):
    words = ("--strategies", "auto,kinetic", "--bending", "nonlinear", "--policies", "auto")
    files = ("--frames", 5, "--json", "a.json", "--picture", "a.png")
    done = command("bench", "drape", SCENES / "sphere.toml", *COARSE, *words, *files)
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "a.json").read_text())
    assert list(found["strategies"]) == ["auto", "kinetic"] and list(found["bending"]) == ["nonlinear"]
    for way in ("auto", "kinetic"):
        entry = found["strategies"][way]
        assert entry["converged"] and entry["stable"] and 0.0 < entry["residual"] <= 1e-4, way
        trace = entry["trace"]
        assert len(trace["seconds"]) == len(trace["residuals"]) == len(trace["energies"]) > entry["steps"]
        # Friction follows after the last iterate of a method: the trace ends where the cloth does.
        assert trace["residuals"][-1] == entry["residual"] and trace["energies"][-1] == entry["energy"]
        assert trace["seconds"] == sorted(trace["seconds"]) and entry["seconds"] >= trace["seconds"][-1]
        # It is laid at the height from which the potential counts, and only sinks; of friction there is no energy then.
        assert entry["initial_energy"] == 0.0 and -(0.7**2) * 0.15 * 9.81 * 0.4 < entry["energy"] < 0.0
    assert min(entry["short"] for entry in found["strategies"].values()) == 0.0
    assert min(entry["factors"] for entry in found["strategies"].values()) > 1
    assert found["policies"]["auto"]["frames"] == found["policies"]["auto"]["converged"] == 2
    for words in (
        "solution strategies from the same start",
        "kinds of bending",
        "policies",
        "short of the best",
        "a.png",
    ):
        assert words in done.stdout
    assert (tmp_path / "a.png").read_bytes().startswith(PNG)


@pytest.mark.slow
# In a process of its own: a solve that is left in its midst stays open in PETSc's log, which then counts no others.
def test_a_run_that_takes_too_long_is_given_up(tmp_path, command, monkeypatch):
    # Beside other work its process takes long to begin: it is not ended before it gives up by itself.
    monkeypatch.setattr("restshape_studies.bench.cloth_strategies.PATIENCE", 100.0)
    words = ("--strategies", "cg", "--bending", "", "--policies", "", "--seconds", 0.1, "--json", "a.json")
    done = command("bench", "drape", SCENES / "pins.toml", *COARSE, *words)
    assert done.returncode == 0, done.stderr
    entry = json.loads((tmp_path / "a.json").read_text())["strategies"]["cg"]
    assert not entry["converged"] and entry["why"] == "0.1 s are over" and entry["short"] is None
    assert entry["trace"]["residuals"][0] == pytest.approx(1.0), "laid flat nothing but the weight acts"


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (("sphere.toml", "--strategies", "auto,fast"), ("fast", "--strategies", "kinetic")),
        (("sphere.toml", "--bending", "cubic"), ("cubic", "morley")),
        (("sphere.toml", "--frames", "1"), ("--frames",)),
        (("plate.toml", "--bending", "", "--strategies", "auto"), ("effects.drape",)),
    ],
)
def test_bad_input(command, words, reported):
    done = command("bench", "drape", SCENES / words[0], *words[1:])
    assert done.returncode == 2 and "Traceback" not in done.stderr
    assert all(word in done.stderr for word in reported)


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
def test_the_study_s_own_scenes_say_what_is_in_openings_and_what_each_way_did(tmp_path, command):
    """Newton's method goes nowhere from flat cloth on nothing, and says so; kinetic damping comes to rest."""
    words = ("--scenes", "mask,curtain", "--ways", "kinetic,cg", "--seconds", 1.5, "--json", "a.json")
    done = command("bench", "drape", *words, "--set", "effects.cloth.bending=hinge")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "a.json").read_text())
    assert list(found) == ["mask", "curtain"] and not found["mask"]["bending"] and not found["mask"]["policies"]
    mask = found["mask"]["strategies"]["kinetic"]
    assert mask["converged"] and mask["kept"] is True and mask["crossings"] == 0 and 0.0 < mask["max_strain"] < 0.05
    assert mask["inside"] == {"1 around peg_left": 1, "2 around peg_right": 1} or mask["inside"] == {
        "1 around peg_right": 1,
        "2 around peg_left": 1,
    }
    assert found["curtain"]["strategies"]["kinetic"]["kept"] is None
    lines = done.stdout.splitlines()
    summary = next(k for k, line in enumerate(lines) if line == "2 scenes")
    kinetic = next(line.split() for line in lines[summary:] if line.startswith("kinetic"))
    assert kinetic[:5] == ["kinetic", "2", "2", "1", "of"]


def test_all_scenes_of_the_study_can_be_read(tmp_path):
    from restshape_studies.verification import verifications

    from restshape.scene.load import load_scene

    known = {name: one for each in verifications().values() for name, one in each.load_drapes().items()}
    assert len(known) >= 20
    for name, one in known.items():
        path = tmp_path / f"{name}.toml"
        path.write_text(one if isinstance(one, str) else one.read_text())
        load_scene(path)


@pytest.mark.parametrize("words", [("--scenes", "tent"), ("sphere", "--scenes", "mask")])
def test_scenes_that_are_not_known_or_twice_named_are_refused(command, words):
    done = command("bench", "drape", *words)
    assert done.returncode == 2 and "--scenes" in done.stderr and "Traceback" not in done.stderr


def test_all_strategies_that_scenes_may_name_are_compared():
    from typing import get_args

    from restshape_studies.bench.cloth_strategies import STRATEGIES

    from restshape.physics.cloth.effects import DrapeKeys

    assert get_args(DrapeKeys.model_fields["strategy"].annotation) == STRATEGIES


def test_waiting_for_the_processor_is_no_work_of_a_run(monkeypatch):
    """What is taken down takes long by the clock where others have the processor: that is not taken off the work."""
    from types import SimpleNamespace

    import numpy as np
    from restshape_studies.bench import drape

    clock, worked = iter(range(0, 1000, 5)), iter(range(100))
    monkeypatch.setattr(drape, "perf_counter", lambda: float(next(clock)))
    monkeypatch.setattr(drape, "process_time", lambda: float(next(worked)))
    problem = SimpleNamespace(softness=1.0, energy=lambda x: 0.0)
    trace = drape.Trace(SimpleNamespace(bound=SimpleNamespace(problem=problem)), limit=1e3)
    for _ in range(3):
        trace(SimpleNamespace(problem=problem), np.zeros((2, 3)), 1.0)
    # Of each second that the processor has worked one in three was for what is taken down.
    assert trace.busy > 0.0
