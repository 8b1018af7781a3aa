"""Tuning a bar: Gauss-Newton on the derivatives of its tones, with a line search by solves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from restshape_apps.metallophone.tuning.bar import Bar, HeldModes
from restshape_apps.metallophone.tuning.motions import Motions, motions_of
from restshape_apps.metallophone.tuning.smallest_change import smallest_change

from restshape.errors import UserError

IN_TUNE = 0.5
"""Distance [cents] within which a tone is the wanted one."""
CLOSE = 0.1
"""Distance [cents] at which steps end."""
ROUGH = 1.0
"""The same [cents] on the first mesh, where the outline moves: a new mesh of it then has frequencies of its own."""
SLIGHT = 0.02
"""Of the whole change: a step below that changes nothing that counts."""
HALVINGS = 4
"""Of a step that does not lead nearer."""
DIGITS = 7
"""Of the numbers that are tried and written."""
CENTS = 1200.0 / np.log(2.0)
"""A factor e of a frequency [cents]."""
IDLE = 1e-9
"""Share of the largest derivative below which a freedom changes no tone."""


@dataclass(frozen=True, eq=False)
class TuningStep:
    """A state of the bar that was kept.

    Args:
        solves: so far; level: of reuse of its mesh; part: of the Gauss-Newton step that was taken.
        values: (k,) of the freedoms; frequencies: (m,) [Hz]; cents: (m,) above the wanted ones.
        moved: root mean square of the displacement of the outline [m]; thickened: the same of the thickness.
    """

    solves: int
    level: int
    part: float
    values: np.ndarray
    frequencies: np.ndarray
    cents: np.ndarray
    moved: float
    thickened: float

    @property
    def worst(self) -> float:
        """Largest distance from a wanted tone [cents]."""
        return float(np.abs(self.cents).max())


@dataclass
class Tuned:
    """What a tuning came to.

    Args:
        steps: in their order, the last the result.
        derivatives: (m, k) cents a unit of each freedom at the end of the last descent.
        low, high: (k,) bounds.
    """

    steps: list[TuningStep] = field(default_factory=list)
    derivatives: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    low: np.ndarray = field(default_factory=lambda: np.zeros(0))
    high: np.ndarray = field(default_factory=lambda: np.zeros(0))

    @property
    def last(self) -> TuningStep:
        """The result."""
        return self.steps[-1]

    @property
    def in_tune(self) -> bool:
        """Whether all wanted tones are met."""
        return self.last.worst <= IN_TUNE

    def at_bounds(self) -> list[tuple[int, str]]:
        """Freedoms that are at a bound, and which one."""
        found, width = [], 1e-6 * (self.high - self.low)
        for k, value in enumerate(self.last.values):
            if value <= self.low[k] + width[k]:
                found.append((k, "lower"))
            elif value >= self.high[k] - width[k]:
                found.append((k, "upper"))
        return found


class Descent:
    """Brings a bar to wanted tones.

    Args:
        bar: solved as the scene has it.
        ids: of the modes that are tuned; wanted: (m,) their frequencies [Hz].
        bounds: (k, 2) of the freedoms; not a number where the default holds.
        most: solves.
        on_step: called with each step.

    Raises:
        UserError: a freedom changes nothing, or starts beyond its bounds.
    """

    def __init__(
        self,
        bar: Bar,
        ids: list[int],
        wanted: np.ndarray,
        bounds: np.ndarray,
        most: int,
        on_step: Callable[[TuningStep], None] = lambda step: None,
    ) -> None:
        self.bar, self.wanted, self.most, self.on_step = bar, wanted, most, on_step
        self.start = np.array([freedom.start for freedom in bar.freedoms])
        self.values, self.held = self.start.copy(), bar.held(ids)
        self._ids, self._shapes = ids, bar.vectors(self.held)
        self.found = Tuned()
        self._motions = motions_of(bar, self.values)
        self.found.low, self.found.high = bounded(bar, self._motions, self.start, bounds)
        _refuse_idle(bar, self._motions)

    def run(self) -> Tuned:
        """The tuned bar, confirmed on a new mesh of its outline where that has moved."""
        self._note(1.0)
        self._first = True
        while True:
            self._descend()
            self._first = False
            if self.bar.solves >= self.most or not self._moved():
                return self.found
            if not self._renewed() or self.found.in_tune or self._nearest:
                return self.found

    def _moved(self) -> bool:
        return self.found.last.moved > 0.0

    def _descend(self) -> None:
        """Steps on the mesh as it is, until they lead nowhere."""
        self._nearest = False
        while True:
            motions = self._motions = motions_of(self.bar, self.values)
            J = self._derivatives(motions)
            self.found.derivatives = J
            done, missing = self.values - self.start, -self._cents()
            low, high = self.found.low - self.start, self.found.high - self.start
            change = smallest_change(motions.metric, J, missing + J @ done, low, high)
            step = change - done
            left = np.linalg.norm(missing - J @ step)
            close = ROUGH if self._first and self._moved() else CLOSE
            stuck = left > 0.5 * np.linalg.norm(missing)
            if _size(motions, step) <= SLIGHT * _size(motions, change) and (self.found.last.worst <= close or stuck):
                self._nearest = self.found.last.worst > close
                return
            if self.bar.solves >= self.most - 1 or not self._search(step, missing, left):
                return

    def _search(self, step: np.ndarray, missing: np.ndarray, left: float) -> bool:
        """Take the longest part of a step, 1, 1/2, ..., that leads nearer; whether one does."""
        now, part = np.linalg.norm(missing), 1.0
        for _ in range(HALVINGS + 1):
            values = rounded(np.clip(self.values + part * step, self.found.low, self.found.high))
            held = self._solved(values)
            if held is not None:
                there = np.linalg.norm(self._cents(held))
                if there <= max(now - 0.1 * part * (now - left), 2.0 * CLOSE):
                    self._keep(values, held, part)
                    return True
            if self.bar.solves >= self.most - 1:
                return False
            part *= 0.5
        return False

    def _solved(self, values: np.ndarray) -> HeldModes | None:
        """The held modes at values; None where there is no solution, or a mode is lost."""
        return self.bar.held(self._ids, self._shapes) if self.bar.at(values) else None

    def _renewed(self) -> bool:
        """Solve the result on a new mesh, which a replay of the tuned scene has; whether that can be done."""
        if not self.bar.at(self.values, anew=True):
            return False
        held = self.bar.held(self._ids, self._shapes)
        if held is None:
            return False
        self._keep(self.values, held, 0.0)
        return True

    def _keep(self, values: np.ndarray, held: HeldModes, part: float) -> None:
        self.values, self.held = values, held
        self._ids, self._shapes = self.bar.ids(held), self.bar.vectors(held)
        self._note(part)

    def _note(self, part: float) -> None:
        change = self.values - self.start
        moved, thickened = self._motions.moved(change), self._motions.thickened(change)
        frequencies, cents = self.held.frequencies, self._cents()
        step = TuningStep(self.bar.solves, self.bar.level, part, self.values, frequencies, cents, moved, thickened)
        self.found.steps.append(step)
        self.on_step(step)

    def _cents(self, held: HeldModes | None = None) -> np.ndarray:
        """How many cents (m,) held modes lie above the wanted tones."""
        return CENTS * np.log((held or self.held).frequencies / self.wanted)

    def _derivatives(self, motions: Motions) -> np.ndarray:
        """Derivatives (m, k) of the tones by the freedoms [cents a unit]."""
        body = self.bar.analysis.state.body
        J = np.zeros((len(self.wanted), len(self.values)))
        gradients = self.bar.gradients(self.held)
        moving = motions.plane.any(axis=(1, 2))
        by_outline = body.motion(motions.plane)
        for k, thicker in enumerate(motions.thickness):
            velocity = by_outline[k] if moving[k] else 0.0
            if thicker.any():
                velocity = velocity + body.thickness_motion(thicker)
            J[:, k] = [CENTS * (gradient * velocity).sum() for gradient in gradients]
        return J


def _size(motions: Motions, change: np.ndarray) -> float:
    return float(np.sqrt(max(change @ motions.metric @ change, 0.0)))


def rounded(values: np.ndarray) -> np.ndarray:
    """Values with as many digits as are written."""
    return np.array([float(f"{value:.{DIGITS}g}") for value in values])


REACH = 0.15
"""Share of the size of the shape that a freedom may move the outline by, where no bound is given."""
THINNER = 0.5
"""Share of the thickness that a freedom may change it by, likewise."""


def bounded(bar: Bar, motions: Motions, start: np.ndarray, given: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper bounds (k,) of the freedoms: those that are given, else by how far a freedom moves what.

    Raises:
        UserError: a freedom starts beyond a bound that is given.
    """
    tiny = np.finfo(float).tiny
    most = np.minimum(
        REACH * bar.outline.size / np.maximum(motions.reach, tiny), THINNER / np.maximum(motions.thinning, tiny)
    )
    low = np.where(np.isnan(given[:, 0]), start - most, given[:, 0])
    high = np.where(np.isnan(given[:, 1]), start + most, given[:, 1])
    for freedom, a, b in zip(bar.freedoms, low, high):
        if not a <= freedom.start <= b:
            what = f"{freedom.name} is {freedom.start:g}, which lies beyond its bounds {a:g} and {b:g}"
            raise UserError(what, "--bound", "widen the bound, or begin at another value (--set)")
    return low, high


def _refuse_idle(bar: Bar, motions: Motions) -> None:
    """Refuses a freedom that moves neither the outline nor the thickness."""
    for freedom, size in zip(bar.freedoms, np.diag(motions.metric)):
        if not size > 0.0:
            what = f"{freedom.name} changes neither the outline nor the thickness"
            raise UserError(what, "--by", "leave it out, or name a freedom that does")
