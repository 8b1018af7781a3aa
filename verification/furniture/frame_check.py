"""What every frame of furniture must keep to, whatever piece it shows."""

import math
from typing import Any

import numpy as np
from restshape_apps.furniture.analysis.furnishing import FurnitureAnalysis
from restshape_apps.furniture.guidance.design import DesignDirection
from restshape_apps.furniture.guidance.suggested import Suggestion
from restshape_apps.furniture.physics.furniture import LOST, UNBALANCED, UNSTABLE, Furniture

from restshape.replay.constraints import FAILS, HOLDS, UNCERTAIN

SHOWN = ("utilisation", "stability_margin", "unbalanced_load", "deflection", "bending_utilisation")
"""Columns that have numbers, or none."""
EDGE = 1e-5
"""How near the end of a range nothing is said of, in parts of the way looked at."""
BALANCED = 1e-6
"""Of forces that contacts must give, in parts of the loads."""


def plank_problem(analysis: FurnitureAnalysis, row: dict[str, Any]) -> str:
    """What is wrong with a frame of furniture that was analysed, in words; empty where nothing is."""
    flaws = row["flaws"]
    # What is uncertain has no flaw, and says what it depends on.
    due = (FAILS, True) if flaws else (HOLDS, False), (FAILS, True) if flaws else (UNCERTAIN, True)
    if (row["constraint_status"], bool(row["violated_constraints"])) not in due:
        return f"the status is {row['constraint_status']}, {row['violated_constraints']!r}, with flaws {flaws}"
    if any(math.isinf(row[name]) and not flaws & LOST for name in SHOWN):
        return "a shown number is infinite"
    if not flaws & (LOST | UNBALANCED) and not (math.isfinite(row["residual"]) and math.isfinite(row["utilisation"])):
        return f"a piece with forces has no number for them, flaws {flaws}"
    if not flaws & (LOST | UNBALANCED | UNSTABLE) and (wrong := _unbalanced(analysis)):
        return wrong
    if (
        analysis.design_direction is not None
        and analysis.design.guidance.ranges
        and (wrong := _off_range(analysis.design_direction, row))
    ):
        return wrong
    fresh = [_holds(analysis, suggestion) for suggestion in analysis.suggestion_list.found]
    listed = [suggestion.valid for suggestion in analysis.suggestion_list.found]
    return "" if fresh == listed else f"suggestions are valid {listed}, and in tests of their own {fresh}"


def _unbalanced(analysis: FurnitureAnalysis) -> str:
    """Which case of a piece that stands has contacts that do not bear its loads; empty where there is none."""
    furniture = analysis.design.furniture
    own = furniture.geometry(analysis.gamma).mass.sum() * np.array(furniture.piece.gravity)
    for case, forces in enumerate(analysis.forces):
        loads = furniture.cases[case].sum(axis=0) + own
        size = np.linalg.norm(own) + np.abs(furniture.cases[case]).sum()
        left = float(np.abs(forces.contacts.sum(axis=0) + loads).max())
        if left > BALANCED * size:
            return f"case {case}: contacts leave {left:.3g} N of {size:.3g} N"
    return ""


def _off_range(design_direction: DesignDirection, row: dict[str, Any]) -> str:
    """What a range says otherwise than the frame; narrow pieces of it may hide between two samples."""
    at, holds, found = row["at"], row["flaws"] == 0, design_direction.ranges
    if not design_direction.low <= at <= design_direction.high or found.holds(at) == holds:
        return ""
    edge = EDGE * (design_direction.high - design_direction.low)
    if len(found.intervals) and np.abs(found.intervals - at).min() <= edge:
        return ""
    k = int(np.searchsorted(found.samples, at))
    around = found.flaws[max(k - 1, 0) : k + 1] == 0
    # Where both samples beside it say otherwise, what is so here is narrower than they see, if a test finds it at all.
    here = (
        Furniture(design_direction.design.piece, design_direction.design.furniture.compliance)
        .test(at * design_direction.direction)
        .flaws
        == 0
    )
    hidden = here == holds and bool((around != holds).all())
    return "" if hidden else f"at {at} the piece {row['constraint_status']}, and its range is {row['ranges']}"


def _holds(analysis: FurnitureAnalysis, suggestion: Suggestion) -> bool:
    """Whether a suggestion is valid in a model made from its piece alone."""
    old = analysis.design.furniture
    piece = suggestion.piece if suggestion.piece is not None else old.moved(suggestion.t * suggestion.direction)
    return Furniture(piece, old.compliance).test().valid
