"""Reuse verification of motion: the steps of a frame repeated from its first state notice what goes wrong in them."""

from dataclasses import replace

import numpy as np
import pytest
from large import LARGE
from small_scenes import make_replay, write_script
from vibrating import DAMPED, SHAKEN, dynamics, tower

from restshape.analysis.effective_system import EffectiveSystem
from restshape.analysis.motion import transient
from restshape.analysis.motion.motion_equations import MotionEquations
from restshape.analysis.motion.nonlinear_transient import NonlinearTransientAnalysis
from restshape.analysis.motion.transient import TransientAnalysis
from restshape.analysis.motion.transient_state import TransientState
from restshape.fem.time_integration import Newmark, Rayleigh
from restshape.replay.parity import Parity

SOFT = "\n[effects.solid]\nmodel = 'plane_strain'\n"
EVENTS = [{"do": "idle", "frames": 2}, {"do": "rotate", "on": "window", "by": 0.1, "frames": 2}]


def summary(folder, law):
    """The summary of the reuse verification of a shaken tower whose window moves."""
    parts = (SOFT, law, SHAKEN, DAMPED, dynamics(0.01, 3))
    made = make_replay(tower(folder, *parts, size=0.34, window=True), write_script(folder, EVENTS))
    check = Parity(made)
    for row in made.frames():
        check()
        if row["index"] == 0:
            X = made.analysis.space.X
            made.analysis.begin(0.02 * X * X[:, 1:], 0.3 * X[:, ::-1] * X[:, 1:])
    return check.summary()


laws = pytest.mark.parametrize("law", ["", LARGE], ids=["linear", "large"])


@laws
def test_motion_is_repeated_in_every_frame_but_the_first(tmp_path, law):
    found = summary(tmp_path, law)
    assert found["holds"] and found["frames"] == 5 and found["left_out"] == {"without a step or a load": 1}
    assert found["compared"] == {"level 1": 2, "still": 2} and found["solution"] < 1e-11


@laws
@pytest.mark.parametrize("share", [0.5, 1 - 1e-7])
@pytest.mark.parametrize("what", ["y", "v"])
def test_a_step_whose_result_is_scaled_is_noticed(tmp_path, monkeypatch, law, share, what):
    after = Newmark.after

    def scaled(self, state, y):
        made = after(self, state, y)
        return made._replace(**{what: share * getattr(made, what)})

    monkeypatch.setattr(Newmark, "after", scaled)
    assert not summary(tmp_path, law)["holds"]


@laws
@pytest.mark.parametrize("what", ["y", "v"])
def test_a_state_that_is_scaled_between_frames_is_noticed(tmp_path, monkeypatch, law, what):
    started = TransientState.started

    def scaled(self, before):
        now = self.now._replace(**{what: 0.5 * getattr(self.now, what)})
        return started(replace(self, now=now) if before is not None and before.bound is not None else self, before)

    monkeypatch.setattr(TransientState, "started", scaled)
    assert not summary(tmp_path, law)["holds"]


@laws
@pytest.mark.parametrize("part", ["alpha", "beta"])
def test_damping_that_is_dropped_is_noticed(tmp_path, monkeypatch, law, part):
    def undamped(body):
        damping = {"alpha": body.damping_of.alpha, "beta": body.damping_of.beta, part: 0.0}
        body.damping_of = Rayleigh(**damping)
        return body

    binds = MotionEquations.__init__ if law else EffectiveSystem.bind

    def bind(self, body, *more):
        binds(self, undamped(body), *more)

    monkeypatch.setattr(*((MotionEquations, "__init__") if law else (EffectiveSystem, "bind")), bind)
    assert not summary(tmp_path, law)["holds"]


@laws
def test_a_base_that_stands_still_is_noticed(tmp_path, monkeypatch, law):
    owner = NonlinearTransientAnalysis if law else TransientAnalysis
    step = owner._step

    def on_still_ground(self, *words):
        integration = self.state.integration
        self.state = replace(self.state, in_time=replace(integration, excitation=None))
        report = step(self, *words)
        self.state = replace(self.state, in_time=integration)
        return report

    monkeypatch.setattr(owner, "_step", on_still_ground)
    assert not summary(tmp_path, law)["holds"]


def test_no_formula_of_the_steps_is_shared(monkeypatch, tmp_path):
    """Steps are repeated with neither the scheme's coefficients nor its update."""
    made = make_replay(tower(tmp_path, SHAKEN, dynamics(0.01, 3), size=0.34), write_script(tmp_path, EVENTS[:1]))
    for _ in made.frames():
        pass
    now = made.analysis.state.now

    def unused(*_):
        raise AssertionError("a step is repeated by its own formula")

    for name in ("a2", "a3", "a4", "a5"):
        monkeypatch.setattr(Newmark, name, property(unused))
    monkeypatch.setattr(Newmark, "after", unused)
    monkeypatch.setattr(transient, "EffectiveSystem", unused)
    assert made.analysis.compare_cold().solution < 1e-11
    assert made.analysis.state.now is now and np.abs(now.y).max() > 0
