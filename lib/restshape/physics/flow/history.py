"""What a flow in time goes on from: its fields at the ends of the last two steps, and backward differences of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape.physics.flow.flow_declaration import FlowSettings
from restshape.physics.flow.incompressible_flow import TimeStep

LONGER = 1.0 + 2.0**0.5
"""A step that is longer than the one before by more than this factor is one of first order: the difference of second
order is not stable there. Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, III.5."""


@dataclass(frozen=True, eq=False)
class Past:
    """The fields with a history at the end of the last time step, and at the end of that before.

    Args:
        time: of the last one [s].
        values: (n, h) of the nodes then, the columns `IncompressibleFlow.history` of the unknowns, in their units.
        places: (n, 2) of the nodes then [m].
        before: values and places at the end of the step before, on the same nodes; None: there was none.
        dt: between the two [s].
    """

    time: float
    values: np.ndarray
    places: np.ndarray
    before: tuple[np.ndarray, np.ndarray] | None = None
    dt: float = 0.0

    def step(self, X: np.ndarray, settings: FlowSettings) -> TimeStep:
        """What the next step adds to the equations, whose nodes are at X (n, 2) [m] then.

        The velocity of the mesh is the difference by which the rates of the fields are taken: with another one, steady
        fields that are linear in space would change where the mesh moves.
        """
        dt, moved = settings.time_step, X - self.places
        if self.before is None or settings.scheme == "backward_euler" or dt > LONGER * self.dt:
            past, mesh, rate = -self.values / dt, moved / dt, 1.0 / dt
        else:
            values, places = self.before
            ratio = dt / self.dt
            older, rate = ratio**2 / (1.0 + ratio) / dt, (1.0 + 2.0 * ratio) / (1.0 + ratio) / dt
            past = older * values - (1.0 + ratio) / dt * self.values
            # By differences: nodes that have not moved have none to the last bit.
            mesh = rate * moved - older * (self.places - places)
        return TimeStep(self.time + dt, rate, dt, past, mesh if np.any(mesh) else None)

    def after(self, step: TimeStep, values: np.ndarray, X: np.ndarray) -> Past:
        """The past after a step to values (n, h), with nodes at X (n, 2)."""
        return Past(step.time, values.copy(), X.copy(), (self.values, self.places), step.dt)
