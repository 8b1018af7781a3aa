"""How the cloth of one scene is relaxed: settings of its plan, and solvers made by them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from petsc4py import PETSc

from restshape.algebra.linear import LinearSolver
from restshape.algebra.nonlinear.kinetic_damping import Steps
from restshape.analysis.analysis import Context
from restshape.application import application_of
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.contact.tunnelling import size_of
from restshape.physics.cloth.relaxation.equilibrium import EquilibriumSolver
from restshape.physics.cloth.scene import ClothArguments, cloth_arguments
from restshape.scene.bodies import Body
from restshape.scene.model import Scene
from restshape.scene.plan import Plan
from restshape.scene.plan import plan as planned

PASSED = 0.5
"""Part of the smallest size of a body that a node goes in one step: it must not come out on the other side."""
SMALL = 600
"""Nodes up to which motion is solved for with complete factors."""
WHOLE = 15_000
"""Nodes up to which each of several ranks relaxes the whole cloth by itself, all in the same way: with shares of it
they would take longer."""
FIRST_STEP, LONGEST_STEP = 0.05, 3.0
"""Time steps that motion begins with and may grow to, over `ClothProblem.swing_time`: 1/60 s, the thesis's for all of
it, and 1 s of cloth that is a metre long."""

Watch = Callable[[EquilibriumSolver, np.ndarray, float], None]


@dataclass(frozen=True)
class RelaxationOptions:
    """What a scene, its plan and the policy say about relaxations.

    Args:
        context: what all parts of the replay share.
        plan: which effects are on.
        scene: whose cloth it is.
        bodies: that it touches, of numbers alone.
        watch: called with the solver, positions (n, 3) and residual over load at each iterate.
    """

    context: Context
    plan: Plan
    scene: Scene
    bodies: tuple[Body, ...]
    watch: Watch

    @classmethod
    def of(cls, context: Context, scene: Scene, known: Plan | None, watch: Watch) -> RelaxationOptions:
        """The options of a scene, whose plan may be known already."""
        plan = known or planned(scene, application_of(scene))
        bodies = tuple(body.evaluated(scene.parameters) for body in scene.bodies.values())
        return cls(context, plan, scene, bodies, watch)

    @property
    def settings(self) -> Any:
        """Of the effect `drape`."""
        return self.plan.settings("drape")

    @property
    def strategy(self) -> str:
        """The name of the solution strategy."""
        return "kinetic" if self.context.policy.name == "thesis" else self.settings.strategy

    @property
    def reach(self) -> float:
        """The farthest way of a node in one step [m]."""
        return PASSED * min((size_of(body) for body in self.bodies), default=np.inf)

    def arguments(self, mesh: Mesh, hand: np.ndarray | None = None) -> ClothArguments:
        """What the problem on a mesh is made from; with the node (1,) that a hand holds, if that is known."""
        return cloth_arguments(self.scene, self.plan, mesh, hand)

    def make_solver(self, problem: ClothProblem, prefix: str = "drape_") -> EquilibriumSolver:
        """A solver of a problem, with a prefix of options in PETSc's database."""
        context, settings = self.context, self.settings
        comm = context.comm if problem.n_nodes > WHOLE else PETSc.COMM_SELF
        # A complete factor shows how to leave an unstable equilibrium; on several ranks that of own rows is definite.
        complete = "stale" if context.policy.name == "auto" else "direct"
        linear = LinearSolver(
            comm,
            f"{prefix}linear_",
            complete,
            settings.tolerance,
            context.calibration,
            context.stages,
            memory=self.scene.solve.factor_memory,
            traits=problem.traits(self.plan),
        )
        # A complete factor of a small matrix costs less than the iterations without one.
        small = settings.strategy == "auto" and problem.n_nodes <= SMALL
        preconditioner = "ilu" if context.policy.name == "thesis" else "cholesky" if small else "sor"
        time = problem.swing_time
        steps = Steps(FIRST_STEP * time, LONGEST_STEP * time, reach=self.reach, most=100, preconditioner=preconditioner)
        backend = context.policy.backend
        solver = EquilibriumSolver(problem, comm, context.stages, linear, settings.tolerance, steps, backend, prefix)
        solver.on_iterate = self.watch
        return solver
