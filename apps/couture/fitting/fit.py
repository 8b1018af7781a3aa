"""Numbers of a scene with which its drape has a measured outline: Gauss-Newton on the derivative of the drape."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from restshape_apps.couture.fitting.alignment import aligned
from restshape_apps.couture.fitting.drapes_by_number import Drape, DrapesByNumber, SetByEdits
from restshape_apps.couture.fitting.measured_outline import MeasuredOutline
from restshape_apps.couture.fitting.outline_distance import Distances, Place, from_middle

from restshape.errors import UserError

STILL = 1e-4
"""Change of a logarithm below which a number is found."""
FLAT = 1e-6
"""Change of the sum of squares, as a share, below which it is."""
EVALUATIONS = 30
"""Most drapes of one descent, without those of differences."""
IDLE = 1e-6
"""Root mean square by which the outline moves as a number grows by 1 %, over the outline's radius: less is nothing."""
LIKE = 0.01
"""Misfit over the radius of the outline below which a drape with as many folds is taken for the measured one."""
NEAR = (0.0, *(sign * away for away in (0.03, 0.06, 0.1, 0.15, 0.2) for sign in (1.0, -1.0)))
AWAY = (*NEAR, *(sign * away for away in (0.27, 0.34, 0.41, 0.48, 0.55) for sign in (1.0, -1.0)))
"""Of the logarithms of the numbers whose shadow has the measured area: where cold drapes are begun. Other folds have
other areas, by up to a twentieth: so much as half of the stiffness."""
SEARCH = 5
"""Most cold drapes until the area of the shadow is that of the outline."""
EVEN = 0.005
"""Difference of both areas, as a share, with which that search ends."""
FARTHEST = 1.2
"""Of a step of the search, in logarithms."""
SAME = 0.02
"""Difference of misfits, as a share, up to which drapes with the same numbers are one."""


@dataclass(frozen=True, eq=False)
class Step:
    """A step of a descent.

    Args:
        drape: at rest.
        place: of the measured outline.
        distances: between both.
        descent: number of the cold drape that it comes from; 0: it is one of the search by area.
    """

    drape: Drape
    place: Place
    distances: Distances
    descent: int

    @property
    def misfit(self) -> float:
        """Root of the mean square of the distances [m]."""
        return self.distances.rms


@dataclass
class Fit:
    """What was found.

    Args:
        steps: of the search by area and of all descents, in their order.
        best: that with the least misfit.
        by_area: (k,) values whose cold drape has the area of the outline, as nearly as was found.
        first: the drape of the scene as it is.
        J: (distances, k) weighted derivatives at the best by the logarithms, without what turns and moves.
        again: a drape that a replay of the fitted scene finds; None: not looked for.
        like: whether the best has as many folds as the measured outline, and is near to it.
    """

    steps: list[Step] = field(default_factory=list)
    best: Step | None = None
    by_area: np.ndarray = field(default_factory=lambda: np.zeros(0))
    first: Step | None = None
    J: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    again: Step | None = None
    like: bool = False


