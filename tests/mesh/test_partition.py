"""Parts of meshes: balanced, contiguous, with short borders; and orders that keep neighbours together."""

import numpy as np
import pytest

from restshape.mesh.generate import generate
from restshape.mesh.numbering import hilbert_keys, node_order
from restshape.mesh.partition import node_owners
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


@pytest.mark.parametrize("ranks", [2, 3, 7])
def test_parts_hold_as_many_nodes_each_and_are_cut_across_a_slender_body_that_lies_askew(ranks):
    """Of a bar 20 long and 1 wide, at 30 degrees, whatever the order of its nodes."""
    along, across = (part.ravel() for part in np.meshgrid(np.arange(200) * 0.1, np.arange(11) * 0.1, indexing="ij"))
    shuffled = np.random.default_rng(1).permutation(len(along))
    cos, sin = np.cos(np.pi / 6), np.sin(np.pi / 6)
    X = np.column_stack([cos * along - sin * across, sin * along + cos * across])[shuffled]
    owner = node_owners(X, ranks)
    sizes = np.bincount(owner, minlength=ranks)
    assert sizes.max() - sizes.min() <= ranks
    spans = [np.ptp(along[shuffled][owner == rank]) for rank in range(ranks)]
    assert max(spans) <= 20.0 / ranks + 0.2


def test_more_ranks_than_nodes_leave_some_without(outline):
    owner = node_owners(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), 5)
    assert len(set(owner.tolist())) == 3 and owner.max() < 5
    assert not len(node_owners(np.empty((0, 2)), 3))


def test_places_are_those_along_the_curve_on_any_number_of_ranks(outline):
    one, three = (generate(outline, MeshSpec(size=0.1), ranks) for ranks in (1, 3))
    back = np.argsort(three.places)
    assert np.array_equal(three.X[back], one.X[np.argsort(one.places)])


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
