"""A hard case: what must hold in it, under each policy."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from petsc4py import PETSc
from restshape_studies.stability.known_bounds import ENTRIES, TOLERANCE_WHY, Known
from restshape_studies.stability.scenery import make_run, rows_of, write_scene, write_script

from restshape.calibration import Calibration
from restshape.interface.run import Run
from restshape.replay.parity import Parity

Row = dict[str, Any]


@dataclass(frozen=True)
class Statement:
    """One thing that must hold.

    Args:
        must: what, in words, with its bound.
        value: what was found.
        holds: whether it does.
        bound: the largest value that holds; None where there is none.
        why: what the bound follows from, where that lets it be far above what comes out.
    """

    must: str
    value: float | str
    holds: bool
    bound: float | None = None
    why: str = ""


@dataclass(frozen=True)
class Trial:
    """One run of a case.

    Args:
        folder: for its files.
        policy: what is reused from frame to frame.
        share: of its frames or seeds, for those who cannot wait; 1 for all.
    """

    folder: Path
    policy: str = "auto"
    share: float = 1.0

    def count(self, full: int, least: int = 1) -> int:
        """The number of frames or seeds out of `full`."""
        return max(least, round(self.share * full))

    def solved(self, complete: float) -> float:
        """The bound of numbers of two solves, of which `complete` holds where factors are complete.

        On several ranks they are those of the ranks' own rows.
        """
        parts = self.policy == "thesis" or PETSc.COMM_WORLD.size > 1
        return Known(1e-5, TOLERANCE_WHY) if parts else complete

    def replay(
        self,
        scene: str | Path,
        events: Sequence[Mapping[str, Any]] = (),
        overrides: Sequence[str] = (),
        policy: str | None = None,
        predict: str = "none",
        calibration: Calibration | None = None,
    ) -> Run:
        """A run that has not begun, of a scene's file or text and events a tenth of a second apart."""
        path = scene if isinstance(scene, Path) else write_scene(self.folder, scene)
        script = write_script(self.folder, events) if events else None
        return make_run(path, script, policy or self.policy, overrides, calibration, predict=predict)

    def rows(self, scene: str | Path, events: Sequence[Mapping[str, Any]] = (), **more: Any) -> list[Row]:
        """The rows of such a run."""
        return rows_of(self.replay(scene, events, **more))

    def compared(
        self, scene: str | Path, events: Sequence[Mapping[str, Any]] = (), every: int = 1, **more: Any
    ) -> tuple[list[Row], list[Statement]]:
        """The rows of such a run, and the statements that its frames equal cold solves: every so many of them."""
        made = self.replay(scene, events, **more)
        check = Parity(made.replay)
        rows = rows_of(made, lambda row: row["index"] % every or check())
        return rows, list(equal(check))


Statements = Callable[[Trial], Iterable[Statement]]


@dataclass(frozen=True)
class Case:
    """A hard case.

    Args:
        run: gives its statements; its docstring's first line says what the case is.
        policies: that it runs under where nobody names any: `auto` and the scene's.
        exempt: policies under which the statements do not apply, each with the reason.
        share: of its frames or seeds that the test-suite runs.
        weekly: policies under which `make weekly` runs it, and `make test` does not.
    """

    run: Statements
    policies: tuple[str, ...] = ("auto",)
    exempt: Mapping[str, str] = field(default_factory=dict)
    share: float = 1.0
    weekly: tuple[str, ...] = ()

    @property
    def summary(self) -> str:
        """What the case is, in one line."""
        return (self.run.__doc__ or "").strip().splitlines()[0]


def true(must: str, found: bool, value: float | str = "") -> Statement:
    """The statement that something is so."""
    return Statement(must, value if value != "" else "yes" if found else "no", bool(found))


def reason(bound: float) -> str:
    """What a bound follows from; empty where what comes out says it."""
    return bound.why if isinstance(bound, Known) else ""


def below(must: str, value: float, bound: float) -> Statement:
    """The statement that a number, or the largest of several, is at most `bound`; a number that is none never is."""
    return Statement(f"{must} at most {bound:g}", float(value), bool(value <= bound), float(bound), reason(bound))


def above(must: str, value: float, bound: float) -> Statement:
    """The statement that a number is at least `bound`."""
    return Statement(f"{must} at least {bound:g}", float(value), bool(value >= bound))


def near(must: str, value: Any, reference: Any, relative: float) -> Statement:
    """The statement that numbers are within so much, relative to their references; shows the largest error."""
    value, reference = np.broadcast_arrays(np.asarray(value, float), np.asarray(reference, float))
    size = np.where(reference == 0.0, 1.0, np.abs(reference))
    error = float(np.max(np.abs(value - reference) / size)) if value.size else math.nan
    return Statement(f"{must} within {relative:g}", error, bool(error <= relative), float(relative), reason(relative))


def equal(check: Parity) -> Iterator[Statement]:
    """The statements that frames equal cold solves: entries to rounding, solutions to the tolerance."""
    found = check.summary()
    yield below("entries equal cold ones", found["entries"], ENTRIES)
    # What compared nothing says nothing.
    solution = found["solution"] if found["compared"] else math.nan
    yield below("solutions equal cold ones", solution, Known(found["tolerance"], TOLERANCE_WHY))


def valid(rows: Sequence[Row], refused: int | None = 0, residual: float | None = None) -> Iterator[Statement]:
    """The statements that shown numbers are finite, so many frames are refused, and residuals are small.

    Args:
        rows: of the frames.
        refused: how many; None: any number.
        residual: largest one of frames that are not refused; None: any.
    """
    shown = [row for row in rows if not row["refused"]]
    numbers = [row[key] for row in shown for key in row if key.startswith(("q_", "f_", "mu_")) or key == "residual"]
    wrong = len(numbers) - int(np.isfinite(numbers).sum())
    yield true(
        f"all numbers of {len(shown)} frames finite", not wrong and bool(numbers), float(wrong) if wrong else "yes"
    )
    if refused is not None:
        count = len(rows) - len(shown)
        why = next((row["refused"] for row in rows if row["refused"]), "")
        value = f"{count}: {why}" if count > refused else float(count)
        yield Statement(f"{refused} frames refused", value, count == refused)
    if residual is not None:
        # The last solution of a refused frame may have been another design's.
        yield below(
            "true residual", max((row["residual"] for row in shown), default=math.nan), Known(residual, TOLERANCE_WHY)
        )


def refused_for(rows: Sequence[Row], *words: str) -> Statement:
    """The statement that each refusal holds one of these words, and there is one."""
    found = [row["refused"] for row in rows if row["refused"]]
    good = [any(word in why for word in words) for why in found]
    wrong = next((why for why, right in zip(found, good) if not right), "")
    must = f"refused with {' or '.join(repr(word) for word in words)}"
    return Statement(must, wrong or f"{len(found)} frames", bool(found) and all(good))
