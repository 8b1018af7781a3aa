"""Validation cases of second-order triangles: rates with straight and curved sides, Cook, LE1."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, PROGRAM, PUBLISHED, Check
from restshape_studies.validation.norms import errors

from restshape.application import application
from restshape.interface.first_frame import first_frame

SCENES = application("solid").folder / "scenes"
SIZES = (0.12, 0.06, 0.03)


def displacement(X: np.ndarray) -> np.ndarray:
    """The manufactured displacements (n, 2) [m] at places X (n, 2) [m]."""
    x, y = X.T
    return 1e-3 * np.column_stack([np.sin(np.pi * x) * np.sin(np.pi * y), x * y * (1 - x) * (1 - y)])


def gradient(X: np.ndarray) -> np.ndarray:
    """Their gradients (n, 2, 2), [i, j] = d u_i / d X_j."""
    x, y = X.T
    sx, cx, sy, cy = np.sin(np.pi * x), np.cos(np.pi * x), np.sin(np.pi * y), np.cos(np.pi * y)
    rows = [[np.pi * cx * sy, np.pi * sx * cy], [(1 - 2 * x) * y * (1 - y), x * (1 - x) * (1 - 2 * y)]]
    return 1e-3 * np.array(rows).transpose(2, 0, 1)


def rates(name: str, order: int, comm: PETSc.Comm) -> tuple[float, float]:
    """Slopes of the L2 and the H1 error over the size of triangles, in a scene of the manufactured solution."""
    found = []
    for size in SIZES:
        analysis = first_frame(SCENES / name, [f"mesh.size={size}", f"mesh.order={order}"], comm).analysis
        mesh = analysis.space
        found.append((np.sqrt(1.0 / len(mesh.cells)), *errors(mesh, analysis.x, displacement, gradient)))
    h, l2, h1 = np.log(np.array(found)).T
    return float((l2[-1] - l2[0]) / (h[-1] - h[0])), float((h1[-1] - h1[0]) / (h[-1] - h[0]))


def quadratic_rates(comm: PETSc.Comm) -> list[Check]:
    """Rates of convergence of second-order triangles on a square, and around a round hole with curved sides."""
    source, checks = "manufactured solution; rates of quadratic elements", []
    for name, sides in (("manufactured.toml", "straight"), ("manufactured_hole.toml", "curved")):
        l2, h1 = rates(name, 2, comm)
        checks.append(Check(f"L2 slope, {sides} sides", l2, 3.0, 0.05, source, CLOSED_FORM))
        checks.append(Check(f"H1 slope, {sides} sides", h1, 2.0, 0.05, source, CLOSED_FORM))
    return checks


def cook_quadratic(comm: PETSc.Comm) -> list[Check]:
    """Cook's membrane in plane stress, nu = 1/3, with second-order triangles."""
    row = first_frame(SCENES / "cook.toml", ["mesh.size=1"], comm).row
    source = "converged p-FEM, plane stress, E = 1, nu = 1/3"
    return [
        Check("v at (48, 52), the middle of the edge [m]", row["q_v_middle"], 23.96775, 0.005, source, PROGRAM),
        Check("v at (48, 60), the top corner [m]", row["q_v_corner"], 25.18941, 0.005, source, PROGRAM),
    ]


def le1(comm: PETSc.Comm) -> list[Check]:
    """NAFEMS LE1, the elliptic membrane: the stress at D on a coarse and on a converged mesh."""
    checks = []
    for size, near in ((0.2, 0.05), (0.1, 0.025), (0.05, 0.0125)):
        row = first_frame(SCENES / "le1.toml", [f"mesh.size={size}", f"mesh.near.D={near}"], comm).row
        what = f"stress yy at D, {row['unknowns']} unknowns [Pa]"
        checks.append(Check(what, row["q_stress_at_D"], 92.7e6, 0.005, "NAFEMS, 1990, LE1", PUBLISHED))
    source = "converged p-FEM of the same membrane"
    checks.append(
        Check("stress yy at D, the finest mesh [Pa]", row["q_stress_at_D"], 92.65818e6, 0.001, source, PROGRAM)
    )
    return checks
