"""Unknowns that supports prescribe, on a mesh whose nodes move and whose triangles stay."""

from __future__ import annotations

import numpy as np

from restshape.fem.entity_sets import nodes_on
from restshape.fem.nodal_values import Nodal
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.cloth_supports import AXES, supports_of
from restshape.physics.cloth.initial_placement import InitialPlacement
from restshape.physics.cloth.sheet.cloth_boundary import ClothDirichlet
from restshape.scene.held_point import hold_of
from restshape.scene.model import Scene


class PrescribedPlaces:
    """Puts what supports prescribe into unknowns of cloth, wherever the nodes of its mesh are.

    Places of nodes that one support holds are found at these nodes alone. Where two hold the same one, or a slope or a
    plane of symmetry is given, all is as a solve has it; a hand keeps the node that it holds.

    Args:
        scene: of the supports.
        problem: of the mesh.
    """

    def __init__(self, scene: Scene, problem: ClothProblem) -> None:
        self._scene, self._problem, self._mesh = scene, problem, problem.mesh
        self._placement = InitialPlacement(scene)
        self._constrained: list[tuple[np.ndarray, int, Nodal]] | None = _constrained(scene, self._mesh)

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Unknowns (n, 3), prescribed ones as they are given for the nodes as they lie.

        Raises:
            ReplayProblem: a place is no number.
            UserError: two supports clash.
        """
        mesh, numbers = self._mesh, self._problem.corner_number
        if self._constrained is None:
            supports = supports_of(self._scene, mesh, self._placement, self._problem.supports.hand)
            boundary = ClothDirichlet(supports, mesh, numbers, self._problem.n_nodes, self._problem.morley)
            return np.where(boundary.mask, boundary.values, values)
        found = values.copy()
        for nodes, axis, value in self._constrained:
            moved = value(self._placement.coordinates(mesh, nodes))
            found[numbers[nodes], axis] = self._placement.places(mesh, nodes)[:, axis] + moved
        return found


def _constrained(scene: Scene, mesh: Mesh) -> list[tuple[np.ndarray, int, Nodal]] | None:
    """Nodes (k,), coordinate and displacement that each support gives; None where there is more to it."""
    if hold_of(scene) is not None:
        return None
    constrained, taken = [], np.zeros((len(mesh.X), len(AXES)), dtype=bool)
    for name, support in scene.supports.items():
        if support.symmetry or "slope" in support.fix:
            return None
        nodes = nodes_on(mesh, support.on)
        for direction, value in support.fix.items():
            axis = AXES.index(direction)
            if taken[nodes, axis].any():
                return None
            taken[nodes, axis] = True
            constrained.append((nodes, axis, Nodal(value, scene.parameters, f"supports.{name}.fix.{direction}")))
    return constrained
