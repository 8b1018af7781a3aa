"""Validation of furniture whose forces equilibrium alone does not report: least energy, and small compliances."""

import numpy as np
from petsc4py import PETSc
from restshape_apps.furniture.analysis.plank_equilibrium import PlankEquilibrium
from restshape_apps.furniture.physics.furniture import Compliance, Furniture
from restshape_apps.furniture.pieces import chair, shelf_1, stool_chair, table
from restshape_studies.validation.case import IDENTITY, PROGRAM, Check
from restshape_verification.furniture.least_energy import least_energy
from restshape_verification.furniture.validation_statics import in_equilibrium

STIFF = 1e-12
"""Compliance at which displacements change no arm."""


def indeterminate(comm: PETSc.Comm) -> list[Check]:
    """Forces in redundant pieces against those of the least complementary energy, by a dense linear system."""
    checks = []
    for piece in (table(), chair(), stool_chair(), shelf_1()):
        furniture = Furniture(piece, Compliance(STIFF, STIFF, STIFF))
        geometry = furniture.geometry()
        solver = PlankEquilibrium(furniture)
        forces = solver.solve(0, one_sided=False)
        solver.destroy()
        joints, contacts = least_energy(furniture)
        pairs = (
            (forces.contacts, contacts),
            (forces.tension, np.einsum("ka,ka->k", joints[:, :3], geometry.n)),
            (forces.bending, np.einsum("ka,ka->k", joints[:, 3:], geometry.y)),
        )
        worst = max(float(np.abs(a - b).max() / np.abs(joints).max()) for a, b in pairs)
        source = "min f.C f / 2 with A f = b: its linear system, dense"
        checks.append(Check(f"{piece.name}: largest error of a force, relative", worst, 0.0, 1e-8, source, PROGRAM))
    return checks


def compliance(comm: PETSc.Comm) -> list[Check]:
    """Forces in redundant pieces over four decades of compliance, at a fixed ratio of translation and rotation."""
    checks = []
    for piece in (table(), stool_chair(), shelf_1()):
        found = []
        for scale in 10.0 ** np.arange(-12, -7):
            forces = in_equilibrium(piece, Compliance(scale, 0.5 * scale, 2.0 * scale)).forces()
            found.append(np.concatenate([forces.bending, forces.tension]))
        change = max(float(np.abs(other - found[0]).max()) for other in found[1:]) / float(np.abs(found[0]).max())
        source = "rigid planks: forces hang on ratios of compliances alone"
        checks.append(
            Check(
                f"{piece.name}: change of forces from 1e-12 to 1e-8 m/N, relative", change, 0.0, 2e-5, source, IDENTITY
            )
        )
    return checks
