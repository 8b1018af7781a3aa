"""Cloth that is placed folded or rolled up, and comes to rest from there."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.relaxation.equilibrium import ROUGH
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport

MOST = 3_000
"""Steps of a fall, and of a descent."""
FALLS = 6
"""Times that cloth falls again where a descent does not get on."""
Curve = Callable[[np.ndarray], np.ndarray]
"""Places (n, 2) [m], x and height, of arc lengths (n,) [m] along a strip."""


def placed(sheet: ClothProblem, curve: Curve) -> np.ndarray:
    """Places (corners, 3) [m] of a strip along a curve whose heights are over where its lowest node is now."""
    X = sheet.mesh.X
    found = curve(X[:, 0])
    return np.column_stack([found[:, 0], X[:, 1], found[:, 1]])


def fix(sheet: ClothProblem, nodes: np.ndarray, axis: int, x: np.ndarray) -> None:
    """Let nodes (k,) stay at the places that they have in x (corners, 3) [m], along an axis."""
    mask, places = sheet.supports.mask.copy(), sheet.supports.places.copy()
    mask[nodes, axis], places[nodes, axis] = 1, x[nodes, axis]
    sheet.set_values(sheet.fabric, replace(sheet.supports, mask=mask, places=places), sheet.g)


def rested(analysis: RelaxationAnalysis, x: np.ndarray) -> tuple[np.ndarray, ConvergenceReport]:
    """The cloth of an analysis at rest (corners, 3) [m], from places x (corners, 3) [m], and how that went.

    Raises:
        ValueError: it crosses itself there.
    """
    sheet, solver, report = analysis.problem, analysis.state.solver, ConvergenceReport()
    if not sheet.begin(y := sheet.flat(x)):
        raise ValueError("the cloth is placed across itself")
    for _ in range(FALLS):
        solver.fall(y, ROUGH, MOST, report)
        if solver.converge(y, MOST, report).converged:
            break
    analysis.state = replace(analysis.state, x=y, report=report)
    return sheet.corners(y), report


def along(parts: list[tuple[float, float]]) -> Curve:
    """The curve of parts one after the other: lengths [m] and curvatures [1/m], from the origin along x."""

    def curve(s: np.ndarray) -> np.ndarray:
        found, at, angle, begin = np.zeros((len(s), 2)), np.zeros(2), 0.0, 0.0
        for number, (length, bent) in enumerate(parts):
            last = number == len(parts) - 1
            here = s >= begin if last else (s >= begin) & (s < begin + length)
            found[here] = at + _part(s[here] - begin, angle, bent)
            at = at + _part(np.array([length]), angle, bent)[0]
            angle, begin = angle + bent * length, begin + length
        return found

    return curve


def _part(s: np.ndarray, angle: float, bent: float) -> np.ndarray:
    """The way (n, 2) along an arc, or a line, that begins at an angle."""
    if bent == 0.0:
        return np.outer(s, [np.cos(angle), np.sin(angle)])
    turned = angle + bent * s
    return np.column_stack([np.sin(turned) - np.sin(angle), np.cos(angle) - np.cos(turned)]) / bent


def heights_at(sheet: ClothProblem, corners: np.ndarray, place: tuple[float, float]) -> np.ndarray:
    """The heights [m], from below, at which a vertical line through a place meets the triangles."""
    a, b, c = corners[sheet.mesh.cells].swapaxes(0, 1)
    u, v, w = (b - a)[:, :2], (c - a)[:, :2], np.asarray(place) - a[:, :2]
    size = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    s, t = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / size, (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]) / size
    met = (s >= 0.0) & (t >= 0.0) & (s + t <= 1.0)
    return np.sort((a[:, 2] + s * (b - a)[:, 2] + t * (c - a)[:, 2])[met])
