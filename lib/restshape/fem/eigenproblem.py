"""What a physics is to an analysis of free vibrations: stiffness and mass of a body over a plane mesh under edit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from restshape.algebra.operator import Block
from restshape.fem.dirichlet import Dirichlet
from restshape.fem.integral import Integral
from restshape.fem.problem import Fields
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


class Eigenproblem(Protocol):
    """K phi = lambda M phi of one scene on a space that follows a plane mesh.

    It has of a `Problem` what operators are assembled from: space, boundary, blocks, integrals. It is no `Problem`,
    for it has no loads, no state to start from and no residual, and its nodes are those of a body over the mesh that is
    edited, where those of a `Problem` are that mesh's own.

    Attributes:
        space: nodes and cells of the unknowns; its X (n, d) follow the plane mesh.
        plane: the plane mesh.
        axes: names of the unknowns of a node, as supports fix them.
        boundary: prescribed unknowns, which are 0.
        materials: of each region of the plane mesh.
    """

    space: Space
    plane: Space
    axes: tuple[str, ...]
    boundary: Dirichlet
    materials: Sequence[Material]

    def blocks(self) -> Sequence[Block]:
        """Entities (m, k) int32 that have a tangent, an array, or a pair with dofs, a block of the operator."""

    def integrals(self, kind: str, part: float = 1.0) -> Sequence[Integral]:
        """Those of `fem.problem.STIFFNESS` or of `fem.problem.MASS`."""

    def follow(self, changed: np.ndarray) -> np.ndarray:
        """Go where the plane mesh is; the cells (k,) of `space` over the plane cells (k,) that flips have changed."""

    def motion(self, plane_motion: np.ndarray) -> np.ndarray:
        """Velocities (k, n, d) of the nodes of `space` from those (k, n2, 2) of the plane nodes."""

    def by_plane_nodes(self, field: np.ndarray) -> np.ndarray:
        """A field (n, ...) of `space` by plane nodes: (n2, columns...)."""

    def free_rigid_motions(self) -> np.ndarray:
        """A basis (r, n f) of the rigid motions that the supports leave free, at the places of the nodes now."""

    def fields(self, x: np.ndarray) -> Fields:
        """What a recording shows of modes x (k, n f)."""

    def normal_participation(self, modes: np.ndarray, mass_products: np.ndarray) -> np.ndarray:
        """Shares (k,) of the kinetic energy that is normal to the plane, of modes (k, n f) with products M phi."""

    def error_estimate(self) -> ModeEstimate:
        """What estimates the errors of its modes."""


Maker = Callable[[Scene, Plan, Space, bool], Eigenproblem]
"""Makes the body of a scene over a plane mesh; the flag: with the mass on the diagonal."""
