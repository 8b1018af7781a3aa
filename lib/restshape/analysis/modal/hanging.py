"""Where a plate that sounds is hung: the two places on the nodal lines of a mode that take least from the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from restshape.analysis.modal.border_distance import BorderDistance
from restshape.analysis.modal.hanging_columns import NOTE, PLACES, loss_columns
from restshape.analysis.modal.line_minimum import line_minimum
from restshape.analysis.modal.mesh_pairs import coinciding, pair_words
from restshape.analysis.modal.modal_state import ModalState, Modes
from restshape.analysis.modal.nodal_lines import inside, linear_triangles, nodal_lines
from restshape.analysis.modal.pair_choice import best_pair, hold
from restshape.analysis.modal.quadratic_patch import quadratic_patch
from restshape.analysis.row_values import RowValues
from restshape.analysis.settings import HangingSettings
from restshape.fem.assembled import Assembled
from restshape.fem.problem import MASS
from restshape.outputs.si_numbers import si
from restshape.sensitivity.frequency_derivative import SolvedModes

OUT_OF_PLANE = 0.5
"""Share of its kinetic energy from which on a mode moves out of the plane."""
SPREAD, LEVEL = 1e-3, 0.1
"""Weights of the squared distances, over that of gyration, of the places from the centre of mass and of that from the
line through both: they choose among places that are as still as others."""


@dataclass(frozen=True)
class Hanging:
    """What is asked of hanging points, where no scene asks.

    Args:
        weights: (k,) of the modes by rank, of those without one 0; empty: 1 of each.
        mode: id of the mode on whose nodal lines they lie.
        at: names of two points or holes that are judged in place of it; empty: the best are found.
        apart: [m] that they are at least from each other; None: the radius of gyration.
        margin: [m] that each is at least from the outline and from holes.
    """

    weights: Sequence[float] = ()
    mode: int = 1
    at: Sequence[str] = ()
    apart: float | None = None
    margin: float = 0.0


@dataclass(frozen=True, eq=False)
class HangingPoints:
    """Two places at which a plate is hung, and what they take from its modes.

    Args:
        places: (2, 2) [m]; not numbers where there are none.
        losses: (modes,) kinetic energy a mass of each mode there, both places' mean, over its mean in the body; of
            frequencies that coincide the mean of theirs.
        offset: distance [m] of the centre of mass from the line through both places: 0 where it hangs level.
        why: there are none, for people; empty where there are.
    """

    places: np.ndarray
    losses: np.ndarray
    offset: float
    why: str = ""

    @property
    def found(self) -> bool:
        """Whether there are such places."""
        return not self.why


def hanging_points(analysis: SolvedModes, weights: Sequence[float] = ()) -> HangingPoints:
    """The places on the nodal lines of mode 1 at which hanging takes least from the others.

    Args:
        analysis: of free vibrations, solved or predicted.
        weights: (k,) of the modes by rank, of those without one 0; empty: 1 of each.

    Source: docs/theory/free-vibrations.md.
    """
    return hanging_of(analysis.state, Hanging(weights))


def hanging_of(state: ModalState, asked: HangingSettings) -> HangingPoints:
    """The places at which hanging takes least from modes, or what a pair of them that is named takes.

    The best two lie on the nodal lines of a mode, at least `apart` from each other and with the centre of mass between
    them, seen from which they lie 90 degrees apart or more. The weighted sum of their losses is the least.

    Raises:
        UserError: a name is that of no entity.
    """
    rank = next(iter(np.flatnonzero(state.ids == asked.mode)), None)
    motion = _Motion(state)
    if asked.at:
        return _judged(motion, asked)
    if state.scene.supports:
        return _nothing(motion, "what supports hold is not hung")
    why = f"mode {asked.mode} is none of those found" if rank is None else motion.not_fixed(int(rank), asked.mode)
    return _nothing(motion, why) if why or rank is None else _best(motion, int(rank), asked)


class HangingColumns:
    """The columns of hanging points, computed again where modes or what is asked for differ from the last frame's."""

    def __init__(self) -> None:
        self._last: tuple[Modes, HangingSettings, RowValues] | None = None

    def __call__(self, state: ModalState, asked: HangingSettings, modes: int) -> RowValues:
        """The columns of a frame whose scene wants so many modes."""
        last = self._last
        if last is None or last[0] is not state.modes or last[1] != asked:
            found = hanging_of(state, asked)
            columns = zip((*PLACES, *loss_columns(modes)), (*found.places.ravel(), *found.losses))
            last = state.modes, asked, {**{name: float(value) for name, value in columns}, NOTE: found.why}
            self._last = last
        return last[2]


