"""The cases as an expert would have NGSolve do them: one mesh whose places are written over, spaces and matrices kept.

Linear systems begin at the answer that the last two frames point to, and take an old complete factor as preconditioner
of conjugate gradients; Newton's method keeps an old tangent. Modes begin at those of the last frame.
"""

import documented
import forms
import ngsolve
import numpy as np
from ngsolve import H1, GridFunction, InnerProduct, Projector, solvers

VERSION = documented.VERSION
TOLERANCE = 1e-6
MOST_ITERATIONS = 10
"""Iterations after which a factor is too old."""


class Kept:
    """A problem whose mesh, spaces and matrices are kept.

    Args:
        mesh: that is handed over; parameters: of the physics.
    """

    def __init__(self, mesh, parameters):
        self.given = parameters
        self.mesh, self.places = forms.made(mesh, mesh.points)
        self.factor, self.before = None, None

    def move(self, points):
        """Write the mesh's places over."""
        self.places[:, :2] = points

    def look_ahead(self, x):
        """Change an answer to where the last two point to."""
        now = x.CreateVector()
        now.data = x
        if self.before is not None:
            x.data = 2 * now - self.before
        self.before = now


class OldFactor:
    """Conjugate gradients with an old complete factor, which is made again when it needs many iterations.

    Args:
        space: whose free unknowns are solved for.
    """

    def __init__(self, space):
        self.free, self.factor = space.FreeDofs(), None
        self.onto = Projector(self.free, True)

    def __call__(self, matrix, right, x):
        """Bring x to a relative residual."""
        if self.factor is None:
            self.factor = matrix.Inverse(self.free, inverse="sparsecholesky")
        r, z, p, q = (x.CreateVector() for _ in range(4))
        r.data = self.onto * right
        limit = TOLERANCE * r.Norm()
        r.data = right - matrix * x
        r.data = self.onto * r
        old, count = 1.0, 0
        while r.Norm() > limit:
            z.data = self.factor * r
            new = InnerProduct(r, z)
            p.data = z + (new / old if count else 0.0) * p if count else z
            q.data = matrix * p
            part = new / InnerProduct(p, q)
            x.data += part * p
            r.data -= part * (self.onto * q)
            old, count = new, count + 1
        if count > MOST_ITERATIONS:
            self.factor = None


class OldTangent:
    """Newton's method with an old factor of the tangent, made again where a step gains too little, and in first frames.

    Args:
        form: the forces; space: of the unknowns; inverse: which factor.
    """

    def __init__(self, form, space, inverse):
        self.form, self.inverse, self.factor = form, inverse, None
        self.free = space.FreeDofs()
        self.onto = Projector(self.free, True)

    def __call__(self, x, load=None, limit=None, extra=None):
        """Bring x to a residual below the limit, that of the first residual where none is given; the limit.

        `extra` is a linear part: a matrix, and the vector that it acts on from.
        """
        residual, step, last, first = x.CreateVector(), x.CreateVector(), np.inf, limit is None
        for _ in range(60):
            self.form.Apply(x, residual)
            if load is not None:
                residual.data -= load
            if extra:
                step.data = x - extra[1]
                residual.data += extra[0] * step
            residual.data = self.onto * residual
            size = residual.Norm()
            limit = TOLERANCE * size if limit is None else limit
            if size <= limit:
                return limit
            if self.factor is None or size > 0.3 * last or first:
                self.form.AssembleLinearization(x)
                if extra:
                    self.form.mat.AsVector().data += extra[0].AsVector()
                self.factor = self.form.mat.Inverse(self.free, inverse=self.inverse)
            step.data = self.factor * residual
            x.data -= step
            last = size
        raise RuntimeError("Newton's method has not converged")


