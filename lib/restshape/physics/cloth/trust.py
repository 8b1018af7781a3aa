"""Why cloth at rest is not to be trusted: stretched edges, bodies inside, crossings, a way that softened it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import compress

import numpy as np

from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.contact.tunnelling import penetrations, tunnelling
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.scene.model import Scene

INSIDE = 0.5
"""Part of `contact.thickness` below a surface from which on cloth counts as inside a body."""


@dataclass(frozen=True)
class Trust:
    """What is known of how far a state can be trusted.

    Args:
        reasons: why it cannot, for people; none: it can.
        max_strain: of the edge that is stretched most; at least 0.
        max_penetration: depth [m] of the deepest place of a triangle in a body.
        crossings: triangles that the cloth's own edges pass through.
    """

    reasons: tuple[str, ...]
    max_strain: float
    max_penetration: float
    crossings: int


def trust_in(state: RelaxationState) -> Trust:
    """How far a state can be trusted; of one that a coarse mesh shows its strain alone is known."""
    problem, scene = state.problem, state.scene
    strain, place = stretched_most(state)
    most = state.plan.settings("cloth").trusted_strain
    reasons = [stretched(strain, place, most)] if strain > most else []
    if state.distance is not None:
        # Shown from a coarse mesh: what bodies and layers do is looked at where the fine one is at rest.
        return Trust(tuple(reasons), strain, np.nan, -1)
    max_penetration = 0.0
    if problem.contact:
        depths = state.lasting(state.x, "depths", lambda: penetrations(problem.contact, problem.corners(state.x)))
        reasons += coming_through(list(compress(scene.bodies, tunnelling(state.bodies, depths))))
        max_penetration = max(depths, default=0.0)
        reasons += penetration_notes("lies", problem, scene, depths)
    crossings = state.lasting(state.x, "crossings", lambda: len(problem.surface.crossed(problem.corners(state.x))))
    reasons += crossing_notes(crossings)
    reasons += problem.ordered_layers.notes(problem.corners(state.x)) if problem.ordered_layers else []
    if state.softness < 1.0:
        reasons.append(f"the way to rest softened the membrane, to {100.0 * state.softness:g} % of its stiffness")
    return Trust((*reasons, *state.doubts), strain, max_penetration, crossings)


def stretched_most(state: RelaxationState) -> tuple[float, np.ndarray]:
    """What `largest_stretch` gives of a state, found once for all places that bodies take it to."""
    return state.lasting(state.x, "stretch", lambda: largest_stretch(state.problem, state.x))


def stretched(strain: float, place: np.ndarray, most: float) -> str:
    """An edge that is stretched beyond what is trusted, at a place (2,) [m] of the pattern."""
    at = ", ".join(f"{1e3 * value:.0f}" for value in place)
    return f"an edge is stretched by {100.0 * strain:.3g} % at ({at}) mm of the pattern, trusted are {100.0 * most:g} %"


def largest_stretch(problem: ClothProblem, x: np.ndarray) -> tuple[float, np.ndarray]:
    """The strain of the edge that is stretched most at x (n, 3) [m], at least 0, and its middle (2,) in the pattern."""
    ends = np.vstack([problem.membrane.corners[:, pair] for pair in ((0, 1), (1, 2), (2, 0))])
    first, second = ends.T
    X = problem.X
    before, now = (np.take(places, first, axis=0) - np.take(places, second, axis=0) for places in (X, x))
    strains = np.sqrt(np.einsum("ij,ij->i", now, now) / np.einsum("ij,ij->i", before, before)) - 1.0
    worst = int(strains.argmax())
    return max(0.0, float(strains[worst])), 0.5 * (X[first[worst]] + X[second[worst]])


def crossing_notes(crossings: int) -> list[str]:
    """What there is to say of so many triangles that others cross."""
    return [f"cloth passes through itself at {crossings} triangle{'s' * (crossings > 1)}"] if crossings else []


def coming_through(names: Sequence[str]) -> list[str]:
    """What there is to say of bodies of these names that come through the cloth."""
    others = f" and {len(names) - 1} others come" if len(names) > 1 else " comes"
    return [f"bodies.{names[0]}{others} through the cloth"] if names else []


def penetration_notes(how: str, problem: ClothProblem, scene: Scene, depths: Sequence[float]) -> list[str]:
    """The body in which cloth is deepest [m], and how many others, of those that it is in.

    It is in one where it is deeper than half of the distance at which contact begins.
    """
    least = INSIDE * problem.contact.thickness
    found = sorted(((depth, name) for name, depth in zip(scene.bodies, depths) if depth > least), reverse=True)
    more = len(found) - 1
    others = f", and less in {more} other bod{'ies' if more > 1 else 'y'}" if more else ""
    return [f"cloth {how} {1e3 * depth:.3g} mm inside bodies.{name}{others}" for depth, name in found[:1]]
