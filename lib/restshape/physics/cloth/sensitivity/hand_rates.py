"""How the forces on resting cloth follow its material: what a hand on the pattern does at constant positions."""

from __future__ import annotations

import numpy as np

from restshape.errors import ReplayProblem
from restshape.fem.assembled import Assembled
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.sensitivity.rest_tangent import RestTangent
from restshape.physics.cloth.sensitivity.support_rates import pattern_turn, support_rates
from restshape.scene.panels import panels_of


def hand_rates(state: RelaxationState, tangent: RestTangent, dX: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The rates (n, 3) [N] of the residual, and those (n, 3) [m] of the prescribed unknowns, when material moves.

    The elements carry dual numbers of their places in the material. What enters them as a parameter and depends on
    these places too is added: areas that touch, anchors that go with the cloth, stiffness of hinges across a grain, and
    the directions of clamps. All unknowns are constant.

    Args:
        state: at rest.
        tangent: there.
        dX: (corners, 2) rates of the places of the mesh's nodes in the material [m].

    Raises:
        ReplayProblem: panels are clamped, each in directions of its own.

    Source: docs/theory/design-derivative.md: f_i of the thesis's (5.11).
    """
    problem, x, contact = state.problem, state.x, tangent.contact
    moved = node_motion(problem, dX)
    prescribed = support_rates(problem, state.scene, dX)
    out = Assembled(problem.material_integrals()).design_product(x, moved)
    if panels_of(state.scene) and len(problem.supports.clamped):
        raise ReplayProblem("drapes of panels with clamps have no derivative by the pattern")
    out += problem.bending_rates(x, dX, pattern_turn(state.scene))
    # Where material is that nodes come to, along the cloth: anchors go with it.
    way = np.einsum("iak,ik->ia", tangent.gradients, dX)
    if contact:
        out += contact.rates(areas=problem.area_rates(moved), anchors=problem.contact.place(way))
    if tangent.layers:
        out += tangent.layers.pattern_rates(dX)
        out[problem.corner_number] += problem.self_contact.place_rates(problem.corners(x), way)
    return out, prescribed


def node_motion(problem: ClothProblem, dX: np.ndarray) -> np.ndarray:
    """Rates (n, 2) [m] of all nodes, those of edges too, from those (corners, 2) of the mesh's."""
    if not problem.morley:
        return np.ascontiguousarray(dX)
    out = np.empty((problem.n_nodes, 2))
    out[problem.corner_number] = dX
    out[problem.morley.side_number] = dX[problem.mesh.edge_nodes].mean(axis=1)
    return out
