"""Forces of supports in motion: Newton's second law for the whole body, in every step."""

import numpy as np
import pytest
from large import LARGE
from small_scenes import make_replay, rows_of, write_script
from vibrating import DAMPED, SHAKEN, dynamics, idle, tower

THICKNESS, RHO, WEIGHT, ALPHA = 0.1, 1000.0, (1.0, -2.0), 0.8
BODY = f"\n[effects.solid]\nmodel = 'plane_strain'\n[effects.gravity]\ng = {list(WEIGHT)}\n"
FORCES = "\nx = { reaction = 'x', at = 'bottom' }\ny = { reaction = 'y', at = 'bottom' }\n"
SCHEMES = {"newmark": (0.25, 0.5), "damping newmark": (0.3, 0.55)}


def body_of(analysis):
    """Mass [kg] of each triangle, and its nodes."""
    cells = analysis.space.cells
    p, q = (analysis.space.X[cells[:, k]] - analysis.space.X[cells[:, 0]] for k in (1, 2))
    return THICKNESS * RHO * 0.5 * np.abs(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]), cells


def outer_force(replay, damped):
    """The forces (2,) [N] on the whole body in the base's frame: supports, weight, inertia, outer damping; momentum."""
    analysis = replay.analysis
    mass, cells = body_of(analysis)
    found = analysis.observe()
    momentum = mass @ analysis.v[cells].mean(axis=1)
    base = analysis.state.integration.base_acceleration(analysis.time, 2)
    support = np.array([found["x"], found["y"]])
    outer = mass.sum() * (np.array(WEIGHT) - base) - (ALPHA * momentum if damped else 0.0)
    return support, support + outer, momentum


@pytest.mark.parametrize("law", ["", LARGE], ids=["linear", "large"])
@pytest.mark.parametrize("excitation", ["free", "base"])
@pytest.mark.parametrize("mass", ["consistent", "lumped"])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_momentum_changes_by_the_forces_on_the_body(tmp_path, law, excitation, mass, scheme):
    """p' - p = dt ((1 - gamma) F + gamma F'), which Newmark's velocities obey exactly."""
    beta, gamma = SCHEMES[scheme]
    dt, damped = 0.013, excitation == "base"
    parts = [SHAKEN, DAMPED] if damped else []
    made = make_replay(
        tower(tmp_path, BODY, law, *parts, dynamics(dt, 1, beta=beta, gamma=gamma, mass=mass), size=0.34, more=FORCES)
    )
    rows_of(made)
    if not damped:
        X = made.moving.mesh.X
        made.analysis.begin(0.02 * X * X[:, 1:], 0.3 * X[:, ::-1] * X[:, 1:])
    _, last, before = outer_force(made, damped)
    largest, error, momenta = 0.0, 0.0, 0.0
    for _ in range(6):
        idle(made)
        support, now, momentum = outer_force(made, damped)
        error = max(error, np.abs((momentum - before) / dt - (1 - gamma) * last - gamma * now).max())
        largest, momenta = max(largest, np.abs(support).max()), max(momenta, np.abs(momentum - before).max() / dt)
        last, before = now, momentum
    assert momenta > 0.05 * largest > 0
    assert error < 1e-9 * largest


def test_no_force_acts_where_there_is_no_support(tmp_path):
    asked = FORCES + "top_x = { reaction = 'x', at = 'top' }\ntop_y = { reaction = 'y', at = 'top' }\n"
    scene = tower(tmp_path, BODY, SHAKEN, DAMPED, dynamics(0.013, 3), size=0.34, more=asked)
    row = rows_of(make_replay(scene, write_script(tmp_path, [{"do": "idle", "frames": 3}])))[-1]
    assert max(abs(row["q_top_x"]), abs(row["q_top_y"])) < 1e-9 * abs(row["q_y"])


@pytest.mark.parametrize("size", [1.0, 0.3])
def test_a_slowly_shaken_tower_pulls_with_its_mass_times_the_acceleration(tmp_path, size):
    """The base shear and the thrust of a body that is stiff for the ground, on every mesh."""
    slow = SHAKEN.replace("frequency = 4.0", "frequency = 0.05")
    scene = tower(tmp_path, slow, dynamics(0.5, 1), size=size, more=FORCES)
    made = make_replay(
        scene, write_script(tmp_path, [{"do": "idle", "frames": 5}]), overrides=["material.rubber.E=2e12"]
    )
    rows = rows_of(made)
    ground = 3.0 * np.sin(2 * np.pi * 0.05 * 0.5 * np.arange(6))
    for name, share in (("x", 2.0), ("y", 1.0)):
        exact = RHO * THICKNESS * 2.0 * ground * share / np.sqrt(5)
        np.testing.assert_allclose([row[f"q_{name}"] for row in rows], exact, atol=1e-4 * exact.max())