class _Motion:
    """How places of a body move in its modes.

    Args:
        state: of the analysis; its body goes where the plane mesh is.
    """

    def __init__(self, state: ModalState) -> None:
        body, modes = state.body, state.modes
        if state.predicted:
            body.follow(np.empty(0, dtype=np.int32))
        self.state, self.X, self.body = state, body.plane.X, body
        known = coinciding(state, min(max(int(modes.chosen.max()) + 1, state.count), len(modes.values)))
        self.groups = [next(group for group in known if k in group) for k in modes.chosen]
        needed = np.unique(np.concatenate(self.groups))
        self.shapes = body.shapes(modes.vectors[needed])
        self.average = np.array([np.isin(needed, group) / len(group) for group in self.groups])
        self.own = np.searchsorted(needed, modes.chosen)
        self._weigh()

    def _weigh(self) -> None:
        """Find mass, centre of mass and radius of gyration, by the forces of a unit acceleration."""
        axes = self.body.axes
        column = axes.index("z") if "z" in axes else 0
        lifted = np.zeros((len(self.body.space.X), len(axes)))
        lifted[:, column] = 1.0
        forces = Assembled(self.body.integrals(MASS)).residual(lifted)[:, column]
        shares = self.body.by_plane_nodes(forces).reshape(len(self.X), -1).sum(axis=1)
        self.mass = float(shares.sum())
        self.centre = shares @ self.X / self.mass
        self.gyration = float(np.sqrt(shares @ ((self.X - self.centre) ** 2).sum(axis=1) / self.mass))

    @property
    def modes(self) -> int:
        """How many are asked for."""
        return len(self.groups)

    def not_fixed(self, rank: int, number: int) -> str:
        """Why a mode, by its rank, has no nodal lines of its own; empty where it has."""
        shape, group = self.shapes[self.own[rank]], self.groups[rank]
        if len(group) > 1:
            return f"lines not fixed: {pair_words(self.state.modes.values[group])}, and so any mix of them"
        energy = (shape**2).sum(axis=0)
        return "" if energy[2] >= OUT_OF_PLANE * energy.sum() else f"mode {number} moves in the plane"

    def losses(self, moved: np.ndarray) -> np.ndarray:
        """Energies (modes, ...) over their means, of displacements (needed, ..., 3) at places."""
        return np.tensordot(self.average, self.mass * (moved**2).sum(axis=-1), axes=1)

    def offset(self, places: np.ndarray) -> float:
        """The distance [m] of the centre of mass from the line through both places (2, 2)."""
        along, to = places[1] - places[0], self.centre - places[0]
        length = float(np.hypot(*along))
        return abs(float(along[0] * to[1] - along[1] * to[0])) / length if length > 0.0 else float(np.hypot(*to))


def _nothing(motion: _Motion, why: str) -> HangingPoints:
    return HangingPoints(np.full((2, 2), np.nan), np.full(motion.modes, np.nan), np.nan, why)


def _judged(motion: _Motion, asked: HangingSettings) -> HangingPoints:
    """The losses of two named places; of a hole the mean of those along its rim."""
    nodes = [motion.body.plane.nodes_of(name) for name in asked.at]
    places = np.array([motion.X[own].mean(axis=0) for own in nodes])
    losses = np.mean([motion.losses(motion.shapes[:, own]).mean(axis=1) for own in nodes], axis=0)
    return HangingPoints(places, losses, motion.offset(places))


