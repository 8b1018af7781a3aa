"""What cloth shows at the hand: seams, supports, contact, where it is stretched most, whether it is in equilibrium."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from restshape.live.condition_marks import ConditionMarks
from restshape.live.extreme_marks import ExtremeMarks
from restshape.live.kept_marks import kept, of_answers
from restshape.live.seen_frame import SeenFrame
from restshape.live.shown_marks import NOWHERE, Lines, Mark, Words
from restshape.physics.cloth.seams.seams import OPEN
from restshape.physics.cloth.trust import stretched_most

if TYPE_CHECKING:
    from restshape.interface.simulation import Simulation
    from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis
    from restshape.physics.cloth.relaxation.state import RelaxationState
    from restshape.physics.cloth.seams.seams import Seams

LEAST_STRAIN = 1e-3
"""Strain from which on it is shown where cloth is stretched most."""


@of_answers
def drape_marks(simulation: Simulation) -> list[Mark]:
    """The marks of the last frame of cloth."""
    return kept(simulation, DrapeMarks)(simulation)


class DrapeMarks:
    """Makes the marks of each frame of cloth; those of a state that is the last one are not made again."""

    def __init__(self) -> None:
        self._conditions, self._extremes = ConditionMarks(), ExtremeMarks()
        self._of: tuple[RelaxationState | None, str] = (None, "")
        self._marks: list[Mark] = []

    def __call__(self, simulation: Simulation) -> list[Mark]:
        """The marks of the last frame; none where it shows no cloth."""
        replay, frame = simulation.replay, simulation.frame
        if not replay.solver.known:
            return []
        state, seen = cast("RelaxationAnalysis", replay.analysis).state, SeenFrame.of(simulation)
        # Why it cannot be trusted comes with the row.
        of = state, str(frame.row["untrusted"])
        if of[0] is not self._of[0] or of[1] != self._of[1]:
            self._of = of
            self._marks = [
                *_seams(state, seen),
                *_touching(state),
                *_stretched(state),
                *_words(state, of[1]),
            ]
        return [*self._conditions(seen), *self._extremes(seen), *self._marks]


def _seams(state: RelaxationState, seen: SeenFrame) -> list[Mark]:
    """Both sides of each seam, and where those that are open are widest."""
    seams, marks = state.problem.seams if state.problem else None, list[Mark]()
    if not seams:
        return marks
    for pair in seams.pairs:
        nodes, starts = np.concatenate([pair.first.nodes, pair.second.nodes]), (0, len(pair.first.nodes))
        words = (pair.name, "")
        marks.append(Lines(f"seam {pair.name}", NOWHERE, starts, "guide", None, words, nodes=nodes[:, None]))
    return [*marks, *_open(state, seams, seen)]


def _open(state: RelaxationState, seams: Seams, seen: SeenFrame) -> list[Mark]:
    """A line across the widest gap of the seams, where that is open."""
    assert state.problem is not None, "what has seams has a problem"
    corners = state.problem.corners(state.x)
    gaps = seams.gaps(corners)
    worst = int(gaps.argmax())
    if not gaps[worst] > OPEN:
        return []
    nodes, share = seams.nodes[worst], float(seams.shares_of_edges[worst])
    here, first, second = corners[nodes]
    at = seen.places(nodes[:1])
    moved = np.stack([here - at[0], (1.0 - share) * first + share * second - at[0]])
    words = [f"open by {1e3 * float(gaps[worst]):.3g} mm"]
    return [Lines("open seam", np.repeat(at, 2, axis=0), (0,), "limit", moved, words)]


def _touching(state: RelaxationState) -> list[Mark]:
    """What touches a body, corners of triangles and the places between them that contact looks at, a dot each."""
    problem = state.problem
    if problem is None or problem.contact is None:
        return []
    contact, corners = problem.contact, problem.corners(state.x)
    here = np.ascontiguousarray(contact.place(corners))
    near = np.zeros(len(here), dtype=bool)
    for body in contact.bodies:
        near |= body.distances(here) < contact.thickness
    if not near.any():
        return []
    flat = np.zeros_like(corners)
    flat[:, :2] = problem.X[: len(corners)]
    at = contact.place(flat)[near]
    return [Lines("touches a body", at, range(len(at)), "force", here[near] - at)]


def _stretched(state: RelaxationState) -> list[Mark]:
    """The strain of the edge that is stretched most, where it is."""
    assert state.problem is not None, "a known state has a problem"
    strain, place = stretched_most(state)
    if strain < LEAST_STRAIN:
        return []
    X = state.problem.X[: len(state.problem.corners(state.x))]
    node = int(((X - place) ** 2).sum(axis=1).argmin())
    at = np.append(place, 0.0)
    moved = state.problem.corners(state.x)[node] - np.append(X[node], 0.0)
    trusted = strain <= state.plan.settings("cloth").trusted_strain
    text = f"stretched most: {100.0 * strain:.2g} %"
    return [Words(text, at.tolist(), "guide" if trusted else "uncertain", moved.tolist())]


def _words(state: RelaxationState, untrusted: str) -> list[Mark]:
    """Whether the cloth is in equilibrium, and why it cannot be trusted if so."""
    marks: list[Mark] = [Words(reason, None, "uncertain") for reason in untrusted.split("; ") if reason]
    if state.predicted:
        return [Words("predicted: not in equilibrium", None, "uncertain"), *marks]
    report = state.report
    of = "weight" if state.problem and state.problem.lumped.load > 0.0 else "forces of the supports"
    if not report.converged:
        return [Words(f"not in equilibrium: residual {report.residual:.1e} of the {of}", None, "limit"), *marks]
    if report.stable is False:
        return [Words("in unstable equilibrium", None, "uncertain"), *marks]
    return [Words(f"in equilibrium: residual {report.residual:.1e} of the {of}"), *marks]
