"""Tuning a bar: Gauss-Newton on the derivatives of its tones, with a line search by solves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from restshape_apps.metallophone.tuning.bar import Bar
from restshape_apps.metallophone.tuning.bounds import bounded, refuse_idle
from restshape_apps.metallophone.tuning.followed_modes import FollowedModes, followed
from restshape_apps.metallophone.tuning.motions import Motions, motions_of
from restshape_apps.metallophone.tuning.smallest_change import smallest_change
from restshape_apps.metallophone.tuning.tone_rates import tone_rates

IN_TUNE = 0.5
"""Distance [cents] within which a tone is the wanted one."""
CLOSE = 0.1
"""Distance [cents] at which steps end."""
ROUGH = 1.0
"""The same [cents] on the first mesh, where the outline moves: a new mesh of it then has frequencies of its own."""
SLIGHT = 0.02
"""Of the whole change: a step below that changes nothing that counts."""
GAIN, SHARE = 1.0, 0.003
"""Cents, and share of the distance: what leads nearer to tones that are far by less leads nowhere."""
NEAR, SLOW = 50.0, 0.2
"""Distance [cents], and share of the one before, between which a step shows that gradients turn on the way: then steps
are the least themselves, which end in tune at once and hardly beside the least change."""
STILL = 1e-9
"""Of the distance of its bounds, which a freedom may move that has been stopped."""
AHEAD = 128.0
"""Times the radius in which no step leads nearer, which show what leads where the outline meets itself."""
HALVINGS = 4
"""Of a step that does not lead nearer."""
TRIALS = 10
"""Of a step, those included that lead to no shape."""
DIGITS = 7
"""Of the numbers that are tried and written."""
CENTS = 1200.0 / np.log(2.0)
"""A factor e of a frequency [cents]."""


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
        clusters: of each tuned mode the frequencies [Hz] of its cluster, itself first.
        blocked: why there is no solution where the last step would have led; empty where there is one.
        nearest: whether derivatives show no way nearer.
    """

    steps: list[TuningStep] = field(default_factory=list)
    derivatives: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    low: np.ndarray = field(default_factory=lambda: np.zeros(0))
    high: np.ndarray = field(default_factory=lambda: np.zeros(0))
    clusters: list[np.ndarray] = field(default_factory=list)
    blocked: str = ""
    nearest: bool = False

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
        self.values, self.modes = self.start.copy(), followed(bar, ids)
        bar.keep()
        self.found, self._stopped = Tuned(), np.zeros(len(self.start), dtype=bool)
        self._motions = motions_of(bar, self.values)
        self.found.low, self.found.high = bounded(bar, self._motions, self.start, bounds)
        refuse_idle(bar, self._motions)

    def run(self) -> Tuned:
        """The tuned bar, confirmed on a new mesh of its outline where that has moved; one in tune stays as it is."""
        self._note(1.0)
        if self.found.in_tune:
            return self.found
        self._first, self._slow, self._radius, kept = True, False, np.inf, 0
        while True:
            self._descend()
            kept, before = len(self.found.steps), kept
            if self.bar.solves >= self.most or not self._moved() or (kept == before and not self._first):
                return self.found
            self._first = False
            if not self._renewed() or self.found.in_tune or self._nearest:
                return self.found
            kept += 1

    def _moved(self) -> bool:
        return self.found.last.moved > 0.0

    def _descend(self) -> None:
        """Steps on the mesh as it is, until they lead nowhere."""
        self._nearest = self.found.nearest = False
        while True:
            motions = self._motions = motions_of(self.bar, self.values)
            J = CENTS * tone_rates(self.bar, self.modes, motions)
            self.found.derivatives = J
            done, missing = self.values - self.start, -self._cents()
            step = self._step(J, np.inf)
            change = done + step
            left = np.linalg.norm(missing - J @ step)
            close = ROUGH if self._first and self._moved() else CLOSE
            stuck = left > 0.5 * np.linalg.norm(missing)
            slight = self._slow or _size(motions, step) <= SLIGHT * _size(motions, change)
            idle = stuck and np.linalg.norm(missing) - left < max(GAIN, SHARE * np.linalg.norm(missing))
            if (
                (slight and (self.found.last.worst <= close or stuck))
                or idle
                or (self._idle(close) and not self._stops_what_blocks(J))
            ):
                self._nearest = self.found.last.worst > close
                self.found.nearest = self._nearest and (stuck or idle)
                return
            if self.bar.solves >= self.most - 1 or not (self._search(J, missing) or self._stops_what_blocks(J)):
                return

    def _stops_what_blocks(self, J: np.ndarray) -> bool:
        """Stop the freedoms that alone lead where the outline crosses itself; whether there are any, and others."""
        if not self.found.blocked:
            return False
        step, ends = self._step(J, AHEAD * self._radius), self._stopped.copy()
        for k in np.flatnonzero(step):
            alone = self.values.copy()
            alone[k] = np.clip(alone[k] + step[k], self.found.low[k], self.found.high[k])
            ends[k] = ends[k] or not self.bar.has_outline(alone)
        found = bool((ends & ~self._stopped).any() and not ends.all())
        if found:
            self._stopped, self._radius = ends, np.inf
        return found

    def _idle(self, close: float) -> bool:
        """Whether the last two steps on this mesh have led hardly nearer to tones that are far."""
        last = self.found.steps[-3:]
        if len(last) < 3 or last[-1].worst <= max(close, IN_TUNE) or not all(step.part for step in last):
            return False
        first, _, now = (float(np.linalg.norm(step.cents)) for step in last)
        return now > first - max(GAIN, SHARE * first)

    def _step(self, J: np.ndarray, radius: float) -> np.ndarray:
        """The step (k,) that derivatives (m, k) ask for, no freedom by more than moves the surface by a radius."""
        done, metric = self.values - self.start, self._motions.metric
        still = STILL * (self.found.high - self.found.low)
        reach = np.where(self._stopped, still, radius / np.sqrt(np.diag(metric)))
        low = np.maximum(self.found.low - self.start, done - reach)
        high = np.minimum(self.found.high - self.start, done + reach)
        missing = -self._cents()
        if self._slow:
            return smallest_change(metric, J, missing, low - done, high - done)
        return smallest_change(metric, J, missing + J @ done, low, high) - done

    def _search(self, J: np.ndarray, missing: np.ndarray) -> bool:
        """Take the longest step, within a radius that is halved, that leads nearer; whether one does."""
        now, scale = np.linalg.norm(missing), np.sqrt(np.diag(self._motions.metric))
        step = self._step(J, self._radius)
        largest = float(np.abs(self._step(J, np.inf) * scale).max())
        self.found.blocked = ""
        solved, halvings = 0, 1 if self.found.last.worst <= IN_TUNE else HALVINGS
        for k in range(TRIALS):
            size, left = float(np.abs(step * scale).max()), np.linalg.norm(missing - J @ step)
            values = rounded(np.clip(self.values + step, self.found.low, self.found.high))
            modes = self._solved(values)
            self.found.blocked = self.found.blocked or self.bar.why
            if modes is not None:
                there = np.linalg.norm(self._cents(modes))
                if there <= max(now - 0.1 * (now - left), CLOSE):
                    self._keep(values, modes, size / largest)
                    self._radius = 2.0 * size if k else max(self._radius, 4.0 * size)
                    self._slow = self._slow or (NEAR > there > SLOW * now)
                    return True
            self.bar.forget()
            # What has no shape takes no solve.
            solved += not self.bar.why
            if self.bar.solves >= self.most - 1 or solved > halvings:
                return False
            self._radius = 0.5 * size
            step = self._step(J, self._radius)
        return False

    def _solved(self, values: np.ndarray) -> FollowedModes | None:
        """The modes at values; None where there is no solution, or one of them is lost."""
        return followed(self.bar, self.modes.ids, self.modes.shapes) if self.bar.at(values) else None

    def _renewed(self) -> bool:
        """Solve the result on a new mesh, which a replay of the tuned scene has; whether that can be done."""
        modes = followed(self.bar, self.modes.ids) if self.bar.at(self.values, new_mesh=True) else None
        if modes is not None:
            self._keep(self.values, modes, 0.0)
        return modes is not None

    def _keep(self, values: np.ndarray, modes: FollowedModes, part: float) -> None:
        self.values, self.modes = values, modes
        self.bar.keep()
        self._note(part)

    def _note(self, part: float) -> None:
        change = self.values - self.start
        moved, thickened = self._motions.moved(change), self._motions.thickened(change)
        frequencies, cents = self.modes.frequencies, self._cents()
        step = TuningStep(self.bar.solves, self.bar.level, part, self.values, frequencies, cents, moved, thickened)
        self.found.steps.append(step)
        values = self.bar.analysis.state.modes.values
        self.found.clusters = [np.sqrt(values[group]) / (2.0 * np.pi) for group in self.modes.groups]
        self.on_step(step)

    def _cents(self, modes: FollowedModes | None = None) -> np.ndarray:
        """How many cents (m,) the modes lie above the wanted tones."""
        return CENTS * np.log((modes or self.modes).frequencies / self.wanted)


def _size(motions: Motions, change: np.ndarray) -> float:
    return float(np.sqrt(max(change @ motions.metric @ change, 0.0)))


def rounded(values: np.ndarray) -> np.ndarray:
    """Values with as many digits as are written."""
    return np.array([float(f"{value:.{DIGITS}g}") for value in values])
