"""What a physics is to the analyses: unknowns on a space, integrals, Dirichlet conditions, quantities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from petsc4py import PETSc

from restshape.algebra.operator import Block
from restshape.algebra.reuse.traits import Traits
from restshape.fem.dirichlet import Dirichlet
from restshape.fem.error_estimate import RecoveryEstimate
from restshape.fem.integral import Integral
from restshape.fem.observer import Observer
from restshape.fem.space import Space
from restshape.fem.time_integration import TimeIntegration
from restshape.scene.model import Quantity, Scene
from restshape.scene.plan import Plan

INTERNAL, LOADS, FOLLOWERS = "internal", "loads", "followers"
"""Kinds of integrals that balance: of the cells, with body loads and all else that the unknowns enter; dead loads on
facets; loads on facets that the unknowns enter and that grow with the part of the load."""

STIFFNESS, REFERENCE = "stiffness", "reference"
"""Kinds for other uses: `INTERNAL` without any load; that where all unknowns are 0."""

MASS, LUMPED, CONSISTENT = "mass", "lumped mass", "consistent mass"
"""Inertia or capacity: as the plan asks for it; lumped onto the diagonal; consistent."""


@dataclass(frozen=True)
class Unknown:
    """A field that is solved for.

    Args:
        name: such as "displacement"; recordings show it by this name.
        unit: of its values.
        components: names of the columns, as supports prescribe them.
    """

    name: str
    unit: str
    components: tuple[str, ...]


Fields = tuple[dict[str, np.ndarray], dict[str, np.ndarray]]
"""By name: fields (n, c) of the nodes, fields (ne, c) of the cells."""


class Problem(Protocol):
    """One physics of one scene on one space: what operators are assembled from, and what recordings show of it.

    Attributes:
        space: nodes and cells of the unknowns, by reference; its nodes may move.
        boundary: prescribed unknowns.
        symmetric: whether every tangent is symmetric.
    """

    space: Space
    boundary: Dirichlet
    symmetric: bool

    def blocks(self) -> Sequence[Block]:
        """Entities (m, k) int32 that have a tangent, an array, or a pair with dofs, a block of the operator."""

    def integrals(self, kind: str, part: float = 1.0) -> Sequence[Integral]:
        """The integrals of a kind at the present places of the nodes; none where the problem has none of it.

        Args:
            kind: one of those above.
            part: of the load, in load steps: `FOLLOWERS` grow with it.
        """

    def fields(self, x: np.ndarray) -> Fields:
        """What a recording shows of the unknowns x (n, f), or of modes x (k, n f)."""


class SteadyProblem(Problem, Protocol):
    """A problem whose unknowns balance loads, from which analyses derive all else: made of scene, plan and space.

    What has a body here a problem need not say: it inherits that there are no loads at nodes and no objections.

    Attributes:
        name: of the physics, before the options of its solvers in PETSc's database.
        unknowns: fields of each node, in the order of the columns.
        cell_scalars: names of the fields of the cells, numbers, where `blank_fields` is inherited.
        definite: whether tangents that are symmetric are positive definite where the problem is stable.
        rigid_motions: whether rigid motions are nearly in the null space of tangents; else constants are.
        linear: whether the integrals are linear in the unknowns.
        varies: whether `update` has anything to do when nodes move.
        stiffest: of all coefficients of the stiffness, integrated over the thickness, the largest.
        backend: of operators of nonlinear problems on one rank, where the policy names none; None: the usual one.
    """

    name: str
    unknowns: tuple[Unknown, ...]
    cell_scalars: tuple[str, ...] = ()
    definite: bool = True
    rigid_motions: bool = False
    backend: str | None = None
    linear: bool

    def __init__(self, scene: Scene, plan: Plan, space: Space) -> None: ...

    @property
    def varies(self) -> bool: ...
    @property
    def stiffest(self) -> float: ...
    @property
    def load_steps(self) -> int:
        """Steps of load that are tried at most where the problem is not linear."""
        return 1

    @property
    def loaded(self) -> bool:
        """Whether there is any load; what has loads at nodes must report by itself."""
        return self.loaded_inside or bool(self.integrals(LOADS))

    @property
    def loaded_inside(self) -> bool:
        """Whether there is one in the integrals of `INTERNAL`."""

    @property
    def nested(self) -> SteadyProblem:
        """What is on the next richer space as it is on this one, for the same unknowns: all, where elements take no
        means."""
        return self

    def update(self) -> None:
        """Evaluate again what depends on the place of the nodes; nothing where all values are constant."""

    def add_nodal_loads(self, out: np.ndarray, sign: float, cells: np.ndarray | None = None) -> None:
        """Add `sign` times the loads that no integral gives, such as point loads, to `out` (n, f).

        Args:
            cells: (k,) int32; loads inside of others are left out.
        """

    def add_nodal_load_rates(self, dX: np.ndarray, out: np.ndarray) -> None:
        """Take the rates of the loads of `add_nodal_loads`, when nodes move with dX (n, d), from `out` (n, f)."""

    def share(self, comm: PETSc.Comm) -> None:
        """Let ranks share what its observer and its estimate do, which are collective then; by default they do not."""

    def start(self) -> np.ndarray:
        """The unknowns (n, f) from which a search begins that knows nothing of the solution."""
        return np.zeros(self.boundary.mask.shape)

    def objection(self, x: np.ndarray) -> str:
        """What speaks against unknowns x (n, f) that solve the equations, for people; empty where nothing does."""
        return ""

    def linear_displacement(self, x: np.ndarray) -> np.ndarray | None:
        """Unknowns x (n, f) where they are displacements [m] of linear theory, no copy: lengths, and linear ones."""
        return x if self.linear and self.unknowns[0].unit == "m" else None

    def energy_moduli(self) -> np.ndarray | None:
        """lambda, mu and thickness h, (3,) or (ne, 3), of the energy h (lambda tr(e)^2 + 2 mu e : e) / 2 by area.

        The tensor e is the strain of a displacement; of one scalar its gradient, as the first of two rows. None where
        the energy has another form.
        """
        return None

    @classmethod
    def traits(cls, plan: Plan) -> Traits:
        """What it declares of its linear systems under a plan; by default the same under all."""
        fields = sum(len(one.components) for one in cls.unknowns)
        return Traits(cls.symmetric, cls.definite, fields, rigid_motions=cls.rigid_motions)

    @classmethod
    def blank_fields(cls, space: Space) -> Fields:
        """The same fields, all NaN, on a space that has not been solved on: the unknowns, and scalars of the cells."""
        shapes = {
            one.name: (len(space.X), *([len(one.components)] * (len(one.components) > 1))) for one in cls.unknowns
        }
        cells = {name: np.full(len(space.cells), np.nan) for name in cls.cell_scalars}
        return {name: np.full(shape, np.nan) for name, shape in shapes.items()}, cells

    def observer(self, quantities: Mapping[str, Quantity]) -> Observer:
        """What evaluates quantities of the unknowns x (n, f).

        Raises:
            UserError: a quantity has no meaning, or none where it is asked for.
        """

    def error_estimate(self) -> RecoveryEstimate | None:
        """The recovery-based estimate on this space; None where there is none."""
        return None


class PrestressedProblem(SteadyProblem, Protocol):
    """A problem whose stress at a solution changes its stiffness."""

    def geometric_stiffness(self, u: np.ndarray, factor: float = 1.0) -> Integral:
        """G of unknowns u (n, f), linear in them: phi . G phi = int sigma(u) : grad(phi)^T grad(phi)."""


class Inertia(Protocol):
    """What quantities of a motion need of a mass, or capacity, matrix."""

    def apply(self, v: np.ndarray) -> np.ndarray:
        """M v (n, f) of nodal values v (n, f)."""

    def energies(self, v: np.ndarray, cells: slice = slice(None)) -> np.ndarray:
        """Kinetic energies (m,) of some cells, or of all, at the rates v (n, f)."""


class TransientProblem(SteadyProblem, Protocol):
    """A problem that may be integrated in time: with integrals of the kinds `MASS`, `LUMPED`, `CONSISTENT`.

    Attributes:
        name_in_time: before the options of its solvers in PETSc's database where it is; empty: `name`.
        time_step_key: of the scene, for messages.
    """

    name_in_time: str = ""
    time_step_key: str

    def initial(self) -> np.ndarray:
        """The unknowns (n, f) at time 0; what is prescribed is so from the first step on."""
        return self.boundary.values.copy()

    @staticmethod
    def time_integration(plan: Plan, before: TimeIntegration | None, now: float) -> TimeIntegration:
        """How it is integrated under a plan; `before` is how it was until the time `now` [s]."""

    @staticmethod
    def accounts_energy(quantities: Mapping[str, Quantity]) -> bool:
        """Whether one of these quantities asks for `Motion.edit` or `Motion.remesh`."""
        return False

    def motion_observer(self, quantities: Mapping[str, Quantity], mass: Inertia) -> Observer:
        """What evaluates quantities of unknowns x (n, f) and a `fem.time_integration.Motion`."""
