"""Meshes, spaces and weak forms of the cases, as DOLFINx and UFL write them."""

import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from ufl import div, dot, dx, grad, inner, sym

TRIANGLES = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.triangle, 1))


class Body:
    """A mesh of DOLFINx with the border's pieces by name.

    Args:
        handed: the mesh that is handed over; points: (n, 2) [m] places of its nodes.

    Attributes:
        domain: DOLFINx's mesh, whose nodes are in an order of its own; node: (n,) number of each of its nodes here.
    """

    def __init__(self, handed, points):
        self.handed = handed
        self.domain = mesh.create_mesh(MPI.COMM_SELF, handed.cells, points, TRIANGLES)
        self.node = np.array(self.domain.geometry.input_global_indices)
        topology = self.domain.topology
        topology.create_connectivity(1, 0)
        topology.create_connectivity(1, 2)
        self.corners = self.node[self.domain.geometry.dofmap.array.reshape(-1, 3)]
        by_vertex = np.empty(len(points), dtype=np.int64)
        by_vertex[topology.connectivity(2, 0).array] = self.corners.ravel()
        ends = np.sort(by_vertex[topology.connectivity(1, 0).array.reshape(-1, 2)], axis=1)
        self.keys = ends[:, 0] * len(points) + ends[:, 1]
        self.order = np.argsort(self.keys)

    def move(self, points):
        """Take other places (n, 2) [m]."""
        self.domain.geometry.x[:, :2] = points[self.node]

    def sides(self, names):
        """Numbers of the sides on pieces of the border, ascending."""
        ends = np.sort(np.concatenate([self.handed.facets[name] for name in names]), axis=1)
        keys = ends[:, 0] * len(self.node) + ends[:, 1]
        return np.sort(self.order[np.searchsorted(self.keys[self.order], keys)]).astype(np.int32)

    def on(self, *groups):
        """The measures of pieces of the border, a group of names each."""
        sides = [self.sides(names) for names in groups]
        marks = np.concatenate([np.full(len(one), k + 1, dtype=np.int32) for k, one in enumerate(sides)])
        order = np.argsort(np.concatenate(sides))
        tags = mesh.meshtags(self.domain, 1, np.concatenate(sides)[order], marks[order])
        measure = ufl.Measure("ds", domain=self.domain, subdomain_data=tags)
        return [measure(k + 1) for k in range(len(groups))]

    def places(self, space):
        """(n,) number of the (blocked) unknown at each node handed over."""
        found = np.empty(len(self.node), dtype=np.int64)
        listed = space.dofmap.list.array.reshape(len(self.corners), -1)
        found[self.corners] = listed[:, :3]
        return found

    def fixed(self, space, names, value):
        """A boundary condition on pieces of the border."""
        dofs = fem.locate_dofs_topological(space, 1, self.sides(names))
        return fem.dirichletbc(value, dofs, space)


def elasticity(body, given):
    """Space, stiffness, load and boundary condition of linear elasticity."""
    space = fem.VectorFunctionSpace(body.domain, ("Lagrange", 1))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    a = (2 * given["mu"] * inner(sym(grad(u)), sym(grad(v))) + given["lam"] * div(u) * div(v)) * dx
    load = dot(ufl.as_vector(given["traction"]), v) * body.on(given["pulled"])[0]
    return space, a, load, body.fixed(space, given["fixed"], np.zeros(2))


def large_deformation(body, given):
    """Displacement, forces and boundary condition of St. Venant and Kirchhoff's law; the side is pressed as it lies."""
    space = fem.VectorFunctionSpace(body.domain, ("Lagrange", 1))
    u, v = fem.Function(space), ufl.TestFunction(space)
    F = ufl.Identity(2) + grad(u)
    strain = 0.5 * (F.T * F - ufl.Identity(2))
    stress = given["lam"] * ufl.tr(strain) * ufl.Identity(2) + 2 * given["mu"] * strain
    forces = inner(F * stress, grad(v)) * dx - dot(ufl.as_vector(given["body_force"]), v) * dx
    if given["pressed"]:
        n = ufl.FacetNormal(body.domain)
        forces += given["pressure"] * dot(ufl.cofac(F) * n, v) * body.on(given["pressed"])[0]
    return u, forces, body.fixed(space, given["fixed"], np.zeros(2))


def plate(body, given):
    """Space, stiffness and mass of a plate with shear, of second order."""
    second = ufl.FiniteElement("Lagrange", ufl.triangle, 2), ufl.VectorElement("Lagrange", ufl.triangle, 2)
    space = fem.FunctionSpace(body.domain, ufl.MixedElement(*second))
    (w, b), (v, c) = ufl.TrialFunctions(space), ufl.TestFunctions(space)
    h, law = given["thickness"], (given["lam"], given["mu"])
    k = h**3 / 12 * (2 * law[1] * inner(sym(grad(b)), sym(grad(c))) + law[0] * div(b) * div(c)) * dx
    k += given["shear_factor"] * law[1] * h * dot(grad(w) - b, grad(v) - c) * dx
    return space, k, given["rho"] * (h * w * v + h**3 / 12 * dot(b, c)) * dx


def heat(body, given):
    """Last temperature, matrix and right-hand side of a step of backward Euler."""
    space = fem.FunctionSpace(body.domain, ("Lagrange", 1))
    u, v, old = ufl.TrialFunction(space), ufl.TestFunction(space), fem.Function(space)
    stored, (air, chip) = given["capacity"] / given["time_step"], body.on(given["cooled"], given["heated"])
    a = (given["conductivity"] * dot(grad(u), grad(v)) + stored * u * v) * dx + given["film"] * u * v * air
    load = stored * old * v * dx + given["flux"] * v * chip + given["film"] * given["ambient"] * v * air
    return old, a, load


def flow(body, given):
    """Velocity and pressure, forces and boundary conditions of steady flow by Taylor and Hood's elements."""
    parts = ufl.VectorElement("Lagrange", ufl.triangle, 2), ufl.FiniteElement("Lagrange", ufl.triangle, 1)
    space = fem.FunctionSpace(body.domain, ufl.MixedElement(*parts))
    x = fem.Function(space)
    (u, p), (v, q) = ufl.split(x), ufl.TestFunctions(space)
    forces = given["viscosity"] * inner(grad(u), grad(v)) * dx + given["rho"] * dot(grad(u) * u, v) * dx
    forces += -(p * div(v) + q * div(u)) * dx
    along, across = space.sub(0).sub(0), space.sub(0).sub(1)
    conditions = [
        body.fixed(across, given["slip"], 0.0),
        body.fixed(along, given["inlet"], given["speed"]),
        body.fixed(across, given["inlet"], 0.0),
        body.fixed(along, given["walls"], 0.0),
        body.fixed(across, given["walls"], 0.0),
    ]
    return x, forces, conditions
