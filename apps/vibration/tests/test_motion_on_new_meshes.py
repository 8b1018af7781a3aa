"""Motions that are brought to new meshes."""

import numpy as np
import pytest
from small_scenes import make_replay, rows_of, write_script

from restshape.analysis.displacement_projection import project_displacement
from restshape.analysis.velocity_projection import project_velocity
from restshape.fem.residuals import energy

SCENE = """format = "restshape-scene"
version = 1
app = "vibration"
[shape]
outline = ["foot", "right", "top", "left"]
vertices = { a = [0, 0], b = [1, 0], c = [1, 3], d = [0, 3] }
edges.foot = { line = ["a", "b"] }
edges.right = { line = ["b", "c"] }
edges.top = { line = ["c", "d"] }
edges.left = { line = ["d", "a"] }
[material.m]
E = 1e6
nu = 0.3
rho = 1000
thickness = 0.1
[effects]
solid = { model = "plane_stress" }
dynamics = {}
[supports]
foot = { on = "foot", fix = ["x", "y"] }
[quantities]
top = { displacement = "x", at = "top" }
"""


BAR = """format = "restshape-scene"
version = 1
app = "vibration"
parameters = { w = 1 }
[shape]
outline = ["bottom", "tip", "top", "wall"]
vertices = { a = [0, 0], b = ["w", 0], c = ["w", 0.05], d = [0, 0.05] }
edges.bottom = { line = ["a", "b"] }
edges.tip = { line = ["b", "c"] }
edges.top = { line = ["c", "d"] }
edges.wall = { line = ["d", "a"] }
[material.m]
name = "steel"
thickness = 0.05
[mesh]
size = "w/30"
[effects]
solid = { model = "plane_stress" }
dynamics = { time_step = 0.24e-3, steps = 20 }
[supports]
wall = { on = "wall", fix = ["x", "y"] }
[loads]
tip = { on = "tip", force = [0, -1000] }
[quantities]
swing = { energy = "total" }
remesh = { energy = "remesh" }
"""


def bodies(tmp_path, order):
    path = tmp_path / "tower.toml"
    path.write_text(SCENE + f"[mesh]\nsize = 0.3\norder = {order}\n")
    found = []
    for size in (0.3, 0.28):
        replay = make_replay(path, overrides=[f"mesh.size={size}"])
        rows_of(replay)
        found.append(replay.analysis.body)
    return found


@pytest.mark.parametrize("order", [1, 2])
def test_fields_of_the_elements_order_are_kept(tmp_path, order):
    old, new = bodies(tmp_path, order)

    def field(X):
        x, y = X.T
        return np.column_stack([y * (1.0 + (order - 1) * (y + x)), y * (2.0 - (order - 1) * x)])

    there = project_displacement(old, new, field(old.problem.space.X))
    np.testing.assert_allclose(there, field(new.problem.space.X), atol=1e-11)


@pytest.mark.parametrize("order", [1, 2])
def test_rough_motions_gain_no_energy_from_mesh_to_mesh(tmp_path, order):
    pair = bodies(tmp_path, order)
    rough = np.random.default_rng(1).normal(size=pair[0].problem.space.X.shape)
    u = v = np.where(pair[0].constrained, 0.0, rough)
    strain, kinetic = energy(pair[0].problem, u), pair[0].mass.energies(v).sum()
    for k in range(6):
        old, new = pair[k % 2], pair[(k + 1) % 2]
        u, v = project_displacement(old, new, u), project_velocity(old.mass, new.mass, v)
        left = energy(new.problem, u), new.mass.energies(v).sum()
        assert left[0] < strain
        assert left[1] < kinetic
        strain, kinetic = left


def test_a_motion_through_many_meshes_keeps_its_energy(tmp_path):
    """A bar without damping swings, a new mesh each fifth of its period; interpolated it gained 9 J to 5.5."""
    (tmp_path / "bar.toml").write_text(BAR)
    edit = {"t": 0.1, "do": "set", "key": "parameters.w", "value": 1.01, "frames": 10}
    script = write_script(tmp_path, [{"t": 0.0, "do": "idle", "frames": 1}, edit])
    rows = rows_of(make_replay(tmp_path / "bar.toml", script, overrides=["solve.jumps=false"]))
    assert [row["level"] for row in rows[2:]] == [3] * 10
    largest = max(row["q_swing"] for row in rows)
    assert max(abs(row["q_remesh"]) for row in rows) < 0.01 * largest
