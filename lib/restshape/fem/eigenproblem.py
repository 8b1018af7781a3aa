"""What a physics is to an analysis of free vibrations: stiffness and mass of a body over a plane mesh under edit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from restshape.fem.problem import Problem
from restshape.fem.space import Space
from restshape.scene.model import Material, Scene
from restshape.scene.plan import Plan


class ModeEstimate(Protocol):
    """Estimates the errors of the modes of a body."""

    @property
    def body(self) -> Eigenproblem:
        """Whose modes they are."""

    def __call__(self, modes: np.ndarray) -> np.ndarray:
        """The estimated errors (k,) of eigenvalues of K phi = lambda M phi, of modes (k, n f) with phi M phi = 1."""


class Eigenproblem(Problem, Protocol):
    """K phi = lambda M phi of one scene on a space that follows a plane mesh: `STIFFNESS` and `MASS` of `fem.problem`.

    It has no loads, no state to start from and no residual, as an `SteadyProblem` has, and its nodes are those of
    a body over the mesh that is edited, where those of an equilibrium are that mesh's own.

    Attributes:
        plane: the plane mesh.
        axes: names of the unknowns of a node, as supports fix them.
        materials: of each region of the plane mesh.
    """

    plane: Space
    axes: tuple[str, ...]
    materials: Sequence[Material]

    def follow(self, changed: np.ndarray) -> np.ndarray:
        """Go where the plane mesh is; the cells (k,) of `space` over the plane cells (k,) that flips have changed."""

    def motion(self, plane_motion: np.ndarray) -> np.ndarray:
        """Velocities (k, n, d) of the nodes of `space` from those (k, n2, 2) of the plane nodes."""

    def thickness_motion(self, rates: np.ndarray) -> np.ndarray:
        """Velocities (n, d) of the nodes of `space` where the thickness over the plane nodes grows with rates (n2,)."""

    def take_off(self, depth: np.ndarray) -> None:
        """Take depths (n2,) [m] off underneath, over the plane nodes."""

    def by_plane_nodes(self, field: np.ndarray) -> np.ndarray:
        """A field (n, ...) of `space` by plane nodes: (n2, columns...)."""

    def shapes(self, modes: np.ndarray) -> np.ndarray:
        """Displacements (k, n2, 3) of the plane nodes in modes (k, n f), those of the middle surface of bodies."""

    def taken_over(self, modes: np.ndarray, before: Eigenproblem) -> np.ndarray:
        """Modes (k, n f) of a body before on the same nodes, as near to modes of this one as its values alone tell."""

    def free_rigid_motions(self) -> np.ndarray:
        """A basis (r, n f) of the rigid motions that the supports leave free, at the places of the nodes now."""

    def normal_participation(self, modes: np.ndarray, mass_products: np.ndarray) -> np.ndarray:
        """Shares (k,) of the kinetic energy that is normal to the plane, of modes (k, n f) with products M phi."""

    def error_estimate(self) -> ModeEstimate:
        """What estimates the errors of its modes."""


Maker = Callable[[Scene, Plan, Space, bool], Eigenproblem]
"""Makes the body of a scene over a plane mesh; the flag: with the mass on the diagonal."""
