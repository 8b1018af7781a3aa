"""Validation cases of solids: patch test, manufactured solution, hole, membrane, cantilever, columns that buckle."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, PROGRAM, ROUNDING, Case, Check
from restshape_verification.solid.buckling import columns, elastic_columns, homogeneity, ring
from restshape_verification.solid.incompressible import incompressible
from restshape_verification.solid.large import csm1, elastica, strip, uniaxial
from restshape_verification.solid.prediction import slender
from restshape_verification.solid.second_order import (
    SCENES,
    cook_quadratic,
    le1,
    quadratic_rates,
    rates,
)

from restshape.interface.first_frame import first_frame


def patch(comm: PETSc.Comm) -> list[Check]:
    """A linear displacement on the boundary of a distorted mesh is met exactly inside."""
    replay = first_frame(SCENES / "patch.toml", comm=comm)
    X, p = replay.moving.mesh.X, replay.session.scene.parameters
    exact = np.column_stack([p["a"] * X[:, 0] + p["b"] * X[:, 1], p["c"] * X[:, 0] + p["d"] * X[:, 1]])
    difference = float(np.abs(replay.analysis.x - exact).max() / np.abs(exact).max())
    return [Check("largest nodal error, relative", difference, 0.0, ROUNDING, "exact for linear elements", CLOSED_FORM)]


def manufactured(comm: PETSc.Comm) -> list[Check]:
    """Rates of convergence to u = (sin pi x sin pi y, x y (1 - x)(1 - y)) / 1000 under its own body force."""
    l2, h1 = rates("manufactured.toml", 1, comm)
    source = "manufactured solution; rates of linear elements"
    return [
        Check("L2 slope", l2, 2.0, 0.05, source, CLOSED_FORM),
        Check("H1 slope", h1, 1.0, 0.05, source, CLOSED_FORM),
    ]


def kirsch(comm: PETSc.Comm) -> list[Check]:
    """Stress concentration at a round hole under tension, on a finite plate with the exact tractions."""
    replay = first_frame(SCENES / "kirsch.toml", comm=comm)
    far = replay.session.scene.parameters["S"]
    source = "Kirsch 1898: 3 and -1 times the stress at infinity"
    return [
        Check("stress xx at the hole's top [S]", replay.row["q_concentration"] / far, 3.0, 0.01, source, CLOSED_FORM),
        Check("stress yy at the hole's side [S]", replay.row["q_compression"] / far, -1.0, 0.01, source, CLOSED_FORM),
    ]


def cook(comm: PETSc.Comm) -> list[Check]:
    """Cook's membrane in plane stress, nu = 1/3."""
    row = first_frame(SCENES / "cook.toml", ["mesh.size=0.4", "mesh.order=1"], comm).row
    source = "converged p-FEM, plane stress, E = 1, nu = 1/3"
    return [
        Check("v at (48, 52), the middle of the edge [m]", row["q_v_middle"], 23.96775, 0.01, source, PROGRAM),
        Check("v at (48, 60), the top corner [m]", row["q_v_corner"], 25.18941, 0.01, source, PROGRAM),
    ]


def timoshenko(comm: PETSc.Comm) -> list[Check]:
    """A cantilever with parabolic end shear and the exact displacements at its root: the tip's deflection."""
    row = first_frame(SCENES / "timoshenko.toml", ["mesh.size=0.5"], comm).row
    source = "Timoshenko and Goodier, Theory of Elasticity"
    return [Check("|v| at the tip [m]", abs(row["q_tip"]), 0.0089, 1e-6, source, CLOSED_FORM)]


CASES: dict[str, Case] = {
    "patch": patch,
    "manufactured": manufactured,
    "kirsch": kirsch,
    "cook": cook,
    "incompressible": incompressible,
    "timoshenko": timoshenko,
    "slender": slender,
    "quadratic_rates": quadratic_rates,
    "cook_quadratic": cook_quadratic,
    "le1": le1,
    "uniaxial": uniaxial,
    "strip": strip,
    "elastica": elastica,
    "csm1": csm1,
    "columns": columns,
    "elastic_columns": elastic_columns,
    "ring": ring,
    "load_factors": homogeneity,
}
