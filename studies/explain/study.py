"""The plan of a scene and its price: replays side by side, in processes of their own, until time is up."""

import json
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from restshape_studies.bench.job import Job, Outcome, run
from restshape_studies.explain.calls import Row, chosen, keys
from restshape_studies.explain.filled import of_kernels
from restshape_studies.explain.price import BY_STEP, OVERLAP, PARTS, Counts, Prices, prices, widest
from restshape_studies.explain.variants import REQUIRED, variants

from restshape.algebra.reuse.choice import Choice
from restshape.algebra.reuse.prices import Size
from restshape.application import Application
from restshape.calibration import Calibration
from restshape.errors import UserError
from restshape.scene.model import Scene
from restshape.scene.plan import Plan, PlannedEffect, as_written, plan

LEAST_RUNS, MOST_RUNS = 2, 5
LEAST_SECONDS = 10.0
"""After which a run ends that has measured a frame, however few seconds are asked for."""
PART_WHY = {
    "solve": "the solution of what all effects leave: none of them is always there",
    "edit": "the script: reading an edit and changing the outline",
    "mesh": "moving nodes, flips, new meshes, and maps from one to the next",
    "observation": "quantities other than stresses",
    "record": "residual and error estimate of each frame",
}


@dataclass(frozen=True)
class Asked:
    """What is to be explained.

    Args:
        scene: file.
        edits: script; None: the first frame alone.
        overrides: ``key=value`` as after --set.
        petsc: words for PETSc's options database.
        frames: most frames, of those in which something is solved for, beside the first one; None for all.
        seconds: after which no further run begins; after as many, or 10, one ends that has measured a frame.
    """

    scene: Path
    edits: Path | None
    overrides: tuple[str, ...]
    petsc: tuple[str, ...]
    frames: int | None
    seconds: float


def explain(
    asked: Asked, scene: Scene, application: Application, folder: Path, play: Callable[[Job], Outcome] = run
) -> list[Row]:
    """A row for each effect of the application and each part of a frame, as `explain --json` writes them.

    Args:
        asked: what is replayed.
        scene: that it names.
        application: of the scene.
        folder: for temporary files.
        play: runs a job.

    Raises:
        UserError: the scene or its script cannot be replayed.
    """
    planned = plan(as_written(scene), application)
    tried = variants(planned, application)
    job = Job(
        str(asked.scene),
        str(asked.edits or _nothing(folder)),
        scene.solve.policy,
        asked.overrides,
        asked.petsc,
        measure="restshape_studies.explain.paired",
        details={
            # The whole scene twice: what two replays of the same differ by is what a difference is worth.
            "left_out": [sorted(names) for names in (*tried.sets, tried.sets[0])],
            "frames": asked.frames if asked.edits else 0,
            "seconds": max(asked.seconds, LEAST_SECONDS),
        },
    )
    runs, begin = [], time.monotonic()
    while len(runs) < LEAST_RUNS or (len(runs) < MOST_RUNS and time.monotonic() - begin < asked.seconds):
        outcome = play(job)
        if outcome.found is None:
            raise UserError(
                f"the replay ended early: {outcome.problem}", str(asked.scene), "see restshape replay on it"
            )
        runs.append(outcome.found)
    found = prices(runs, tried, planned.solver.equations == "nonlinear")
    whole = [row for row in runs[0] if row["variant"] == 0]
    return Report(planned, application, found, tried.kept, len(runs), solver(planned, scene, whole)).rows()


def solver(planned: Plan, scene: Scene, whole: list[Row]) -> Row:
    """The plan of solvers, and what they did in the frames of a replay."""
    made = planned.solver
    used: dict[str, int] = {}
    for row in whole:
        used[row["preconditioner"]] = used.get(row["preconditioner"], 0) + 1
    return {
        "equations": made.equations,
        "why": made.why,
        "systems": [vars(system) for system in made.systems],
        "order": planned.order,
        "order_why": planned.order_why,
        "models": models(planned),
        "elements": sorted({name for row in whole for name, calls in row["calls"].items() if "tangent" in calls}),
        "policy": scene.solve.policy,
        "preconditioners": used,
        "expected_ms": expected(scene, whole[-1]) if _chooses(planned, scene) else {},
        "factorisations": sum(row["pc_rebuilt"] for row in whole),
        "iterations": sum(row["iterations"] for row in whole),
        "newton": sum(row["newton"] for row in whole),
    }


def models(planned: Plan) -> dict[str, str]:
    """What the settings of effects choose among several ways, by key."""
    settings = [(effect.name, effect.settings.model_dump()) for effect in planned.effects if effect.settings]
    return {f"{name}.{key}": value for name, keys in settings for key, value in keys.items() if isinstance(value, str)}


def _chooses(planned: Plan, scene: Scene) -> bool:
    """Whether the preconditioner is chosen by what counted work costs."""
    return scene.solve.policy == "auto" and planned.solver.systems[0].krylov == "cg"


