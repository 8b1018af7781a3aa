"""The cases as an expert would have scikit-fem do them: see `kept.py` for what is kept from frame to frame.

Geometry alone moves; numbering and pattern are those of the first frame. Values are summed into place, one point of
quadrature serves where the integrand is constant, loads of sides are written down by hand. Linear systems begin at the
answer that the last two frames point to and take an old complete factor as preconditioner; Newton's method keeps an old
tangent. Modes begin at those of the last frame.
"""

import documented
import forms
import numpy as np
import skfem
from kept import Entries, KeptNumbering, KeptPattern, OldFactor, OldTangent, film_entries
from scipy.sparse.linalg import LinearOperator, eigsh, lobpcg, splu
from skfem import ElementTriP1, ElementTriP2, ElementVector

VERSION = f"scikit-fem {skfem.__version__}"
TOLERANCE = 1e-6


def ahead(history):
    """Where the last two answers point to."""
    return 2 * history[-1] - history[-2] if len(history) > 1 else history[-1].copy()


def spread(ends, values, count):
    """Sums (count,) of the values of sides (k,) at both their ends (k, 2)."""
    return np.bincount(ends.ravel(), np.repeat(values, 2), count)


class Kept:
    """A problem whose numbering is kept.

    Args:
        mesh: that is handed over; parameters: of the physics.
    """

    elements = {"u": (ElementVector(ElementTriP1()), 0)}

    def __init__(self, mesh, parameters):
        self.mesh, self.given = mesh, parameters
        self.bases, self.history = KeptNumbering(mesh.cells, self.elements), []

    def sides(self, points, names):
        """Ends (k, 2) of pieces of the border, and their halved lengths."""
        ends = np.concatenate([self.mesh.facets[name] for name in names])
        way = points[ends[:, 1]] - points[ends[:, 0]]
        return ends, 0.5 * np.hypot(*way.T)

    def remember(self, x):
        """Keep the last two answers."""
        self.history = [*self.history[-1:], x]

    def set_free(self, fixed, count):
        """Which unknowns are free; those of two components a node."""
        self.free = np.setdiff1d(np.arange(count), fixed)
        self.pattern = KeptPattern(self.free, count)


class Static(Kept):
    """Linear elasticity."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        nodes = mesh.nodes_on(*parameters["fixed"])
        self.set_free(np.concatenate([2 * nodes, 2 * nodes + 1]), 2 * len(mesh.points))
        self.solve = OldFactor()

    def frame(self, points):
        """(n, 2) [m] displacements."""
        law = {"lam": self.given["lam"], "mu": self.given["mu"]}
        K = self.pattern(forms.elasticity.coo_data(self.bases(points)["u"], **law))
        ends, half = self.sides(points, self.given["pulled"])
        f = np.column_stack([spread(ends, half * one, len(points)) for one in self.given["traction"]])
        guess = ahead(self.history) if self.history else np.zeros(len(self.free))
        x = self.solve(K, f.ravel()[self.free], guess, TOLERANCE)
        self.remember(x)
        u = np.zeros(f.size)
        u[self.free] = x
        return u.reshape(-1, 2)


class LargeDeformation(Kept):
    """St. Venant and Kirchhoff's law with weight and a pressure that follows the side."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        nodes = mesh.nodes_on(*parameters["fixed"])
        self.set_free(np.concatenate([2 * nodes, 2 * nodes + 1]), 2 * len(mesh.points))
        self.newton = OldTangent(symmetric=True)
        self.law = {"lam": parameters["lam"], "mu": parameters["mu"]}

    def place(self, points):
        """Take moved geometry: basis, areas, weight."""
        self.points, self.basis = points, self.bases(points)["u"]
        corners = points[self.mesh.cells]
        one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        third = (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]) / 6
        self.share = np.bincount(self.mesh.cells.ravel(), np.repeat(third, 3), len(points))
        self.load = (self.share[:, None] * np.array(self.given["body_force"])).ravel()

    def forces(self, u):
        """Forces out of balance (2n,); a side pressed by p has p times its turned deformed half at each end."""
        r = forms.inner_force.assemble(self.basis, u=self.basis.interpolate(u), **self.law) - self.load
        if self.given["pressed"]:
            ends = np.concatenate([self.mesh.facets[name] for name in self.given["pressed"]])
            x = self.points + u.reshape(-1, 2)
            way = x[ends[:, 1]] - x[ends[:, 0]]
            push = 0.5 * self.given["pressure"] * np.column_stack([way[:, 1], -way[:, 0]])
            r += np.column_stack([spread(ends, one, len(x)) for one in push.T]).ravel()
        return r

    def tangent(self, u):
        """Their derivative, of free unknowns, without that of the pressure."""
        return self.pattern(forms.tangent.coo_data(self.basis, u=self.basis.interpolate(u), **self.law))

    def frame(self, points):
        """(n, 2) [m] displacements."""
        self.place(points)
        u = ahead(self.history) if self.history else np.zeros(2 * len(points))
        limit = TOLERANCE * np.linalg.norm(self.load[self.free])
        u = self.newton(u, self.free, self.forces, self.tangent, limit)
        self.remember(u)
        return u.reshape(-1, 2)


