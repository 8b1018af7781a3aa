"""Quantities and estimates that ranks share are those of the whole, on few and many ranks; ranks are threads here."""

from types import SimpleNamespace

import numpy as np
import pytest
from rank_threads import Ranks
from small_scenes import HEAD, block, write_scene

from restshape.fem import part_space
from restshape.fem.problem import CONSISTENT
from restshape.interface.first_frame import first_frame
from restshape.mesh.reconnect import Reconnection
from restshape.physics.elasticity.elasticity_quantities import MotionQuantities
from restshape.physics.elasticity.plane_solid import PlaneSolid

SCENE = f"""
{HEAD}{block()}[shape.regions.core]
polygon = [[0.3, 0.25], [0.7, 0.3], [0.65, 0.75], [0.25, 0.7]]
[material.soft]
E = 1e6
nu = 0.3
[material.hard]
E = 1e8
nu = 0.2
region = ["core"]
[effects.solid]
[supports.left]
on = "left"
fix = ["x", "y"]
[loads.pull]
on = "right"
traction = [1e3, 4e2]
[mesh]
size = 0.12
[quantities]
work = {{ energy = "strain" }}
core = {{ energy = "strain", at = "core" }}
peak = {{ stress = "von_mises", reduce = "max" }}
least = {{ stress = "min_principal", reduce = "min" }}
inside = {{ stress = "xx", at = "core", reduce = "absmax" }}
edge = {{ stress = "yy", at = "left", reduce = "max" }}
"""
LARGE, FIRST = "effects.large_deformation={}", "mesh.order=1"


def whole(analysis) -> PlaneSolid:
    """The solid of an analysis, as a rank would make it."""
    return PlaneSolid(analysis.state.scene, analysis.state.plan, analysis.space)


def observed(solid: PlaneSolid, x) -> dict[str, float]:
    estimate = solid.error_estimate().relative(x)
    return {**solid.observer(solid.scene.quantities)(x), "estimate": estimate}


def check(analysis, ranks: int, x) -> None:
    """Energies and estimates agree but for rounding; recovered stresses bit for bit; all ranks have one result."""
    one, exchange = observed(whole(analysis), x), Ranks(ranks)

    def on_rank(comm):
        solid = whole(analysis)
        solid.share(comm)
        assert solid.shared is not None
        return observed(solid, x)

    each = exchange.run(on_rank)
    assert all(found == each[0] for found in each)
    for name, value in one.items():
        exact = name in ("peak", "least", "inside", "edge")
        assert each[0][name] == (value if exact else pytest.approx(value, rel=1e-12)), name


@pytest.mark.parametrize("ranks", [2, 3])
@pytest.mark.parametrize("overrides", [[], [FIRST], [LARGE, FIRST]])
def test_shared_is_whole(tmp_path, monkeypatch, overrides, ranks):
    monkeypatch.setattr(part_space, "LEAST_SHARED", 0)
    analysis = first_frame(write_scene(tmp_path, SCENE), overrides).analysis
    check(analysis, ranks, analysis.x)


def test_more_ranks_than_cells(tmp_path, monkeypatch):
    monkeypatch.setattr(part_space, "LEAST_SHARED", 0)
    scene = SCENE
    for begin, end in (
        ("[shape.regions", "[material.soft]"),
        ("[material.hard]", "[effects"),
        ("core =", "peak"),
        ("inside", "edge"),
    ):
        scene = scene[: scene.index(begin)] + scene[scene.index(end, scene.index(begin)) :]
    analysis = first_frame(write_scene(tmp_path, scene), ["mesh.size=2.0"]).analysis
    assert len(analysis.space.cells) < 9
    check(analysis, 9, analysis.x)


def test_flips_make_another_part(tmp_path, monkeypatch):
    """A part that was made before edges are flipped, or nodes move, is not looked at afterwards."""
    monkeypatch.setattr(part_space, "LEAST_SHARED", 0)
    analysis = first_frame(write_scene(tmp_path, SCENE), [FIRST]).analysis
    mesh, x, exchange = analysis.space, analysis.x, Ranks(2)
    solids = exchange.run(lambda comm: _shared(whole(analysis), comm))
    before = exchange.run(lambda comm: observed(solids[comm.rank], x))[0]
    inner = mesh.node_edge < 0
    mesh.X[inner] += np.random.default_rng(1).uniform(-0.02, 0.02, (inner.sum(), 2))
    mesh.geometry += 1
    assert exchange.run(lambda comm: observed(solids[comm.rank], x))[0]["peak"] == observed(whole(analysis), x)["peak"]
    flips, _ = Reconnection(mesh).flip(mesh.X)
    assert flips > 0
    mesh.topology, mesh.geometry = -12345, mesh.geometry + 1
    after, one = exchange.run(lambda comm: observed(solids[comm.rank], x))[0], observed(whole(analysis), x)
    assert after["peak"] == one["peak"] != before["peak"]
    assert after["estimate"] == pytest.approx(one["estimate"], rel=1e-12)
    assert after["core"] == pytest.approx(one["core"], rel=1e-12)


def _shared(solid: PlaneSolid, comm) -> PlaneSolid:
    solid.share(comm)
    return solid


def test_small_meshes_stay_whole(tmp_path):
    analysis = first_frame(write_scene(tmp_path, SCENE), []).analysis
    assert _shared(whole(analysis), SimpleNamespace(rank=0, size=2)).shared is None


@pytest.mark.parametrize("at", [None, "core"])
def test_energies_of_motions(tmp_path, monkeypatch, at):
    """Of the whole body and of a region: strain, kinetic and their sum are those of the whole."""
    monkeypatch.setattr(part_space, "LEAST_SHARED", 0)
    scene = SCENE.replace("nu = 0.3", "nu = 0.3\nrho = 1000").replace("nu = 0.2", "nu = 0.2\nrho = 3000")
    analysis = first_frame(write_scene(tmp_path, scene), [FIRST]).analysis
    cells = analysis.space.cells_of(at) if at else slice(None)
    motion = SimpleNamespace(v=np.random.default_rng(2).standard_normal(analysis.x.shape))

    def of(solid):
        mass = solid.integrals(CONSISTENT)[0]
        energy = MotionQuantities(solid, lambda v, some: mass.of(some).energies(v)).energy
        return [energy(kind, cells)(analysis.x, motion) for kind in ("strain", "kinetic", "total")]

    strain, kinetic, total = one = of(whole(analysis))
    assert total == pytest.approx(strain + kinetic) and min(one) > 0.0
    for ranks in (2, 3):
        each = Ranks(ranks).run(lambda comm: of(_shared(whole(analysis), comm)))
        assert all(found == each[0] for found in each)
        assert each[0] == pytest.approx(one, rel=1e-12)