def _best(motion: _Motion, rank: int, asked: HangingSettings) -> HangingPoints:
    """The best two places on the nodal lines of a mode by its rank."""
    weights = _by_rank(asked.weights, motion.modes) @ motion.average
    on_lines = _OnLines(motion, int(motion.own[rank]), weights, asked.margin)
    apart = motion.gyration if asked.apart is None else asked.apart
    pair = best_pair(on_lines.away, on_lines.cost, apart, LEVEL / motion.gyration**2)
    if pair is None:
        inside = f", {si(asked.margin, 'm')} off the border" if asked.margin else ""
        which = f"no two places on the lines of mode {asked.mode}, {si(apart, 'm')} apart or more{inside},"
        return _nothing(motion, f"{which} have the centre of mass between them")
    found = [on_lines.smooth(k) for k in pair]
    if not hold(found[0][0] - motion.centre, found[1][0] - motion.centre, apart):
        found = [on_lines.linear(k) for k in pair]
    places = np.array([place for place, _ in found])
    losses = np.mean([motion.losses(moved) for _, moved in found], axis=0)
    return HangingPoints(places, losses, motion.offset(places))


class _OnLines:
    """The place on each segment of a mode's nodal lines at which others move least.

    Args:
        motion: of the body.
        own: index of the mode among those whose displacements are known; weights: (needed,) of these.
        margin: [m] that places keep from the border.
    """

    def __init__(self, motion: _Motion, own: int, weights: np.ndarray, margin: float) -> None:
        self.motion, self.own, self.weights, self.margin = motion, own, weights, margin
        self.triangles = linear_triangles(motion.body.plane.cells)
        self.border = BorderDistance(motion.X, self.triangles)
        self.lines = nodal_lines(self.triangles, motion.shapes[own, :, 2])
        ends, at = self.lines.ends(np.moveaxis(motion.shapes, 0, 1)), self.lines.ends(motion.X)
        share = _stillest(weights, ends)
        if margin:
            share = self.border.kept(at, share, margin)
            fits = np.isfinite(share)
            self.lines = self.lines.those(fits)
            share, ends, at = share[fits], ends[fits], at[fits]
        self.places = at[:, 0] + share[:, None] * (at[:, 1] - at[:, 0])
        self.moved = ends[:, 0] + share[:, None, None] * (ends[:, 1] - ends[:, 0])
        self.away = self.places - motion.centre
        spread = SPREAD * (self.away**2).sum(axis=1) / motion.gyration**2
        self.cost = motion.mass * np.einsum("k,mka,mka->m", weights, self.moved, self.moved) + spread

    def linear(self, segment: int) -> tuple[np.ndarray, np.ndarray]:
        """The place (2,) on a segment, and the displacements (needed, 3) there, linear on the triangle."""
        return self.places[segment], self.moved[segment]

    def smooth(self, segment: int) -> tuple[np.ndarray, np.ndarray]:
        """The same by displacements that are quadratic around it; the linear ones where these have no least place."""
        place, motion, nodes = self.places[segment], self.motion, self.lines.sides[segment].ravel()
        count, shapes = len(self.weights), np.moveaxis(motion.shapes, 0, 1).reshape(len(motion.X), -1)
        fields = np.column_stack([shapes, motion.X - motion.centre])
        patch = quadratic_patch(motion.X, self.triangles, fields, place, nodes)
        if patch is None:
            return self.linear(segment)
        spread = SPREAD / (motion.mass * motion.gyration**2)
        least = line_minimum(patch, 3 * self.own + 2, np.append(np.repeat(self.weights, 3), [spread, spread]))
        if least is None or not inside(motion.X[self.triangles], least):
            return self.linear(segment)
        if self.margin and self.border(least[None])[0] < self.margin:
            return self.linear(segment)
        return least, patch.values(least)[0][: 3 * count].reshape(count, 3)


def _by_rank(weights: Sequence[float], count: int) -> np.ndarray:
    """The weights (count,) of so many modes from those given."""
    if not len(weights):
        return np.ones(count)
    given = np.asarray(weights, dtype=float)[:count]
    return np.append(given, np.zeros(count - len(given)))


def _stillest(weights: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """The shares (m,) of segments at which the weighted energy is least; displacements (m, 2, k, 3) of their ends."""
    start, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    slope = np.einsum("k,mka,mka->m", weights, start, along)
    bend = np.einsum("k,mka,mka->m", weights, along, along)
    return np.clip(np.divide(-slope, bend, out=np.full(len(bend), 0.5), where=bend > 0.0), 0.0, 1.0)
