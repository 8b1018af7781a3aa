"""Harmonic maps that ranks share are those of the whole mesh, the same on each; ranks are threads here."""

import numpy as np
import pytest
from mesh_samples import SQUARE, polygon_outline
from rank_threads import Ranks
from test_moving import plate

from restshape.mesh import shared_extension
from restshape.mesh.generate import generate
from restshape.mesh.relocate import BoundaryNodes, HarmonicExtension, motion
from restshape.mesh.shared_extension import NO_AREA, MeshPart, SharedHarmonicExtension, harmonic_on
from restshape.scene.model import MeshSpec


def on_ranks(mesh, ranks, work):
    """What a function of a world gives on each of so many ranks."""
    return Ranks(ranks).run(lambda comm: work(comm.tompi4py()))


def a_mesh(ranks):
    mesh = generate(plate(), MeshSpec(size=0.12), ranks)
    return mesh, BoundaryNodes(mesh).nodes


@pytest.mark.parametrize("ranks", [2, 3])
@pytest.mark.parametrize("columns", [1, 2, 4])
def test_shared_is_whole(monkeypatch, ranks, columns):
    """So it is of values that are no linear function, with equal weights and with those that they adapt."""
    monkeypatch.setattr(shared_extension, "LEAST_CELLS", 0)
    mesh, nodes = a_mesh(ranks)
    values = np.sin(3.0 * mesh.X[nodes] @ np.arange(1.0, 2.0 * columns + 1.0).reshape(2, columns))
    whole = HarmonicExtension(mesh, nodes)
    expected = whole(values), whole.adapted(values)

    def work(world):
        shared = harmonic_on(world)(mesh, nodes)
        assert isinstance(shared, SharedHarmonicExtension) and len(shared.part.border)
        return shared(values), shared.adapted(values)

    each = on_ranks(mesh, ranks, work)
    for plain, adapted in each:
        np.testing.assert_array_equal(plain, each[0][0])
        np.testing.assert_array_equal(adapted, each[0][1])
    np.testing.assert_allclose(each[0][0], expected[0], atol=1e-13)
    np.testing.assert_allclose(each[0][1], expected[1], atol=1e-13)
    assert abs(expected[0] - expected[1]).max() > 1e-3


def test_more_ranks_than_cells(monkeypatch):
    """Ranks that have no cells, and none that are free, take part."""
    monkeypatch.setattr(shared_extension, "LEAST_CELLS", 0)
    mesh = generate(polygon_outline(SQUARE), MeshSpec(size=0.3), 2)
    nodes = BoundaryNodes(mesh).nodes
    assert len(mesh.X) - len(nodes) > 3
    ranks = len(mesh.cells) + 2
    mesh.node_offsets = np.minimum(np.arange(ranks + 1), len(mesh.X)).astype(np.int32)
    values = mesh.X[nodes] ** 2
    expected = HarmonicExtension(mesh, nodes).adapted(values)
    for found in on_ranks(mesh, ranks, lambda world: harmonic_on(world)(mesh, nodes).adapted(values)):
        np.testing.assert_allclose(found, expected, atol=1e-13)


def test_each_node_is_of_one_rank():
    mesh, nodes = a_mesh(3)
    parts = [MeshPart(mesh, nodes, rank) for rank in range(3)]
    assert sum(len(part.cells) for part in parts) == len(mesh.cells)
    assert sorted(np.concatenate([part.own[part.first[part.own] == k] for k, part in enumerate(parts)])) == list(
        range(len(mesh.X))
    )
    shared = set(parts[0].border)
    assert shared and shared.isdisjoint(nodes)
    assert all(shared & set(part.own) for part in parts)


def test_a_triangle_without_area_ends_all_ranks():
    mesh, nodes = a_mesh(2)
    inside = np.setdiff1d(np.unique(mesh.cells), nodes)
    cell = next(cell for cell in mesh.cells if np.isin(cell, inside).all())
    mesh.X[cell] = mesh.X[cell[0]]

    def work(world):
        with pytest.raises(RuntimeError, match=NO_AREA):
            SharedHarmonicExtension(world, mesh, MeshPart(mesh, nodes, world.rank))
        return True

    assert on_ranks(mesh, 2, work) == [True, True]


@pytest.mark.parametrize("limit", ["LEAST_CELLS", "MOST_BORDER"])
def test_small_meshes_and_long_borders_stay_whole(monkeypatch, limit):
    monkeypatch.setattr(shared_extension, "LEAST_CELLS", 10**9 if limit == "LEAST_CELLS" else 0)
    monkeypatch.setattr(shared_extension, "MOST_BORDER", 10**9 if limit == "LEAST_CELLS" else 1)
    mesh, nodes = a_mesh(2)
    found = on_ranks(mesh, 2, lambda world: harmonic_on(world)(mesh, nodes))
    assert all(isinstance(one, HarmonicExtension) for one in found)


def test_the_map_of_a_drag(monkeypatch):
    """All nodes of an outline that moves evenly move with it: linear functions are reproduced."""
    monkeypatch.setattr(shared_extension, "LEAST_CELLS", 0)
    mesh, nodes = a_mesh(2)
    basis = np.stack([np.tile([1.0, 0.5], (len(nodes), 1)), np.tile([0.0, 1.0], (len(nodes), 1))])
    for Psi in on_ranks(mesh, 2, lambda world: motion(mesh, basis, "harmonic", nodes, harmonic_on(world))):
        np.testing.assert_allclose(Psi, np.broadcast_to(basis[:, :1], Psi.shape), atol=1e-13)
