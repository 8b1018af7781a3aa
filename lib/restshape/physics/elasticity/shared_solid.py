"""Stresses, energies and error estimates of a plane solid on ranks: each rank those of its share of the cells."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, Protocol, TypeVar

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.fem.error_estimate import Flux, RecoveryEstimate, SharedRecovery
from restshape.fem.integral import Integral
from restshape.fem.observer import REDUCTIONS, Function
from restshape.fem.part_space import CellPatch, PartSpace
from restshape.fem.space import Space
from restshape.physics.elasticity.nodal_stress import NodalStress
from restshape.physics.elasticity.stress import PlaneStresses

KineticEnergies = Callable[[np.ndarray, slice], np.ndarray]
"""Kinetic energies (m,) [J] of the cells of a slice at velocities (n, 2) [m/s]."""

EXTREMES = ("max", "min", "absmax", "peak")
"""Reductions of stresses that ranks share: the extreme of their extremes."""


class WholeSolid(Protocol):
    """A solid that all ranks have whole.

    Attributes:
        stiffness_params: of its cells, as of `PlaneSolid`; linear: its strains are small.
    """

    space: Space
    stresses: PlaneStresses
    stiffness_params: np.ndarray
    linear: bool


P = TypeVar("P", bound=CellPatch)


class SolidPart(Generic[P]):
    """The part of a solid that is observed by itself, as by a rank, on one topology.

    Args:
        solid: whole; space: the part of its space.
    """

    def __init__(self, solid: WholeSolid, space: P) -> None:
        whole = solid.stresses
        self.solid, self.space, self._known = solid, space, solid.stiffness_params
        parameters = space.of_cells(self._known)
        self.stresses = PlaneStresses(space, whole.element, parameters, whole.large, whole.thins)  # type: ignore[arg-type]
        self.nodal_stress = NodalStress(self.stresses)
        self._x = np.empty((len(space.nodes), 2))

    def follow(self, x: np.ndarray) -> np.ndarray:
        """Take nodes and parameters as they are now; the displacement (k, 2) of the part from that of all x (n, 2)."""
        self.space.follow()
        if self._known is not self.solid.stiffness_params:
            self._known = self.solid.stiffness_params
            self.stresses.parameters = self.space.of_cells(self._known)
        return np.take(x, self.space.nodes, axis=0, out=self._x)

    def energies(self, x: np.ndarray) -> np.ndarray:
        """Strain energies (s,) [J] of the rank's share of the cells at x (k, 2) [m]."""
        found = self.nodal_stress.energies(x)
        if found is None:
            at = self.stresses
            found = Integral(at.element, self.space.X, self.space.cells, at.parameters).energies(x)
        return found[self.space.share]


