"""What a fit found, for people and for programs."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from restshape_apps.couture.fitting.confidence import Confidence, confidence
from restshape_apps.couture.fitting.drapes_by_number import DrapesByNumber
from restshape_apps.couture.fitting.fit import SAME, Fit, OutlineFit, Step
from restshape_apps.couture.fitting.measured_outline import MeasuredOutline, read_outline
from restshape_apps.couture.fitting.refusals import default_keys, refuse_size

from restshape.fem.observer import area_at
from restshape.physics.cloth.drape_shadow import DIRECTIONS, count_folds, reach
from restshape.scene.model import Scene

Rows = tuple[list[str], list[Sequence[Any]]]
SMOOTHED = 2.0
"""Standard deviation [deg] of the Gaussian that takes noise off a measured outline before its folds are counted."""
CORRELATED = 0.99
"""Correlation of two numbers above which only a product of them is known."""


@dataclass(frozen=True, eq=False)
class MeasuredShadow:
    """What is measured of an outline as of a shadow.

    Args:
        area: [m^2] as it is seen from its middle; folds: around it.
        coefficient: of the drape; None: no quantity of the scene has one.
    """

    area: float
    folds: int
    coefficient: float | None


@dataclass(frozen=True, eq=False)
class FitReport:
    """A fit with what it was asked for.

    Args:
        drapes: of the scene; outline: measured; measured: of it; found: the fit; trust: its intervals.
        disc: area [m^2] that drape coefficients leave out; None: no quantity has one; flat: of the flat cloth.
    """

    drapes: DrapesByNumber
    outline: MeasuredOutline
    measured: MeasuredShadow
    found: Fit
    trust: Confidence
    disc: float | None
    flat: float

    @property
    def best(self) -> Step:
        """The step with the least misfit."""
        return self.found.best

    def coefficient(self, step: Step) -> float | None:
        """Drape coefficient of a step; None: no quantity has one."""
        return _coefficient(step.drape.area, self.disc, self.flat)

    def rounded(self) -> dict[str, float]:
        """The numbers with six digits, by key."""
        return {key: float(f"{value:.6g}") for key, value in zip(self.drapes.keys, self.best.drape.values)}

    def steps(self) -> Rows:
        """A row a step."""
        rows = [
            (
                one.descent or "area",
                *(f"{value:.5g}" for value in one.drape.values),
                f"{1e3 * one.misfit:.4g}",
                one.drape.folds,
                *_cell(self.coefficient(one)),
            )
            for one in self.found.steps
        ]
        return ["start", *self.drapes.keys, "misfit [mm]", "folds", *self._column()], rows

    def numbers(self) -> Rows:
        """A row a number."""
        rows = [
            (key, *(f"{one:.5g}" for one in (start, area, value, low, high)), f"{50 * (high - low) / abs(value):.2g} %")
            for key, start, area, value, low, high in zip(
                self.drapes.keys,
                self.drapes.start,
                self.found.by_area,
                self.best.drape.values,
                self.trust.low,
                self.trust.high,
            )
        ]
        return ["number (SI)", "before", "by area", "fitted", "low", "high", "half width"], rows

    def outlines(self) -> Rows:
        """A row an outline."""
        rows: list[Sequence[Any]] = [
            ("measured", 1e4 * self.measured.area, *_cell(self.measured.coefficient), self.measured.folds, "", "")
        ]
        named = [("before", self.found.first), ("fitted", self.best), ("replay of the fitted scene", self.found.again)]
        for name, step in named:
            if step is not None:
                own = (f"{1e3 * step.misfit:.4g}", f"{1e3 * step.distances.farthest:.4g}")
                rows.append((name, 1e4 * step.drape.area, *_cell(self.coefficient(step)), step.drape.folds, *own))
        return ["outline", "area [cm^2]", *self._column(), "folds", "misfit [mm]", "farthest [mm]"], rows

    def notes(self) -> list[str]:
        """What there is to note."""
        found, trust = self.found, self.trust
        lines = [*filter(None, [self.outline.doubt]), *self.outline.notes]
        lines += [f"by differences, as there is no derivative by {key}: {why}" for key, why in self._differenced()]
        lines += [
            f"the outline does not determine {key}: its interval is wider than a factor of 10 each way"
            for key, loose in zip(self.drapes.keys, trust.loose)
            if loose
        ]
        if trust.correlation > CORRELATED and not trust.loose.all():
            lines.append(f"the outline hardly separates the numbers: their correlation is {trust.correlation:.4f}")
        if self.best.drape.folds != self.measured.folds:
            lines.append(
                f"the outline has {self.measured.folds} folds, the drape {self.best.drape.folds}: cloth has several "
                "rests, and this one is another than that which was measured; intervals do not count that"
            )
        elif not found.like:
            lines.append("the folds are not those of the outline: the misfit is more than 1 % of its radius")
        again = found.again
        if again is None:
            lines.append("a replay of the fitted scene does not come to rest")
        elif abs(again.misfit - self.best.misfit) > SAME * self.best.misfit:
            lines.append(
                "a replay of the fitted scene finds another rest than that of the fit: "
                f"misfit {1e3 * again.misfit:.3g} mm, {again.drape.folds} folds"
            )
        return lines

    def _column(self) -> list[str]:
        return [] if self.disc is None else ["drape coefficient"]

    def _differenced(self) -> list[tuple[str, str]]:
        return list(self.drapes.by_differences.items())

    @property
    def drawn(self) -> tuple[np.ndarray, Step, Step, tuple[str, str]]:
        """What a picture shows."""
        first = self.found.first
        words = tuple(self.drapes.words(step.drape.values) for step in (first, self.best))
        return self.outline.points - self.outline.middle, first, self.best, (words[0], words[1])

    def plain(self) -> dict[str, Any]:
        """For programs."""
        found, trust = self.found, self.trust

        def step(one: Step) -> dict[str, Any]:
            return {
                "start": one.descent,
                "values": dict(zip(self.drapes.keys, one.drape.values.tolist())),
                "misfit": one.misfit,
                "farthest": one.distances.farthest,
                "folds": one.drape.folds,
                "drape_coefficient": self.coefficient(one),
                "area": one.drape.area,
                "turn": one.place.turn,
                "middle": [one.place.x, one.place.y],
            }

        numbers = zip(self.drapes.keys, self.drapes.start, self.best.drape.values, trust.low, trust.high)
        return {
            "numbers": {
                key: {"before": float(start), "fitted": float(value), "low": _finite(low), "high": _finite(high)}
                for key, start, value, low, high in numbers
            },
            "by_area": dict(zip(self.drapes.keys, found.by_area.tolist())),
            "correlation": trust.correlation,
            "independent": trust.independent,
            "measured": {
                "area": self.measured.area,
                "folds": self.measured.folds,
                "drape_coefficient": self.measured.coefficient,
            },
            "before": step(found.first),
            "fitted": step(self.best),
            "again": None if found.again is None else step(found.again),
            "like": found.like,
            "drapes": self.drapes.count,
            "steps": [step(one) for one in found.steps],
            "notes": self.notes(),
        }


def fitted(scene: Scene, args: argparse.Namespace, on_step: Callable[[str, float], None]) -> FitReport:
    """The fit that the arguments ask for.

    Raises:
        UserError: see `read_outline`, `refuse_size`, `DrapesByNumber` and `OutlineFit`.
    """
    outline = read_outline(args.outline)
    drapes = DrapesByNumber(scene, args.by or default_keys(scene), args.edits, args.frame)
    first = drapes.cold(drapes.start)
    refuse_size(outline, drapes, args.outline.name)
    disc, flat = _disc(scene, drapes), drapes.mesh.outline.area()
    radii = smoothed(outline)
    area = float(0.5 * (radii**2).sum() * 2.0 * np.pi / DIRECTIONS)
    measured = MeasuredShadow(area, count_folds(radii), _coefficient(area, disc, flat))
    fit = OutlineFit(
        drapes, outline, measured.folds, lambda step: on_step(drapes.words(step.drape.values), step.misfit)
    )
    found = fit.run(first, args.starts)
    trust = confidence(found.best, found.J, len(outline.points))
    return FitReport(drapes, outline, measured, found, trust, disc, flat)


def smoothed(outline: MeasuredOutline) -> np.ndarray:
    """Radii (`DIRECTIONS`,) [m] of an outline from its middle, without noise."""
    points = outline.points - outline.middle
    radii = reach(points, np.roll(points, -1, axis=0))
    waves = np.radians(SMOOTHED) * np.arange(DIRECTIONS // 2 + 1)
    return np.fft.irfft(np.fft.rfft(radii) * np.exp(-0.5 * waves**2), DIRECTIONS)


def _disc(scene: Scene, drapes: DrapesByNumber) -> float | None:
    """The area that the first drape coefficient among the quantities leaves out [m^2]; None: there is none."""
    for name, quantity in scene.quantities.items():
        if quantity.drape_coefficient and quantity.at is not None:
            return float(area_at(drapes.mesh, name, quantity)())
    return None


def _coefficient(area: float, disc: float | None, flat: float) -> float | None:
    return None if disc is None else (area - disc) / (flat - disc)


def _cell(coefficient: float | None) -> list[str]:
    """A cell of a table, or none."""
    return [] if coefficient is None else [f"{coefficient:.4f}"]


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
