"""Vibration where it is hard: shaken on the resonance, a window that jumps, several ranks."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from small_scenes import drag, make_replay, rows_of, write_script
from vibrating import SHAKEN, dynamics, idle, tower

from restshape.analysis.frequencies import lowest_modes
from restshape.analysis.harmonic import harmonic_response


def shaken_on_resonance(replay, dt):
    """First mode's w, its weights M phi over free unknowns, participation, and the angle of a step at its resonance."""
    analysis = replay.analysis
    free = ~analysis.body.held.ravel()
    stiffness, mass, _ = analysis.matrices()
    (omega,), phi = lowest_modes(stiffness, mass, 1)
    angle = 2 * np.arctan(0.5 * omega * dt)
    uniform = analysis.body.inertia.apply(np.tile([1.0, 0.0], (len(free) // 2, 1))).ravel()[free]
    amplitude = 0.7
    analysis.ground = SimpleNamespace(acceleration=lambda t: np.array([amplitude * np.sin(angle * t / dt), 0.0]))
    return omega, mass @ phi[:, 0], amplitude * float(phi[:, 0] @ uniform), angle


def test_undamped_resonance_grows_as_the_closed_form_does(tmp_path):
    """q_n = B n dt cos(n a) + D sin(n a), from rest, on the resonance of the discrete motion, over 100 periods.

    The average acceleration obeys (1 + s^2)(q+ + q-) - 2 (1 - s^2) q = dt^2/4 (f+ + 2 f + f-), s = w dt/2 = tan(a/2),
    which for f = -F sin(n a) gives B = F / (2 w (1 + s^2)); q_1 = dt^2/4 f_1 / (1 + s^2) gives D.
    """
    dt = 0.02
    replay = make_replay(tower(tmp_path, dynamics(dt, 1)))
    rows_of(replay)
    omega, weight, load, angle = shaken_on_resonance(replay, dt)
    analysis, s = replay.analysis, 0.5 * omega * dt
    free = ~analysis.body.held.ravel()
    rate = load / (2 * omega * (1 + s**2))
    first = -(dt**2) / 4 * load * np.sin(angle) / (1 + s**2)
    phase = (first - rate * dt * np.cos(angle)) / np.sin(angle)
    steps = int(100 * 2 * np.pi / angle)
    for n in range(1, steps + 1):
        idle(replay)
        exact = rate * n * dt * np.cos(n * angle) + phase * np.sin(n * angle)
        q = weight @ analysis.x.ravel()[free]
        assert q == pytest.approx(exact, abs=1e-8 * rate * n * dt + 1e-9 * abs(first))
    assert np.all(np.isfinite(analysis.x))
    assert np.abs(analysis.x).max() > 0.5


def test_damped_resonance_settles_at_the_harmonic_response(tmp_path):
    dt = 0.004
    damping = "\n[effects.damping]\nratio = 0.02\nfrequencies = [3, 30]\n"
    replay = make_replay(tower(tmp_path, damping, dynamics(dt, 25)), overrides=["solve.tolerance=1e-9"])
    rows_of(replay)
    omega = shaken_on_resonance(replay, dt)[0]
    analysis = replay.analysis
    analysis.ground = SimpleNamespace(acceleration=lambda t: np.array([0.7 * np.sin(omega * t), 0.0]))
    peaks = []
    for _ in range(int(10 / (0.02 * omega) / (25 * dt))):
        idle(replay)
        peaks.append(analysis.observe()["amplitude"])
    free = ~analysis.body.held.ravel()
    uniform = analysis.body.inertia.apply(np.tile([1.0, 0.0], (len(free) // 2, 1))).ravel()[free]
    response = np.zeros(free.size, dtype=complex)
    response[free] = harmonic_response(*analysis.matrices(), omega, -0.7 * uniform)
    node = replay.moving.mesh.nodes_of("c")[0]
    period = int(np.ceil(2 * np.pi / omega / (25 * dt)))
    assert max(peaks[-2 * period :]) == pytest.approx(abs(response[2 * node]), rel=0.01)
    assert max(peaks) < 1.05 * abs(response[2 * node])


def test_a_window_may_jump_by_two_fifths_of_the_body(tmp_path):
    """One frame moves the window by 0.8 m of 2 m: the motion goes on, and its energy is accounted for."""
    events = [{"do": "idle", "frames": 2}, *drag("window", (0.5, 1.4), [(0.5, 0.6)]), {"do": "idle", "frames": 20}]
    replay = make_replay(tower(tmp_path, dynamics(0.01, 10), window=True), write_script(tmp_path, events))
    left = []
    for row in replay.frames():
        if row["index"] == 0:
            X = replay.moving.mesh.X
            replay.analysis.begin(0.05 * X * X[:, 1:], 0.3 * X[:, ::-1] * X[:, 1:])
            start = replay.analysis.energy()
            continue
        assert not row["refused"]
        left.append(row["q_energy"] - row["q_edit"] - row["q_remesh"])
    assert np.abs(np.array(left) / start - 1).max() < 1e-9
    assert replay.row["q_energy"] < 5 * start
    assert abs(replay.row["q_sway"]) < 1.0


@pytest.mark.parametrize("steps", [1, 10])
def test_two_ranks_give_what_one_gives(restshape, tmp_path, steps):
    scene = tower(tmp_path, SHAKEN, dynamics(0.01, steps), window=True)
    path = [(0.5, 1.4 - 0.04 * k) for k in range(1, 16)]
    script = write_script(tmp_path, drag("window", (0.5, 1.4), path))
    found = []
    for ranks in (1, 2):
        done = restshape("replay", scene, "--edits", script, "--parity", "--json", f"{ranks}.json", ranks=ranks)
        assert done.returncode == 0, done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text()))
    for name in ("sway", "amplitude", "energy"):
        one, two = (np.array(summary["quantities"][name]) for summary in found)
        assert np.abs(one - two).max() < 1e-8 * np.abs(one).max()
    assert found[0]["levels"]["1"] > 0 and found[0]["quantities"]["edit"] == pytest.approx(
        found[1]["quantities"]["edit"], rel=1e-6, abs=1e-9
    )
