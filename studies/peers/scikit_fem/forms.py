"""Weak forms of the cases, as scikit-fem writes them."""

import numpy as np
from skfem import BilinearForm, LinearForm
from skfem.helpers import ddot, div, dot, eye, grad, mul, sym_grad, trace, transpose


@BilinearForm
def elasticity(u, v, w):
    """Linear elasticity."""
    return 2 * w["mu"] * ddot(sym_grad(u), sym_grad(v)) + w["lam"] * div(u) * div(v)


@LinearForm
def force(v, w):
    """A force of the volume, or of a side."""
    return w["x"] * v[0] + w["y"] * v[1]


def _stress(F, w):
    """Piola and Kirchhoff's second stress of St. Venant and Kirchhoff's law."""
    strain = 0.5 * (mul(transpose(F), F) - eye(1.0 + 0 * F[0, 0], 2))
    return w["lam"] * eye(trace(strain), 2) + 2 * w["mu"] * strain


def _deformation(w):
    gradient = grad(w["u"])
    return gradient + eye(1.0 + 0 * gradient[0, 0], 2)


@LinearForm
def inner_force(v, w):
    """Forces of a deformed body."""
    F = _deformation(w)
    return ddot(mul(F, _stress(F, w)), grad(v))


@BilinearForm
def tangent(u, v, w):
    """Their derivative."""
    F, more = _deformation(w), grad(u)
    strain = 0.5 * (mul(transpose(F), more) + mul(transpose(more), F))
    stress = w["lam"] * eye(trace(strain), 2) + 2 * w["mu"] * strain
    return ddot(mul(more, _stress(F, w)) + mul(F, stress), grad(v))


def _turned(G, n):
    """The cofactors of a matrix in the plane, times the normal."""
    return np.array([G[1, 1] * n[0] - G[1, 0] * n[1], G[0, 0] * n[1] - G[0, 1] * n[0]])


@LinearForm
def follower(v, w):
    """A pressure on the deformed side."""
    return w["p"] * dot(_turned(_deformation(w), w.n), v)


@BilinearForm
def follower_tangent(u, v, w):
    """Its derivative."""
    return w["p"] * dot(_turned(grad(u), w.n), v)


@BilinearForm
def vector_mass(u, v, w):
    """Inertia."""
    return w["rho"] * dot(u, v)


@BilinearForm
def plate_stiffness(w_, b, v, c, w):
    """Bending and shear of a plate: deflection and rotation of the normal."""
    bending = w["h"] ** 3 / 12 * (2 * w["mu"] * ddot(sym_grad(b), sym_grad(c)) + w["lam"] * div(b) * div(c))
    return bending + w["k"] * w["h"] * w["mu"] * dot(grad(w_) - b, grad(v) - c)


@BilinearForm
def plate_mass(w_, b, v, c, w):
    """Inertia of a plate."""
    return w["rho"] * (w["h"] * w_ * v + w["h"] ** 3 / 12 * dot(b, c))


@BilinearForm
def diffusion(u, v, w):
    """Conduction, or viscosity of one component."""
    return w["k"] * dot(grad(u), grad(v))


@BilinearForm
def mass(u, v, w):
    """Storage, or a film."""
    return w["c"] * u * v


@LinearForm
def source(v, w):
    """A flux."""
    return w["q"] * v


@LinearForm
def stored(v, w):
    """What a temperature has stored."""
    return w["c"] * w["old"] * v


@BilinearForm
def viscosity(u, v, w):
    """Viscosity of a fluid."""
    return w["mu"] * ddot(grad(u), grad(v))


@BilinearForm
def divergence(u, q, w):
    """Continuity."""
    return -div(u) * q


@BilinearForm
def convection(u, v, w):
    """The derivative of convection."""
    a = w["a"]
    return w["rho"] * dot(mul(grad(u), a) + mul(grad(a), u), v)


@LinearForm
def convected(v, w):
    """Convection, and viscous forces."""
    a = w["a"]
    return w["rho"] * dot(mul(grad(a), a), v) + w["mu"] * ddot(grad(a), grad(v))


@LinearForm
def pressed(v, w):
    """What a pressure does to a fluid."""
    return -w["pressure"] * div(v)


@LinearForm
def gained(q, w):
    """Volume that a flow gains."""
    return -div(w["a"]) * q
