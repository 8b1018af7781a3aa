"""What a frame's row reports of cloth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import compress
from typing import Any

from restshape.physics.cloth.body_columns import body_columns, body_row
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.tunnelling import penetrations, tunnelling
from restshape.scene.bodies import Body
from restshape.scene.model import Scene


class Row:
    """Makes the columns that only cloth has.

    Args:
        bodies: of the first scene by name, whose numbers have columns.
    """

    def __init__(self, bodies: Mapping[str, Body]) -> None:
        self.body_columns = list(body_columns(bodies))

    def __call__(self, state: RelaxationState) -> dict[str, Any]:
        """The columns at a state."""
        bodies, report = state.scene.bodies, state.report
        notes, max_penetration = _notes(state)
        crossings = len(state.problem.surface.crossed(state.problem.corners(state.x)))
        notes += crossing_notes(crossings)
        return {
            "converged": int(report.converged),
            "tangent_positive_definite": -1 if report.stable is None else int(report.stable),
            "relaxation_steps": report.steps,
            "factorisations": report.factors,
            "slip_distance": report.slip,
            "max_penetration": max_penetration,
            "crossings": crossings,
            "note": "; ".join(notes),
            **body_row(dict(zip(bodies, state.bodies)), self.body_columns),
        }


def _notes(state: RelaxationState) -> tuple[list[str], float]:
    """What there is to say of a state, and the depth [m] of the deepest node in a body."""
    problem, bodies = state.problem, state.scene.bodies
    notes, max_penetration = convergence_notes(state), 0.0
    if problem.contact:
        corners, kernels = problem.corners(state.x), problem.contact.bodies
        through = tunnelling(state.bodies, kernels, corners[problem.mesh.cells])
        notes += [f"bodies.{name} comes through the cloth" for name in compress(bodies, through)]
        depths = penetrations(kernels, corners)
        max_penetration = max(depths, default=0.0)
        notes += penetration_notes("lies", problem, state.scene, depths)
    return [*notes, *state.notes], max_penetration


def convergence_notes(state: RelaxationState) -> list[str]:
    """Whether the cloth is not in a stable equilibrium, and why."""
    report = state.report
    if not report.converged:
        scale = "weight" if state.problem.lumped.load > 0.0 else "forces of the supports"
        return [f"not converged: residual {report.residual:.2e} of the {scale}; {report.why}"]
    if report.stable is False:
        return ["converged to an unstable equilibrium: the tangent is not positive definite"]
    return []


def crossing_notes(crossings: int) -> list[str]:
    """What there is to say of so many triangles that others cross."""
    return [f"cloth passes through itself at {crossings} triangle{'s' * (crossings > 1)}"] if crossings else []


def penetration_notes(how: str, problem: ClothProblem, scene: Scene, depths: Sequence[float]) -> list[str]:
    """Bodies in which cloth is deeper than contact begins above their surface, by how deep [m] it is in each."""
    least = problem.contact.thickness
    found = zip(scene.bodies, depths)
    return [f"cloth {how} {1e3 * depth:.3g} mm inside bodies.{name}" for name, depth in found if depth > least]
