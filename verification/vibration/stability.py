"""Hard cases of bodies that vibrate: shaken on the resonance, a window that jumps, long and stiff, few elements."""

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from restshape_studies.stability.case import Case, Row, Statement, Trial, below, near, true, valid
from restshape_studies.stability.known_bounds import DIRECT, drifted
from restshape_studies.stability.scenery import across, block, drag
from restshape_studies.stability.towers import FOOT, QUANTITIES, RUBBER, SHAKEN, dynamics
from restshape_verification.vibration.hard_scenes import HEAD, tower

from restshape.analysis.modal.frequencies import lowest_modes
from restshape.analysis.motion.harmonic import harmonic_response
from restshape.policy import POLICIES
from restshape.replay.loop import Replay

LARGE = "\n[effects.large_deformation]\n"
GRAVITY = "\n[effects.gravity]\ng = [0, -9.81]\n"


def shake(made: Replay, dt: float) -> tuple[float, np.ndarray, float, float]:
    """Shakes a body on the resonance of its discrete motion.

    Returns: first mode's w, its weights M phi over free unknowns, its load, and the angle of a step at its resonance.
    """
    analysis = made.analysis
    free = ~analysis.body.constrained.ravel()
    stiffness, mass, _ = analysis.matrices()
    (omega,), phi = lowest_modes(stiffness, mass, 1)
    angle = 2 * np.arctan(0.5 * omega * dt)
    uniform = analysis.body.mass.apply(np.tile([1.0, 0.0], (len(free) // 2, 1))).ravel()[free]
    amplitude = 0.7
    analysis.set_integration(
        excitation=SimpleNamespace(acceleration=lambda t: np.array([amplitude * np.sin(angle * t / dt), 0.0]))
    )
    return omega, mass @ phi[:, 0], amplitude * float(phi[:, 0] @ uniform), angle


def undamped_resonance(trial: Trial) -> Iterator[Statement]:
    """A tower shaken on its resonance without damping, over 100 periods, grows as the closed form does.

    q_n = B n dt cos(n a) + D sin(n a), from rest. The average acceleration obeys (1 + s^2)(q+ + q-) - 2 (1 - s^2) q =
    dt^2/4 (f+ + 2 f + f-), s = w dt/2 = tan(a/2), which for f = -F sin(n a) gives B = F / (2 w (1 + s^2));
    q_1 = dt^2/4 f_1 / (1 + s^2) gives D.
    """
    dt, steps = 0.02, 2500
    run = trial.replay(tower(trial.folder, dynamics(dt, 1)), [{"do": "idle", "frames": steps}])
    made = run.replay
    frames = run.rows()
    next(frames)
    omega, weight, load, angle = shake(made, dt)
    analysis, s = made.analysis, 0.5 * omega * dt
    free = ~analysis.body.constrained.ravel()
    rate = load / (2 * omega * (1 + s**2))
    first = -(dt**2) / 4 * load * np.sin(angle) / (1 + s**2)
    phase = (first - rate * dt * np.cos(angle)) / np.sin(angle)
    worst, largest = 0.0, 0.0
    for n in range(1, min(steps, int(100 * 2 * np.pi / angle)) + 1):
        next(frames)
        exact = rate * n * dt * np.cos(n * angle) + phase * np.sin(n * angle)
        error = abs(float(weight @ analysis.x.ravel()[free]) - exact)
        # Directly after the start there is hardly any motion yet.
        worst = max(worst, error / (rate * n * dt + 0.1 * abs(first)))
        largest = max(largest, float(np.abs(analysis.x).max()))
    yield below("error of the first mode, relative to its growth", worst, drifted(steps))
    yield true("it has grown, and is finite", bool(0.5 < largest < np.inf), largest)


def damped_resonance(trial: Trial) -> Iterator[Statement]:
    """A damped tower shaken on its resonance settles at the harmonic response."""
    dt = 0.004
    damping = "\n[effects.damping]\nratio = 0.02\nfrequencies = [3, 30]\n"
    scene = tower(trial.folder, damping, dynamics(dt, 25))
    run = trial.replay(scene, [{"do": "idle", "frames": 2000}], ["solve.tolerance=1e-9"])
    made = run.replay
    frames = run.rows()
    next(frames)
    omega = shake(made, dt)[0]
    analysis = made.analysis
    analysis.set_integration(
        excitation=SimpleNamespace(acceleration=lambda t: np.array([0.7 * np.sin(omega * t), 0.0]))
    )
    peaks = [next(frames)["q_amplitude"] for _ in range(int(10 / (0.02 * omega) / (25 * dt)))]
    free = ~analysis.body.constrained.ravel()
    uniform = analysis.body.mass.apply(np.tile([1.0, 0.0], (len(free) // 2, 1))).ravel()[free]
    response = np.zeros(free.size, dtype=complex)
    response[free] = harmonic_response(*analysis.matrices(), omega, -0.7 * uniform)
    wanted = abs(response[2 * made.moving.mesh.nodes_of("c")[0]])
    period = int(np.ceil(2 * np.pi / omega / (25 * dt)))
    yield near("amplitude once settled is that of the response", max(peaks[-2 * period :]), wanted, 0.01)
    yield below("largest amplitude over that", max(peaks) / wanted, 1.05)


def _swung(trial: Trial, scene: Path, events: list[dict]) -> tuple[list[Row], list[float], float, Replay]:
    """The rows of a replay that begins with a swing, its energy less what edits and meshes added, and the first one."""
    run = trial.replay(scene, events)
    made = run.replay
    rows, left, start = [], [], 0.0
    for row in run.rows():
        rows.append(dict(row))
        if row["index"] == 0:
            X = made.analysis.space.X
            made.analysis.begin(0.05 * X * X[:, 1:], 0.3 * X[:, ::-1] * X[:, 1:])
            start = made.analysis.energy()
        else:
            left.append(row["q_energy"] - row["q_edit"] - row["q_remesh"])
    return rows, left, start, made


def window_jumps(trial: Trial) -> Iterator[Statement]:
    """A window jumps by two fifths of a swinging tower in one frame: its energy is accounted for."""
    events = [{"do": "idle", "frames": 2}, *drag("window", (0.5, 1.4), [(0.5, 0.6)]), {"do": "idle", "frames": 20}]
    scene = tower(trial.folder, dynamics(0.01, 10), window=True)
    rows, left, start, _ = _swung(trial, scene, events)
    yield near("energy less the work of edits and meshes is conserved", left, start, DIRECT)
    yield below("energy at the end over the first", rows[-1]["q_energy"] / start, 5)
    yield below("sway at the end [m]", abs(rows[-1]["q_sway"]), 1.0)
    yield from valid(rows)


def long_swing(trial: Trial) -> Iterator[Statement]:
    """10,000 frames of a tower that swings while its window goes round: energy is conserved but for the edits."""
    frames = trial.count(10_000, 200)
    turn = 2 * np.pi / 300
    path = [(0.5 + 0.1 * np.sin(k * turn), 1.3 + 0.1 * np.cos(k * turn)) for k in range(1, frames + 1)]
    scene = tower(trial.folder, dynamics(0.01, 1), window=True, size=0.3)
    events = drag("window", (0.5, 1.4), path)
    rows, left, start, _ = _swung(trial, scene, events)
    largest = max(row["q_energy"] for row in rows[1:])
    drift = float(np.abs(np.array(left) - start).max()) / max(start, largest)
    yield below(
        "drift of the energy less the work of edits, over the largest energy",
        drift,
        drifted(frames),
    )
    yield from valid(rows)


def ground_shaken_long_steps(trial: Trial) -> Iterator[Statement]:
    """Time steps a hundred times as long as the fastest mode's period: the average acceleration stays bounded."""
    scene = tower(trial.folder, SHAKEN, dynamics(0.37, 4))
    rows = trial.rows(scene, [{"do": "idle", "frames": trial.count(300, 60)}])
    yield below("sway [m]", max(abs(row["q_sway"]) for row in rows), 1.0)
    yield from valid(rows)


def few(trial: Trial) -> Iterator[Statement]:
    """A tower of a handful of triangles, of either order, lumped and consistent, swings and is dragged."""
    for order, mass in ((1, "consistent"), (1, "lumped"), (2, "consistent")):
        text = HEAD + block(1.0, 2.0) + RUBBER + FOOT + f"\n[mesh]\nsize = 4.0\norder = {order}\n"
        text += dynamics(0.01, 5, mass=mass) + QUANTITIES
        events = [*drag("top", (0.5, 2.0), across((0.5, 2.0), (0.6, 2.2), 6)), {"do": "idle", "frames": 10}]
        scene = trial.folder / f"few{order}{mass}.toml"
        scene.write_text(text)
        rows, left, start, _ = _swung(trial, scene, events)
        yield below(f"elements (order {order}, {mass})", rows[0]["elements"], 12)
        yield near(f"energy less the work of edits is conserved (order {order}, {mass})", left, start, DIRECT)
        yield from valid(rows)


def dropped_gravity(trial: Trial) -> Iterator[Statement]:
    """Gravity acts at once on a soft beam of large deformation, whose end is dragged while it falls."""
    text = HEAD + block(1.0, 0.1) + '\n[material.m]\nE = "1 MPa"\nnu = 0.3\nrho = 1000\n' + LARGE + GRAVITY
    text += '\n[effects.solid]\nmodel = "plane_strain"\n[supports.wall]\non = "left"\nfix = ["x", "y"]\n'
    text += "\n[mesh]\nsize = 0.05\n" + dynamics(0.005, 2).replace("1e-12", "1e-8") + QUANTITIES
    events = [{"do": "idle", "frames": 20}, *drag("right", (1.0, 0.05), across((1.0, 0.05), (1.2, 0.05), 20))]
    rows = trial.rows(text, events)
    yield below("fall of the tip [m]", max(abs(row["q_sway"]) for row in rows), 2.5)
    yield from valid(rows)


CASES: dict[str, Any] = {
    "undamped_resonance": Case(undamped_resonance),
    "damped_resonance": Case(damped_resonance, weekly=("auto",)),
    "window_jumps": Case(window_jumps, tuple(POLICIES)),
    "long_swing": Case(long_swing, share=0.03),
    "long_steps": Case(ground_shaken_long_steps, share=0.2),
    "few": Case(few),
    "dropped_gravity": Case(dropped_gravity),
}
