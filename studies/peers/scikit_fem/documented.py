"""The cases as scikit-fem's examples have them: mesh, basis and matrices of each frame are made from nothing.

Sources: examples 11 (linear elasticity), 36 (nonlinear elasticity), 19 (heat in time), 18 (Stokes), 27 (backward facing
step) of scikit-fem's documentation; systems are solved by `skfem.solve`, SciPy's SuperLU.
"""

import forms
import numpy as np
import skfem
from scipy.sparse import bmat
from scipy.sparse.linalg import eigsh
from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, FacetBasis, MeshTri, condense, solve

VERSION = f"scikit-fem {skfem.__version__}"
TOLERANCE = 1e-6
MOST = 60


def sides_of(mesh, facets):
    """Numbers of mesh sides by their ends (k, 2)."""
    count = mesh.p.shape[1]
    ends = np.sort(facets, axis=1)
    keys = mesh.facets.min(axis=0) * count + mesh.facets.max(axis=0)
    order = np.argsort(keys)
    return order[np.searchsorted(keys[order], ends[:, 0] * count + ends[:, 1])]


class FromNothing:
    """A problem whose mesh is made in each frame.

    Args:
        mesh: that is handed over; parameters: of the physics.
    """

    def __init__(self, mesh, parameters):
        self.mesh, self.given = mesh, parameters

    def made(self, points):
        """A mesh of scikit-fem."""
        return MeshTri(np.ascontiguousarray(points.T), np.ascontiguousarray(self.mesh.cells.T))

    def on(self, mesh, element, names):
        """The basis on pieces of the border."""
        facets = np.concatenate([self.mesh.facets[name] for name in names])
        return FacetBasis(mesh, element, facets=sides_of(mesh, facets))

    def fixed(self, basis, names):
        """Unknowns on pieces of the border."""
        return basis.nodal_dofs[:, self.mesh.nodes_on(*names)].ravel()


class Static(FromNothing):
    """Linear elasticity."""

    def frame(self, points):
        """(n, 2) [m] displacements."""
        mesh, element = self.made(points), ElementVector(ElementTriP1())
        basis, given = Basis(mesh, element), self.given
        K = forms.elasticity.assemble(basis, lam=given["lam"], mu=given["mu"])
        x, y = given["traction"]
        f = forms.force.assemble(self.on(mesh, element, given["pulled"]), x=x, y=y)
        u = solve(*condense(K, f, D=self.fixed(basis, given["fixed"])))
        return u[basis.nodal_dofs].T


class Elastic(FromNothing):
    """What large deformations and motions share."""

    def bases(self, points):
        """Bases of the body and of the side under pressure, with the dead load."""
        mesh, element = self.made(points), ElementVector(ElementTriP1())
        basis, given = Basis(mesh, element), self.given
        side = self.on(mesh, element, given["pressed"]) if given["pressed"] else None
        x, y = given["body_force"]
        return basis, side, forms.force.assemble(basis, x=x, y=y)

    def system(self, u, basis, side, load):
        """Forces out of balance, and their derivative."""
        law = {"lam": self.given["lam"], "mu": self.given["mu"]}
        state, p = basis.interpolate(u), self.given["pressure"]
        r = forms.inner_force.assemble(basis, u=state, **law) - load
        K = forms.tangent.assemble(basis, u=state, **law)
        if side is not None:
            r += forms.follower.assemble(side, u=side.interpolate(u), p=p)
            K = K + forms.follower_tangent.assemble(side, p=p)
        return r, K


class LargeDeformation(Elastic):
    """St. Venant and Kirchhoff's law: Newton's method from the undeformed state, with full steps."""

    def frame(self, points):
        """(n, 2) [m] displacements."""
        basis, side, load = self.bases(points)
        free = basis.complement_dofs(self.fixed(basis, self.given["fixed"]))
        u, first = basis.zeros(), None
        for _ in range(MOST):
            r, K = self.system(u, basis, side, load)
            size = np.linalg.norm(r[free])
            first = first or size
            if size <= TOLERANCE * first:
                return u[basis.nodal_dofs].T
            u += solve(*condense(K, -r, I=free))
        raise RuntimeError(f"Newton's method has not converged in {MOST} steps")


