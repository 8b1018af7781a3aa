"""What a frame's row reports of cloth."""

from __future__ import annotations

from collections.abc import Mapping
from math import nan
from typing import Any

from restshape.physics.cloth.contact.body_columns import body_columns, body_row
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.trust import Trust, trust_in
from restshape.scene.bodies import Body


class Row:
    """Makes the columns that only cloth has.

    Args:
        bodies: of the first scene by name, whose numbers have columns.
    """

    def __init__(self, bodies: Mapping[str, Body]) -> None:
        self.body_columns = list(body_columns(bodies))

    def __call__(self, state: RelaxationState) -> dict[str, Any]:
        """The columns at a state."""
        notes = "; ".join([*convergence_notes(state), *seam_notes(state), *state.notes])
        return self._columns(
            state, state.report, trust_in(state), -1 if state.predicted else int(state.report.converged), notes
        )

    def postponed(self, rest: RelaxationState) -> dict[str, Any]:
        """The columns of a prediction from an equilibrium, of which its positions alone are looked at."""
        return self._columns(rest, ConvergenceReport(), Trust((), nan, nan, -1), -1, "")

    def _columns(
        self, state: RelaxationState, report: ConvergenceReport, trust: Trust, converged: int, note: str
    ) -> dict[str, Any]:
        bodies = state.scene.bodies
        return {
            "converged": converged,
            "tangent_positive_definite": -1 if report.stable is None else int(report.stable),
            "relaxation_steps": report.steps,
            "factorisations": report.factors,
            "slip_distance": report.slip,
            "max_penetration": trust.max_penetration,
            "max_strain": trust.max_strain,
            "crossings": trust.crossings,
            "untrusted": "; ".join(trust.reasons),
            **seam_row(state),
            "note": note,
            **body_row(dict(zip(bodies, state.bodies)), self.body_columns),
        }


def seam_notes(state: RelaxationState) -> list[str]:
    """Which seam is open at an equilibrium, if one is."""
    problem = state.problem
    if state.predicted or not problem.seams:
        return []
    return problem.seams.gap_notes(problem.corners(state.x))


def seam_row(state: RelaxationState) -> dict[str, float]:
    """The columns of seams; no numbers where there are none."""
    problem = state.problem
    if not problem.seams:
        return {"seam_gap": nan, "seam_energy": nan}
    return {"seam_gap": problem.seams.gap(problem.corners(state.x)), "seam_energy": problem.seam_energy(state.x)}


def convergence_notes(state: RelaxationState) -> list[str]:
    """Whether the cloth is not in a stable equilibrium, and why."""
    report = state.report
    if state.predicted:
        return []
    if not report.converged:
        scale = "weight" if state.problem.lumped.load > 0.0 else "forces of the supports"
        return [f"not converged: residual {report.residual:.2e} of the {scale}; {report.why}"]
    if report.stable is False:
        return ["converged to an unstable equilibrium: the tangent is not positive definite"]
    return []
