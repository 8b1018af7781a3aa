"""Fields with a history at other places: on a new mesh, or where nodes have gone far; and made divergence-free."""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import cast

import numpy as np

from restshape import _kernels
from restshape.algebra.nonlinear.newton import Newton
from restshape.algebra.nonlinear.newton_convergence import Outcome
from restshape.analysis.static.residual_equations import ResidualEquations
from restshape.errors import ReplayProblem
from restshape.mesh.transfer import FieldNodes, Transfer
from restshape.physics.flow.flow_declaration import FlowSettings
from restshape.physics.flow.history import Level, Past
from restshape.physics.flow.incompressible_flow import IncompressibleFlow, TimeStep

OUTSIDE = 1e-9
"""Distance of a point from the nearest one of a mesh, over the extent of the mesh, from which it lies outside."""
FAR = 8.0
"""Sides of a cell that nodes go in a step, beyond which fields are taken at the new places of the nodes."""

log = logging.getLogger("restshape.analysis")


class Carrier:
    """Takes what a flow goes on from to the mesh as it lies.

    Nodes that move keep what they had, and the equations have the velocity of the mesh (ALE); where they go too far in
    a step, they take what was at their new places. Nodes of a new mesh take fields of the mesh before where its nodes
    are now, and the places where these came from, so that they count as nodes that have moved like them.

    Args:
        equations: on the space as it lies; newton: solves them.
        settings: of the time steps.
        tolerance: of the residual, over forces.

    Attributes:
        pressure: spread of the one that makes the last velocity divergence-free on a new mesh [Pa]; 0 without one.

    Source: docs/theory/flow.md.
    """

    def __init__(self, equations: ResidualEquations, newton: Newton, settings: FlowSettings, tolerance: float) -> None:
        self.problem = cast(IncompressibleFlow, equations.problem)
        self.correct = VelocityCorrection(self.problem, equations, newton, settings.time_step, tolerance)
        self.first_order = settings.scheme == "backward_euler"
        self.farthest = {"ale": math.inf, "remap": 0.0, "auto": FAR}[settings.carry]
        self.pressure = 0.0

    def __call__(self, x: np.ndarray, past: Past, old: FieldNodes | None) -> tuple[np.ndarray, Past, Outcome | None]:
        """Unknowns and past on the mesh as it lies, and what it took to take them there.

        Args:
            x: (n, f) unknowns, and past, on the mesh before.
            old: that mesh, its nodes where they are now; None: it is the present one.
        """
        X, stays = self.problem.space.X, old is None or old is self.problem.space
        if stays and courant(past.last, X) <= self.farthest:
            return x, past, None
        # Steps of first order go on from the last level alone.
        past = past.of([past.last]) if self.first_order else past
        levels = past.levels
        if old is None or stays:
            log.info("Nodes go far: fields are taken at their new places")
            return x, past.of([interpolated(level, self.problem, t) for level, t in zip(levels, past.times)]), None
        transfer = Transfer(old, X)
        x = transfer(x)
        followed = self._followed(past, transfer)
        if any(level.areas().min() <= 0.0 for level in followed) or courant(followed[0], X) > self.farthest:
            followed = [interpolated(level, self.problem, t) for level, t in zip(levels, past.times)]
        log.info("Velocities interpolated to %d nodes", len(x))
        total = None
        for k, (level, time) in enumerate(zip(levels, past.times)):
            lost, area = divergence(level)
            outcome, followed[k] = self.correct(followed[k], transfer((lost / area)[:, None])[:, 0], time)
            if k == 0:
                self.pressure = self.correct.pressure
            total = outcome if total is None else outcome.after(total)
        x[:, list(self.problem.history)] = followed[0].values
        return x, past.of(followed), total

    def _followed(self, past: Past, transfer: Transfer) -> list[Level]:
        """All levels at new nodes, by what found them in the mesh before where its nodes are now."""
        space, levels = self.problem.space, []
        fields = np.hstack([part for level in past.levels for part in (level.X, level.values)])
        for found, time in zip(np.hsplit(transfer.curved(fields), len(past.levels)), past.times):
            X, values = found[:, :2].copy(), found[:, 2:].copy()
            still = np.abs(X - space.X).max(axis=1) <= OUTSIDE * np.ptp(space.X, axis=0).max()
            X[still] = space.X[still]
            prescribe(self.problem, values, X, time)
            levels.append(Level(values, X, space.cells.copy()))
        return levels


def prescribe(problem: IncompressibleFlow, values: np.ndarray, X: np.ndarray, time: float) -> np.ndarray:
    """Set what is prescribed of the fields with a history, values (n, h) at nodes X (n, 2), at a time [s].

    Values of the scene may have changed since, so that formulas have no number there: then nothing is.

    Returns:
        Where they are prescribed, (n, h).
    """
    columns, x = list(problem.history), np.zeros(problem.boundary.values.shape)
    x[:, columns] = values
    try:
        with placed(problem, X):
            problem.conditions.evaluate(time, balanced=False)
    except ReplayProblem as why:
        log.info("Past fields are not prescribed: %s", why)
        return np.zeros(values.shape, dtype=bool)
    problem.boundary.apply(x)
    values[...] = x[:, columns]
    return problem.boundary.mask[:, columns] > 0


