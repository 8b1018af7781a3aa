"""What a tuning came to, for people and for programs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from restshape_apps.metallophone.tuning.descent import IN_TUNE, TuningStep
from restshape_apps.metallophone.tuning.tuning import Tuning

from restshape.analysis.modal.pitch import note
from restshape.outputs.si_numbers import counted

Rows = tuple[list[str], list[Sequence[Any]]]


class TuningReport:
    """Tables and plain values of a tuning.

    Args:
        tuning: that is told of; a4: frequency of A4 [Hz].
    """

    def __init__(self, tuning: Tuning, a4: float) -> None:
        self.tuning, self.found, self.a4 = tuning, tuning.found, a4

    def steps(self) -> Rows:
        """A row a state that was kept; modes by their rank at the start."""
        tones = self.tuning.ranks
        heads = ["solves", "mesh", "part", *(f"f_{k} [Hz]" for k in tones), *(f"off_{k} [cents]" for k in tones)]
        rows = [
            (
                step.solves,
                "new" if step.level > 2 else f"level {step.level}",
                "" if step is self.found.steps[0] or not step.part else f"{step.part:g}",
                *(f"{f:.2f}" for f in step.frequencies),
                *(f"{c:+.2f}" for c in step.cents),
                f"{1e3 * step.moved:.4f}",
                f"{1e3 * step.thickened:.4f}",
            )
            for step in self.found.steps
        ]
        return [*heads, "outline [mm]", "thickness [mm]"], rows

    def freedoms(self) -> Rows:
        """A row a freedom; modes as in `steps`."""
        bounds, tones = dict(self.found.at_bounds()), self.tuning.ranks
        rows = [
            (
                freedom.name,
                f"{freedom.start:.7g}",
                f"{value:.7g}",
                f"{low:.5g}",
                f"{high:.5g}",
                *(f"{1e-3 * one:+.4g}" for one in rates),
                bounds.get(k, ""),
            )
            for k, (freedom, value, low, high, rates) in enumerate(self._freedoms())
        ]
        return [
            "freedom (SI)",
            "before",
            "tuned",
            "low",
            "high",
            *(f"cents_{k} by 0.001" for k in tones),
            "bound",
        ], rows

    def summary(self) -> str:
        """One sentence: what was reached."""
        last = self.found.last
        tones = ", ".join(f"{f:.2f} Hz ({_named(float(f), self.a4)})" for f in last.frequencies)
        if self.found.in_tune:
            return (
                f"in tune with {self._wanted()}: {tones}, after {counted(self.tuning.solves, 'solve')}{self._errors()}"
            )
        away = ", ".join(f"{c:+.1f}" for c in last.cents)
        if self.found.blocked:
            why = f"there is no solution further on ({self.found.blocked})"
            do = "leave out with --by what leads there, or give bounds that keep off it"
            return f"gave up on {self._wanted()} at {tones}, {away} cents off: {why}; {do}{self._errors()}"
        bounds = [f"{self.tuning.freedoms[k].name} is at its {end} bound" for k, end in self.found.at_bounds()]
        why = f": {'; '.join(bounds)}" if bounds else ": no step within the solves leads nearer"
        if not bounds and not self.found.nearest:
            why = f": {self.tuning.solves} solves are spent, or no step leads nearer"
            return f"gave up on {self._wanted()} at {tones}, {away} cents off{why}{self._errors()}"
        return f"the nearest to {self._wanted()} is {tones}, {away} cents off{why}{self._errors()}"

    def _errors(self) -> str:
        """What the mesh adds to them, by estimate."""
        if not self.tuning.errors:
            return ""
        return f"; error of the mesh about {', '.join(f'{error:.1f}' for error in self.tuning.errors)} cents"

    def notes(self) -> list[str]:
        """What there is to note of modes that lie together, and of what lies below a first tone."""
        together = [
            f"{' and '.join(f'{f:.3f}' for f in sorted(own))} Hz lie together: what is tuned is their mean"
            for own in self.found.clusters
            if len(own) > 1
        ]
        mean = {float(f) for own in self.found.clusters for f in own}
        below = [f for f in self.tuning.below if f not in mean] if self.tuning.ranks[0] == 1 else []
        if not below:
            return together
        tones = " and ".join(f"{f:.2f} Hz" for f in below)
        return [*together, f"{tones} {'lies' if len(below) == 1 else 'lie'} below the tuned tone now"]

    def _wanted(self) -> str:
        wanted = self.tuning.wanted
        ratios = " with " + ":".join(f"{ratio:g}" for ratio in wanted.ratios) if len(wanted.ratios) > 1 else ""
        return f"{wanted.tone} ({wanted.frequencies[0]:.2f} Hz){ratios}"

    def plain(self) -> dict[str, Any]:
        """For programs."""
        wanted, bounds = self.tuning.wanted, dict(self.found.at_bounds())
        return {
            "to": wanted.tone,
            "ratios": list(wanted.ratios),
            "wanted": list(wanted.frequencies),
            "modes": list(self.tuning.ranks),
            "in_tune": self.found.in_tune,
            "blocked": self.found.blocked,
            "within": IN_TUNE,
            "solves": self.tuning.solves,
            "frequencies": self.found.last.frequencies.tolist(),
            "cents": self.found.last.cents.tolist(),
            "errors": list(self.tuning.errors),
            "clusters": [own.tolist() for own in self.found.clusters],
            "notes": self.notes(),
            "tolerances": self.tuning.tolerances.as_json(),
            "steps": [_plain(step) for step in self.found.steps],
            "freedoms": {
                freedom.name: {
                    "before": freedom.start,
                    "tuned": float(value),
                    "low": float(low),
                    "high": float(high),
                    "cents": rates,
                    "bound": bounds.get(k),
                }
                for k, (freedom, value, low, high, rates) in enumerate(self._freedoms())
            },
        }

    def _freedoms(self):
        found = self.found
        return zip(self.tuning.freedoms, found.last.values, found.low, found.high, found.derivatives.T.tolist())


def _named(frequency: float, a4: float) -> str:
    """The nearest tone of a frequency [Hz] and the distance from it."""
    tone, cents = note(frequency, a4)
    return f"{tone} {cents:+.1f} cents"


def _plain(step: TuningStep) -> dict[str, Any]:
    return {
        "solves": step.solves,
        "level": step.level,
        "part": step.part,
        "frequencies": step.frequencies.tolist(),
        "cents": step.cents.tolist(),
        "moved": step.moved,
        "thickened": step.thickened,
        "values": step.values.tolist(),
    }
