"""What an analysis of motion knows: the state of the last frame, and where its energy has gone."""

from dataclasses import dataclass, field

import numpy as np

from restshape.analysis.effective_system import EffectiveSystem
from restshape.analysis.increment_subspace import IncrementProjection
from restshape.fem.quantity import Observer
from restshape.fem.semidiscrete import SemiDiscrete
from restshape.fem.space import Space
from restshape.fem.time_integration import Motion, TimeIntegration, TimeState
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


# The fifteen that a step takes and gives, so that a failure takes back all of them.
@dataclass(frozen=True, eq=False)
class TransientState:
    """A motion, and what it was found with.

    Args:
        plan: which effects are on.
        scene: whose values it is for; None before the first solution.
        integration: in time.
        body: the scene's problem on its space.
        system: what outlives frames on the space.
        observer: of the scene's quantities.
        increments: what guesses are made of.
        now, previous: after the last step and before it.
        account: of energies.
        topology, geometry: versions of the space that it was found at; -1: on none.
        factored: the solver has a complete factor of this very matrix.
        unsolved: no step has been taken yet.
        age: frames since the preconditioner was made.
    """

    plan: Plan
    scene: Scene | None = None
    integration: TimeIntegration | None = None
    body: SemiDiscrete | None = None
    system: EffectiveSystem | None = None
    observer: Observer | None = None
    increments: IncrementProjection | None = None
    now: TimeState = NOTHING
    previous: TimeState = NOTHING
    account: EnergyAccount = field(default_factory=EnergyAccount)
    topology: int = -1
    geometry: int = -1
    factored: bool = False
    unsolved: bool = True
    age: int = 0

    @property
    def space(self) -> Space | None:
        """Where the unknowns live."""
        return None if self.body is None else self.body.problem.space

    @property
    def motion(self) -> Motion:
        """What quantities see beside the unknowns."""
        return Motion(self.now.v, self.account.edit, self.account.remesh)