class Motion(LargeDeformation):
    """Newmark's method of average acceleration, from rest."""

    # More than 15 attributes: what a solid at rest keeps, and a motion besides.

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        self.u = None

    def begin(self, points):
        """The state at time 0."""
        self.place(points)
        basis = KeptNumbering(self.mesh.cells, {"u": (ElementVector(ElementTriP1()), 2)})(points)["u"]
        entries = forms.vector_mass.coo_data(basis, rho=self.given["rho"])
        self.mass, self.free_mass = entries.tocsr(), self.pattern(entries)
        self.u, self.v, self.a = (np.zeros(2 * len(points)) for _ in range(3))
        self.a[self.free] = splu(self.free_mass).solve(self.load[self.free])

    def frame(self, points):
        """(n, 2) [m] displacements: in the first frame those at time 0, then after a step each."""
        if self.u is None:
            self.begin(points)
        else:
            self.step()
        return self.u.reshape(-1, 2)

    def step(self):
        """A time step, begun where displacement, velocity and acceleration lead."""
        dt = self.given["time_step"]
        rate, old = 4 / dt**2, self.u + dt * self.v + 0.25 * dt**2 * self.a
        u = old + 0.25 * dt**2 * self.a
        limit = TOLERANCE * np.linalg.norm(self.load[self.free])
        u = self.newton(
            u,
            self.free,
            lambda x: self.forces(x) + self.mass @ (rate * (x - old)),
            lambda x: self.tangent(x) + rate * self.free_mass,
            limit,
        )
        a = rate * (u - old)
        self.v = self.v + 0.5 * dt * (self.a + a)
        self.u, self.a = u, a


class Modes(Kept):
    """Free vibrations of a plate with shear: LOBPCG from the last frame's modes, with an old factor."""

    elements = {"plate": (ElementTriP2() * ElementVector(ElementTriP2()), 4)}
    shift = 1e6

    def matrices(self, basis):
        """Stiffness and mass."""
        given = self.given
        law = {"lam": given["lam"], "mu": given["mu"], "h": given["thickness"], "k": given["shear_factor"]}
        K = self.pattern(forms.plate_stiffness.coo_data(basis, **law))
        return K, self.pattern(forms.plate_mass.coo_data(basis, rho=given["rho"], h=given["thickness"]))

    def frame(self, points):
        """Frequencies [Hz] without the three motions of a rigid plate."""
        basis = self.bases(points)["plate"]
        if not self.history:
            self.set_free(np.empty(0, dtype=int), basis.N)
            K, M = self.matrices(basis)
            values, modes = eigsh(K, self.given["modes"] + 3, M, sigma=-self.shift)
            self.factor = splu(K + self.shift * M)
            values, modes = values[3:], modes[:, 3:]
        else:
            K, M = self.matrices(basis)
            by_factor = LinearOperator(K.shape, self.factor.solve, matmat=self.factor.solve)
            values, modes = lobpcg(K, self.history[-1], M, by_factor, self.still(basis), 1e-3 * self.size, 30, False)
            order = np.argsort(values)
            values, modes = values[order], modes[:, order]
        self.size = np.linalg.norm(M @ modes[:, 0]) * values[0]
        self.remember(modes)
        return np.sqrt(values) / (2 * np.pi)

    def still(self, basis):
        """(N, 3) motions of a rigid plate: up, and about both axes."""
        Y, x = np.zeros((basis.N, 3)), basis.doflocs
        deflection, turns = basis.split_indices()
        Y[deflection, 0] = 1.0
        for k in range(2):
            Y[deflection, 1 + k] = x[k, deflection]
            Y[turns[k::2], 1 + k] = 1.0
        return Y


