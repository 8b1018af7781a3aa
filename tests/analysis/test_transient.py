"""Transient analysis: Newmark's steps against a textbook's, energy under edits, velocities on new meshes."""

import numpy as np
import pytest
from scipy.sparse.linalg import eigs, spsolve
from small_scenes import across, drag, make_replay, rows_of, write_script
from vibrating import DAMPED, SHAKEN, dynamics, idle, textbook_newmark, tower

from restshape.analysis.modal.frequencies import lowest_modes
from restshape.analysis.motion.velocity_projection import project_velocity
from restshape.fem.assembled import Assembled
from restshape.fem.problem import INTERNAL
from restshape.fem.residuals import dead_loads
from restshape.replay.parity import Parity

PULLED = "\n[loads.pull]\non = 'right'\ntraction = ['300 Pa', '-100 Pa']\n"
WEIGHT = "\n[loads.weight]\non = 'all'\nbody = ['20*y', -9810]\n"
DOWN = drag("window", (0.5, 1.4), across((0.5, 1.4), (0.55, 0.6), 24))


@pytest.mark.parametrize("mass", ["consistent", "lumped"])
@pytest.mark.parametrize(("beta", "gamma"), [(0.25, 0.5), (0.3025, 0.6), (0.3, 0.5)])
@pytest.mark.parametrize("steps", [1, 12])
def test_steps_are_those_of_the_textbook(tmp_path, mass, beta, gamma, steps):
    """u and v after 12 steps under ground acceleration, damping, tractions and weight, in one frame or in twelve."""
    scene = tower(tmp_path, SHAKEN, DAMPED, PULLED, WEIGHT, dynamics(0.013, steps, beta=beta, gamma=gamma, mass=mass))
    replay = make_replay(scene)
    rows_of(replay)
    for _ in range(12 // steps):
        idle(replay)
    analysis, body = replay.analysis, replay.analysis.body
    free = ~body.constrained.ravel()
    direction = np.array([2.0, 1.0]) / np.sqrt(5)
    uniform = body.mass.apply(np.tile(direction, (len(free) // 2, 1))).ravel()[free]
    static = np.zeros_like(body.static)
    dead_loads(body.problem, static)
    static -= Assembled(body.problem.integrals(INTERNAL)).residual(np.zeros_like(static))

    def force(t: float) -> np.ndarray:
        return static.ravel()[free] - 3.0 * np.sin(2 * np.pi * 4.0 * t) * uniform

    u, v = textbook_newmark(analysis.matrices(), force, 0.013, beta, gamma, 12)
    assert analysis.time == pytest.approx(12 * 0.013)
    assert np.abs(analysis.x.ravel()[free] - u).max() < 1e-8 * np.abs(u).max()
    assert np.abs(analysis.v.ravel()[free] - v).max() < 1e-8 * np.abs(v).max()
    assert np.all(analysis.x.ravel()[~free] == 0)


def test_steady_motion_is_the_discrete_harmonic_response(tmp_path):
    """Once the start has died down, U = (K - s^2 M + i s C)^-1 F with s = (2/dt) tan(w dt/2), at every step."""
    dt, omega = 0.01, 2 * np.pi * 4.0
    replay = make_replay(tower(tmp_path, SHAKEN, "\n[effects.damping]\nalpha = 20\nbeta = 2e-3\n", dynamics(dt, 50)))
    rows_of(replay)
    for _ in range(8):
        idle(replay)
    analysis, body = replay.analysis, replay.analysis.body
    analysis.set_integration(steps=1)
    free = ~body.constrained.ravel()
    stiffness, mass, damping = analysis.matrices()
    s = 2 / dt * np.tan(0.5 * omega * dt)
    uniform = body.mass.apply(np.tile(np.array([2.0, 1.0]) / np.sqrt(5), (len(free) // 2, 1))).ravel()[free]
    response = spsolve((stiffness - s**2 * mass + 1j * s * damping).tocsc(), -3.0 * uniform + 0j)
    for _ in range(30):
        idle(replay)
        exact = (response * np.exp(1j * omega * analysis.time)).imag
        assert np.abs(analysis.x.ravel()[free] - exact).max() < 1e-8 * np.abs(response).max()


def test_energy_changes_by_the_work_of_edits_alone(tmp_path):
    """E less sum (u.dK u + v.dM v)/2 is constant while a window moves: level 1, from the matrices themselves."""
    script = write_script(tmp_path, drag("window", (0.5, 1.4), across((0.5, 1.4), (0.5, 1.32), 12)))
    replay = make_replay(tower(tmp_path, dynamics(0.02, 7), window=True), script)
    work, energies, last = 0.0, [], None
    for row in replay.frames():
        analysis = replay.analysis
        free = ~analysis.body.constrained.ravel()
        if row["index"] == 0:
            X = replay.moving.mesh.X
            analysis.begin(0.02 * X * X[:, 1:], 0.3 * X[:, ::-1] * X[:, 1:])
        stiffness, mass, _ = analysis.matrices()
        if last is not None:
            (u, v), (K, M) = last
            work += 0.5 * (u @ ((stiffness - K) @ u) + v @ ((mass - M) @ v))
            assert row["level"] in (0, 1)
        state = analysis.x.ravel()[free], analysis.v.ravel()[free]
        energies.append(0.5 * (state[0] @ (stiffness @ state[0]) + state[1] @ (mass @ state[1])) - work)
        last = state, (stiffness, mass)
    assert abs(work) > 1e-4 * energies[0]
    assert replay.row["q_edit"] == pytest.approx(work, rel=1e-9)
    assert np.abs(np.array(energies) / energies[0] - 1).max() < 1e-9


def test_energy_is_accounted_for_through_flips_and_new_meshes(tmp_path):
    """Total less what edits and new meshes did stays what it was at the start."""
    replay = make_replay(tower(tmp_path, dynamics(0.02, 5), window=True), write_script(tmp_path, DOWN))
    levels, left = set(), []
    for row in replay.frames():
        if row["index"] == 0:
            X = replay.moving.mesh.X
            replay.analysis.begin(0.02 * X * X[:, 1:], 0.3 * X[:, ::-1] * X[:, 1:])
            start = replay.analysis.energy()
            continue
        levels.add(row["level"])
        left.append(row["q_energy"] - row["q_edit"] - row["q_remesh"])
    assert {1, 3} <= levels
    assert np.abs(np.array(left) / start - 1).max() < 1e-9


def test_velocities_keep_their_momentum_on_a_new_mesh(tmp_path):
    coarse, fine = (make_replay(tower(tmp_path, dynamics(), size=size, window=True)) for size in (0.2, 0.13))
    for replay in (coarse, fine):
        rows_of(replay)
    old, new = coarse.analysis.body.mass, fine.analysis.body.mass
    X = coarse.moving.mesh.X
    v = np.column_stack([np.sin(X[:, 1]), X[:, 0] * X[:, 1] ** 2]) * X[:, 1:]
    projected = project_velocity(old, new, v)
    mesh = fine.moving.mesh
    corners = projected[mesh.cells].mean(axis=1)
    p, q = (mesh.X[mesh.cells[:, k]] - mesh.X[mesh.cells[:, 0]] for k in (1, 2))
    mass = 1000 * 0.1 * 0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
    assert mass @ corners == pytest.approx(old.momentum(v), rel=1e-12)
    Y = mesh.X
    exact = np.column_stack([np.sin(Y[:, 1]), Y[:, 0] * Y[:, 1] ** 2]) * Y[:, 1:]
    assert np.abs(projected - exact).max() < 0.03 * np.abs(exact).max()
    assert np.all(projected[fine.analysis.body.constrained] == 0)


def test_velocities_stay_on_the_same_mesh(tmp_path):
    replay = make_replay(tower(tmp_path, dynamics()))
    rows_of(replay)
    inertia, X = replay.analysis.body.mass, replay.moving.mesh.X
    v = np.where(replay.analysis.body.constrained, 0.0, np.sin(5 * X) + X[:, ::-1])
    assert np.abs(project_velocity(inertia, inertia, v) - v).max() < 1e-12


def test_the_consistent_mass_is_that_of_the_mesh_as_it_lies(tmp_path):
    replay = make_replay(tower(tmp_path, dynamics()))
    rows_of(replay)
    body = replay.analysis.body
    X, at_first = body.mass.space.X, body.mass.space.X.copy()
    w = np.where(body.constrained, 0.0, np.sin(5 * at_first))
    for stretch in (1.0, 1.3, 1.0):
        # As a frame does that is taken back: versions stay.
        X[:] = stretch * at_first
        assert body.mass.solve(body.mass.apply(w), consistent=True) == pytest.approx(w, abs=1e-12)


def test_lowest_modes_of_a_bar_that_stretches(tmp_path):
    """A bar without Poisson's effect, held sideways: discrete frequencies of linear elements, consistent mass.

    On the mesh of two rows of triangles the first axial mode lies between the bar's own and the coarse mesh's:
    w = (pi / 2) sqrt(E / rho) / L within (k h)^2 / 24 of it, for a mode that does not vary across.
    """
    sideways = "\n[supports.sides]\non = ['left', 'right']\nfix = ['x']\n"
    replay = make_replay(tower(tmp_path, sideways, dynamics(), size=0.05), overrides=["material.rubber.nu=0"])
    rows_of(replay)
    stiffness, mass, _ = replay.analysis.matrices()
    omega, modes = lowest_modes(stiffness, mass, 2)
    exact = 0.5 * np.pi * np.sqrt(2e6 / 1000) / 2.0
    nearest = omega[np.argmin(abs(omega - exact))]
    assert nearest == pytest.approx(exact, rel=2e-3)
    assert modes.T @ (mass @ modes) == pytest.approx(np.eye(2), abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["auto", "thesis", "refactor", "rebuild"])
@pytest.mark.parametrize("steps", [1, 3, 20])
def test_parity_with_cold_solves(tmp_path, policy, steps):
    scene = tower(tmp_path, SHAKEN, DAMPED, dynamics(0.01, steps), window=True)
    replay = make_replay(scene, write_script(tmp_path, DOWN), policy, ["solve.tolerance=1e-8"])
    parity = Parity(replay)
    rows_of(replay, lambda row: parity())
    assert parity.summary()["holds"], parity.summary()


def test_policies_that_keep_the_mesh_give_the_same_motion(tmp_path):
    """Old factors and guesses change the cost alone: `auto` follows `refactor` through flips and new meshes."""
    scene, script = tower(tmp_path, SHAKEN, DAMPED, dynamics(0.01, 3), window=True), write_script(tmp_path, DOWN)
    sway = {}
    for policy in ("auto", "refactor"):
        sway[policy] = np.array([row["q_sway"] for row in rows_of(make_replay(scene, script, policy))])
    assert np.abs(sway["auto"] - sway["refactor"]).max() < 1e-9 * np.abs(sway["refactor"]).max()


def test_refused_values_leave_the_motion_as_it_was(tmp_path):
    events = [
        {"do": "idle", "frames": 3},
        {"do": "set", "key": "supports.foot.fix", "value": {"x": "1/(x - x)", "y": 0}},
        {"do": "set", "key": "material.rubber.rho", "value": 0},
        {"do": "idle", "frames": 2},
    ]
    scene = tower(tmp_path, SHAKEN, dynamics(0.01, 2))
    replay = make_replay(scene, write_script(tmp_path, events))
    times, sway = [], []
    for row in rows_of(replay, lambda row: times.append(replay.analysis.time)):
        sway.append((row["q_sway"], row["refused"]))
    assert np.allclose(times, 0.02 * np.array([0, 1, 2, 3, 3, 3, 4, 5]))
    assert all(refused and np.isnan(value) for value, refused in sway[4:6])
    straight = rows_of(make_replay(scene, write_script(tmp_path, [{"do": "idle", "frames": 5}])))
    assert sway[-1][0] == pytest.approx(straight[-1]["q_sway"], rel=1e-9)


@pytest.mark.slow
def test_steps_beyond_the_stable_one_grow_until_they_are_refused(tmp_path):
    """The limit of the linear acceleration method, omega dt = sqrt(12), is also the one that `check` names."""
    first = make_replay(tower(tmp_path, dynamics(0.01, 1, mass="lumped")))
    rows_of(first)
    stiffness, mass, _ = first.analysis.matrices()
    highest = np.sqrt(eigs(stiffness, M=mass.tocsc(), k=1, return_eigenvectors=False)[0].real)
    step = np.sqrt(12) / highest
    events = write_script(tmp_path, [{"do": "idle", "frames": 4}])

    def amplitudes(part: float) -> list[tuple[float, str]]:
        scene = tower(tmp_path, SHAKEN, dynamics(part * step, 400, beta=1 / 6, mass="lumped"))
        return [(row["q_sway"], row["refused"]) for row in rows_of(make_replay(scene, events))]

    assert all(abs(sway) < 0.1 and not refused for sway, refused in amplitudes(0.99))
    growing = amplitudes(1.1)
    assert abs(growing[1][0]) > 1e10 and np.isnan(growing[-1][0])
    assert growing[-1][1].startswith("the motion grows without bound")


def test_the_ground_goes_on_smoothly_when_its_frequency_changes(tmp_path):
    events = [{"do": "idle", "frames": 3}, {"do": "set", "key": "effects.ground.frequency", "value": 9.0}]
    replay = make_replay(tower(tmp_path, SHAKEN, dynamics(0.013, 1)), write_script(tmp_path, events))
    grounds = {}
    rows_of(replay, lambda row: grounds.setdefault(row["event"], replay.analysis.state.integration.excitation))
    before, after = (grounds[do].acceleration(3 * 0.013) for do in ("idle", "set"))
    assert before == pytest.approx(after)
    assert np.linalg.norm(before) > 0.1