class OutlineFit:
    """Fits numbers of a scene to a measured outline.

    Args:
        drapes: of the scene; measured: outline.
        folds: around the measured outline.
        on_step: called after each step.
    """

    def __init__(
        self, drapes: DrapesByNumber, measured: MeasuredOutline, folds: int, on_step: Callable[[Step], None]
    ) -> None:
        self.drapes, self.folds, self.on_step = drapes, folds, on_step
        self.measured = from_middle(measured)
        self.radius = float(np.hypot(*self.measured.T).mean())
        self.found = Fit()
        self.area = measured.area
        self._at: Step | None = None

    def run(self, first: Drape, starts: int) -> Fit:
        """Looks for the area of the outline, then descends from cold drapes near there, until one is like the outline.

        Folds go from one rest to another as numbers change, and most rests are not the measured one; the area of the
        shadow hardly depends on which. Descents keep their folds. They are begun from cold drapes that are nearer to
        the outline than all before, and end where a replay of the scene finds their end again.

        Args:
            first: the drape of the scene as it is.
            starts: most cold drapes that descents are begun from.

        Raises:
            UserError: a number does nothing.
        """
        found, nearest = self.found, np.inf
        found.first = self.step(first, 0)
        middle = self._by_area(found.first)
        found.by_area = middle.drape.values
        for k, away in enumerate(AWAY[:starts], 1):
            step = replace(middle, descent=1) if k == 1 else self._cold(found.by_area * np.exp(away), k)
            if step is None or step.misfit >= nearest:
                continue
            nearest = step.misfit
            end, J = self.descend(step)
            if found.best is None or end.misfit < found.best.misfit:
                found.best, found.J = end, J
            if self._like(found.best):
                found.again = self._cold(found.best.drape.values, k)
                if found.again and self._same(found.again):
                    break
        found.like = self._like(found.best)
        if found.again is None or np.any(found.again.drape.values != found.best.drape.values):
            found.again = self._cold(found.best.drape.values, 0)
        return found

    def _by_area(self, first: Step) -> Step:
        """A cold drape whose shadow has the area of the outline, or that of the search which is nearest to it.

        Newton's steps on the area, the shortest ones in the logarithms of the numbers.
        """
        step, found = first, [first]
        for _ in range(SEARCH):
            self._note(step)
            off = self.area - step.drape.area
            if abs(off) < EVEN * self.area:
                break
            edge = step.drape.edge
            slopes = edge.radii @ self.drapes.rates(step.drape) * step.drape.values * (2.0 * np.pi / len(edge.radii))
            if np.abs(slopes).max() < 100.0 * IDLE * self.area:
                break
            way = off * slopes / (slopes @ slopes)
            way *= min(1.0, FARTHEST / float(np.abs(way).max()))
            cold = self._cold(step.drape.values * np.exp(way), 0)
            if cold is None:
                break
            step = cold
            found.append(step)
        return min(found, key=lambda one: abs(self.area - one.drape.area))

    def _note(self, step: Step) -> None:
        """Keep a step, and hand it on."""
        self.found.steps.append(step)
        self.on_step(step)

    def _like(self, step: Step) -> bool:
        return step.drape.folds == self.folds and step.misfit < LIKE * self.radius

    def _same(self, step: Step) -> bool:
        """Whether a cold drape is the best one once more."""
        return abs(step.misfit - self.found.best.misfit) < SAME * self.found.best.misfit

    def _cold(self, values: np.ndarray, descent: int) -> Step | None:
        """A step from a cold drape; None: it does not come to rest."""
        try:
            drape = self.drapes.cold(values)
        except SetByEdits:
            raise
        except UserError:
            return None
        self._at = None
        return self.step(drape, descent)

    def step(self, drape: Drape, descent: int = 0) -> Step:
        """A step with a drape, on which the outline is placed."""
        last = self._at.place if self._at else None
        return Step(drape, *aligned(self.measured, drape.edge, last), descent)

    def descend(self, start: Step) -> tuple[Step, np.ndarray]:
        """The step with the least misfit from one, on its folds, and the derivatives (distances, k) there, as `Fit.J`.

        Raises:
            UserError: a number does nothing.
        """
        from scipy.optimize import least_squares

        self._at, tried, jacobians = start, [start], []
        origin = start.drape.values

        def residuals(u: np.ndarray) -> np.ndarray:
            if not np.any(u):
                return start.distances.weights * start.distances.values
            drape = self.drapes.near(self._at.drape, origin * np.exp(u))
            if drape is None:
                # The trust region shrinks where there is no rest.
                return np.full(len(start.distances.values), np.nan)
            tried.append(self.step(drape, start.descent))
            return tried[-1].distances.weights * tried[-1].distances.values

        def jacobian(u: np.ndarray) -> np.ndarray:
            # It is asked for at steps that are taken alone.
            self._at = min(tried, key=lambda one: float(np.abs(one.drape.values - origin * np.exp(u)).max()))
            self._note(self._at)
            jacobians.append((self._at, self._derivative(self._at)))
            return jacobians[-1][1]

        least_squares(
            residuals, np.zeros(len(origin)), jacobian, xtol=STILL, ftol=FLAT, gtol=None, max_nfev=EVALUATIONS
        )
        return min(jacobians, key=lambda one: one[0].misfit)

    def _derivative(self, step: Step) -> np.ndarray:
        """Derivatives (distances, k) by the logarithms, weighted, without what turning and moving takes up.

        L. Kaufman, A variable projection method for solving separable nonlinear least squares problems, BIT 15, 1975.

        Raises:
            UserError: a number does nothing.
        """
        weights, rates = step.distances.weights, self.drapes.rates(step.drape)
        J = np.stack(
            [
                weights * step.distances.by_radii(one) * value
                for one, value in zip(rates[:: len(rates) // self._directions(step)].T, step.drape.values)
            ],
            axis=1,
        )
        sizes = np.linalg.norm(J, axis=0)
        for key, value, size in zip(self.drapes.keys, step.drape.values, sizes):
            if 0.01 * size < IDLE * self.radius:
                what = f"{key} = {value:.4g} hardly moves the outline"
                raise UserError(what, "--by", "begin at another value (--set), or name another number")
        placed = weights[:, None] * step.distances.by_place
        return J - placed @ np.linalg.lstsq(placed, J, rcond=1e-9)[0]

    def _directions(self, step: Step) -> int:
        return len(step.distances.values) - len(self.measured)
