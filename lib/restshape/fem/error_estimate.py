"""How far unknowns are from those of a finer mesh, estimated from the fluxes that they give."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from restshape import _kernels
from restshape.fem.recovery import NodalFlux
from restshape.fem.space import Space

ROUNDING = 1e-6
"""Gradients below this share of the unknowns over the body's size are rounding, or what a solve to the usual tolerance
leaves: where supports only shift a body, or all of it is as hot as the air."""

NO_KINDS = np.empty(0, dtype=np.int32)

Flux = Callable[[np.ndarray, np.ndarray | None], np.ndarray]
"""Fluxes, or stresses, (ne, m, 4) of unknowns (n, f) at reference points (m, 2), or (ne, 4) at centroids for None."""


class SharedRecovery(Protocol):
    """A flux that others recover too, and which is computed once a state.

    Attributes:
        recovery: on the space of the estimate.
    """

    @property
    def recovery(self) -> NodalFlux: ...

    def sampled(self, x: np.ndarray) -> np.ndarray:
        """The flux of the cells that is recovered: (ne, 4), or (ne, 3, 4) at the points of `recovery`."""

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """The recovered flux (rows, 4)."""


@dataclass(frozen=True, eq=False)
class Sampled:
    """Fluxes of unknowns: (rows, 4) recovered at nodes, and those of the cells at the points of the estimate."""

    nodal: np.ndarray
    flux: np.ndarray

    def plus(self, other: Sampled, factor: float) -> Sampled:
        """These and `factor` times others; both are linear in the unknowns."""
        return Sampled(self.nodal + factor * other.nodal, self.flux + factor * other.flux)


class RecoveryEstimate:
    """The recovery-based estimate of fluxes that derive from a potential, order 1 or 2, one material or several.

    Fluxes are recovered at nodes, on each region by itself, interpolated, and compared with those of the cells in the
    norm of the complementary energy.

    Args:
        space: by reference: nodes may move, edges may flip inside regions.
        flux: that the norm takes; columns that it has not are 0.
        compliance: (k, 4, 4) from fluxes to gradients, over the thickness; one, or one a region, the rest first.
        stiffest: as of the problem.
        shared: who computes and recovers the same flux, up to columns that do not count; None: the estimate itself.

    Source: docs/theory/error-estimates.md; Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 24 (1987) 337.
    """

    def __init__(
        self,
        space: Space,
        flux: Flux,
        compliance: np.ndarray,
        stiffest: float,
        shared: SharedRecovery | None = None,
    ) -> None:
        self.space, self.flux, self.stiffest, self.shared = space, flux, stiffest, shared
        # Fluxes of first order are constant in a cell.
        second = space.cells.shape[1] == 6
        self._points = _kernels.estimate_points(6) if second else None
        self._compliance = compliance
        self._kinds = space.cell_region if len(compliance) > 1 else NO_KINDS

    @cached_property
    def recovery(self) -> NodalFlux:
        """What recovers fluxes at the nodes; ranks that have parts of their own never ask for it."""
        return self.shared.recovery if self.shared else NodalFlux(self.space)

    def relative(self, x: np.ndarray) -> float:
        """The estimated error of unknowns x (n, f) over their size, both in the energy norm.

        Not a number where there is no flux.
        """
        sampled = self.shared.sampled(x) if self.shared else self.flux(x, self.recovery.points)
        nodal = self.shared(x) if self.shared else self.recovery(sampled)
        flux = sampled if self._points is None else self.flux(x, self._points)
        error, size = self._energies(self.recovery.cell_rows(), nodal, flux)
        return self._ratio(error, size, x)

    def sampled(self, x: np.ndarray) -> Sampled:
        """The fluxes of unknowns x (n, f), as `error_energy` and `error_product` take them."""
        x = np.ascontiguousarray(x)
        sampled = self.flux(x, self.recovery.points)
        return Sampled(self.recovery(sampled), sampled if self._points is None else self.flux(x, self._points))

    def error_energy(self, of: Sampled, cells: np.ndarray | slice = slice(None)) -> float:
        """The square of the estimated error of unknowns in the energy norm, of some cells (k,) or of all."""
        rows, kinds = self.recovery.cell_rows(), self._kinds if len(self._kinds) == 0 else self._kinds[cells]
        entities, rows, flux = (np.ascontiguousarray(array[cells]) for array in (self.space.cells, rows, of.flux))
        return _kernels.recovery_energies(self.space.X, entities, rows, of.nodal, flux, self._compliance, kinds)[0]

    def error_product(self, one: Sampled, other: Sampled) -> float:
        """The product of the estimated errors of two sets of unknowns in the scalar product of the energy.

        By polarisation, of both at the same size.
        """
        energies = self.error_energy(one), self.error_energy(other)
        if min(energies) <= 0.0:
            return 0.0
        factor = float(np.sqrt(energies[0] / energies[1]))
        ahead, behind = (self.error_energy(one.plus(other, sign * factor)) for sign in (1.0, -1.0))
        return 0.25 * (ahead - behind) / factor

    def distance(self, x: np.ndarray, reference: np.ndarray) -> float:
        """The distance of two sets of unknowns (n, f) over the size of the second, in the same norm."""
        flux = self.flux(reference, self._points)
        size, error = self._norm(flux), self._norm(self.flux(x, self._points) - flux)
        return self._ratio(error, size, reference)

    def _ratio(self, error: float, size: float, x: np.ndarray) -> float:
        rounding = self.stiffest * (ROUNDING * _kernels.largest_size(x)) ** 2
        return float(np.sqrt(error / size)) if size > rounding else float("nan")

    def _norm(self, flux: np.ndarray) -> float:
        """Twice the complementary energy of fluxes of the cells."""
        return self._energies(np.zeros_like(self.space.cells), np.zeros((1, 4)), flux)[1]

    def _energies(self, rows: np.ndarray, nodal: np.ndarray, flux: np.ndarray) -> tuple[float, float]:
        space = self.space
        return _kernels.recovery_energies(space.X, space.cells, rows, nodal, flux, self._compliance, self._kinds)
