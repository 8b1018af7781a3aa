"""Contact of cloth with bodies in closed form: penalty along the gradient of the distance, friction by anchors."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from restshape import _kernels

POTENTIAL = 12
"""Parameters of the element potential_point1: a place, the gradient there, the second derivatives xx yy zz yz xz xy."""


class Contact:
    """What bodies do to nodes. Between two calls of `lag` it is a potential of the positions.

    Args:
        bodies: of `restshape._kernels.Body`; they may be replaced as they move.
        area: (n,) that each node stands for [m^2].
        stiffness: of the penalty [N/m^3]; thickness: distance at which it begins [m].
        friction: coefficient, of all bodies or one of each; slip: way along the surface at which it is all there [m].

    Attributes:
        anchors: (bodies, n, 3) [m]; they move in `lag` only.

    Source: docs/theory.md, section "Cloth".
    """

    def __init__(
        self,
        bodies: Sequence[_kernels.Body],
        area: np.ndarray,
        stiffness: float,
        thickness: float,
        friction: float | Sequence[float] = 0.0,
        slip: float = 1e-4,
    ) -> None:
        self.bodies = list(bodies)
        self.area, self.stiffness, self.thickness = area, stiffness, thickness
        self.friction, self.slip = np.broadcast_to(friction, len(self.bodies)), slip
        shape = (len(self.bodies), len(area))
        self.anchors, self._normals = np.zeros((*shape, 3)), np.zeros((*shape, 3))
        self._limits, self.version = np.zeros(shape), 0

    def take(self, other: Contact) -> None:
        """Take anchors, normals and normal forces from contact of the same nodes with the same bodies."""
        self.restore(other.history())

    def history(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Copies of all that friction remembers, for `restore`."""
        return self.anchors.copy(), self._normals.copy(), self._limits.copy()

    def restore(self, history: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
        """Remember what `history` has told."""
        self.anchors[:], self._normals[:], self._limits[:] = history
        self.version += 1

    def inherit(
        self, other: Contact, before: np.ndarray, after: np.ndarray, carry: Callable[[np.ndarray], np.ndarray]
    ) -> None:
        """Take the ways from anchors, and which nodes are pressed, from contact of other nodes with the same bodies.

        Args:
            other: the contact of (m,) nodes.
            before, after: (m, 3) and (n, 3) where the nodes of both are [m].
            carry: takes values (m, f) at its nodes to these (n, f).
        """
        for k, (anchors, limits) in enumerate(zip(other.anchors, other._limits)):
            found = carry(np.column_stack([before - anchors, limits]))
            self.anchors[k], self._limits[k] = after - found[:, :3], np.maximum(found[:, 3], 0.0)

    def pressed(self, body: int) -> bool:
        """Tell whether a body with friction pressed any node when `lag` was called last."""
        return bool(self._limits[body].any())

    def lag(self, x: np.ndarray) -> float:
        """Take normals and normal forces for friction from x, and drag the anchors; returns the farthest way [m]."""
        dragged = 0.0
        self.version += 1
        for k, body in enumerate(self.bodies):
            force, self._normals[k] = body.pressing(x, self.area, self.stiffness, self.thickness)
            fresh = self._limits[k] == 0.0
            self.anchors[k][fresh] = x[fresh]
            self._limits[k] = self.friction[k] * force
            way = _kernels.drag_anchors(x, self.anchors[k], self._normals[k], self._limits[k], self.slip)
            dragged = max(dragged, way)
        return dragged

    def passed(self, x: np.ndarray, way: np.ndarray) -> bool:
        """Tell whether points (n, 3) that go on along a way (3,) touch no body any more: all bodies are convex."""
        for body in self.bodies:
            distance, gradient, _ = body.distance(x)
            if distance.min() <= self.thickness or (gradient @ way).min() < 0.0:
                return False
        return True

    def potential(self, x: np.ndarray, curved: bool = True) -> tuple[float, np.ndarray]:
        """Energy [J], and the parameters (n, 12) of potential_point1 whose residual and tangent at x are its own.

        Args:
            x: (n, 3) positions [m].
            curved: with the force times the curvature of the surface; without it the tangent is semidefinite.
        """
        out = np.zeros((len(x), POTENTIAL))
        out[:, :3] = x
        energy = 0.0
        for k, body in enumerate(self.bodies):
            energy += body.add_contact(x, self.area, self.stiffness, self.thickness, out, curved)
            energy += _kernels.add_friction(x, self.anchors[k], self._normals[k], self._limits[k], self.slip, out)
        return energy, out
