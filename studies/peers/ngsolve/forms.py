"""Spaces and weak forms of the cases, as NGSolve writes them."""

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    Grad,
    Id,
    InnerProduct,
    LinearForm,
    Mesh,
    Sym,
    Trace,
    Variation,
    VectorH1,
    div,
    ds,
    dx,
    grad,
    specialcf,
)


def made(handed, points):
    """A mesh of NGSolve, and its places as an array (n, 3) that moves it."""
    mesh, places = NetgenMesh(dim=2), np.zeros((len(points), 3))
    places[:, :2] = points
    mesh.AddPoints(places)
    inside = mesh.AddRegion("body", dim=2)
    mesh.AddElements(dim=2, index=inside, data=handed.cells.astype(np.int32), base=0)
    for name, ends in handed.facets.items():
        mesh.AddElements(dim=1, index=mesh.AddRegion(name, dim=1), data=ends.astype(np.int32), base=0)
    return Mesh(mesh), mesh.Coordinates()


def pieces(names):
    """The border's pieces of these names."""
    return "|".join(name.replace(".", "[.]") for name in names)


def at_nodes(field, count):
    """(n, 2) values of a vector field at the mesh's nodes."""
    return np.column_stack([part.vec.FV().NumPy()[:count] for part in field.components])


def elasticity(mesh, given):
    """Space, stiffness and load of linear elasticity."""
    space = VectorH1(mesh, order=1, dirichlet=pieces(given["fixed"]))
    u, v = space.TnT()
    a, f = BilinearForm(space), LinearForm(space)
    a += (2 * given["mu"] * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) + given["lam"] * div(u) * div(v)) * dx
    f += CF(tuple(given["traction"])) * v * ds(pieces(given["pulled"]))
    return space, a, f


def large_deformation(mesh, given):
    """Space, forces and inertia of St. Venant and Kirchhoff's law with weight and a pressure that follows the side."""
    space = VectorH1(mesh, order=1, dirichlet=pieces(given["fixed"]))
    u, v = space.TnT()
    F = Id(2) + Grad(u)
    strain = 0.5 * (F.trans * F - Id(2))
    stored = 0.5 * given["lam"] * Trace(strain) ** 2 + given["mu"] * InnerProduct(strain, strain)
    a, load = BilinearForm(space), LinearForm(space)
    a += Variation(stored * dx)
    load += CF(tuple(given["body_force"])) * v * dx
    if given["pressed"]:
        n = specialcf.normal(2)
        along = CF((-n[1], n[0]))
        moved = along + Grad(u).Trace() * along
        a += given["pressure"] * CF((moved[1], -moved[0])) * v.Trace() * ds(pieces(given["pressed"]))
    mass = BilinearForm(space)
    mass += given.get("rho", 0.0) * u * v * dx
    return space, a, load, mass


def plate(mesh, given):
    """Space, stiffness and mass of a plate with shear, of second order."""
    space = H1(mesh, order=2) * VectorH1(mesh, order=2)
    (w, b), (v, c) = space.TnT()
    k, m, h = BilinearForm(space), BilinearForm(space), given["thickness"]
    k += h**3 / 12 * (2 * given["mu"] * InnerProduct(Sym(Grad(b)), Sym(Grad(c))) + given["lam"] * div(b) * div(c)) * dx
    k += given["shear_factor"] * given["mu"] * h * (grad(w) - b) * (grad(v) - c) * dx
    m += given["rho"] * (h * w * v + h**3 / 12 * b * c) * dx
    return space, k, m


def shifted(k, m, shift):
    """The matrix of `k` and so much of that of `m`, which has the same pattern."""
    found = k.mat.CreateMatrix()
    found.AsVector().data = k.mat.AsVector() + shift * m.mat.AsVector()
    return found


def heat(mesh, given, old):
    """Matrix and right-hand side of a step of backward Euler from a temperature."""
    space, stored = old.space, given["capacity"] / given["time_step"]
    u, v = space.TnT()
    a, f = BilinearForm(space), LinearForm(space)
    a += (given["conductivity"] * grad(u) * grad(v) + stored * u * v) * dx
    a += given["film"] * u * v * ds(pieces(given["cooled"]))
    f += stored * old * v * dx + given["flux"] * v * ds(pieces(given["heated"]))
    f += given["film"] * given["ambient"] * v * ds(pieces(given["cooled"]))
    return a, f


def flow(mesh, given):
    """Space and forces of steady flow by Taylor and Hood's elements."""
    walls = [*given["walls"], *given["inlet"]]
    across = pieces([*walls, *given["slip"]])
    V, Q = VectorH1(mesh, order=2, dirichletx=pieces(walls), dirichlety=across), H1(mesh, order=1)
    space = V * Q
    (u, p), (v, q) = space.TnT()
    a = BilinearForm(space)
    a += given["viscosity"] * InnerProduct(Grad(u), Grad(v)) * dx
    a += (given["rho"] * (Grad(u) * u) * v - p * div(v) - q * div(u)) * dx
    return space, a
