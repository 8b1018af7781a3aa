"""Parts of meshes: balanced, contiguous, with short borders; and orders that keep neighbours together."""

import numpy as np
import pytest

from restshape.mesh.generate import generate
from restshape.mesh.numbering import hilbert_keys, node_order
from restshape.mesh.partition import cell_parts, node_owners
from restshape.scene.model import MeshSpec, ShapeSpec
from restshape.shape.build import outline_from_spec


@pytest.fixture(scope="module")
def outline():
    return outline_from_spec(
        ShapeSpec(
            vertices={"a": [0, 0], "b": [2, 0], "c": [2, 1], "d": [0, 1]},
            edges={name: {"line": list(name)} for name in ("ab", "bc", "cd", "da")},
            outline=["ab", "bc", "cd", "da"],
            holes={"hole": {"circle": {"center": [0.7, 0.5], "radius": 0.2}}},
        )
    )


@pytest.mark.parametrize("ranks", [2, 3, 4])
def test_ranks_own_contiguous_balanced_nodes_with_short_borders(outline, ranks):
    mesh = generate(outline, MeshSpec(size=0.06), ranks)
    assert mesh.node_offsets[0] == 0 and mesh.node_offsets[-1] == mesh.n_nodes and len(mesh.node_offsets) == ranks + 1
    sizes = np.diff(mesh.node_offsets)
    assert sizes.max() < 1.1 * mesh.n_nodes / ranks
    owner = np.searchsorted(mesh.node_offsets, np.arange(mesh.n_nodes), side="right") - 1
    cut = np.count_nonzero(owner[mesh.edge_nodes[:, 0]] != owner[mesh.edge_nodes[:, 1]])
    # Cuts across the 1 m wide plate cross about 3 edges a mesh size.
    assert cut < (ranks - 1) * 4 / 0.06 * 1.3


def test_parts_are_the_same_at_each_call(outline):
    first, second = (generate(outline, MeshSpec(size=0.06), 2) for _ in range(2))
    assert np.array_equal(first.X, second.X) and np.array_equal(first.cells, second.cells)
    assert np.array_equal(first.node_offsets, second.node_offsets)


def test_the_partition_only_renumbers(outline):
    one, two = (generate(outline, MeshSpec(size=0.06), ranks) for ranks in (1, 2))
    order_one, order_two = np.lexsort(one.X.T), np.lexsort(two.X.T)
    assert np.array_equal(one.X[order_one], two.X[order_two])
    back = np.empty(two.n_nodes, dtype=int)
    back[order_two] = order_one
    assert {frozenset(c) for c in one.cells.tolist()} == {frozenset(c) for c in back[two.cells].tolist()}
    assert np.allclose(two.X[two.nodes_of("da"), 0], 0.0) and len(two.nodes_of("da")) == len(one.nodes_of("da"))


def test_every_part_has_cells_and_every_node_an_owner_beside_it(outline):
    mesh = generate(outline, MeshSpec(size=0.1))
    part = cell_parts(mesh.X, mesh.cells, 3)
    assert set(part.tolist()) == {0, 1, 2}
    owner = node_owners(mesh.X, mesh.cells, 3)
    beside = [set() for _ in range(mesh.n_nodes)]
    for cell, rank in zip(mesh.cells.tolist(), part.tolist()):
        for node in cell:
            beside[node].add(rank)
    assert all(rank in ranks for rank, ranks in zip(owner.tolist(), beside))


def test_the_hilbert_curve_steps_from_square_to_neighbouring_square():
    axis = np.arange(16.0)
    squares = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    walk = squares[np.argsort(hilbert_keys(squares))]
    assert len(np.unique(hilbert_keys(squares))) == 256
    assert np.allclose(np.abs(np.diff(walk, axis=0)).sum(axis=1), 1.0)


def test_neighbours_are_close_in_memory(outline):
    mesh = generate(outline, MeshSpec(size=0.05))
    far = np.abs(np.diff(mesh.edge_nodes.astype(int), axis=1))
    assert np.median(far) < np.sqrt(mesh.n_nodes)
    assert np.array_equal(node_order(mesh.X), np.arange(mesh.n_nodes))
