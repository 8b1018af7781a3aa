"""Stretches of a bar's outline along which rasping moves the first tone one way."""

import numpy as np
from restshape_apps.metallophone.rasping.densities import Densities
from restshape_apps.metallophone.rasping.outline_motion import (
    boundary_motion,
    corner_cosines,
    edge_nodes,
    followed_inside,
    lengths_along,
    outer_edges,
)
from restshape_apps.metallophone.rasping.places import SHORTEST, Place, profile, profile_words, stretches
from restshape_apps.metallophone.rasping.tolerances import CENTS

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.mesh.mesh import Mesh
from restshape.mesh.quality import areas
from restshape.sensitivity.outline_density import OutlineDensity

AROUND = "whole outline"
"""What its stretches are part of."""
SMOOTH = 0.9
"""Cosine of the angle between two edges beyond which their joint is no corner that a rasp would go over."""
LEAST_AREA = 0.35
"""Share of its area that each triangle keeps at least: deeper, the mesh would be too poor to judge by."""


def outline_places(analysis: ModalAnalysis, densities: Densities, most: float) -> list[Place]:
    """The stretches of the edges that no support holds, none of a hole's.

    Args:
        analysis: solved on the mesh as it lies.
        densities: of the modes whose cents are wanted.
        most: largest depth [m].
    """
    mesh = analysis.state.space.mesh
    free, found = ~constrained_corners(analysis), []
    for edge in outer_edges(mesh, ("outline",)):
        nodes = edge_nodes(mesh, edge)
        if free[nodes].any():
            found += _on_edge(analysis, edge, nodes, densities, most)
    return found


def all_around(analysis: ModalAnalysis, densities: Densities, most: float) -> list[Place]:
    """The whole outline without its holes, the same depth everywhere; none where a support holds some of it.

    Args:
        analysis: solved on the mesh as it lies.
        densities: of the modes whose cents are wanted.
        most: largest depth [m].
    """
    mesh, constrained = analysis.state.space.mesh, constrained_corners(analysis)
    chains = {edge: edge_nodes(mesh, edge) for edge in outer_edges(mesh, ("outline",))}
    if not chains or any(constrained[nodes].any() for nodes in chains.values()):
        return []
    moved = boundary_motion(mesh, {edge: np.ones(len(nodes)) for edge, nodes in chains.items()})
    motion, thickness = followed_inside(mesh, moved), corner_thickness(analysis)
    lengths = {edge: np.diff(lengths_along(mesh, nodes)) for edge, nodes in chains.items()}
    volume = sum(
        float(lengths[edge] @ (thickness[nodes][1:] + thickness[nodes][:-1])) / 2.0 for edge, nodes in chains.items()
    )
    cents = CENTS * np.array([_along(moved, one) for one in densities.outline]) / analysis.frequencies[densities.ranks]
    first = next(iter(chains.values()))
    middle = first[len(first) // 2]
    mark = np.array([mesh.X[middle], -moved[middle] / np.linalg.norm(moved[middle])])
    ends, length = mesh.X[first[[0, 0]]], float(sum(own.sum() for own in lengths.values()))
    limit, none = largest_depth(mesh, motion, most), np.zeros(len(mesh.X))
    return [Place(AROUND, False, ends, mark, length, "even", motion, none, volume, cents, limit)] if limit else []


def constrained_corners(analysis: ModalAnalysis) -> np.ndarray:
    """Whether (n,) a support holds something of each corner of the plane mesh."""
    space, body = analysis.state.space, analysis.state.body
    fixed = body.by_plane_nodes(body.boundary.mask.any(axis=1)).reshape(len(space.X), -1).any(axis=1)
    return fixed if space is space.mesh else fixed[space.corner_number]


def _on_edge(analysis: ModalAnalysis, edge: int, nodes: np.ndarray, densities: Densities, most: float) -> list[Place]:
    mesh = analysis.state.space.mesh
    s = lengths_along(mesh, nodes)
    # By a unit of depth at each node of the edge alone, as the rasp would do it.
    first = [_change(mesh, {edge: row}, densities.outline[0]) for row in np.eye(len(nodes))]
    facet, found = s[-1] / (len(nodes) - 1), []
    sharp = np.abs(corner_cosines(mesh, edge)) < SMOOTH
    widths = np.gradient(s)
    for begin, end in stretches(s, np.array(first) / widths):
        if end - begin < min(SHORTEST * facet, 0.999 * s[-1]):
            continue
        over = bool(begin == s[0] and sharp[0]), bool(end == s[-1] and sharp[1])
        depth = profile(s, begin, end, over)
        if np.count_nonzero(depth) < 1:
            continue
        moved = boundary_motion(mesh, {edge: depth})
        motion = followed_inside(mesh, moved)
        cents = (
            CENTS * np.array([_along(moved, one) for one in densities.outline]) / analysis.frequencies[densities.ranks]
        )
        ends = np.column_stack([np.interp([begin, end], s, mesh.X[nodes, axis]) for axis in range(2)])
        thickness = corner_thickness(analysis)[nodes]
        volume = float(np.sum(0.5 * np.diff(s) * ((depth * thickness)[1:] + (depth * thickness)[:-1])))
        limit = largest_depth(mesh, motion, most)
        name = f"edge {mesh.outline.edges[edge].name}"
        most_off = int(np.argmax(depth - 1e-3 * np.abs(s - 0.5 * (begin + end)) / s[-1]))
        outward = -moved[nodes[most_off]] / np.linalg.norm(moved[nodes[most_off]])
        mark = np.array([mesh.X[nodes[most_off]], outward])
        words, none = profile_words(over), np.zeros(len(mesh.X))
        found.append(Place(name, False, ends, mark, end - begin, words, motion, none, volume, cents, limit))
    return found


def _change(mesh: Mesh, depths: dict[int, np.ndarray], density: OutlineDensity) -> float:
    """The change [Hz/m] of a frequency by depths off edges."""
    return _along(boundary_motion(mesh, depths), density)


def _along(moved: np.ndarray, density: OutlineDensity) -> float:
    """The change of a frequency [Hz] by displacements (n, 2) of the boundary."""
    return float((density.gradient * moved[density.nodes]).sum())


def corner_thickness(analysis: ModalAnalysis) -> np.ndarray:
    """The thickness (n,) [m] at the corners of the plane mesh."""
    from restshape.mesh.thickness import Thickness
    from restshape.physics.elasticity.vibrating_materials import common_thickness

    scene = analysis.state.scene
    return Thickness(common_thickness(scene), scene.parameters).at(analysis.state.space.mesh.X)


def largest_depth(mesh: Mesh, motion: np.ndarray, most: float) -> float:
    """The largest depth [m] up to `most` by which all triangles keep `LEAST_AREA` of what they have.

    Args:
        mesh: of corners.
        motion: (n, 2) displacements of them a unit of depth.
    """
    for depth in most * np.linspace(1.0, 0.0, 41)[:-1]:
        if least_area(mesh, depth * motion) >= LEAST_AREA:
            return float(depth)
    return 0.0


def least_area(mesh: Mesh, moved: np.ndarray) -> float:
    """The least share of its area that a triangle keeps where the corners of the mesh are displaced by `moved`."""
    return float((areas(mesh.X + moved, mesh.cells) / areas(mesh.X, mesh.cells)).min())
