"""Vibrating solids of second order: steps against a textbook's, motion through flips and onto new meshes."""

import numpy as np
import pytest
from small_scenes import across, drag, make_replay, rows_of, write_script
from vibrating import DAMPED, SHAKEN, dynamics, textbook_newmark, tower

from restshape.analysis.frame import Frame
from restshape.analysis.motion.velocity_projection import project_velocity
from restshape.fem.residuals import unconstrained_residual
from restshape.mesh.reconnect import Reconnection
from restshape.replay.parity import Parity

ORDER = ["mesh.order=2"]
PULLED = "\n[loads.pull]\non = 'right'\ntraction = ['90*y', '-100 Pa']\n"
WEIGHT = "\n[loads.weight]\non = 'all'\nbody = ['20*y', -9810]\n"
DOWN = drag("window", (0.5, 1.4), across((0.5, 1.4), (0.55, 0.6), 24))
A = np.array([[1e-3, 4e-4], [-2e-4, 7e-4]])


@pytest.mark.parametrize("mass", ["consistent", "lumped"])
@pytest.mark.parametrize(("beta", "gamma"), [(0.25, 0.5), (0.3, 0.5)])
def test_steps_are_those_of_the_textbook(tmp_path, mass, beta, gamma):
    """u and v after 12 steps under ground acceleration, damping, tractions and weight."""
    scene = tower(tmp_path, SHAKEN, DAMPED, PULLED, WEIGHT, dynamics(0.013, 6, beta=beta, gamma=gamma, mass=mass))
    replay = make_replay(scene, overrides=ORDER)
    rows_of(replay)
    idle_of(replay, 2)
    analysis, body = replay.analysis, replay.analysis.body
    free = ~body.constrained.ravel()
    direction = np.array([2.0, 1.0]) / np.sqrt(5)
    uniform = body.mass.apply(np.tile(direction, (len(free) // 2, 1))).ravel()[free]
    static = -unconstrained_residual(body.problem, np.zeros_like(body.static))

    def force(t: float) -> np.ndarray:
        return static.ravel()[free] - 3.0 * np.sin(2 * np.pi * 4.0 * t) * uniform

    u, v = textbook_newmark(analysis.matrices(), force, 0.013, beta, gamma, 12)
    assert np.abs(analysis.x.ravel()[free] - u).max() < 1e-8 * np.abs(u).max()
    assert np.abs(analysis.v.ravel()[free] - v).max() < 1e-8 * np.abs(v).max()


def idle_of(replay, frames: int) -> None:
    """Some more frames in which nothing is edited."""
    analysis = replay.analysis
    for _ in range(frames):
        none = np.empty(0, dtype=np.int32)
        analysis.solve(Frame(replay.moving.field_mesh, none, None, analysis.state.scene, (None, (0.0, 0.0))))


@pytest.mark.slow
@pytest.mark.parametrize("relocation", ["harmonic", "laplacian"])
def test_reuse_equals_rebuild_under_an_edit(tmp_path, relocation):
    scene = tower(tmp_path, SHAKEN, DAMPED, dynamics(0.01, 4), window=True)
    settings = [*ORDER, f"mesh.relocation={relocation}", "mesh.criterion=author"]
    replay = make_replay(scene, write_script(tmp_path, DOWN), overrides=settings)
    check = Parity(replay)
    rows = rows_of(replay, lambda row: row.update(check()))
    assert check.summary()["holds"] and not any(row["refused"] for row in rows)
    assert {1, 2, 3} <= {row["level"] for row in rows}


def test_edits_and_new_meshes_account_for_all_energy(tmp_path):
    """Without ground, load and damping, energy less the work of edits and new meshes is constant."""
    settings = [*ORDER, "mesh.relocation=laplacian", "mesh.criterion=author"]
    scene = tower(tmp_path, dynamics(0.01, 4), window=True)
    replay = make_replay(scene, write_script(tmp_path, DOWN), overrides=settings)
    frames = replay.frames()
    next(frames)
    analysis = replay.analysis
    X = analysis.space.X
    analysis.begin(1e-3 * X * X[:, 1:], 0.1 * X[:, ::-1] * X[:, 1:])
    start = analysis.energy()
    books, levels = [], set()
    for row in frames:
        books.append(analysis.energy() - row["q_edit"] - row["q_remesh"])
        levels.add(row["level"])
    assert {1, 2, 3} <= levels
    np.testing.assert_allclose(books, start, rtol=1e-8)


def test_flips_leave_linear_motions_as_they_are(tmp_path):
    """At a step so short that nothing moves: displacements and velocities linear in the place stay so."""
    replay = make_replay(tower(tmp_path, dynamics(1e-8, 1)), overrides=ORDER)
    rows_of(replay)
    moving, analysis = replay.moving, replay.analysis
    mesh, space = moving.mesh, moving.space
    inside = np.flatnonzero(mesh.node_edge < 0)
    mesh.X[inside] += np.random.default_rng(5).uniform(-0.05, 0.05, (len(inside), 2))
    mesh.geometry += 1
    space.place()
    idle_of(replay, 1)
    foot = space.X[:, 1:]
    analysis.begin(foot * A[0], 1000 * foot * A[1])
    ends = mesh.edge_nodes.copy()
    flips, changed = Reconnection(mesh).flip(mesh.X)
    space.reconnect(changed)
    space.place()
    mesh.topology -= 10_000
    assert flips and (ends != mesh.edge_nodes).any()
    analysis.solve(Frame(space, changed, None, analysis.state.scene, (None, (0.0, 0.0)), space.interpolations))
    np.testing.assert_allclose(analysis.x, space.X[:, 1:] * A[0], atol=1e-7)
    np.testing.assert_allclose(analysis.v, 1000 * space.X[:, 1:] * A[1], atol=1e-5)


@pytest.mark.parametrize("mass", ["consistent", "lumped"])
def test_velocities_on_a_new_mesh(tmp_path, mass):
    """Momentum is kept; quadratic velocities are projected exactly between meshes with straight sides."""
    bodies = []
    for size in (0.3, 0.17):
        replay = make_replay(tower(tmp_path, dynamics(mass=mass), size=size), overrides=ORDER)
        rows_of(replay)
        bodies.append(replay.analysis.body)
    old, new = bodies

    def velocity(X):
        x, y = X.T
        return np.column_stack([y * (2 - x + 3 * y), y * (1 + 0.5 * x)])

    projected = project_velocity(old.mass, new.mass, velocity(old.problem.space.X))
    np.testing.assert_allclose(
        new.mass.momentum(projected), old.mass.momentum(velocity(old.problem.space.X)), rtol=1e-10
    )
    if mass == "consistent":
        np.testing.assert_allclose(projected, velocity(new.problem.space.X), atol=1e-9)
    rough = np.where(old.constrained, 0.0, np.random.default_rng(0).normal(size=old.problem.space.X.shape))
    projected = project_velocity(old.mass, new.mass, rough)
    np.testing.assert_allclose(new.mass.momentum(projected), old.mass.momentum(rough), rtol=1e-9)
