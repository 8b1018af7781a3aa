"""What errors of quantities are estimated of: an analysis of a linear problem, and its solution."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from restshape.algebra.linear import LinearSolver
    from restshape.analysis.analysis import Context
    from restshape.analysis.static.linear_system import LinearSystem
    from restshape.fem.error_estimate import RecoveryEstimate
    from restshape.fem.observer import Observer
    from restshape.fem.problem import SteadyProblem
    from restshape.mesh.lagrange_space import LagrangeSpace
    from restshape.mesh.mesh import Mesh
    from restshape.scene.model import Scene
    from restshape.scene.plan import Plan


class LinearState(Protocol):
    """A solution of a linear problem, and what it was found with."""

    @property
    def x(self) -> np.ndarray: ...
    @property
    def predicted(self) -> bool: ...
    @property
    def scene(self) -> Scene: ...
    @property
    def plan(self) -> Plan: ...
    @property
    def mesh(self) -> Mesh | LagrangeSpace | None: ...
    @property
    def problem(self) -> SteadyProblem: ...
    @property
    def system(self) -> LinearSystem: ...
    @property
    def observer(self) -> Observer: ...


class Estimated(Protocol):
    """What errors are estimated of: an analysis of a linear, symmetric problem.

    Attributes:
        context: whose policy says how matrices are kept.
        solver: whose kept preconditioner is used.
        make: makes the problem of a scene, a plan and a space.
    """

    context: Context
    solver: LinearSolver

    @property
    def state(self) -> LinearState: ...
    @property
    def make(self) -> Callable[[Scene, Plan, LagrangeSpace], SteadyProblem]: ...
    @property
    def error_estimate(self) -> RecoveryEstimate | None: ...