class Motion(Elastic):
    """Newmark's method of average acceleration, from rest; bases and mass are made once, as the shape stays."""

    def __init__(self, mesh, parameters):
        super().__init__(mesh, parameters)
        self.u = None

    def begin(self, points):
        """The state at time 0."""
        self.basis, self.side, self.load = self.bases(points)
        self.mass = forms.vector_mass.assemble(self.basis, rho=self.given["rho"])
        self.free = self.basis.complement_dofs(self.fixed(self.basis, self.given["fixed"]))
        self.u, self.v = self.basis.zeros(), self.basis.zeros()
        self.a = solve(*condense(self.mass, self.load, I=self.free))

    def frame(self, points):
        """(n, 2) [m] displacements: in the first frame those at time 0, then after a step each."""
        if self.u is None:
            self.begin(points)
        else:
            self.step()
        return self.u[self.basis.nodal_dofs].T

    def step(self):
        """A time step."""
        dt, free = self.given["time_step"], self.free
        old = self.u + dt * self.v + 0.25 * dt**2 * self.a
        u, first = self.u.copy(), None
        while True:
            r, K = self.system(u, self.basis, self.side, self.load)
            r += self.mass @ ((4 / dt**2) * (u - old))
            size = np.linalg.norm(r[free])
            first = first or size
            if size <= TOLERANCE * first:
                break
            u = u + solve(*condense(K + (4 / dt**2) * self.mass, -r, I=free))
        a = (4 / dt**2) * (u - old)
        self.v = self.v + 0.5 * dt * (self.a + a)
        self.u, self.a = u, a


class Modes(FromNothing):
    """Free vibrations of a plate with shear, of second order, by Lanczos's method about a negative shift."""

    def frame(self, points):
        """Frequencies [Hz] without the three motions of a rigid plate."""
        mesh, given = self.made(points), self.given
        basis = Basis(mesh, ElementTriP2() * ElementVector(ElementTriP2()), intorder=4)
        law = {"lam": given["lam"], "mu": given["mu"], "h": given["thickness"], "k": given["shear_factor"]}
        K = forms.plate_stiffness.assemble(basis, **law)
        M = forms.plate_mass.assemble(basis, rho=given["rho"], h=given["thickness"])
        count = given["modes"] + 3
        values = eigsh(K, count, M, sigma=-1e6, return_eigenvectors=False)
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
        mesh, element, given = self.made(points), ElementTriP1(), self.given
        basis, stored = Basis(mesh, element), given["capacity"] / given["time_step"]
        air, chip = (self.on(mesh, element, given[name]) for name in ("cooled", "heated"))
        A = forms.diffusion.assemble(basis, k=given["conductivity"]) + forms.mass.assemble(basis, c=stored)
        A = A + forms.mass.assemble(air, c=given["film"])
        f = forms.source.assemble(chip, q=given["flux"]) + forms.source.assemble(
            air, q=given["film"] * given["ambient"]
        )
        f += forms.stored.assemble(basis, old=basis.interpolate(self.T), c=stored)
        self.T = solve(A, f)
        return self.T


class Flow(FromNothing):
    """Steady flow by Taylor and Hood's elements and Newton's method, from the slow flow without convection."""

    def spaces(self, points):
        """Bases of velocity and pressure, the constrained unknowns, and their values."""
        mesh, given = self.made(points), self.given
        basis = {"u": Basis(mesh, ElementVector(ElementTriP2()), intorder=5)}
        basis["p"] = basis["u"].with_element(ElementTriP1())
        known = basis["u"].zeros()
        sides = {name: self.of_side(mesh, basis["u"], given[name]) for name in ("slip", "inlet", "walls")}
        known[sides["inlet"][0]] = given["speed"]
        fixed = np.unique(np.concatenate([sides["slip"][1], *sides["inlet"], *sides["walls"]]))
        return basis, fixed, known

    def of_side(self, mesh, basis, names):
        """Unknowns of each component on pieces of the border."""
        sides = sides_of(mesh, np.concatenate([self.mesh.facets[name] for name in names]))
        nodes = self.mesh.nodes_on(*names)
        return [np.concatenate([basis.nodal_dofs[k, nodes], basis.facet_dofs[k, sides]]) for k in range(2)]

    def frame(self, points):
        """(n, 2) [m/s] velocities."""
        basis, fixed, x = self.spaces(points)
        given, inner = self.given, basis["u"].N
        viscous = forms.viscosity.assemble(basis["u"], mu=given["viscosity"])
        B = forms.divergence.assemble(basis["u"], basis["p"])
        x = np.concatenate([x, basis["p"].zeros()])
        free = np.setdiff1d(np.arange(len(x)), fixed)
        first = None
        while True:
            state = basis["u"].interpolate(x[:inner])
            r = forms.convected.assemble(basis["u"], a=state, rho=given["rho"], mu=given["viscosity"])
            r = np.concatenate([r + B.T @ x[inner:], B @ x[:inner]])
            size = np.linalg.norm(r[free])
            first = first or size
            if size <= TOLERANCE * first:
                return x[basis["u"].nodal_dofs].T
            C = forms.convection.assemble(basis["u"], a=state, rho=given["rho"])
            K = bmat([[viscous + C, B.T], [B, None]], "csr")
            x[free] += solve(*condense(K, -r, I=free))[free]


PROBLEMS = {
    "static": Static,
    "large_deformation": LargeDeformation,
    "motion": Motion,
    "modes": Modes,
    "heat": Heat,
    "flow": Flow,
}