@contextmanager
def placed(problem: IncompressibleFlow, X: np.ndarray) -> Iterator[None]:
    """Lay the nodes of a problem's space at X (n, 2), for as long as this lasts."""
    space = problem.space
    here = space.X.copy()
    space.X[...] = X
    try:
        yield
    finally:
        space.X[...] = here


def courant(level: Level, X: np.ndarray) -> float:
    """How many of its sides a cell's nodes go at most, from where they lay to X (n, 2): the mesh's Courant number."""
    return _kernels.sides_gone(level.X, X, level.cells)


def interpolated(level: Level, problem: IncompressibleFlow, time: float) -> Level:
    """The fields of a level at the nodes of a problem as they lie now, whatever its mesh is.

    Args:
        time: of the level [s], whose prescribed values count.

    Where there was no fluid, the values are harmonic between those around: what is linear in space stays what it is.
    """
    space = problem.space
    transfer = Transfer(level, space.X)
    values = transfer.curved(level.values)
    away = np.abs(transfer(level.X) - space.X).max(axis=1)
    inside = away <= OUTSIDE * np.ptp(space.X, axis=0).max()
    mask = prescribe(problem, values, space.X, time)
    known = inside[:, None] | mask
    for pattern in np.unique(known, axis=1).T:
        if pattern.any() and not pattern.all():
            columns, nodes = (known == pattern[:, None]).all(axis=0), np.flatnonzero(pattern).astype(np.int32)
            extension = _kernels.HarmonicExtension(space.X, space.cells, nodes)
            values[:, columns] = extension.solve(np.ascontiguousarray(values[np.ix_(nodes, columns)]))
    prescribe(problem, values, space.X, time)
    return Level(values, space.X.copy(), space.cells.copy())


class VelocityCorrection:
    """Makes velocities that were interpolated as divergence-free as they were, by one linear step of the equations.

    The change d of the velocity, and a pressure, solve the step's equations without what drives it: their inertia,
    friction and convection of d balance the pressure, and the divergence becomes that which velocities had on the mesh
    that they come from. That is the one which stabilisation leaves; without any, pressures of the steps after would
    have to bring it about. Velocities that are prescribed stay, and fields that are linear in space and free of
    divergence.

    Args:
        problem: on the space of the velocities; equations: of it; newton: solves them.
        dt: of the steps [s].
        tolerance: of the residual, over forces.

    Attributes:
        pressure: spread of the last one [Pa], see `pressure_spread`.

    Source: docs/theory/flow.md.
    """

    pressure = 0.0

    def __init__(
        self, problem: IncompressibleFlow, equations: ResidualEquations, newton: Newton, dt: float, tolerance: float
    ) -> None:
        self.problem, self.equations, self.newton, self.dt, self.tolerance = problem, equations, newton, dt, tolerance

    def __call__(self, level: Level, wanted: np.ndarray, time: float) -> tuple[Outcome, Level]:
        """What it took, and the fields after it.

        Args:
            level: interpolated ones at the time [s], on the cells of the problem's space.
            wanted: (n,) divergence that velocities had there [1/s].
        """
        problem, columns = self.problem, list(self.problem.history)
        x = np.zeros(problem.boundary.values.shape)
        x[:, columns] = level.values
        problem.take(TimeStep(time, 1.0 / self.dt, self.dt, -level.values / self.dt))
        problem.advecting = level.values[:, :2].copy() if problem.inertia else None
        try:
            problem.update()
            with placed(problem, level.X):
                outcome = self._solve(x, level, wanted)
        finally:
            problem.advecting = None
            self.equations.begin()
        if not outcome.converged:
            log.info("Velocities keep their divergence: %s", outcome.why)
            return outcome, level
        self.pressure = pressure_spread(x)
        values = level.values.copy()
        values[:, :2] = x[:, :2]
        return outcome, Level(values, level.X, level.cells)

    def _solve(self, x: np.ndarray, level: Level, wanted: np.ndarray) -> Outcome:
        """What it takes to give x (n, f), which is changed, this divergence (n,)."""
        problem = self.problem
        if problem.boundary.sliding:
            problem.boundary.sliding.update(level.X)
        defect, area = divergence(level)
        self.equations.begin()
        # All other residuals may stay what they are.
        offset = self.equations.full_residual(x)
        offset[:, 2] -= problem.continuity * (defect - wanted * area)
        problem.boundary.zero(offset)
        scale = problem.force_scale(x)
        return self.newton.solve(x, self.tolerance * scale, scale, offset=offset, rounding=problem.rounding())


def pressure_spread(x: np.ndarray) -> float:
    """Standard deviation [Pa] of the nodes' pressures, of unknowns x (n, f)."""
    return float(np.std(x[:, 2]))


def divergence(level: Level) -> tuple[np.ndarray, np.ndarray]:
    """Integrals (n,) of the shapes with the divergence of the velocity, and of the shapes alone [m^2]."""
    corners, velocity = level.X[level.cells], level.values[level.cells, :2]
    (ax, ay), (bx, by) = np.moveaxis(corners[:, 1:] - corners[:, :1], 0, -1)
    (au, av), (bu, bv) = np.moveaxis(velocity[:, 1:] - velocity[:, :1], 0, -1)
    found, twice = au * by - bu * ay + bv * ax - av * bx, ax * by - bx * ay
    nodes, n = level.cells.ravel(), len(level.X)
    share = np.repeat(np.column_stack([found, twice]) / 6.0, 3, axis=0)
    return np.bincount(nodes, share[:, 0], n), np.bincount(nodes, share[:, 1], n)
