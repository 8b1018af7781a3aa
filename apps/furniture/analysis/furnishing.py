"""Furniture under the hand, frame after frame: status, forces, valid range of what is dragged, suggestions."""

# More than 15 modules: equilibrium, ranges and suggestions, which know nothing of each other, meet here.

from __future__ import annotations

import json
from collections.abc import Sequence
from time import perf_counter
from typing import Any

import numpy as np
from restshape_apps.furniture.analysis.plank_equilibrium import PlankEquilibrium
from restshape_apps.furniture.guidance.design import Design, DesignDirection, findings_at
from restshape_apps.furniture.guidance.doubts import free
from restshape_apps.furniture.guidance.suggested import Suggestion, SuggestionList
from restshape_apps.furniture.guidance.valid_ranges import Grabbed, ValidRange, encode_ranges
from restshape_apps.furniture.physics.derivatives import stability_values
from restshape_apps.furniture.physics.furniture import LOST, Forces, Furniture, TestResult
from restshape_apps.furniture.physics.joint_compliance import (
    UtilisationRange,
    recorded_utilisations,
    utilisation_range_at,
)
from restshape_apps.furniture.physics.plank_beam import cross
from restshape_apps.furniture.physics.plank_bending import overbent, plank_bending
from restshape_apps.furniture.physics.plank_phrases import balanced_by_springs, phrases
from restshape_apps.furniture.physics.plank_quantities import Observed, plank_quantities, require_places
from restshape_apps.furniture.scene.furniture import REDUNDANT_BYTES, SUGGESTIONS_BYTES
from restshape_apps.furniture.session.boards import Boards

from restshape.algebra.linear_report import LinearReport
from restshape.analysis.analysis import Comparison, Context, Timeless
from restshape.analysis.frame import Frame
from restshape.analysis.solution import Solution
from restshape.errors import ReplayProblem
from restshape.findings import Finding
from restshape.replay.constraints import UNCERTAIN, limits_of, violated_constraints
from restshape.scene.model import Scene
from restshape.scene.plan import Plan

NONE = (np.nan, np.nan)


