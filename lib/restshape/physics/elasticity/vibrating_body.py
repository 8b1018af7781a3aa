"""What bodies that vibrate freely have in common: supports, rigid motions, stiffness and mass as integrals."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from restshape.errors import UserError
from restshape.fem.dirichlet import Dirichlet
from restshape.fem.eigenproblem import Eigenproblem
from restshape.fem.elements import Family
from restshape.fem.integral import Integral
from restshape.fem.problem import INTERNAL, MASS, STIFFNESS, Fields, Unknown
from restshape.fem.space import Space
from restshape.fem.supports import dirichlet_of
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.physics.elasticity.mode_estimate import RecoveryModeEstimate
from restshape.physics.elasticity.vibrating_materials import materials_by_region
from restshape.scene.model import Scene

CONSTRAINED = 1e-9
"""A rigid motion of which less than this is left at the supports is free."""


class VibratingBody(ABC):
    """The problem K phi = lambda M phi of a body over a plane mesh under edit.

    Of a `fem.problem.SteadyProblem` it is all that an eigenproblem asks for: nothing loads the body.

    Args:
        scene: materials and supports.
        plane: mesh of the outline, of either order; kept by reference.

    Attributes:
        space: nodes and cells of the unknowns; its X (n, d) follow the plane mesh.
        axes: names of the unknowns of a node, as supports fix them.
        materials: of each region of the plane mesh.

    Raises:
        UserError: a material has no density, part of the body no material, or a support makes no sense for the body.
    """

    symmetric = definite = linear = rigid_motions = True
    name = "modes"
    axes: tuple[str, ...]
    space: Space
    boundary: Dirichlet
    stiffness: Integral
    mass: Integral

    def __init__(self, scene: Scene, plane: Mesh | LagrangeSpace) -> None:
        self.scene, self.plane = scene, plane
        self.materials = materials_by_region(scene, plane)

    # --- as a problem -------------------------------------------------------------------------------------------------

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """One field: the amplitude of the displacement, whose size means nothing."""
        return (Unknown("displacement", "", self.axes),)

    def update(self) -> None:  # noqa: B027  nothing does, where materials are constant
        """Evaluate again what depends on the place of the nodes."""

    def blocks(self) -> list[np.ndarray]:
        """The cells (ne, k) int32."""
        return [self.space.cells]

    def integrals(self, kind: str, part: float = 1.0) -> Sequence[Integral]:
        """Those of `STIFFNESS`, which are all internal forces, or of `MASS`."""
        return {INTERNAL: (self.stiffness,), STIFFNESS: (self.stiffness,), MASS: (self.mass,)}.get(kind, ())

    def free_rigid_motions(self) -> np.ndarray:
        """A basis (r, n f) of the rigid motions that the supports leave free, at the places of the nodes now."""
        basis = self.all_rigid_motions()
        size = np.linalg.norm(basis, axis=1)
        basis /= size[:, None]
        constrained = basis[:, self.boundary.mask.ravel() != 0]
        if not constrained.shape[1]:
            return basis
        weights, sizes, _ = np.linalg.svd(constrained, full_matrices=True)
        free = np.ones(len(basis), dtype=bool)
        free[: len(sizes)] = sizes <= CONSTRAINED
        return np.ascontiguousarray(weights[:, free].T @ basis)

    def fields(self, x: np.ndarray) -> Fields:
        """Displacements of the middle surface in each mode, the largest 1; of the cells the size of the first one.

        Args:
            x: (k, n f) modes.
        """
        shapes = self.shapes(x)
        sizes = np.linalg.norm(shapes, axis=2)
        shapes /= sizes.max(axis=1)[:, None, None]
        size = np.linalg.norm(shapes[0], axis=1)
        names = {f"mode_{k + 1}": shape for k, shape in enumerate(shapes)}
        return names, {"size_of_mode_1": size[self.plane.cells].mean(axis=1)}

    # --- over the plane mesh ------------------------------------------------------------------------------------------

    def follow(self, changed: np.ndarray) -> np.ndarray:
        """Go where the plane mesh is; the cells (k,) of `space` over the plane cells (k,) that flips have changed."""
        changed = self.space.follow(changed)
        self.update()
        return changed

    def motion(self, plane_motion: np.ndarray) -> np.ndarray:
        """Velocities (k, n, d) of the nodes of `space` from those (k, n2, 2) of the plane nodes."""
        return plane_motion

    def thickness_motion(self, rates: np.ndarray) -> np.ndarray:
        """Velocities (n, d) of the nodes of `space` where the thickness over the plane nodes grows with rates (n2,).

        A plate's third coordinate is its thickness; of a solid the lower face moves, and the upper one stays.

        Raises:
            UserError: the body is a plane one.
        """
        raise UserError("a plane solid has no face underneath", "effects.modal.model", 'use "plate" or "solid"')

    def take_off(self, depth: np.ndarray) -> None:
        """Take depths (n2,) [m] off underneath, over the plane nodes; what was taken off before does not count.

        Raises:
            ReplayProblem: nothing is left somewhere; all is as before.
            UserError: the body is a plane one.
        """
        raise UserError("a plane solid has no face underneath", "effects.modal.model", 'use "plate" or "solid"')

    def by_plane_nodes(self, field: np.ndarray) -> np.ndarray:
        """A field (n, ...) of `space` by plane nodes: (n2, columns...)."""
        return field

    def taken_over(self, modes: np.ndarray, before: Eigenproblem) -> np.ndarray:
        """Modes (k, n f) of a body before on the same nodes, as near to modes of this one as its values alone tell."""
        return modes

    @abstractmethod
    def all_rigid_motions(self) -> np.ndarray:
        """All rigid motions (r, n f) that the unknowns can make."""

    # --- what modes look like -----------------------------------------------------------------------------------------

    @abstractmethod
    def shapes(self, modes: np.ndarray) -> np.ndarray:
        """Displacements (k, n2, 3) of the plane nodes in modes (k, n f), those of the middle surface of bodies."""

    def normal_participation(self, modes: np.ndarray, mass_products: np.ndarray) -> np.ndarray:
        """Shares (k,) of the kinetic energy that is normal to the plane, of modes (k, n f) with products M phi."""
        column = self.axes.index("z") if "z" in self.axes else None
        if column is None:
            return np.zeros(len(modes))
        weighted = (modes * mass_products).reshape(len(modes), -1, len(self.axes))
        return weighted[:, :, column].sum(axis=1) / weighted.sum(axis=(1, 2))

    @abstractmethod
    def error_estimate(self) -> RecoveryModeEstimate:
        """What estimates the errors of its modes."""

    # --- parts --------------------------------------------------------------------------------------------------------

    def supports(self) -> Dirichlet:
        """The conditions of the scene's supports.

        Raises:
            UserError: one fixes what the body does not have.
        """
        for name, support in self.scene.supports.items():
            for axis in support.fix:
                if axis not in self.axes:
                    raise UserError(
                        f"this body has no unknown {axis!r}",
                        f"supports.{name}.fix",
                        f"fix some of {', '.join(self.axes)}",
                    )
        return dirichlet_of(self.scene, self.space, self.unknowns)

    def integral(self, element: Family, parameters: np.ndarray) -> Integral:
        """The element of a family over all cells."""
        return Integral(element[self.space.cell_type], self.space.X, self.space.cells, parameters)