class Heat(Kept):
    """Conduction in time by backward Euler."""

    elements = {"T": (ElementTriP1(), 2)}

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        self.set_free(np.empty(0, dtype=int), len(mesh.points))
        self.solve, self.T = OldFactor(), None

    def frame(self, points):
        """(n,) [K] temperatures: in the first frame those at time 0, then after a step each."""
        if self.T is None:
            self.T = np.full(len(points), self.given["initial"])
            return self.T
        basis, given = self.bases(points)["T"], self.given
        stored = forms.mass.coo_data(basis, c=given["capacity"] / given["time_step"])
        conducted = forms.diffusion.coo_data(basis, k=given["conductivity"])
        air, half = self.sides(points, given["cooled"])
        A = self.pattern(conducted, stored, film_entries(air, half, given["film"]))
        f = np.bincount(stored.indices[0], stored.data * self.T[stored.indices[1]])
        f += spread(air, half * given["film"] * given["ambient"], len(points))
        chip, half = self.sides(points, given["heated"])
        f += spread(chip, half * given["flux"], len(points))
        self.remember(self.T)
        self.T = self.solve(A, f, ahead(self.history), TOLERANCE)
        return self.T


class Flow(Kept):
    """Steady flow by Taylor and Hood's elements, from the last frame's flow."""

    elements = {"u": (ElementVector(ElementTriP2()), 5), "p": (ElementTriP1(), 5)}

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        self.newton, self.known = OldTangent(symmetric=False), None

    def place(self, points):
        """Take moved geometry; in the first frame find what is constrained, and its values."""
        self.basis = self.bases(points)
        self.inner = self.basis["u"].N
        if self.known is not None:
            return
        first = documented.Flow(self.mesh, self.given)
        _, fixed, known = first.spaces(points)
        self.known = np.concatenate([known, self.basis["p"].zeros()])
        self.set_free(fixed, len(self.known))

    def residual(self, x):
        """Momentum and volume out of balance."""
        u, p, given = self.basis["u"], self.basis["p"], self.given
        state, pressure = u.interpolate(x[: self.inner]), p.interpolate(x[self.inner :])
        r = forms.convected.assemble(u, a=state, rho=given["rho"], mu=given["viscosity"])
        r += forms.pressed.assemble(u, pressure=pressure)
        return np.concatenate([r, forms.gained.assemble(p, a=state)])

    def tangent(self, x):
        """The derivative, of free unknowns."""
        u, p, given = self.basis["u"], self.basis["p"], self.given
        state = u.interpolate(x[: self.inner])
        viscous = forms.viscosity.coo_data(u, mu=given["viscosity"])
        convected = forms.convection.coo_data(u, a=state, rho=given["rho"])
        B = forms.divergence.coo_data(u, p)
        below = B.indices + np.array([[self.inner], [0]])
        return self.pattern(viscous, convected, Entries(below, B.data), Entries(below[::-1], B.data))

    def frame(self, points):
        """(n, 2) [m/s] velocities."""
        self.place(points)
        if not self.history:
            self.limit = TOLERANCE * np.linalg.norm(self.residual(self.known)[self.free])
        x = self.newton(ahead(self.history or [self.known]), self.free, self.residual, self.tangent, self.limit)
        self.remember(x)
        return x[self.basis["u"].nodal_dofs].T


PROBLEMS = {
    "static": Static,
    "large_deformation": LargeDeformation,
    "motion": Motion,
    "modes": Modes,
    "heat": Heat,
    "flow": Flow,
}