# More than 15 attributes: it holds the answers of a frame, a column each.
class FurnitureAnalysis(Timeless):
    """What holds and what breaks in a piece of furniture while it is edited.

    The model of a piece, its solver and what guidance finds are kept from frame to frame while the hand changes one
    parameter of it; nothing found in one frame changes what another one finds.

    Args:
        scene: what the user wrote.
        plan: which effects are on.
        context: what all parts of the replay share; each rank does the same, for the equations are few.

    Attributes:
        result: of the last frame.
        forces: of each case; empty where joints are lost or no equilibrium was found.

    Source: docs/theory/furniture.md.
    """

    estimated_quantity = "nothing: planks are rigid here, and a model without a mesh has no error of one"
    predictor = quantity_errors = None
    why_not = "furniture is not predicted: forces of feet and joints are solved for in each frame"

    def __init__(self, scene: Scene, plan: Plan, context: Context) -> None:
        self.plan, self.policy, self.stages, self.guided = plan, context.policy, context.stages, context.guided
        self.scene: Scene | None = None
        self.space: Boards | None = None
        self.tolerance = scene.solve.tolerance
        self.design: Design | None = None
        self.equilibrium: PlankEquilibrium | None = None
        self.gamma = np.zeros((0, 8))
        self.result = TestResult(0, 0.0, 0.0, 0.0)
        self.forces: list[Forces] = []
        self.utilisation = np.zeros(0)
        self.utilisation_range: UtilisationRange | None = None
        self.free: tuple[Finding, ...] = ()
        self.overbent: tuple[Finding, ...] = ()
        self.deflection = np.zeros(0)
        self.bent = np.nan
        self.stability_margin = np.nan
        self.worst = 0.0
        self.seconds = 0.0
        self.design_direction: DesignDirection | None = None
        self.at = np.nan
        self.ranged_seconds = np.nan
        self.suggestion_list = SuggestionList()
        self.note = self.sprung = ""
        self.age = 0

    @property
    def state(self) -> TestResult:
        """What each solve rebuilds: of frames with the same one nothing is measured twice."""
        return self.result

    @property
    def unknowns(self) -> int:
        """Unknowns of one case: displacements and turns of planks, forces of joints."""
        return self.equilibrium.mixed.size if self.equilibrium else 0

    def solve(self, frame: Frame) -> LinearReport:
        """Bring status, forces and guidance up to date with a frame."""
        boards: Boards = frame.mesh
        shown = boards.frame
        if self.scene is None:
            require_places(frame.scene.quantities, shown.design.piece)
        same = self.design is shown.design and np.array_equal(self.gamma, shown.gamma) and self.space is not None
        if same and not self.policy.regenerate:
            steps, refreshed = 0, False
            self.age += 1
        else:
            steps, refreshed = self._stand(shown.design, shown.gamma)
        self.space, self.scene, self.note = boards, frame.scene, shown.note
        self._look(shown)
        return LinearReport(0, refreshed, self.age, "lu", steps)

    def _stand(self, design: Design, gamma: np.ndarray) -> tuple[int, bool]:
        """Status and forces of a design at parameters (n, 8): Newton steps, and whether the solver is rebuilt."""
        fresh = design is not self.design or self.policy.regenerate
        if fresh:
            with self.stages("pattern"):
                if self.equilibrium:
                    self.equilibrium.destroy()
                self.equilibrium = PlankEquilibrium(design.furniture)
            self.age = 0
        self.age += not fresh
        self.design, self.gamma = design, gamma.copy()
        furniture, steps = design.furniture, 0
        with self.stages("values"):
            furniture.kernel.forget()
            self.result = furniture.test(gamma)
        with self.stages("krylov"):
            steps = self._balance(gamma)
            # What the forces say is the answer, and deflection an effect: no stage of quantities.
            self._measure(furniture)
        return steps, fresh

    def _balance(self, gamma: np.ndarray) -> int:
        """Equilibria of all cases by SNES, and the Newton steps that they took."""
        start, self.forces, steps, self.worst, sprung = perf_counter(), [], 0, 0.0, []
        if not self.result.flaws & LOST:
            try:
                for case in range(len(self.design.furniture.cases)):
                    self.forces.append(self.equilibrium.solve(case))
                    steps += self.equilibrium.steps
                    sprung += [case] if self.equilibrium.sprung else []
                    self.worst = max(self.worst, self.equilibrium.last / (self.equilibrium.scale or 1.0))
            except ReplayProblem:
                # The status reports that it has none.
                self.forces, self.worst = [], np.nan
        self.seconds = perf_counter() - start
        self.sprung = balanced_by_springs(self.design.piece, sprung if self.forces else [])
        return steps

    def _measure(self, furniture: Furniture) -> None:
        """What the forces say of each plank, and of the piece."""
        planks = len(furniture.piece.planks)
        self.utilisation, self.deflection = np.zeros(planks), np.full(planks, np.nan)
        self.bent, self.stability_margin, self.utilisation_range, self.free = np.nan, np.nan, None, ()
        self.overbent = ()
        if not self.forces:
            self.utilisation[:] = np.nan
            return
        for forces in self.forces:
            worst = forces.utilisation
            for k, joint in enumerate(furniture.piece.joints):
                for plank in (joint.i, joint.j):
                    self.utilisation[plank] = max(self.utilisation[plank], worst[k])
        rows = [stability_values(furniture, case) for case in range(len(self.forces))]
        self.stability_margin = float(min((row.min() for row in rows if len(row)), default=np.nan))
        self.utilisation_range = utilisation_range_at(furniture, self.gamma)
        self.free = free(furniture.moved(self.gamma)) if self.result.valid else ()
        if self.plan.on("bending"):
            self._bend(furniture)

    def _bend(self, furniture: Furniture) -> None:
        """Deflection of each plank, and the largest utilisation of bending strength, over all cases."""
        if self.gamma.any():
            # Beams are those of a piece at no change of its design parameters.
            furniture = Furniture(furniture.moved(self.gamma), furniture.compliance)
            furniture.test()
        cases = range(len(self.forces))
        found = [[plank_bending(furniture, k, case) for case in cases] for k in range(len(self.utilisation))]
        self.deflection = np.array([max(one.max_deflection for one in each) for each in found])
        self.bent = max(one.utilisation for each in found for one in each)
        self.overbent = tuple(overbent(furniture.piece, dict(enumerate(found)))) if self.result.valid else ()

    def _look(self, shown: Any) -> None:
        """Guidance: the range of what the hand holds, and suggestions once it has let an invalid piece go."""
        asked = self.design.guidance
        self.design_direction, self.at, self.ranged_seconds = shown.gesture, shown.c[0], np.nan
        if self.design_direction is not None and asked.ranges:
            start = perf_counter()
            self.design_direction.ranges  # noqa: B018
            self.ranged_seconds = perf_counter() - start
        wanted = self.guided and shown.edit_ended and not shown.gamma.any()
        self.suggestion_list = self.design.suggestion_list if wanted and not self._sure() else SuggestionList()

    def _sure(self) -> bool:
        """Whether the piece holds beyond doubt, and within the limits of quantities."""
        depends = self.utilisation_range and self.utilisation_range.changes
        if not self.result.valid or self.result.doubts or self.free or self.overbent or depends:
            return False
        limits = limits_of(self.scene.quantities)
        return not limits or not violated_constraints(limits, self.observe())

    def observe(self) -> dict[str, float]:
        """The scene's quantities of interest."""
        if not self.scene.quantities:
            return {}
        piece, geometry = self.design.piece, self.design.furniture.geometry(self.gamma)
        return plank_quantities(
            self.scene.quantities, Observed(piece, geometry, self.forces, self.deflection, self.stability_margin)
        )

    def row(self) -> dict[str, Any]:
        """The columns that only furniture has, and its status."""
        found, low, high = self._ranges()
        depends = self.utilisation_range.findings(self.design.piece) if self.utilisation_range else ()
        findings = findings_at(self.design.furniture, self.result, self.gamma)
        findings = findings or self.result.doubts + self.free
        findings += (*depends, *self.overbent)
        status = UNCERTAIN if self.result.valid and findings else self.result.status
        why = self.suggestion_list.why
        return {
            "constraint_status": status,
            "violated_constraints": "; ".join(phrases(findings)),
            "findings": findings,
            "flaws": self.result.flaws,
            "utilisation": float(np.nanmax(self.utilisation)) if self.forces else np.nan,
            "redundant": self._redundant(),
            "redundant_count": len(self.utilisation_range.redundant) if self.utilisation_range else 0,
            "stability_margin": self.stability_margin,
            "unbalanced_load": self.result.unbalanced,
            "deflection": float(np.nanmax(self.deflection)) if np.isfinite(self.deflection).any() else np.nan,
            "bending_utilisation": self.bent,
            "parameter": self.design_direction.name if self.design_direction else "",
            "at": self.at if self.design_direction else np.nan,
            "range_low": low,
            "range_high": high,
            "ranges": found,
            "valid_ranges": self._valid_ranges(),
            "inside": self._inside(),
            "tried": self.suggestion_list.tried,
            "tested": self.suggestion_list.tested,
            "suggested": len(self.suggestion_list.found),
            "suggestions": _listed(self.suggestion_list.found),
            "no_suggestions": f"depends on joints: {why}" if depends and why else why,
            "ms_equilibrium": 1e3 * self.seconds,
            "ms_range": 1e3 * self.ranged_seconds,
            "ms_suggestions": 1e3 * self.suggestion_list.seconds if self.suggestion_list.found else np.nan,
            "note": "; ".join(filter(None, [self.note, self.sprung])),
        }

    def _redundant(self) -> str:
        """The JSON text of redundant joints with the range of their utilisation, as many as there is room for."""
        count = len(self.utilisation_range.redundant) if self.utilisation_range else 0
        while len(
            text := json.dumps(recorded_utilisations(self.design.piece, self.utilisation_range, count) if count else [])
        ) > (REDUNDANT_BYTES):
            count -= 1
        return text if count else ""

    def _ranges(self) -> tuple[str, float, float]:
        """The valid ranges of the parameter under the hand as text, and the ends of the one at the hand, or nearest."""
        if self.design_direction is None or not self.design.guidance.ranges:
            return "", *NONE
        intervals = self.design_direction.ranges.intervals
        if not len(intervals):
            return "none", *NONE
        text = "; ".join(self._marked(low, high) for low, high in intervals)
        far = np.maximum(intervals[:, 0] - self.at, self.at - intervals[:, 1])
        low, high = intervals[int(np.argmin(far))]
        return text, float(low), float(high)

    def _valid_ranges(self) -> str:
        """What is under the hand and its valid ranges for programs; empty where nothing is."""
        if self.design_direction is None:
            return ""
        design_direction, ranges = self.design_direction, None
        if self.design.guidance.ranges:
            ranges = tuple(
                ValidRange(
                    float(low), float(high), bool(low <= design_direction.low), bool(high >= design_direction.high)
                )
                for low, high in design_direction.ranges.intervals
            )
        return encode_ranges(
            Grabbed(
                design_direction.subject, design_direction.unit, ranges, design_direction.doubtful if ranges else ()
            )
        )

    def _inside(self) -> int:
        """1: the piece is valid at the hand; 0: it is not; -1: it is, but farther than ranges were looked for."""
        if self.design_direction is None:
            return -1
        known = not self.design.guidance.ranges or self.design_direction.low <= self.at <= self.design_direction.high
        return int(self.result.valid) if known or not self.result.valid else -1

    def _marked(self, low: float, high: float) -> str:
        """A valid range as text; an end that is as far as was looked at is marked."""
        ends = (low, low <= self.design_direction.low), (high, high >= self.design_direction.high)
        return " to ".join(f"{value:.6g}{' or beyond' if is_open else ''}" for value, is_open in ends)

    def linear_displacement(self) -> None:
        """None: planks are rigid."""

    def solution(self) -> Solution:
        """Nothing: rigid planks have no field over a plane."""
        return Solution()

    def fields(self) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """Displacements (8 n, 3) [m] of corners under the weights; utilisation of the worst joint of each plank, and
        deflection."""
        planks = len(self.utilisation)
        moved = np.full((8 * planks, 3), np.nan)
        if self.forces:
            u, X = self.forces[0].u, self.space.X.reshape(planks, 8, 3)
            arms = X - X.mean(axis=1, keepdims=True)
            moved = (u[:, None, :3] + cross(u[:, None, 3:], arms)).reshape(-1, 3)
        cells = {"utilisation": self.utilisation, "valid": np.full(planks, float(self.result.valid))}
        if self.plan.on("bending"):
            cells["deflection"] = self.deflection
        return {"displacement": np.ascontiguousarray(moved)}, cells

    def blank_fields(self, mesh: Boards) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """The same fields where nothing is known."""
        names = ["utilisation", "valid", *(["deflection"] if self.plan.on("bending") else [])]
        cells = {name: np.full(len(mesh.cells), np.nan) for name in names}
        return {"displacement": np.full(mesh.X.shape, np.nan)}, cells

    def residual_norm(self) -> float:
        """The largest residual of a case in parts of the loads."""
        return self.worst

    def errors(self) -> dict[str, float]:
        """None: see `estimated_quantity`."""
        return {}

    def compare_cold(self) -> Comparison:
        """How far tangents and forces are from those of a model made from nothing; for `replay --parity`."""
        if not self.forces:
            return Comparison(0.0, None)
        furniture = Furniture(self.design.piece, self.design.furniture.compliance)
        # A new solver looks at the piece as it was drawn.
        cold = PlankEquilibrium(furniture)
        furniture.test(self.gamma)
        self.design.furniture.geometry(self.gamma)
        entries = difference = 0.0
        for case, warm in enumerate(self.forces):
            fresh = cold.solve(case)
            tangents = [_tangent(cold, case, fresh), _tangent(self.equilibrium, case, warm)]
            entries = max(entries, _relative(*tangents))
            pairs = ((getattr(fresh, name), getattr(warm, name)) for name in ("u", "tension", "bending", "shear"))
            difference = max(difference, *(_relative(*pair) for pair in pairs))
        cold.destroy()
        return Comparison(entries, difference)


