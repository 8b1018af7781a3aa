"""The cases as NGSolve's tutorials have them: mesh, spaces and matrices of each frame are made from nothing.

Sources: NGSolve's i-tutorials, units 1.1 (Poisson), 2.4 (mixed), 3.2 (Navier and Stokes), 3.7 (nonlinear problems), 1.7
(eigenvalues), and netgen's manual mesh generation (4.2).
"""

import forms
import ngsolve
import numpy as np
from ngsolve import H1, GridFunction, solvers

VERSION = f"NGSolve {ngsolve.__version__}"
TOLERANCE = 1e-6


class FromNothing:
    """A problem whose mesh is made in each frame.

    Args:
        mesh: that is handed over; parameters: of the physics.
    """

    def __init__(self, mesh, parameters):
        self.mesh, self.given = mesh, parameters


class Static(FromNothing):
    """Linear elasticity."""

    def frame(self, points):
        """(n, 2) [m] displacements."""
        mesh, _ = forms.made(self.mesh, points)
        space, a, f = forms.elasticity(mesh, self.given)
        a.Assemble()
        f.Assemble()
        u = GridFunction(space)
        u.vec.data = a.mat.Inverse(space.FreeDofs(), inverse="sparsecholesky") * f.vec
        return forms.at_nodes(u, len(points))


def newton(a, u, free, load, limit, inverse="sparsecholesky", extra=None):
    """Newton's method with full steps; `extra`: a linear part, a matrix and the vector that it acts on from."""
    residual, step = u.vec.CreateVector(), u.vec.CreateVector()
    mask = np.array(list(free))
    for _ in range(60):
        a.Apply(u.vec, residual)
        if load is not None:
            residual.data -= load
        if extra:
            step.data = u.vec - extra[1]
            residual.data += extra[0] * step
        size = np.linalg.norm(residual.FV().NumPy()[mask])
        limit = TOLERANCE * size if limit is None else limit
        if size <= limit:
            return limit
        a.AssembleLinearization(u.vec)
        if extra:
            a.mat.AsVector().data += extra[0].AsVector()
        u.vec.data -= a.mat.Inverse(free, inverse=inverse) * residual
    raise RuntimeError("Newton's method has not converged")


class LargeDeformation(FromNothing):
    """St. Venant and Kirchhoff's law: Newton's method from the undeformed state."""

    def frame(self, points):
        """(n, 2) [m] displacements."""
        mesh, _ = forms.made(self.mesh, points)
        space, a, load, _ = forms.large_deformation(mesh, self.given)
        load.Assemble()
        u = GridFunction(space)
        newton(a, u, space.FreeDofs(), load.vec, None, "umfpack")
        return forms.at_nodes(u, len(points))


class Motion(FromNothing):
    """Newmark's method of average acceleration, from rest; mesh, space and mass are made once, as the shape stays."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        self.u = None

    def begin(self, points):
        """The state at time 0."""
        mesh, _ = forms.made(self.mesh, points)
        self.space, self.form, self.load, mass = forms.large_deformation(mesh, self.given)
        self.load.Assemble()
        mass.Assemble()
        self.free, self.mass = self.space.FreeDofs(), mass
        self.u = GridFunction(self.space)
        self.v, self.a, self.old = (self.u.vec.CreateVector() for _ in range(3))
        self.v[:] = 0.0
        self.a.data = mass.mat.Inverse(self.free, inverse="sparsecholesky") * self.load.vec
        self.scaled = mass.mat.CreateMatrix()
        self.scaled.AsVector().data = 4 / self.given["time_step"] ** 2 * mass.mat.AsVector()

    def frame(self, points):
        """(n, 2) [m] displacements: in the first frame those at time 0, then after a step each."""
        if self.u is None:
            self.begin(points)
        else:
            self.step()
        return forms.at_nodes(self.u, len(points))

    def step(self):
        """A time step."""
        dt = self.given["time_step"]
        self.old.data = self.u.vec + dt * self.v + 0.25 * dt**2 * self.a
        self.solve()
        new = (4 / dt**2) * (self.u.vec - self.old)
        new = new.Evaluate()
        self.v.data += 0.5 * dt * self.a + 0.5 * dt * new
        self.a.data = new

    def solve(self):
        """The displacement after a step."""
        newton(self.form, self.u, self.free, self.load.vec, None, extra=(self.scaled, self.old))


class Modes(FromNothing):
    """Free vibrations of a plate with shear, of second order, by PINVIT with the factor of a shifted stiffness."""

    def frame(self, points):
        """Frequencies [Hz] without the three motions of a rigid plate."""
        mesh, _ = forms.made(self.mesh, points)
        space, k, m = forms.plate(mesh, self.given)
        k.Assemble()
        m.Assemble()
        shifted = forms.shifted(k, m, 1e6).Inverse(space.FreeDofs(), inverse="sparsecholesky")
        values, _ = solvers.PINVIT(k.mat, m.mat, shifted, self.given["modes"] + 3, maxit=20, printrates=False)
        return np.sqrt(np.sort(values)[3:]) / (2 * np.pi)


class Heat(FromNothing):
    """Conduction in time by backward Euler."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        self.T = None

    def frame(self, points):
        """(n,) [K] temperatures: in the first frame those at time 0, then after a step each."""
        if self.T is None:
            self.T = np.full(len(points), self.given["initial"])
            return self.T
        mesh, _ = forms.made(self.mesh, points)
        old = GridFunction(H1(mesh, order=1))
        old.vec.FV().NumPy()[:] = self.T
        a, f = forms.heat(mesh, self.given, old)
        a.Assemble()
        f.Assemble()
        old.vec.data = a.mat.Inverse(old.space.FreeDofs(), inverse="sparsecholesky") * f.vec
        self.T = np.array(old.vec.FV().NumPy())
        return self.T


class Flow(FromNothing):
    """Steady flow by Taylor and Hood's elements and Newton's method, from the fluid at rest."""

    def frame(self, points):
        """(n, 2) [m/s] velocities."""
        mesh, _ = forms.made(self.mesh, points)
        space, a = forms.flow(mesh, self.given)
        x = GridFunction(space)
        inlet = mesh.Boundaries(forms.pieces(self.given["inlet"]))
        x.components[0].Set(ngsolve.CF((self.given["speed"], 0)), definedon=inlet)
        newton(a, x, space.FreeDofs(), None, None, "umfpack")
        return forms.at_nodes(x.components[0], len(points))


PROBLEMS = {
    "static": Static,
    "large_deformation": LargeDeformation,
    "motion": Motion,
    "modes": Modes,
    "heat": Heat,
    "flow": Flow,
}
