"""How many modes must be solved for, so that those that a scene asks for are among them."""

from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from restshape.algebra.eigenproblems.clusters import cluster_end
from restshape.algebra.eigenproblems.davidson import Found
from restshape.algebra.eigenproblems.eigen import EigenReport, EigenSolver
from restshape.analysis.modal.mode_tracking import ModeIds, normalise_signs
from restshape.errors import ReplayProblem
from restshape.fem.eigenproblem import Eigenproblem

NORMAL = 0.5
"""Share of the kinetic energy beyond which a mode counts as out of the plane."""

MOST_BESIDE = 24
"""Modes in the plane that may lie below the last one out of the plane that is wanted."""


@dataclass(frozen=True, eq=False)
class FoundModes:
    """What a search has come to; fields as in `analysis.modal_state.Modes`, `count` as in `ModalState`."""

    values: np.ndarray
    vectors: np.ndarray
    mass_products: np.ndarray
    participation: np.ndarray
    chosen: np.ndarray
    count: int
    report: EigenReport


@dataclass(frozen=True)
class ModeSearch:
    """Looks for the lowest modes of a body, those in the plane left out where they are not asked for.

    Args:
        solver: of the eigenproblem.
        body: what vibrates.
        modes: how many are wanted.
        in_plane: those in the plane count too.
    """

    solver: EigenSolver
    body: Eigenproblem
    modes: int
    in_plane: bool

    def __call__(
        self, stiffness: PETSc.Mat, mass: PETSc.Mat, rigid: np.ndarray, count: int, new_system: bool, verify: bool
    ) -> FoundModes:
        """The modes of K and M, as many as it takes to have those that are wanted and the clusters that they are in.

        Args:
            stiffness, mass, rigid, new_system, verify: as in `EigenSolver.solve`.
            count: of modes that are solved for at first.

        Raises:
            ReplayProblem: too many lie in the plane, or the eigenproblem has no solution that can be found.
        """
        total = None
        while True:
            again = total is not None
            found, report = self.solver.solve(stiffness, mass, rigid, count, new_system and not again, verify, again)
            total = report if total is None else total.followed_by(report)
            modes, mass_products = self._whole(found)
            participation = self.body.normal_participation(modes, mass_products)
            chosen = self.choose(participation, np.arange(len(participation)) < count)
            if len(chosen) == self.modes:
                whole = cluster_end(found.values, int(chosen[-1]))
                if whole <= count or count >= self.modes + MOST_BESIDE:
                    return FoundModes(found.values, modes, mass_products, participation, chosen, count, total)
                count = whole
                continue
            if count >= self.modes + MOST_BESIDE:
                what = f"only {len(chosen)} of the {count} lowest modes move mostly out of the plane, not {self.modes}"
                raise ReplayProblem(f"{what}: ask for fewer effects.modal.modes, or set effects.modal.in_plane = true")
            count += max(1, self.modes - len(chosen))

    def _whole(self, found: Found) -> tuple[np.ndarray, np.ndarray]:
        """The modes (k, n) and their products M phi, whole on each rank, of which each has found its columns."""
        pencil, products = self.solver.pencil, found.mass_products
        if products is None:
            products = np.empty_like(found.modes)
            pencil.apply(pencil.mass, found.modes, products)
        return pencil.share.whole(found.modes), pencil.share.whole(products)

    def ids(self, found: FoundModes, before: ModeIds, previous: np.ndarray, sizes: np.ndarray) -> ModeIds:
        """The ids of modes that have been found, whose signs are set.

        Args:
            found: the modes.
            before: ids of those before.
            previous: (k, n f) the modes before, on the nodes of now; (0, n f) where there are none.
            sizes: (k,) their phi^T M phi in the mass of now.
        """
        if len(previous):
            return before.track(previous, found.vectors, found.mass_products, sizes)
        normalise_signs(found.vectors, found.mass_products)
        return ModeIds.first(len(found.vectors), found.chosen)

    def choose(self, participation: np.ndarray, known: np.ndarray) -> np.ndarray:
        """Indices of the lowest modes that are wanted, among known (k,) ones with their participation (k,)."""
        return chosen_modes(self.body, self.modes, self.in_plane, participation, known)


def chosen_modes(
    body: Eigenproblem, modes: int, in_plane: bool, participation: np.ndarray, known: np.ndarray
) -> np.ndarray:
    """Indices of the `modes` lowest modes that are wanted, those in the plane too where `in_plane`.

    Args:
        body: what vibrates.
        modes: how many are wanted.
        in_plane: those in the plane count too.
        participation: (k,) share of the kinetic energy out of the plane.
        known: (k,) bool, which ones there are.
    """
    if "z" in body.axes and not in_plane:
        known = known & (participation >= NORMAL)
    return np.flatnonzero(known)[:modes]
