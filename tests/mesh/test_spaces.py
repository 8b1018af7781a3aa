"""Meshes and what stands over them are spaces: they say what they are made of, and fields follow flips."""

import numpy as np
import pytest
from mesh_samples import SQUARE, polygon_outline

from restshape import _kernels
from restshape.fem.space import Space
from restshape.mesh.extrude import Extrusion
from restshape.mesh.generate import generate
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.mesh.morley import MorleySpace
from restshape.mesh.plate import PlateMesh
from restshape.mesh.reconnect import Reconnection
from restshape.scene.model import MeshSpec

SPACES = {
    "first order": lambda mesh: mesh,
    "second order": LagrangeSpace,
    "Morley": MorleySpace,
    "plate": lambda mesh: PlateMesh(mesh, 0.1),
    "body": lambda mesh: Extrusion(mesh, 2, 0.1),
    "body of second order": lambda mesh: Extrusion(LagrangeSpace(mesh), 1, 0.1),
}


def coarse() -> Mesh:
    return generate(polygon_outline(SQUARE), MeshSpec(size=0.3))


@pytest.mark.parametrize("kind", list(SPACES))
def test_spaces_say_what_they_are_made_of(kind):
    space = SPACES[kind](coarse())
    assert isinstance(space, Space)
    assert space.dofs is space.cells or np.array_equal(space.dofs, space.cells)
    # Elements are named after the cell type, and have its nodes and its space's coordinates.
    element = _kernels.Element(f"{'mass_plate' if kind == 'plate' else 'mass'}_{space.cell_type}")
    assert element.nodes == space.cells.shape[1] and element.dim == space.X.shape[1]
    assert space.corners.shape == (len(space.cells), space.dim + 1)
    assert len(space.cell_region) == len(space.cells) and space.node_offsets[-1] == len(space.X)


# The unknowns of Morley's edges are slopes, which no values interpolate.
@pytest.mark.parametrize("kind", [kind for kind in SPACES if kind != "Morley"])
def test_a_linear_field_stays_linear_through_flips(kind):
    mesh = coarse()
    space = SPACES[kind](mesh)
    below = getattr(space, "plane", space)
    mesh.X[:, 0] += 0.9 * mesh.X[:, 1]
    if isinstance(below, LagrangeSpace):
        below.bend(mesh.outline)
        below.place()
    space.follow(np.empty(0, dtype=np.int32))
    before = 1.0 + space.X @ np.linspace(1.0, 2.0, space.X.shape[1])[:, None]
    flips, changed = Reconnection(mesh).flip(mesh.X)
    assert flips
    interpolations = ()
    if isinstance(below, LagrangeSpace):
        below.reconnect(changed)
        interpolations = below.interpolations
        below.place()
    after = space.interpolate(before, interpolations)
    space.follow(changed)
    expected = 1.0 + space.X @ np.linspace(1.0, 2.0, space.X.shape[1])[:, None]
    np.testing.assert_allclose(after, expected, atol=1e-12)
