"""The cases as an expert would have DOLFINx do them: one mesh whose places are written over, forms and matrices kept.

Forms are compiled for this machine. Linear systems begin at the answer that the last two frames point to, and take an
old complete factor as preconditioner of conjugate gradients; Newton's method keeps an old tangent. Modes begin at those
of the last frame.
"""

import documented
import forms
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix, assemble_vector, create_matrix, create_vector
from petsc4py import PETSc
from slepc4py import SLEPc

VERSION = documented.VERSION
TOLERANCE = 1e-6
MOST_ITERATIONS = 10
"""Iterations after which a factor is too old."""
COMPILED = {"cffi_extra_compile_args": ["-O3", "-march=native", "-ffast-math"]}


def compiled(form):
    """A form, compiled for this machine."""
    return fem.form(form, jit_params=COMPILED)


def refill(matrix, form, conditions=()):
    """Sum a matrix's values again, in its pattern."""
    matrix.zeroEntries()
    assemble_matrix(matrix, form, list(conditions))
    matrix.assemble()


def fill(vector, form, fixed=()):
    """Sum a vector's values again, 0 at unknowns that are fixed."""
    with vector.localForm() as local:
        local.set(0.0)
    assemble_vector(vector, form)
    if len(fixed):
        vector.array[fixed] = 0.0


def unknowns(conditions):
    """Numbers of the unknowns that boundary conditions fix."""
    return np.unique(np.concatenate([one.dof_indices()[0] for one in conditions]))


class OldFactor:
    """Conjugate gradients with an old complete factor, which is made again when it needs many iterations."""

    def __init__(self, matrix):
        self.solver = PETSc.KSP().create(PETSc.COMM_SELF)
        self.solver.setOperators(matrix)
        self.solver.setType("cg")
        self.solver.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        self.solver.setInitialGuessNonzero(True)
        self.solver.setTolerances(rtol=TOLERANCE, atol=0.0)
        self.solver.getPC().setType("cholesky")
        self.solver.getPC().setFactorOrdering("nd")

    def __call__(self, right, x):
        """Bring x to a relative residual."""
        self.solver.solve(right, x)
        self.solver.getPC().setReusePreconditioner(self.solver.getIterationNumber() <= MOST_ITERATIONS)


class OldTangent:
    """Newton's method with an old factor of the tangent, made again where a step gains too little, and in first frames.

    Args:
        forces: a form; u: what they hang on; conditions: at the border; inverse: PETSc's name of the factor's maker.
    """

    def __init__(self, forces, u, conditions, inverse):
        self.u, self.conditions, self.fixed = u, conditions, unknowns(conditions)
        self.forces, self.tangent = compiled(forces), compiled(ufl.derivative(forces, u))
        self.matrix, self.residual = create_matrix(self.tangent), create_vector(self.forces)
        self.step, self.ready = self.residual.duplicate(), False
        self.solver = PETSc.KSP().create(PETSc.COMM_SELF)
        self.solver.setType("preonly")
        self.solver.setOperators(self.matrix)
        self.solver.getPC().setType("lu")
        self.solver.getPC().setFactorSolverType(inverse)

    def refresh(self):
        """Make the factor again, with the analysis of the first."""
        refill(self.matrix, self.tangent, self.conditions)
        self.solver.setOperators(self.matrix)
        self.solver.setUp()
        self.ready = True

    def __call__(self, limit=None):
        """Bring u to a residual below the limit, that of the first residual where none is given; the limit."""
        last, first = np.inf, limit is None
        for _ in range(60):
            fill(self.residual, self.forces, self.fixed)
            size = self.residual.norm()
            limit = TOLERANCE * size if limit is None else limit
            if size <= limit:
                return limit
            if first or not self.ready or size > 0.3 * last:
                self.refresh()
            self.solver.solve(self.residual, self.step)
            self.u.x.array[:] -= self.step.array
            last = size
        raise RuntimeError("Newton's method has not converged")


class Kept:
    """A problem whose mesh, forms and matrices are kept.

    Args:
        mesh: that is handed over; parameters: of the physics.
    """

    def __init__(self, mesh, parameters):
        self.given, self.body, self.before = parameters, forms.Body(mesh, mesh.points), None

    def look_ahead(self, values):
        """Change an answer in place to where the last two point to."""
        now = values.copy()
        if self.before is not None:
            values[:] = 2 * now - self.before
        self.before = now


class Static(Kept):
    """Linear elasticity."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        space, a, load, condition = forms.elasticity(self.body, parameters)
        self.condition, self.place = condition, self.body.places(space)
        self.a, self.load = compiled(a), compiled(load)
        self.matrix, self.right = create_matrix(self.a), create_vector(self.load)
        self.matrix.setOption(PETSc.Mat.Option.SPD, True)
        self.u, self.fixed, self.solve = fem.Function(space), unknowns([condition]), OldFactor(self.matrix)

    def frame(self, points):
        """(n, 2) [m] displacements."""
        self.body.move(points)
        refill(self.matrix, self.a, [self.condition])
        fill(self.right, self.load, self.fixed)
        self.look_ahead(self.u.x.array)
        self.solve(self.right, self.u.vector)
        return self.u.x.array.reshape(-1, 2)[self.place]


class LargeDeformation(Kept):
    """St. Venant and Kirchhoff's law with weight and a pressure that follows the side."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        self.u, forces, condition = forms.large_deformation(self.body, parameters)
        self.place, self.limit = self.body.places(self.u.function_space), None
        self.newton = OldTangent(forces, self.u, [condition], "mumps")

    def frame(self, points):
        """(n, 2) [m] displacements."""
        self.body.move(points)
        if self.limit is not None:
            self.look_ahead(self.u.x.array)
        self.limit = self.newton(self.limit)
        return self.u.x.array.reshape(-1, 2)[self.place]


