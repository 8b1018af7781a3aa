"""The cases as DOLFINx's demos and tutorial have them: mesh, spaces, forms and solvers of each frame from nothing.

Sources: demos elasticity, hyperelasticity, stokes and heat of DOLFINx's documentation and tutorial: `LinearProblem`
with a complete factor, `NewtonSolver`, and SLEPc's Krylov and Schur method. Forms are compiled once, into a cache.
"""

import dolfinx
import forms
import numpy as np
import ufl
from dolfinx import fem, nls
from dolfinx.fem.petsc import LinearProblem, NonlinearProblem, assemble_matrix
from petsc4py import PETSc
from slepc4py import SLEPc

VERSION = f"DOLFINx {dolfinx.__version__}"
TOLERANCE = 1e-6
DIRECT = {"ksp_type": "preonly", "pc_type": "lu"}


class FromNothing:
    """A problem whose mesh is made in each frame.

    Args:
        mesh: that is handed over; parameters: of the physics.
    """

    def __init__(self, mesh, parameters):
        self.mesh, self.given = mesh, parameters


def newton(u, forces, conditions):
    """Brings u to where the forces vanish, by full steps."""
    solver = nls.petsc.NewtonSolver(u.function_space.mesh.comm, NonlinearProblem(forces, u, conditions))
    solver.convergence_criterion = "residual"
    solver.rtol, solver.atol, solver.max_it = TOLERANCE, 0.0, 60
    solver.krylov_solver.setType("preonly")
    solver.krylov_solver.getPC().setType("lu")
    solver.krylov_solver.getPC().setFactorSolverType("mumps")
    solver.solve(u)


class Static(FromNothing):
    """Linear elasticity."""

    def frame(self, points):
        """(n, 2) [m] displacements."""
        body = forms.Body(self.mesh, points)
        space, a, load, condition = forms.elasticity(body, self.given)
        u = LinearProblem(a, load, [condition], petsc_options=DIRECT).solve()
        return u.x.array.reshape(-1, 2)[body.places(space)]


class LargeDeformation(FromNothing):
    """St. Venant and Kirchhoff's law: Newton's method from the undeformed state."""

    def frame(self, points):
        """(n, 2) [m] displacements."""
        body = forms.Body(self.mesh, points)
        u, forces, condition = forms.large_deformation(body, self.given)
        newton(u, forces, [condition])
        return u.x.array.reshape(-1, 2)[body.places(u.function_space)]


class Motion(FromNothing):
    """Newmark's method of average acceleration, from rest; mesh and forms are made once, as the shape stays."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        self.u = None

    def begin(self, points):
        """The state at time 0."""
        body, given = forms.Body(self.mesh, points), self.given
        self.u, forces, self.condition = forms.large_deformation(body, given)
        space = self.u.function_space
        self.old, self.velocity = fem.Function(space), np.zeros_like(self.u.x.array)
        a, v = ufl.TrialFunction(space), ufl.TestFunction(space)
        inertia = given["rho"] * ufl.dot(a, v) * ufl.dx
        load = ufl.dot(ufl.as_vector(given["body_force"]), v) * ufl.dx
        start = LinearProblem(inertia, load, [self.condition], petsc_options=DIRECT).solve()
        self.acceleration, self.place = start.x.array.copy(), body.places(space)
        self.rate = 4 / given["time_step"] ** 2
        self.forces = forces + self.rate * given["rho"] * ufl.dot(self.u - self.old, v) * ufl.dx

    def frame(self, points):
        """(n, 2) [m] displacements: in the first frame those at time 0, then after a step each."""
        if self.u is None:
            self.begin(points)
        else:
            self.step()
        return self.u.x.array.reshape(-1, 2)[self.place]

    def step(self):
        """A time step."""
        dt, now = self.given["time_step"], self.u.x.array
        self.old.x.array[:] = now + dt * self.velocity + 0.25 * dt**2 * self.acceleration
        self.solve()
        new = self.rate * (self.u.x.array - self.old.x.array)
        self.velocity += 0.5 * dt * (self.acceleration + new)
        self.acceleration = new

    def solve(self):
        """The displacement after a step."""
        newton(self.u, self.forces, [self.condition])


class Modes(FromNothing):
    """Free vibrations of a plate with shear, of second order, by Krylov and Schur's method about a negative shift."""

    def frame(self, points):
        """Frequencies [Hz] without the three motions of a rigid plate."""
        body = forms.Body(self.mesh, points)
        _, k, m = forms.plate(body, self.given)
        K, M = assemble_matrix(fem.form(k)), assemble_matrix(fem.form(m))
        K.assemble()
        M.assemble()
        solver, count = SLEPc.EPS().create(PETSc.COMM_SELF), self.given["modes"] + 3
        solver.setOperators(K, M)
        solver.setProblemType(SLEPc.EPS.ProblemType.GHEP)
        solver.setDimensions(count)
        solver.setTarget(-1e6)
        solver.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
        solver.getST().setType("sinvert")
        solver.getST().getKSP().setType("preonly")
        solver.getST().getKSP().getPC().setType("cholesky")
        solver.getST().getKSP().getPC().setFactorSolverType("mumps")
        solver.solve()
        values = np.sort([solver.getEigenvalue(k).real for k in range(count)])
        return np.sqrt(values[3:]) / (2 * np.pi)


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
        body = forms.Body(self.mesh, points)
        old, a, load = forms.heat(body, self.given)
        place = body.places(old.function_space)
        old.x.array[place] = self.T
        self.T = LinearProblem(a, load, petsc_options=DIRECT).solve().x.array[place]
        return self.T


def velocities(body, x):
    """(n, 2) numbers of the velocities at the nodes."""
    space, numbers = x.function_space.sub(0).collapse()
    return np.array(numbers).reshape(-1, 2)[body.places(space)]


class Flow(FromNothing):
    """Steady flow by Taylor and Hood's elements and Newton's method, from the fluid at rest."""

    def frame(self, points):
        """(n, 2) [m/s] velocities."""
        body = forms.Body(self.mesh, points)
        x, forces, conditions = forms.flow(body, self.given)
        newton(x, forces, conditions)
        return x.x.array[velocities(body, x)]


PROBLEMS = {
    "static": Static,
    "large_deformation": LargeDeformation,
    "motion": Motion,
    "modes": Modes,
    "heat": Heat,
    "flow": Flow,
}
