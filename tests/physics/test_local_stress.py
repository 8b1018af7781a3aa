"""Stresses at few nodes, from the cells around them, have the bits of those of the whole; they cost what is few."""

import tracemalloc

import numpy as np
import pytest
from small_scenes import write_scene
from test_shared_solid import FIRST, LARGE, SCENE, whole

from restshape.fem.residuals import unconstrained_residual
from restshape.interface.first_frame import first_frame
from restshape.mesh.reconnect import Reconnection
from restshape.physics.elasticity import local_stress

AT_FEW = """
corner = { stress = "von_mises", at = "c", reduce = "max" }
mean = { stress = "xx", at = "left", reduce = "mean" }
inside = { stress = "min_principal", at = "core", reduce = "min" }
"""


def observed(solid, x):
    return solid.observer(solid.scene.quantities)(x)


@pytest.mark.parametrize("overrides", [[], [FIRST], [LARGE, FIRST]])
def test_the_same_bits(tmp_path, monkeypatch, overrides):
    """Before and after edges are flipped and nodes move, beside regions too."""
    scene = SCENE[: SCENE.index("work =")] + AT_FEW
    analysis = first_frame(write_scene(tmp_path, scene), overrides).analysis
    mesh, x = analysis.space, analysis.x
    one = observed(whole(analysis), x)
    monkeypatch.setattr(local_stress, "LEAST_CELLS", 0)
    monkeypatch.setattr(local_stress, "FEW", 1.0)
    monkeypatch.setattr(local_stress, "cells_around", seen := Counted(local_stress.cells_around))
    solid = whole(analysis)
    observer = solid.observer(solid.scene.quantities)
    assert observer(x) == one and seen.calls == len(one)
    if overrides != [FIRST]:
        return
    mesh.X[mesh.node_edge < 0] += np.random.default_rng(1).uniform(-0.02, 0.02, (np.sum(mesh.node_edge < 0), 2))
    mesh.geometry += 1
    moved = observer(x)
    assert moved == whole_of(monkeypatch, analysis, x) != one
    assert Reconnection(mesh).flip(mesh.X)[0] > 0
    mesh.topology, mesh.geometry = -12345, mesh.geometry + 1
    assert observer(x) == whole_of(monkeypatch, analysis, x) != moved


class Counted:
    """A function that is called, and counted."""

    def __init__(self, function):
        self.function, self.calls = function, 0

    def __call__(self, *words):
        self.calls += 1
        return self.function(*words)


def whole_of(monkeypatch, analysis, x):
    with monkeypatch.context() as patch:
        patch.setattr(local_stress, "LEAST_CELLS", 10**9)
        return observed(whole(analysis), x)


def test_what_looks_at_a_point_costs_a_point(tmp_path):
    """Stress at a corner of a large mesh is that of a patch: no stress of all cells is computed."""
    scene = SCENE[: SCENE.index("work =")] + AT_FEW.splitlines()[1]
    analysis = first_frame(write_scene(tmp_path, scene), [FIRST, "mesh.size=0.018"]).analysis
    solid = whole(analysis)
    observer = solid.observer(solid.scene.quantities)
    assert len(analysis.space.cells) >= local_stress.LEAST_CELLS
    assert np.isfinite(list(observer(analysis.x).values())).all() and not solid.nodal_stress._found


def test_a_reaction_takes_no_room_for_all_nodes(tmp_path):
    """From the second state on; what was left of the first one does not count."""
    scene = SCENE[: SCENE.index("work =")] + 'wall = { reaction = "x", at = "left" }\n'
    analysis = first_frame(write_scene(tmp_path, scene), [FIRST, "mesh.size=0.018"]).analysis
    solid, x = whole(analysis), analysis.x
    observer, nodes = solid.observer(solid.scene.quantities), np.flatnonzero(solid.boundary.mask[:, 0])
    observer(x)
    tracemalloc.start()
    found = observer(1.5 * x)["wall"]
    assert tracemalloc.get_traced_memory()[1] < 1.5 * x.nbytes
    tracemalloc.stop()
    assert found == unconstrained_residual(solid, 1.5 * x)[nodes, 0].sum() == pytest.approx(1.5 * observer(x)["wall"])