def _tangent(equilibrium: PlankEquilibrium, case: int, forces: Forces) -> np.ndarray:
    """Values of the tangent at the equilibrium of a case."""
    kernel, law = equilibrium.furniture.kernel, int(forces.one_sided)
    kernel.set_state(case, np.ascontiguousarray(forces.u).ravel(), law)
    values = np.zeros(len(equilibrium.values))
    equilibrium.mixed.tangent(case, law, equilibrium.mixed.join(case), values, equilibrium.furniture.compliance.shift)
    return values


def _relative(one: np.ndarray, other: np.ndarray) -> float:
    """The largest difference over the largest number."""
    size = max(float(np.abs(one).max(initial=0.0)), 1e-300)
    return float(np.abs(one - other).max(initial=0.0)) / size


def _listed(suggestion_list: Sequence[Suggestion]) -> str:
    """The JSON text of suggestions, as many as there is room for; empty without any."""
    entries = [_suggestion_entry(k, suggestion) for k, suggestion in enumerate(suggestion_list, 1)]
    while len(text := json.dumps(entries)) > SUGGESTIONS_BYTES:
        entries.pop()
    return text if entries else ""


def _suggestion_entry(number: int, suggestion: Suggestion) -> dict[str, Any]:
    """A suggestion for programs."""
    t, low, high = (float(f"{value:.6g}") for value in (suggestion.t, *suggestion.span))
    entries = {"number": number, "words": suggestion.whole, "t": t, "range": [low, high], "valid": suggestion.valid}
    return (
        entries
        | {"unit": suggestion.unit, "beyond": suggestion.beyond[1]}
        | ({"rest": suggestion.rest} if suggestion.rest else {})
        | ({"set": [part for one in suggestion.settings for part in one]} if suggestion.settings else {})
        | ({"doubt": suggestion.doubt} if suggestion.doubt else {})
    )
