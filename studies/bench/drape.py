"""One solution strategy of cloth, iterate by iterate: residual and energy over steps and seconds."""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter, process_time
from typing import Any, cast

import numpy as np
from petsc4py import PETSc
from restshape_studies.bench.openings import inside, kept

from restshape.errors import ReplayProblem, UserError
from restshape.interface.run import Run
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.initial_placement import InitialPlacement
from restshape.physics.cloth.relaxation.equilibrium import EquilibriumSolver
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis
from restshape.physics.cloth.scene import cloth_arguments
from restshape.physics.cloth.trust import trust_in
from restshape.replay.event_counts import EventCounts
from restshape.replay.request import Request
from restshape.scene.model import Scene
from restshape.scene.plan import plan

COUNTED = {"factors": "MatCholFctrNum", "applications": "MatSolve"}


class Over(Exception):
    """The seconds of a run are over. No method may take it for a problem that it can go on from."""


class Trace:
    """Residual and energy at each iterate, with the seconds until then; what is taken down takes none of them.

    Args:
        analysis: whose iterates these are.
        limit: seconds of the processor's work after which the run ends.

    Attributes:
        seconds, residuals, energies: one each, and those at the end of a run that is not given up; an energy is None
            where other cloth stands in: softer, with hinges, or on a coarser mesh.
        x: (n, 3) the last iterate [m] on the scene's own mesh; None before the first.
    """

    def __init__(self, analysis: RelaxationAnalysis, limit: float) -> None:
        self.analysis, self.limit = analysis, limit
        self.seconds: list[float] = []
        self.residuals: list[float | None] = []
        self.energies: list[float | None] = []
        self.x: np.ndarray | None = None
        self.aside, self.busy_aside, self.start, self.begun = 0.0, 0.0, perf_counter(), process_time()
        analysis.watch = self

    @property
    def clock(self) -> float:
        """Seconds of the run."""
        return perf_counter() - self.start - self.aside

    @property
    def busy(self) -> float:
        """Seconds that the processor has worked for the run."""
        return process_time() - self.begun - self.busy_aside

    def __call__(self, solver: EquilibriumSolver, x: np.ndarray, residual: float) -> None:
        """Take an iterate down.

        Raises:
            Over: the seconds are over.
        """
        begun, worked = perf_counter(), process_time()
        spent = begun - self.start - self.aside
        self.seconds.append(spent)
        self.residuals.append(_finite(residual))
        own = solver.problem is self.analysis.bound.problem
        self.x = x.copy() if own else self.x
        stiff = own and solver.problem.softness == 1.0
        self.energies.append(_finite(solver.problem.energy(x)) if stiff else None)
        self.aside, self.busy_aside = self.aside + perf_counter() - begun, self.busy_aside + process_time() - worked
        if self.busy > self.limit:
            raise Over(f"{self.limit:g} s are over")

    def end(self, seconds: float) -> None:
        """Take down where the run has come to: the last iterate of a method, or what friction has made of it."""
        self.seconds.append(seconds)
        self.residuals.append(_finite(self.analysis.state.report.residual))
        self.energies.append(_finite(self.analysis.problem.energy(self.analysis.x)))


def measure(request: Request, seconds: float) -> dict[str, Any]:
    """How a scene's cloth comes to equilibrium from its initial placement, by the strategy that the scene names.

    Args:
        request: of a scene of cloth; its script is left out.
        seconds: of the processor's work, after which it is given up.

    Raises:
        UserError: the scene is not one of cloth.

    Returns: converged, stable, residual (over the weight), energy [J], initial_energy (of the weight at the start [J]),
        seconds, busy (those that the processor worked for it), steps, factors (complete ones), applications (of
        preconditioners and factors), why (it is not in equilibrium), unknowns, elements, the trace: seconds,
        residuals, energies, and what `trust` gives.
    """
    PETSc.Log.begin()
    if not plan(request.scene, request.application).on("drape"):
        raise UserError(
            "the scene has no cloth that reaches equilibrium", str(request.scene.path), "name one of couture"
        )
    run = Run(request, summed=False)
    analysis = cast(RelaxationAnalysis, run.replay.analysis)
    counts = EventCounts(tuple(COUNTED.values()))
    trace, over = Trace(analysis, seconds), ""
    try:
        next(run)
    except Over as problem:
        over = str(problem)
    except UserError as problem:
        # The replay says so of a first frame without an answer; that of a method is one here.
        if not isinstance(problem.__cause__, ReplayProblem):
            raise
        over = str(problem.__cause__)
    spent, busy, events = trace.clock, trace.busy, counts.since_last()
    if not over:
        trace.end(spent)
    return {
        **_ended(analysis, trace, over),
        "seconds": spent,
        "busy": busy,
        **{name: events[event] for name, event in COUNTED.items()},
        "initial_energy": _initial_energy(analysis.bound.problem, request.scene),
        "unknowns": int(analysis.bound.x.size),
        "elements": len(analysis.bound.problem.mesh.cells),
        **trust(analysis, trace.x if over else analysis.x, request.scene),
        "trace": {"seconds": trace.seconds, "residuals": trace.residuals, "energies": trace.energies},
    }


def trust(analysis: RelaxationAnalysis, x: np.ndarray | None, scene: Scene) -> dict[str, Any]:
    """How far cloth at x (n, 3) [m] can be trusted, in the first frame of a scene; nothing is known of None.

    Returns: max_strain, max_penetration [m], crossings, untrusted (why, for people), kept (what was in openings at
        first still is; None: there was nothing), inside (what is in openings).
    """
    if x is None:
        return dict.fromkeys(("max_strain", "max_penetration", "crossings", "kept"), None)
    state = replace(analysis.bound, x=x, scene=scene)
    found, problem, mesh = trust_in(state), state.problem, state.problem.mesh
    bodies = dict(zip(scene.bodies, state.bodies))
    start = cloth_arguments(scene, state.plan, mesh).start
    before, after = (inside(mesh.X, mesh.cells, places, bodies) for places in (start, problem.corners(x)))
    return {
        "max_strain": found.max_strain,
        "max_penetration": found.max_penetration,
        "crossings": found.crossings,
        "untrusted": "; ".join(found.reasons),
        "kept": kept(before, after),
        "inside": after,
    }


def _ended(analysis: RelaxationAnalysis, trace: Trace, over: str) -> dict[str, Any]:
    """How a run ended, by itself or not."""
    report = analysis.state.report
    residual = trace.residuals[-1] if over and trace.residuals else report.residual
    energies = [energy for energy in trace.energies if energy is not None]
    energy = (energies or [None])[-1] if over else analysis.bound.problem.energy(analysis.x)
    return {
        "converged": not over and report.converged,
        "stable": None if over else report.stable,
        "residual": residual if residual is None else _finite(residual),
        "energy": None if energy is None else _finite(energy),
        "steps": len(trace.seconds) if over else report.steps,
        "why": over or report.why,
    }


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _initial_energy(cloth: ClothProblem, scene: Scene) -> float:
    """The energy [J] of the weight at the initial placement, flat and without scatter."""
    places = InitialPlacement(scene).places(cloth.mesh)
    return -float(cloth.lumped.mass[cloth.corner_number] @ (places @ cloth.g))
