"""Contact of cloth with bodies in closed form: penalty along the gradient of the distance, friction by anchors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from restshape import _kernels

POTENTIAL = 12
"""Parameters of the element potential_point1: a place, the gradient there, the second derivatives xx yy zz yz xz xy."""


@dataclass(frozen=True, eq=False)
class FrictionHistory:
    """What friction remembers; each update makes another one.

    Args:
        anchors: (bodies, n, 3) [m].
        normals: (bodies, n, 3) of the surfaces at the last update.
        limits: (bodies, n) largest forces of friction [N].
    """

    anchors: np.ndarray
    normals: np.ndarray
    limits: np.ndarray

    @classmethod
    def none(cls, bodies: int, nodes: int) -> FrictionHistory:
        """The history of nodes that have touched nothing."""
        shape = (bodies, nodes)
        return cls(np.zeros((*shape, 3)), np.zeros((*shape, 3)), np.zeros(shape))

    def mapped(
        self, before: np.ndarray, after: np.ndarray, interpolate: Callable[[np.ndarray], np.ndarray]
    ) -> FrictionHistory:
        """The history on other nodes: the ways from anchors, and which nodes are pressed.

        Args:
            before, after: (m, 3) and (n, 3) where the nodes of both are [m].
            interpolate: takes values (m, f) at the nodes of before to the others (n, f).
        """
        found = FrictionHistory.none(len(self.anchors), len(after))
        for k, (anchors, limits) in enumerate(zip(self.anchors, self.limits)):
            values = interpolate(np.column_stack([before - anchors, limits]))
            found.anchors[k], found.limits[k] = after - values[:, :3], np.maximum(values[:, 3], 0.0)
        return found

    def pressed(self, body: int) -> bool:
        """Whether a body with friction pressed any node at the last update."""
        return bool(self.limits[body].any())


class Contact:
    """What bodies do to nodes. With one history of friction it is a potential of the positions.

    Args:
        bodies: of `restshape._kernels.Body`; they may be replaced as they move.
        area: (n,) that each node stands for [m^2].
        stiffness: of the penalty [N/m^3]; thickness: distance at which it begins [m].
        friction: coefficient, of all bodies or one of each; slip: way along the surface at which it is all there [m].

    Attributes:
        history: of friction; it changes in `update_friction` only.

    Source: docs/theory/cloth.md.
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
        self.history = FrictionHistory.none(len(self.bodies), len(area))

    def update_friction(self, x: np.ndarray) -> float:
        """Take normals and normal forces from x (n, 3), and drag the anchors; returns the largest slip distance [m]."""
        before, slipped = self.history, 0.0
        anchors, normals, limits = before.anchors.copy(), before.normals.copy(), before.limits.copy()
        for k, body in enumerate(self.bodies):
            force, normals[k] = body.pressing(x, self.area, self.stiffness, self.thickness)
            fresh = limits[k] == 0.0
            anchors[k][fresh] = x[fresh]
            limits[k] = self.friction[k] * force
            distance = _kernels.update_friction_anchors(x, anchors[k], normals[k], limits[k], self.slip)
            slipped = max(slipped, distance)
        self.history = FrictionHistory(anchors, normals, limits)
        return slipped

    def passed(self, x: np.ndarray, way: np.ndarray) -> bool:
        """Whether points (n, 3) that go on along a way (3,) touch no body any more: all bodies are convex."""
        for body in self.bodies:
            distance, gradient, _ = body.distance(x)
            if distance.min() <= self.thickness or (gradient @ way).min() < 0.0:
                return False
        return True

    def force_rates(self, x: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Rates (n, 3) of forces at constant x (n, 3) when areas change with rates (n,): the penalty is linear in them.

        Friction has none, for its limits are those of the last update.
        """
        out = np.zeros((len(x), POTENTIAL))
        for body in self.bodies:
            body.add_contact(x, rates, self.stiffness, self.thickness, out, False)
        return out[:, 3:6]

    def potential(self, x: np.ndarray, curved: bool = True) -> tuple[float, np.ndarray]:
        """Energy [J], and the parameters (n, 12) of potential_point1 whose residual and tangent at x are its own.

        Args:
            x: (n, 3) positions [m].
            curved: with the force times the curvature of the surface; without it the tangent is semidefinite.
        """
        out = np.zeros((len(x), POTENTIAL))
        out[:, :3] = x
        energy, history = 0.0, self.history
        for k, body in enumerate(self.bodies):
            energy += body.add_contact(x, self.area, self.stiffness, self.thickness, out, curved)
            anchors, normals, limits = history.anchors[k], history.normals[k], history.limits[k]
            energy += _kernels.add_friction(x, anchors, normals, limits, self.slip, out)
        return energy, out
