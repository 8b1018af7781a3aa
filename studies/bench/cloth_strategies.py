"""Solution strategies of cloth side by side: methods from one start, kinds of bending, and policies over a script."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import mean, median
from typing import Any

from restshape_studies.bench.job import Job, Outcome, Row, run

STRATEGIES = ("auto", "kinetic", "rayleigh", "newton", "stabilised", "cg")
"""Those of `effects.drape.strategy`, which would take long to import for a help."""
BENDING = ("hinge", "morley", "nonlinear")
POLICIES = ("rebuild", "thesis", "auto")
SLOWER, PATIENCE = 3.0, 30.0
"""Multiple of its limit, beside other work, and seconds beyond, after which a run that does not look at the clock is
ended."""
Play = Callable[[Job, float], Outcome]


@dataclass(frozen=True)
class Plan:
    """What is compared.

    Args:
        strategies: of `effects.drape.strategy`, each from where the scene lays the cloth.
        bending: kinds of `effects.cloth.bending`, by the strategy that the scene names.
        policies: on the frames of the job's script.
        seconds: of the processor's work, after which a run is given up.
    """

    strategies: Sequence[str] = STRATEGIES
    bending: Sequence[str] = BENDING
    policies: Sequence[str] = POLICIES
    seconds: float = 60.0


def study(job: Job, plan: Plan, on_run: Callable[[str], None], play: Play = run) -> Row:
    """The record of a scene, as `bench drape --json` writes it.

    Each run has a process of its own.

    Args:
        job: of the scene, with the script for policies, or without any.
        plan: what is compared.
        on_run: called with what comes next.
        play: runs a job for so many seconds at most.

    Raises:
        UserError: the scene cannot be simulated.

    Returns: strategies and bending: by name what `bench.drape` measures, or a problem; strategies with `short`, the
        part of the energy's decrease to the best equilibrium that is missing; policies: by name what the frames took.
    """
    still = replace(job, edits="", measure="drape", details={"seconds": plan.seconds})
    found: Row = {"strategies": {}, "bending": {}, "policies": {}}
    for kind, key, names in (
        ("strategies", "drape.strategy", plan.strategies),
        ("bending", "cloth.bending", plan.bending),
    ):
        for name in names:
            on_run(f"{kind}: {name}")
            outcome = play(
                replace(still, overrides=(*job.overrides, f"effects.{key}={name}")), SLOWER * plan.seconds + PATIENCE
            )
            found[kind][name] = outcome.found or {"problem": outcome.problem}
    add_short(found["strategies"])
    for name in plan.policies if job.edits else ():
        on_run(f"policies: {name}")
        found["policies"][name] = frames(play(replace(job, policy=name), plan.seconds))
    return found


def add_short(strategies: Mapping[str, Row]) -> None:
    """Note in each run how much of the fall of the energy, to the lowest at rest, it has missed: `short`, or None.

    Cloth that has lost what was in its openings lies lower than it could: where any way has kept it, others count not.
    """
    converged = [entry for entry in strategies.values() if entry.get("converged")]
    resting = [entry["energy"] for entry in [e for e in converged if e.get("kept")] or converged]
    for entry in strategies.values():
        energy = entry.get("energy")
        entry["short"] = None
        if resting and energy is not None and entry["initial_energy"] > (best := min(resting)):
            entry["short"] = (energy - best) / (entry["initial_energy"] - best)


def frames(outcome: Outcome) -> dict[str, Any]:
    """What the frames of a script took, the first and idle ones left out.

    Returns: problem; frames; converged, of them; and where there are any: p50, mean and longest [s], steps, factors and
        iterations a frame; first: seconds of the first frame.
    """
    moved = [row for row in outcome.rows[1:] if row["relaxation_steps"] and row["event"] != "idle"]
    found: dict[str, Any] = {
        "problem": outcome.problem,
        "frames": len(moved),
        "converged": sum(row["converged"] for row in moved),
        "first": outcome.rows[0]["ms"] / 1e3 if outcome.rows else None,
    }
    if moved:
        seconds = [row["ms"] / 1e3 for row in moved]
        found |= {"p50": median(seconds), "mean": mean(seconds), "longest": max(seconds)}
        columns = {"steps": "relaxation_steps", "factors": "factorisations", "iterations": "iterations"}
        found |= {key: mean(row[column] for row in moved) for key, column in columns.items()}
    return found