def expected(scene: Scene, row: Row) -> dict[str, float]:
    """Milliseconds a solve that the choice expects of each preconditioner on the system of a frame."""
    size = Size(row["unknowns"], row["entries"] / max(1, row["matrices"]))
    choice = Choice(Calibration.load(), scene.solve.factor_memory)
    return {candidate.name: 1e3 * choice.cost(candidate, size) for candidate in choice.open(size)}


def _nothing(folder: Path) -> Path:
    """A script without edits."""
    path = folder / "nothing.jsonl"
    path.write_text(json.dumps({"format": "restshape-edits", "version": 1, "units": "m"}) + "\n")
    return path


@dataclass(frozen=True)
class Report:
    """Rows of what was found.

    Args:
        plan: of the scene.
        application: of the scene.
        prices: of what can be left out.
        kept: why the others cannot be.
        runs: that were measured.
        solver: goes with the effects that are always there.
    """

    plan: Plan
    application: Application
    prices: Prices
    kept: dict[str, str]
    runs: int
    solver: Row

    def rows(self) -> list[Row]:
        """All effects, named ones first, then the parts of a frame that belong to none."""
        effects = [*self.plan.effects, *self.plan.derived]
        core = self._core()
        rows = [self._row(effect, core) for effect in effects]
        measured, why = self.prices, self.application.frame_parts(PART_WHY)
        for part in PARTS:
            if part == "solve":
                if not core:
                    whole = {**self._numbers("", measured.counts[""]), "how": "all that is left", "solver": self.solver}
                    rows.append({"effect": part, "kind": "part", "on": True, "why": PART_WHY[part], **whole})
                continue
            counts = Counts(calls=measured.beside if part == "record" else {})
            row = self._numbers(part, counts)
            rows.append({"effect": part, "kind": "part", "on": True, "why": why[part], **row, "how": "measured"})
        return rows

    def _core(self) -> str:
        """The effect that has what belongs to no other: one that is kept, or without which nothing is."""
        named, tried = self.application.effects, self.prices.problems
        kept = [name for name in self.kept if not self._own(name)]
        driving = [name for name in named if name in tried and named[name].drives and not self._own(name)]
        return next(iter([*(name for name in kept if name in named), *driving, *kept, *self.kept]), "")

    def _row(self, effect: PlannedEffect, core: str) -> Row:
        name, known = effect.name, {**self.application.effects, **self.application.derived}
        head = {
            "effect": name,
            "kind": effect.cause,
            "required": self.kept.get(name) == REQUIRED,
            "on": effect.on,
            "why": effect.why,
            "summary": known[name].summary,
        }
        if not effect.on:
            return {**head, **self._numbers(name, Counts()), "how": "absent"}
        rest = self.prices.counts[""]
        taken = {other: self._share_of(other, rest) for other in self.kept if other != core}
        if name == core:
            how = f"all that is left{', with ' + ', '.join(taken) if taken else ''}"
            how = OVERLAP if self.prices.shares[""] < 0.0 else how
            kept = keys(rest.calls).difference(*(keys(counts.calls) for counts in taken.values()))
            entries = rest.entries - sum(counts.entries for counts in taken.values())
            counts = replace(rest, entries=entries, calls=chosen(rest.calls, kept))
            return {**head, **self._numbers("", counts), "how": how, "solver": self.solver}
        counts = self.prices.counts.get(name) or taken.get(name, Counts())
        how = self.prices.problems.get(name) or (BY_STEP if name in self.prices.by_step else "by difference")
        if name in self.kept:
            within = getattr(known[name], "needs", "") or core
            how = f"its time is within that of {within}: {self.kept[name]}"
        return {**head, **self._numbers(name, counts), "how": how}

    def _own(self, name: str) -> tuple[str, ...]:
        """How the names of the kernels begin that are called for a named effect alone."""
        return self.application.effects[name].kernels if name in self.application.effects else ()

    def _share_of(self, name: str, rest: Counts) -> Counts:
        """The calls of kernels that are there for an effect alone, and the matrices that only they fill."""
        own = self._own(name)
        calls = {kernel: made for kernel, made in rest.calls.items() if own and kernel.startswith(own)}
        return Counts(0, widest(calls, self.prices.reach), of_kernels(rest.filled, own), calls)

    def _numbers(self, name: str, counts: Counts) -> Row:
        measured = self.prices
        share = measured.shares.get(name, 0.0)
        made = sum(times for purposes in counts.calls.values() for times, _ in purposes.values())
        return {
            "unknowns": counts.unknowns,
            "elements": counts.elements,
            "entries": counts.entries,
            "calls": made / measured.frames,
            "kernels": counts.calls,
            "share": share,
            "spread": measured.spreads.get(name, 0.0),
            "ms": share * measured.ms,
            "frames": measured.frames,
            "runs": self.runs,
        }
