"""Meshes to compare a mesh with that flips, or a reconstruction, have just changed: on one shape both."""

from dataclasses import dataclass, replace

import numpy as np

from restshape import _kernels
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.mesh.moving_state import Generated, Kept
from restshape.mesh.relocate import BoundaryNodes, extension
from restshape.shape.outline import Outline

LEAST = 0.05
"""Quality of a triangle below which a mesh says nothing of another: its own error would count as the jump."""
STEPS = (1, 8)
"""In which a new mesh goes back to the shape before: more where fewer leave triangles of low quality."""
LOW = 0.5
"""Of the lowest quality of its triangles, below which it is low."""


@dataclass(frozen=True)
class OtherMesh:
    """A mesh of one of the two shapes that an update goes between.

    Args:
        mesh: what fields live on.
        before: it is the new mesh on the shape before; else the old one on the new shape.
    """

    mesh: Mesh | LagrangeSpace
    before: bool


def compared_meshes(generated: Generated, kept: Kept, old: Mesh | LagrangeSpace | None) -> tuple[OtherMesh, ...]:
    """The old mesh where the frame has moved its nodes; where triangles do not bear that, the new one on the old shape.

    Nothing where neither is valid, where the shapes have not the same edges, or elements of another order.

    Args:
        generated: the mesh as it is now.
        kept: what it was before the update.
        old: the mesh before a reconstruction; None after flips.
    """
    mesh = generated.mesh
    if old is not None and (old is old.mesh) != (generated.space is None):
        return ()
    outline = kept.versions[0] if kept.versions else mesh.outline
    former = mesh if old is None else old.mesh
    if former.outline is mesh.outline:
        there = _fields_on(_with(former, former.X, mesh.outline, kept.connectivity), old or generated.space)
        if there is not None:
            return (OtherMesh(there, before=False),)
    if len(outline.edges) != len(mesh.outline.edges) or len(outline.points) != len(mesh.outline.points):
        return ()
    X = kept.X if old is None else moved_to(mesh, outline)
    back = None if X is None else _fields_on(_with(mesh, X, outline, None), generated.space)
    return () if back is None else (OtherMesh(back, before=True),)


def copied(space: Mesh | LagrangeSpace) -> Mesh | LagrangeSpace:
    """A copy of a mesh, or of a space over one, whose nodes move without it."""
    mesh = _with(space.mesh, space.mesh.X, space.mesh.outline, None)
    if space is space.mesh:
        return mesh
    copy = LagrangeSpace(mesh, space)
    copy.X[:] = space.X
    return copy


def _with(mesh: Mesh, X: np.ndarray, outline: Outline, connectivity: dict[str, np.ndarray] | None) -> Mesh:
    """A copy of a mesh with nodes at X (n, 2) [m], as its triangles are or were."""
    arrays = connectivity or {name: getattr(mesh, name) for name in ("cells", "cell_edges", "edge_nodes", "facet_cell")}
    copies = {name: values.copy() for name, values in arrays.items()}
    return replace(mesh, X=X.copy(), outline=outline, hierarchy=None, **copies)


def moved_to(mesh: Mesh, outline: Outline) -> np.ndarray:
    """The nodes (n, 2) [m] of a mesh on another outline with the same edges, moved harmonically in few steps."""
    boundary = BoundaryNodes(mesh)
    least = LOW * _kernels.check_cells(mesh.X, mesh.cells, 0.0, 0.0)[0]
    for steps in STEPS:
        X = _stepped(mesh, outline, boundary, steps)
        quality, invalid, _ = _kernels.check_cells(X, mesh.cells, 0.0, 0.0)
        if not invalid and quality >= least:
            break
    return X


def _stepped(mesh: Mesh, outline: Outline, boundary: BoundaryNodes, steps: int) -> np.ndarray:
    """The nodes (n, 2) [m] after so many steps, each of which is harmonic on the mesh as it lies then.

    They stay where the way leaves a triangle without area, as half a turn of a hole does in the middle.
    """
    moved, nodes, start = replace(mesh, X=mesh.X.copy()), boundary.nodes, mesh.outline.points
    for part in np.linspace(0.0, 1.0, steps + 1)[1:]:
        target = boundary.values(outline, start + part * (outline.points - start))
        try:
            harmonic = extension(moved, nodes, "harmonic")
        except RuntimeError:
            break
        moved.X += harmonic(target - moved.X[nodes])
    return moved.X


def _fields_on(mesh: Mesh, like: Mesh | LagrangeSpace | None) -> Mesh | LagrangeSpace | None:
    """What fields of the order of another space live on; None where a triangle is invalid, or nearly.

    Args:
        mesh: with the facets of the other.
        like: its sides on the outline bend as these do where both are on one outline.
    """
    quality, invalid, _ = _kernels.check_cells(mesh.X, mesh.cells, 0.0, 0.0)
    if invalid or quality < LEAST:
        return None
    if like is None or like is like.mesh:
        return mesh
    # State before the frame is numbered so: after flips a new space would have other numbers.
    space = LagrangeSpace(mesh, like)
    if like.mesh.outline is mesh.outline:
        # A space that is rebuilt leaves sides straight that it has bent when triangles were better.
        space.X[space.facets[:, 2]] = like.X[like.facets[:, 2]]
    return space if _kernels.curved_jacobian_bound(space.X, space.cells).min() > 0.0 else None
