"""What an analysis of motion knows: the state of the last frame, and where its energy has gone."""

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from restshape.analysis.effective_system import EffectiveSystem
from restshape.analysis.motion.increment_subspace import IncrementProjection
from restshape.fem.observer import Observer
from restshape.fem.problem import TransientProblem
from restshape.fem.semidiscrete import SemiDiscrete
from restshape.fem.space import Space
from restshape.fem.time_integration import Motion, TimeIntegration, TimeState
from restshape.first_use import made
from restshape.scene.model import Scene
from restshape.scene.plan import Plan

NOTHING = TimeState(np.zeros((0, 2)), np.zeros((0, 2)), None, 0.0)


@dataclass(frozen=True)
class EnergyAccount:
    """Where the energy of a motion comes from.

    Args:
        known: whether anybody asks.
        last: energy after the last step [J].
        edit, remesh: as in `Motion`.
    """

    known: bool = False
    last: float = 0.0
    edit: float = 0.0
    remesh: float = 0.0


@dataclass(frozen=True, eq=False)
class BoundMotion:
    """What is set up for a mesh and the values of a scene.

    Args:
        body: the scene's problem on its space.
        system: what outlives frames on the space.
        observer: of the scene's quantities.
        increments: what guesses are made of.
    """

    body: SemiDiscrete
    system: EffectiveSystem
    observer: Observer
    increments: IncrementProjection


# All that a step takes and gives, so that a failure takes back the whole of it.
@dataclass(frozen=True, eq=False)
class TransientState:
    """A motion, and what it was found with.

    Args:
        plan: which effects are on.
        scene: whose values it is for.
        in_time: how it is integrated; bound: both None before the first frame.
        now, previous: after the last step and before it.
        account: of energies.
        topology, geometry: versions of the space that it was found at; -1: on none.
        unsolved: no step has been taken yet.
        age: frames since the preconditioner was made.
        start: before the first step of the last frame, on its mesh.
        last_end: the end of the frame before, where the start has the same nodes; None: it has others.
        interrupted: the last frame has failed: what was set up for it must be set up again.
    """

    plan: Plan
    scene: Scene
    in_time: TimeIntegration | None = None
    bound: BoundMotion | None = None
    now: TimeState = NOTHING
    previous: TimeState = NOTHING
    account: EnergyAccount = field(default_factory=EnergyAccount)
    topology: int = -1
    geometry: int = -1
    unsolved: bool = True
    age: int = 0
    start: TimeState = NOTHING
    last_end: TimeState | None = None
    interrupted: bool = False

    def changed(self, **values: object) -> Self:
        """The same with other values: what `dataclasses.replace` makes, in a tenth of its time."""
        other = object.__new__(type(self))
        other.__dict__.update(self.__dict__, **values)
        return other

    def started(self, before: "TransientState | None") -> Self:
        """The motion before the first step of a frame; `before` is that of the frame before, on the same nodes."""
        last_end = None if before is None or before.bound is None else before.now
        return self.changed(start=self.now, last_end=last_end)

    def after(self, now: TimeState) -> "TransientState":
        """The motion after a step to `now`."""
        return self.changed(previous=self.now, now=now, unsolved=False)

    def beside(self, body: SemiDiscrete, now: TimeState) -> Self:
        """The motion of another body with the same settings after a step to `now`, for looking at."""
        return replace(self, bound=replace(made(self.bound), body=body), now=now, unsolved=False)

    @property
    def integration(self) -> TimeIntegration:
        """How it is integrated in time."""
        return self.in_time or made(self.in_time)

    @property
    def body(self) -> SemiDiscrete:
        """The scene's problem on its space."""
        return (self.bound or made(self.bound)).body

    @property
    def problem(self) -> TransientProblem:
        """The scene's problem, before it is discretised in time."""
        return self.body.problem

    @property
    def system(self) -> EffectiveSystem:
        """What outlives frames on the space."""
        return (self.bound or made(self.bound)).system

    @property
    def observer(self) -> Observer:
        """Of the scene's quantities."""
        return (self.bound or made(self.bound)).observer

    @property
    def space(self) -> Space | None:
        """Where the unknowns live; None before the first frame."""
        return None if self.bound is None else self.bound.body.problem.space

    @property
    def motion(self) -> Motion:
        """What quantities see beside the unknowns."""
        account = self.account
        return Motion(self.now.v, account.edit, account.remesh, self._inertia_and_damping, not self.unsolved)

    def _inertia_and_damping(self) -> np.ndarray:
        now = self.now
        base = self.integration.base_acceleration(now.time, now.v.shape[1])
        return self.body.inertia_and_damping(now.y, now.v, base)
