"""Forces of Newton's cloth in double precision: what its solver of vertices leaves at the places that it ends at.

The energies are those that the documentation of `SolverVBD` names: a membrane of B. Smith, F. de Goes and T. Kim,
Stable neo-Hookean flesh simulation (ACM Transactions on Graphics 37, 2018), in the area ratio of a surface, and half a
stiffness times the edge's length times the square of the angle between two triangles.
"""

import numpy as np


def hinge_stiffness(points, edges, bending):
    """Stiffness of edges (ne,) [N] whose angle bends as a plate does: restshape's nonlinear hinges; 0 on the border.

    Args:
        points: (n, 3) [m] places at rest; bending: of the plate [N m].
        edges: (ne, 4) the nodes opposite of each edge, -1 where there is none, and its ends.
    """
    along = points[edges[:, 3]] - points[edges[:, 2]]
    sides = [np.cross(along, points[edges[:, k]] - points[edges[:, 2]]) for k in (0, 1)]
    areas = 0.5 * sum(np.linalg.norm(side, axis=1) for side in sides)
    return np.where((edges[:, :2] >= 0).all(axis=1), bending * np.linalg.norm(along, axis=1) / areas, 0.0)


class ClothForces:
    """Forces on a cloth under its weight.

    Args:
        points: (n, 2) [m] places in the plane that it is cut from; cells: (nt, 3).
        edges: (ne, 4) and stiffness (ne,) [N] as in `hinge_stiffness`.
        lam, mu: Lamé's numbers of the membrane [N/m]; weight: of an area [N/m^2], along -z; fixed: nodes.
    """

    def __init__(self, points, cells, edges, stiffness, lam, mu, weight, fixed):
        sides = self._sides(points, cells)
        self.cells, self.inverse, self.area = cells, np.linalg.inv(sides), 0.5 * np.linalg.det(sides)
        bent = stiffness > 0
        self.edges, ends = edges[bent], points[edges[bent]][:, 2:]
        self.moment = stiffness[bent] * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        # Smith, de Goes and Kim, section 3.4: these numbers give Lamé's at rest.
        self.mu, self.lam = mu, lam + mu
        self.load = np.zeros((len(points), 3))
        np.add.at(self.load[:, 2], cells.ravel(), -weight * np.repeat(self.area / 3, 3))
        self.fixed = fixed

    @staticmethod
    def _sides(places, cells):
        return np.stack([places[cells[:, k]] - places[cells[:, 0]] for k in (1, 2)], axis=2)

    def _bent(self, x):
        """Angles (ne,), both normals of double area (ne, 3) and edges (ne, 3) between bent triangles."""
        one, two, start, end = (x[nodes] for nodes in self.edges.T)
        left, right = np.cross(start - one, end - one), np.cross(end - two, start - two)
        along = end - start
        sine = np.einsum("ij,ij->i", np.cross(left, right), along) / np.linalg.norm(along, axis=1)
        return np.arctan2(sine, np.einsum("ij,ij->i", left, right)), left, right, along

    def energy(self, x):
        """Potential energy [J] at x (n, 3)."""
        F = self._sides(x, self.cells) @ self.inverse
        ratio, rest = np.linalg.norm(np.cross(F[:, :, 0], F[:, :, 1]), axis=1), 1 + self.mu / self.lam
        density = 0.5 * self.mu * (F**2).sum(axis=(1, 2)) + 0.5 * self.lam * (ratio - rest) ** 2
        return self.area @ density + 0.5 * self.moment @ self._bent(x)[0] ** 2 - (self.load * x).sum()

    def forces(self, x):
        """Forces (n, 3) [N] at x (n, 3), less the energy's gradient; 0 where fixed."""
        f = self.load.copy()
        F = self._sides(x, self.cells) @ self.inverse
        normal = np.cross(F[:, :, 0], F[:, :, 1])
        ratio = np.linalg.norm(normal, axis=1, keepdims=True)
        normal /= ratio
        pressed = self.lam * (ratio - 1) - self.mu
        columns = [
            self.mu * F[:, :, 0] + pressed * np.cross(F[:, :, 1], normal),
            self.mu * F[:, :, 1] + pressed * np.cross(normal, F[:, :, 0]),
        ]
        pulls = -self.area[:, None, None] * np.stack(columns, axis=2) @ self.inverse.transpose(0, 2, 1)
        for k, pull in enumerate((-pulls.sum(axis=2), pulls[:, :, 0], pulls[:, :, 1])):
            np.add.at(f, self.cells[:, k], pull)
        self._add_bending(x, f)
        f[self.fixed] = 0.0
        return f

    def _add_bending(self, x, f):
        angle, left, right, along = self._bent(x)
        length, start = np.linalg.norm(along, axis=1), x[self.edges[:, 2]]
        turns, shares = [], []
        for node, normal in zip(self.edges.T[:2], (left, right)):
            turns.append(normal * (-length / (normal**2).sum(axis=1))[:, None])
            shares.append((np.einsum("ij,ij->i", x[node] - start, along) / length**2)[:, None])
        ends = [sum(-(1 - share) * turn for share, turn in zip(shares, turns))]
        ends.append(sum(-share * turn for share, turn in zip(shares, turns)))
        for node, turn in zip(self.edges.T, (*turns, *ends)):
            np.add.at(f, node, -(self.moment * angle)[:, None] * turn)

    def residual(self, x):
        """Norm of the forces at x (n, 3) over that of the loads."""
        return float(np.linalg.norm(self.forces(x)) / np.linalg.norm(self.load))
