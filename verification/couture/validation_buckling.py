"""Validation cases of cloth that turns over: a strip on edge under its own weight."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, Check

from restshape.application import application
from restshape.interface.first_frame import first_frame
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport

BLADE = application("couture").folder / "scenes" / "blade.toml"
D, NU, DENSITY, STRETCH = 1e-3, 0.3, 0.1, 1e4
"""Of blade.toml: bending stiffness [N m], mass by area [kg/m^2], tension by strain [N/m]."""

SLENDER = 12.8537633
"""q L^3/sqrt(EI GJ) at which a slender cantilever turns over, 6 times the lowest zero of the Bessel function J_-1/6."""
SOURCE = "q L^3/sqrt(EI GJ) = 12.8537633, Prandtl 1899"
CLOSE, MOST = 1e-4, 10
"""Change of the acceleration, over it, that ends the search for the critical one, and accelerations that are tried."""


def lightest(width: float) -> float:
    """The acceleration [m/s^2] at which a slender strip turns over.

    Its stiffness EI' in its own plane is finite: like that of bending by moments, its load is higher by a factor of
    1/sqrt((1 - EI/EI')(1 - GJ/EI')).
    """
    bending, twist = D * (1 - NU**2) * width, 2 * D * (1 - NU) * width
    upright = STRETCH * width**3 / 12
    load = SLENDER * np.sqrt(bending * twist / ((1 - bending / upright) * (1 - twist / upright)))
    return float(load / (DENSITY * width))


def of_width(width: float, g: float, across: int = 4) -> list[str]:
    """Overrides of the scene: a strip of this width, triangles across it, and an acceleration [m/s^2]."""
    return [
        f"shape.vertices.c=[1,{width}]",
        f"shape.vertices.d=[0,{width}]",
        f"mesh.size={width / across}",
        f"effects.gravity.g=[0,{-g},0]",
    ]


def critical(width: float, comm: PETSc.Comm, across: int = 4) -> float:
    """The acceleration [m/s^2] at which the lowest eigenvalue of the true tangent is zero, on the path in the plane."""
    guess = lightest(width)
    overrides = [*of_width(width, 0.5 * guess, across), "effects.drape.strategy=newton"]
    analysis = first_frame(BLADE, overrides, comm).analysis
    x = analysis.x.copy()
    loads = [0.9 * guess, 0.97 * guess]
    values = [lowest(analysis, g, x) for g in loads]
    while abs(loads[-1] / loads[-2] - 1) > CLOSE and len(loads) < MOST:
        slope = (values[-1] - values[-2]) / (loads[-1] - loads[-2])
        loads.append(loads[-1] - values[-1] / slope)
        values.append(lowest(analysis, loads[-1], x))
    return float(loads[-1])


def lowest(analysis: RelaxationAnalysis, g: float, x: np.ndarray) -> float:
    """The eigenvalue [1/s^2] nearest to zero of the true tangent in the mass, at the equilibrium in x (n, 3)."""
    from slepc4py import SLEPc

    sheet, rest = analysis.problem, analysis.state.solver
    sheet.g = np.array([0.0, -g, 0.0])
    sheet.update()
    rest.refine(x, ConvergenceReport())
    tangent = rest.equations.true_tangent(x, 0.0)
    masses = sheet.lumped.mass[:, None] * sheet.boundary.free
    weights = PETSc.Vec().createWithArray(masses.ravel(), comm=PETSc.COMM_SELF)
    mass = PETSc.Mat().createAIJ(tangent.getSizes(), nnz=1, comm=PETSc.COMM_SELF)
    mass.setDiagonal(weights)
    mass.assemble()
    eps = SLEPc.EPS().create(PETSc.COMM_SELF)
    eps.setOperators(tangent, mass)
    eps.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    eps.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
    eps.setTarget(0.0)
    eps.getST().setType(SLEPc.ST.Type.SINVERT)
    solver = eps.getST().getKSP()
    solver.setType("preonly")
    solver.getPC().setType("cholesky")
    eps.setDimensions(1)
    eps.solve()
    value = eps.getEigenvalue(0).real
    for part in (eps, mass, weights):
        part.destroy()
    return float(value)


def blade(_comm: PETSc.Comm) -> list[Check]:
    """The weight at which a strip on edge turns over, in the limit of a narrow one."""
    # Inertia is counted on one rank: each does the same.
    comm = PETSc.COMM_SELF
    widths = (0.04, 0.02)
    found = [critical(width, comm) for width in widths]
    ratios = [SLENDER * g / lightest(width) for g, width in zip(found, widths)]
    # A clamp keeps its end from contracting, over a length of the order of the width: some w/L.
    near = f"{SOURCE}; a clamp adds some w/L"
    return [
        Check("w/L = 1/25: critical q L^3/sqrt(EI GJ)", ratios[0], SLENDER, 0.04, near, CLOSED_FORM),
        Check("limit of two widths", 2 * ratios[1] - ratios[0], SLENDER, 0.002, SOURCE, CLOSED_FORM),
    ]