class SharedSolid:
    """What ranks find of a solid together: collective, and the same on each of them.

    Args:
        comm: PETSc communicator; solid: whole on each rank.
    """

    def __init__(self, comm: PETSc.Comm, solid: WholeSolid) -> None:
        self.comm, self.solid = comm, solid
        self._part: SolidPart[PartSpace] | None = None

    @property
    def part(self) -> SolidPart[PartSpace]:
        """This rank's, on the cells as they are now."""
        if self._part is None or not self._part.space.fits:
            self._part = SolidPart(self.solid, PartSpace(self.comm, self.solid.space))
        return self._part

    def energy(self, cells: np.ndarray | slice) -> Function:
        """The function of x (n, 2) [m] that is the strain energy [J] of some cells, or of all."""

        def energy(x: np.ndarray, *_: object) -> float:
            part = self.part
            return self._sum_in(cells, part.energies(part.follow(x)))

        return energy

    def kinetic_energy(self, energies: KineticEnergies, cells: np.ndarray | slice) -> Function:
        """The function of x (n, 2) [m] and a `Motion` that is the kinetic energy [J] of some cells, or of all."""
        return lambda _, motion: self._sum_in(cells, energies(motion.v, self.part.space.own))

    def _sum_in(self, cells: np.ndarray | slice, energies: np.ndarray) -> float:
        """The sum over the ranks of the energies (s,) of their shares of the cells, of some cells or of all."""
        space = self.part.space
        if not isinstance(cells, slice):
            own = space.own
            energies = energies[cells[(cells >= own.start) & (cells < own.stop)] - own.start]
        return float(space.summed(energies.sum()))

    def extreme(self, component: str, how: str, nodes: np.ndarray | slice, cells: np.ndarray) -> Function:
        """The function of x (n, 2) [m] that is an extreme of a recovered stress [Pa].

        Args:
            component: of the stress; how: one of `EXTREMES`.
            nodes: at which it is taken; cells: whose regions' stress counts, those of all where there are none.
        """
        reduce, worst = REDUCTIONS[how], min if how == "min" else max
        rows: tuple[SolidPart[PartSpace] | None, np.ndarray] = (None, np.empty(0, dtype=int))

        def extreme(x: np.ndarray, *_: object) -> float:
            nonlocal rows
            part = self.part
            if rows[0] is not part:
                rows = (part, rows_at(part, nodes, self.solid.space.cell_region[cells]))
            values = part.nodal_stress.component(component, part.follow(x))[rows[1]]
            found = reduce(values) if len(values) else None
            each = self.comm.tompi4py().allgather(found)
            return float(_worst([one for one in each if one is not None], worst))

        return extreme

    def estimate(self, compliance: np.ndarray, stiffest: float) -> RecoveryEstimate:
        """The recovery-based estimate of the solid, of which ranks share `relative`; arguments as of the estimate's."""
        solid = self.solid
        shared = solid.nodal_stress if solid.linear else None
        return SharedEstimate(self, solid.stresses.of_estimate, compliance, stiffest, shared)


def _worst(values: list[float], worst: Callable[[list[float]], float]) -> float:
    """The extreme of what ranks have found; not a number where one of them has none."""
    return float("nan") if not values or np.isnan(values).any() else worst(values)


def rows_at(part: SolidPart[P], nodes: np.ndarray | slice, regions: np.ndarray) -> np.ndarray:
    """Rows (k,) of a part's recovery that are at nodes of its share, among these nodes, as regions see them."""
    recovery, space = part.nodal_stress.recovery, part.space
    chosen = np.zeros(len(recovery.nodes), dtype=bool)
    chosen[recovery.cell_rows()[space.share]] = True
    if not isinstance(nodes, slice):
        chosen &= np.isin(space.nodes[recovery.nodes], nodes)
    if len(regions) and len(recovery.region) == len(chosen):
        chosen &= np.isin(recovery.region, regions)
    return np.flatnonzero(chosen)


class SharedEstimate(RecoveryEstimate):
    """The estimate of a solid on several ranks: each of them adds the energies of its share of the cells.

    Args:
        ranks: the solid; the others as of `RecoveryEstimate`.
    """

    def __init__(
        self, ranks: SharedSolid, flux: Flux, compliance: np.ndarray, stiffest: float, shared: SharedRecovery | None
    ) -> None:
        super().__init__(ranks.solid.space, flux, compliance, stiffest, shared)
        self._ranks = ranks

    def relative(self, x: np.ndarray) -> float:
        """As of the whole estimate; collective."""
        part = self._ranks.part
        space, own, nodal = part.space, part.follow(x), part.nodal_stress
        if self.shared:
            sampled, recovered = nodal.sampled(own), nodal(own)
        else:
            sampled = part.stresses.of_estimate(own, nodal.recovery.points)
            recovered = nodal.recovery(sampled)
        flux = sampled if self._points is None else part.stresses.of_estimate(own, self._points)
        share, kinds = space.share, space.cell_region[space.share] if len(self._compliance) > 1 else self._kinds
        rows = nodal.recovery.cell_rows()[share]
        energies = _kernels.recovery_energies(
            space.X, space.cells[share], rows, recovered, flux[share], self._compliance, kinds
        )
        error, size = space.summed(np.array(energies))
        return self._ratio(float(error), float(size), x)
