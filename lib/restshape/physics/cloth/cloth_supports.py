"""Where supports of a scene constrain cloth on one mesh: places, slopes across edges, planes of symmetry."""

from __future__ import annotations

import numpy as np

from restshape.errors import UserError
from restshape.fem.entity_sets import facets_on, nodes_on
from restshape.fem.nodal_values import Nodal
from restshape.mesh.hinges import border_cells, normals
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.initial_placement import InitialPlacement
from restshape.physics.cloth.sheet.cloth_boundary import ClothSupports
from restshape.scene.held_point import hold_of
from restshape.scene.model import Scene, Support

AXES = "xyz"
ALIKE = 1e-9
"""Places that differ by no more, over the size of the cloth, are the same."""


def supports_of(scene: Scene, mesh: Mesh, placement: InitialPlacement, hand: np.ndarray | None = None) -> ClothSupports:
    """Where the scene's supports constrain the cloth.

    Args:
        scene: with the supports; mesh: of the cloth.
        placement: of the cloth before it falls.
        hand: the node (1,) that a hand holds; None: the one that is nearest to its point now.

    Raises:
        UserError: two of them clash, or one prescribes a slope or a plane of symmetry where there is no edge for it.
    """
    places = placement.places(mesh)
    coordinates = placement.coordinates(mesh)
    given = np.full(places.shape, np.nan)
    clamped, mirrored = [np.empty(0, dtype=np.int32)], [np.empty(0, dtype=np.int32)]
    axes = [np.empty(0, dtype=np.int32)]
    for name, support in scene.supports.items():
        nodes = nodes_on(mesh, support.on)
        for direction, value in support.fix.items():
            where = f"supports.{name}.fix.{direction}"
            if direction == "slope":
                clamped.append(_edges(scene, mesh, support, where))
                continue
            axis = AXES.index(direction)
            moved = Nodal(value, scene.parameters, where)(coordinates[nodes])
            _prescribe(given, nodes, axis, places[nodes, axis] + moved, mesh, f"{scene.path}: {where}")
        if support.symmetry:
            where = f"supports.{name}.symmetry"
            edges, axis = _edges(scene, mesh, support, where), AXES.index(support.symmetry)
            _require_plane(scene, places, nodes, axis, where)
            _prescribe(given, nodes, axis, places[nodes, axis], mesh, f"{scene.path}: {where}")
            mirrored.append(edges)
            axes.append(np.full(len(edges), axis, dtype=np.int32))
    hand = nodes_of_hand(scene, mesh) if hand is None else hand
    _hold(scene, mesh, given, hand)
    mask = (~np.isnan(given)).astype(np.uint8)
    clamped = np.unique(np.concatenate(clamped))
    return ClothSupports(
        mask=mask,
        places=np.where(mask, given, 0.0),
        clamped=clamped,
        slopes=placement.directions(
            mesh, mesh.edge_nodes[clamped, 0], normals(mesh.X, border_cells(mesh.cells, mesh.cell_edges, clamped)[1])
        ),
        mirrored=np.concatenate(mirrored),
        axes=np.concatenate(axes),
        hand=hand,
    )


def nodes_of_hand(scene: Scene, mesh: Mesh) -> np.ndarray:
    """The node (1,) that is nearest to the point that a hand holds; (0,) where it holds none."""
    hold = hold_of(scene)
    return np.empty(0, dtype=np.int64) if hold is None else np.hypot(*(mesh.X - hold.at).T).argmin(keepdims=True)


def _hold(scene: Scene, mesh: Mesh, given: np.ndarray, hand: np.ndarray) -> None:
    """Prescribe the place of the node (1,) that a hand holds.

    Raises:
        UserError: no cloth is there, or a support holds that node at another place.
    """
    hold = hold_of(scene)
    if hold is None:
        return
    distance = np.hypot(*(mesh.X - hold.at).T)
    node, place = int(hand[0]), f"{scene.path}: hold"
    around = mesh.edge_nodes[(mesh.edge_nodes == node).any(axis=1)]
    if distance[node] > np.hypot(*(mesh.X[around[:, 0]] - mesh.X[around[:, 1]]).T).max(initial=0.0):
        at = f"({hold.at[0]:.6g}, {hold.at[1]:.6g}) m"
        raise UserError(f"there is no cloth at {at} of the pattern", f"{place}.at", "hold it elsewhere")
    way = np.abs(given[node] - hold.to)
    if (way > ALIKE * _size(mesh.X)).any():
        axis, (x, y) = int(np.nanargmax(way)), mesh.X[node]
        what = f"a support constrains {AXES[axis]} of the cloth at ({x:.6g}, {y:.6g}) m of the pattern"
        do = f"hold it at {AXES[axis]} = {given[node, axis]:.6g} m, or elsewhere"
        raise UserError(f"{what}, and the hand is {way[axis]:.6g} m from there", f"{place}.to", do)
    given[node] = hold.to


def _edges(scene: Scene, mesh: Mesh, support: Support, where: str) -> np.ndarray:
    """Mesh edges (k,) of the border that a support is on."""
    facets = facets_on(mesh, support.on)
    edges = np.unique(_edges_of_facets(mesh, facets))
    inner = np.bincount(mesh.cell_edges.ravel(), minlength=len(mesh.edge_nodes))[edges] > 1
    if not len(edges) or inner.any():
        what = "which is no edge of the border" if inner.any() else "where no edge is"
        raise UserError(
            f"the support wants to give the slope across an edge on {', '.join(support.on)}, {what}",
            f"{scene.path}: {where}",
            "name edges of the outline or of holes",
        )
    return edges.astype(np.int32)


def _edges_of_facets(mesh: Mesh, facets: np.ndarray) -> np.ndarray:
    """The mesh edge (k,) of each facet (k,)."""
    n = np.int64(len(mesh.X))
    ends = np.sort(mesh.facets[facets], axis=1).astype(np.int64)
    all_ends = mesh.edge_nodes.astype(np.int64)
    return np.searchsorted(all_ends[:, 0] * n + all_ends[:, 1], ends[:, 0] * n + ends[:, 1])


def _require_plane(scene: Scene, places: np.ndarray, nodes: np.ndarray, axis: int, where: str) -> None:
    """Refuse a plane of symmetry whose nodes are not in one plane with that normal."""
    off = np.ptp(places[nodes, axis])
    if off > ALIKE * _size(places):
        raise UserError(
            f"the edge lies in no plane of symmetry with that normal: its places differ by {off:.3g} m",
            f"{scene.path}: {where}",
            "name a straight edge along the plane, or the other normal",
        )


def _prescribe(given: np.ndarray, nodes: np.ndarray, axis: int, places: np.ndarray, mesh: Mesh, where: str) -> None:
    """Note the places (k,) [m] of nodes on an axis in `given` (n, 3); refuse others than are there already."""
    before = given[nodes, axis]
    clash = np.flatnonzero(np.abs(places - before) > ALIKE * _size(mesh.X))
    if len(clash):
        x, y = mesh.X[nodes[clash[0]]]
        raise UserError(
            f"the support wants another displacement than one before it at ({x:.6g}, {y:.6g}) m: they differ by "
            f"{places[clash[0]] - before[clash[0]]:.6g} m",
            where,
            "let supports that meet agree where they meet",
        )
    given[nodes, axis] = places


def _size(places: np.ndarray) -> float:
    # Column by column: along the rows it takes several times as long.
    return max(float(np.ptp(column)) for column in places.T)
