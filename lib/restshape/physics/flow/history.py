"""What a flow in time goes on from: its fields at the ends of the last two steps, and backward differences of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from restshape.mesh.quality import areas
from restshape.physics.flow.flow_declaration import FlowSettings
from restshape.physics.flow.incompressible_flow import IncompressibleFlow, TimeStep

LONGER = 1.0 + 2.0**0.5
"""A step that is longer than the one before by more than this factor is one of first order: the difference of second
order is not stable there. Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, III.5."""


@dataclass(frozen=True, eq=False)
class Level:
    """The fields with a history at one time, on the triangles as they lay then; its arrays are never changed in place.

    Args:
        values: (n, h) of the nodes, the columns `IncompressibleFlow.history` of the unknowns, in their units.
        X: (n, 2) of the nodes [m]; cells: (m, 3) int32 of the triangles.
    """

    values: np.ndarray
    X: np.ndarray
    cells: np.ndarray
    dim = 2
    cell_type = "tri3"

    @property
    def corners(self) -> np.ndarray:
        """Of the triangles: their nodes."""
        return self.cells

    def areas(self) -> np.ndarray:
        """Of the triangles (m,) [m^2], negative where nodes run the other way."""
        return areas(self.X, self.cells)

    @classmethod
    def of(cls, problem: IncompressibleFlow, x: np.ndarray) -> Level:
        """That of unknowns x (n, f) of a problem on its space as it lies."""
        space = problem.space
        return cls(problem.remembered(x), space.X.copy(), space.cells.copy())


@dataclass(frozen=True, eq=False)
class Past:
    """The fields with a history at the end of the last time step, and at the end of that before.

    Args:
        time: of the last one [s].
        last: the fields then.
        before: at the end of the step before, on the same nodes; None: there was none.
        dt: between the two [s].
        sudden: the step between them was an impulse, so that the field before does not fit the one after.
        projected: pressures that a new mesh has added to those of the frame, over these.
    """

    time: float
    last: Level
    before: Level | None = None
    dt: float = 0.0
    sudden: bool = False
    projected: float = 0.0

    @property
    def levels(self) -> list[Level]:
        """All of them, the last one first."""
        return [self.last] if self.before is None else [self.last, self.before]

    @property
    def times(self) -> tuple[float, float]:
        """Of the last one, and of that before [s]."""
        return self.time, self.time - self.dt

    def of(self, levels: Sequence[Level]) -> Past:
        """The same with other levels, as many."""
        last, *before = levels
        return replace(self, last=last, before=before[0] if before else None)

    def step(self, X: np.ndarray, settings: FlowSettings) -> TimeStep:
        """What the next step adds to the equations, whose nodes are at X (n, 2) [m] then.

        The velocity of the mesh is the difference by which the rates of the fields are taken: with another one, steady
        fields that are linear in space would change where the mesh moves.
        """
        last, before = self.last, self.before
        dt, moved = settings.time_step, X - last.X
        if before is None or settings.scheme == "backward_euler" or dt > LONGER * self.dt:
            past, mesh, rate = -last.values / dt, moved / dt, 1.0 / dt
        else:
            ratio = dt / self.dt
            older, rate = ratio**2 / (1.0 + ratio) / dt, (1.0 + 2.0 * ratio) / (1.0 + ratio) / dt
            past = older * before.values - (1.0 + ratio) / dt * last.values
            # By differences: nodes that have not moved have none to the last bit.
            mesh = rate * moved - older * (last.X - before.X)
        return TimeStep(self.time + dt, rate, dt, past, mesh if np.any(mesh) else None)

    def after(self, step: TimeStep, problem: IncompressibleFlow, x: np.ndarray) -> Past:
        """The past after a step to unknowns x (n, f) of a problem on its space as it lies."""
        level = Level.of(problem, x)
        if np.array_equal(level.cells, self.last.cells):
            level = replace(level, cells=self.last.cells)
        return Past(step.time, level, self.last, step.dt)
