"""How what supports of cloth prescribe follows the material that they hold."""

from __future__ import annotations

import numpy as np

from restshape.fem.entity_sets import nodes_on
from restshape.fem.nodal_values import Nodal
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.cloth_supports import AXES
from restshape.physics.cloth.initial_placement import InitialPlacement
from restshape.scene.model import Scene
from restshape.shape.placement import rotation


def support_rates(problem: ClothProblem, scene: Scene, dX: np.ndarray) -> np.ndarray:
    """Rates (n, 3) [m] of the prescribed unknowns when the mesh's nodes move with dX (corners, 2) [m]; 0 elsewhere.

    Places follow where the scene lays the flat cloth, and formulas of the place; slopes across clamped edges follow
    these edges. What a hand holds stays where that is.
    """
    mesh, placement = problem.mesh, InitialPlacement(scene)
    flat = placement.directions(mesh, slice(None), dX)
    coordinates = placement.coordinates(mesh)
    places = flat.copy()
    for name, support in scene.supports.items():
        nodes = nodes_on(mesh, support.on)
        for direction, value in support.fix.items():
            if direction != "slope":
                axis = AXES.index(direction)
                moved = Nodal(value, scene.parameters, f"supports.{name}.fix.{direction}")
                places[nodes, axis] = flat[nodes, axis] + moved.rate(coordinates[nodes], dX[nodes])
    places[problem.supports.hand] = 0.0
    out = np.zeros((problem.n_nodes, 3))
    out[problem.corner_number] = np.where(problem.supports.mask, places, 0.0)
    if problem.morley:
        clamped = problem.supports.clamped
        start, end = dX[mesh.edge_nodes[clamped]].swapaxes(0, 1)
        along = end - start
        # The unknown is the derivative along the edge's own normal, as long as the edge.
        turned = np.column_stack([along[:, 1], -along[:, 0]])
        out[problem.morley.side_number[clamped]] = placement.directions(mesh, mesh.edge_nodes[clamped, 0], turned)
    return out


def pattern_turn(scene: Scene) -> np.ndarray:
    """The matrix (3, 2) from directions in the flat pattern to those in space where the scene lays it."""
    return rotation(InitialPlacement(scene).start.turn)[:, :2]