class Static(Kept):
    """Linear elasticity."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        space, self.a, self.f = forms.elasticity(self.mesh, parameters)
        self.u, self.solve = GridFunction(space), OldFactor(space)

    def frame(self, points):
        """(n, 2) [m] displacements."""
        self.move(points)
        self.a.Assemble()
        self.f.Assemble()
        self.look_ahead(self.u.vec)
        self.solve(self.a.mat, self.f.vec, self.u.vec)
        return forms.at_nodes(self.u, len(points))


class LargeDeformation(Kept):
    """St. Venant and Kirchhoff's law with weight and a pressure that follows the side."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        space, a, self.load, _ = forms.large_deformation(self.mesh, parameters)
        self.u, self.newton, self.limit = GridFunction(space), OldTangent(a, space, "umfpack"), None

    def frame(self, points):
        """(n, 2) [m] displacements."""
        self.move(points)
        self.load.Assemble()
        if self.limit is not None:
            self.look_ahead(self.u.vec)
        self.limit = self.newton(self.u.vec, self.load.vec, self.limit)
        return forms.at_nodes(self.u, len(points))


class Motion(documented.Motion):
    """Newmark's method of average acceleration; a step begins where the last accelerations lead."""

    newton, limit = None, None

    def solve(self):
        """The displacement after a step."""
        if self.newton is None:
            self.newton = OldTangent(self.form, self.space, "sparsecholesky")
        self.u.vec.data = self.old + 0.25 * self.given["time_step"] ** 2 * self.a
        if self.limit is None:
            self.limit = TOLERANCE * (self.newton.onto * self.load.vec).Evaluate().Norm()
        self.newton(self.u.vec, self.load.vec, self.limit, (self.scaled, self.old))


class Modes(Kept):
    """Free vibrations of a plate with shear: LOBPCG from the last frame's modes, with an old factor."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        self.space, self.k, self.m = forms.plate(self.mesh, parameters)
        self.modes = None

    def frame(self, points):
        """Frequencies [Hz] without the three motions of a rigid plate."""
        self.move(points)
        self.k.Assemble()
        self.m.Assemble()
        if self.factor is None:
            self.factor = forms.shifted(self.k, self.m, 1e6).Inverse(self.space.FreeDofs(), inverse="sparsecholesky")
        count, steps = self.given["modes"] + 3, 20 if self.modes is None else 3
        values, self.modes = solvers.LOBPCG(
            self.k.mat, self.m.mat, self.factor, count, maxit=steps, initial=self.modes, printrates=False
        )
        return np.sqrt(np.sort(values)[3:]) / (2 * np.pi)


class Heat(Kept):
    """Conduction in time by backward Euler."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        self.T, self.now = (GridFunction(H1(self.mesh, order=1)) for _ in range(2))
        self.a, self.f = forms.heat(self.mesh, parameters, self.T)
        self.solve, self.started = OldFactor(self.T.space), False

    def frame(self, points):
        """(n,) [K] temperatures: in the first frame those at time 0, then after a step each."""
        values = self.T.vec.FV().NumPy()
        if not self.started:
            values[:], self.started = self.given["initial"], True
            return values
        self.move(points)
        self.a.Assemble()
        self.f.Assemble()
        self.now.vec.data = self.T.vec
        self.look_ahead(self.now.vec)
        self.solve(self.a.mat, self.f.vec, self.now.vec)
        self.T.vec.data = self.now.vec
        return values


class Flow(Kept):
    """Steady flow by Taylor and Hood's elements, from the last frame's flow."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        space, a = forms.flow(self.mesh, parameters)
        self.x, self.newton, self.limit = GridFunction(space), OldTangent(a, space, "umfpack"), None
        inlet = self.mesh.Boundaries(forms.pieces(parameters["inlet"]))
        self.x.components[0].Set(ngsolve.CF((parameters["speed"], 0)), definedon=inlet)

    def frame(self, points):
        """(n, 2) [m/s] velocities."""
        self.move(points)
        if self.limit is not None:
            self.look_ahead(self.x.vec)
        self.limit = self.newton(self.x.vec, None, self.limit)
        return forms.at_nodes(self.x.components[0], len(points))


PROBLEMS = {
    "static": Static,
    "large_deformation": LargeDeformation,
    "motion": Motion,
    "modes": Modes,
    "heat": Heat,
    "flow": Flow,
}