class Motion(documented.Motion):
    """Newmark's method of average acceleration; a step begins where the last accelerations lead."""

    newton, limit = None, None

    def solve(self):
        """The displacement after a step."""
        if self.newton is None:
            self.newton = OldTangent(self.forces, self.u, [self.condition], "mumps")
        self.u.x.array[:] = self.old.x.array + 0.25 * self.given["time_step"] ** 2 * self.acceleration
        if self.limit is None:
            self.limit = TOLERANCE * self.weight()
        self.newton(self.limit)

    def weight(self):
        """The norm of the weight, which residuals are measured by."""
        v = ufl.TestFunction(self.u.function_space)
        load = assemble_vector(compiled(ufl.dot(ufl.as_vector(self.given["body_force"]), v) * ufl.dx))
        load.array[self.newton.fixed] = 0.0
        return load.norm()


class Modes(Kept):
    """Free vibrations of a plate with shear: LOBPCG from the last frame's modes, with an old factor."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        self.space, k, m = forms.plate(self.body, parameters)
        self.k, self.m = compiled(k), compiled(m)
        self.K, self.M, self.modes = create_matrix(self.k), create_matrix(self.m), []
        self.deflection, self.turns = ([*self.space.sub(j).collapse()] for j in range(2))

    def still(self):
        """Motions of a rigid plate: up, and about both axes."""
        found = []
        x = self.deflection[0].tabulate_dof_coordinates()
        for k in range(3):
            vector = self.K.createVecRight()
            vector.array[self.deflection[1]] = 1.0 if k == 2 else x[:, k]
            if k < 2:
                vector.array[np.array(self.turns[1])[k::2]] = 1.0
            found.append(vector)
        return found

    def begin(self):
        """The factor of the first frame, of the stiffness with a part of the mass."""
        shifted = self.K.copy()
        shifted.axpy(1e6, self.M, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        shifted.setOption(PETSc.Mat.Option.SPD, True)
        self.factor = shifted

    def frame(self, points):
        """Frequencies [Hz] without the three motions of a rigid plate."""
        self.body.move(points)
        refill(self.K, self.k)
        refill(self.M, self.m)
        count = self.given["modes"]
        if not self.modes:
            self.begin()
            self.solver = self.made(count)
        self.solver.setOperators(self.K, self.M)
        self.solver.setDeflationSpace(self.still())
        if self.modes:
            self.solver.setInitialSpace(self.modes)
        self.solver.solve()
        self.modes = [self.K.createVecRight() for _ in range(count)]
        values = np.sort([self.solver.getEigenpair(k, self.modes[k]).real for k in range(count)])
        return np.sqrt(values) / (2 * np.pi)

    def made(self, count):
        """SLEPc's LOBPCG with the kept factor."""
        solver = SLEPc.EPS().create(PETSc.COMM_SELF)
        solver.setType("lobpcg")
        solver.setProblemType(SLEPc.EPS.ProblemType.GHEP)
        solver.setWhichEigenpairs(SLEPc.EPS.Which.SMALLEST_REAL)
        solver.setDimensions(count)
        solver.setTolerances(tol=1e-3, max_it=50)
        solver.getST().setType("precond")
        solver.getST().setPreconditionerMat(self.factor)
        solver.getST().getKSP().setType("preonly")
        solver.getST().getKSP().getPC().setType("cholesky")
        solver.getST().getKSP().getPC().setFactorSolverType("mumps")
        return solver


class Heat(Kept):
    """Conduction in time by backward Euler."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        self.T, a, load = forms.heat(self.body, parameters)
        self.a, self.load = compiled(a), compiled(load)
        self.matrix, self.right = create_matrix(self.a), create_vector(self.load)
        self.matrix.setOption(PETSc.Mat.Option.SPD, True)
        self.place, self.solve = self.body.places(self.T.function_space), OldFactor(self.matrix)
        self.started = False

    def frame(self, points):
        """(n,) [K] temperatures: in the first frame those at time 0, then after a step each."""
        if not self.started:
            self.T.x.array[:], self.started = self.given["initial"], True
            return self.T.x.array[self.place]
        self.body.move(points)
        refill(self.matrix, self.a)
        fill(self.right, self.load)
        self.look_ahead(self.T.x.array)
        self.solve(self.right, self.T.vector)
        return self.T.x.array[self.place]


class Flow(Kept):
    """Steady flow by Taylor and Hood's elements, from the last frame's flow."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        self.x, forces, conditions = forms.flow(self.body, parameters)
        self.numbers, self.limit = documented.velocities(self.body, self.x), None
        for one in conditions:
            fem.petsc.set_bc(self.x.vector, [one])
        self.newton = OldTangent(forces, self.x, conditions, "mumps")

    def frame(self, points):
        """(n, 2) [m/s] velocities."""
        self.body.move(points)
        if self.limit is not None:
            self.look_ahead(self.x.x.array)
        self.limit = self.newton(self.limit)
        return self.x.x.array[self.numbers]


PROBLEMS = {
    "static": Static,
    "large_deformation": LargeDeformation,
    "motion": Motion,
    "modes": Modes,
    "heat": Heat,
    "flow": Flow,
}
