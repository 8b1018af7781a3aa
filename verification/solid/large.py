"""Validation cases of large deformation: the law alone, its limit, a hanging strip, the elastica, a heavy beam."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, PUBLISHED, Check

from restshape.application import application
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame

SCENES = application("solid").folder / "scenes"
TOLERANCE = 1e-10
"""Of the solves of a uniform stretch, which every mesh has exactly."""
LIMIT = 1.0 / (3.0 * np.sqrt(3.0))
"""The largest pressure over E that St. Venant and Kirchhoff's law bears in one direction."""


def uniaxial(comm: PETSc.Comm) -> list[Check]:
    """Stretch and stress of a block under tension and pressure, and the pressure that has no equilibrium any more."""
    source = "P / E = l (l^2 - 1) / 2, St. Venant and Kirchhoff with free sides"
    stretches, stresses = [], []
    for stretch in (1.25, 1.1, 0.9, 0.8):
        load = stretch * (stretch**2 - 1) / 2
        row = first_frame(
            SCENES / "uniaxial.toml", [f"parameters.P={load!r}", f"solve.tolerance={TOLERANCE}"], comm
        ).row
        section = 1.0 - 0.3 * (stretch**2 - 1)
        stretches.append((1.0 + row["q_longer"]) / stretch - 1.0)
        stresses.append(row["q_stress"] * section / load - 1.0)
    # Each Newton iteration squares the error: single ones end far below the tolerance of the solve, by chance.
    checks = [
        Check("largest relative error of four stretches", np.abs(stretches).max(), 0.0, TOLERANCE, source, CLOSED_FORM),
        Check("the same of Cauchy's stress", np.abs(stresses).max(), 0.0, TOLERANCE, source, CLOSED_FORM),
    ]
    least, most = 0.85 * LIMIT, 1.2 * LIMIT
    while most - least > 1e-4 * LIMIT:
        middle = 0.5 * (least + most)
        least, most = (middle, most) if bears(middle, comm) else (least, middle)
    source = "1 / (3 sqrt 3), at l = 1/sqrt 3"
    return [*checks, Check("largest pressure over E that is borne", least, LIMIT, 2e-4, source, CLOSED_FORM)]


def bears(pressure: float, comm: PETSc.Comm) -> bool:
    """Whether an equilibrium is found under a pressure [over E] on a block that cannot swerve."""
    straight = ['supports.bottom.on="all"', "material.block.nu=0", f"parameters.P={-pressure!r}"]
    try:
        first_frame(SCENES / "uniaxial.toml", straight, comm)
    except UserError:
        return False
    return True


def strip(comm: PETSc.Comm) -> list[Check]:
    """How far the foot of a hanging strip sinks under its own weight."""
    source = "l (l^2 - 1) / 2 = (rho g / E)(L - X), integrated"
    table = {0.1: 0.045797685, 0.5: 0.182257884, 1.0: 0.305359307}
    rows = {w: first_frame(SCENES / "strip.toml", [f"effects.gravity.g=[0, {-1000 * w}]"], comm).row for w in table}
    return [
        Check(f"sinking at rho g L / E = {w:g} [L]", -rows[w]["q_foot"], wanted, 1e-7, source, CLOSED_FORM)
        for w, wanted in table.items()
    ]


def elastica(comm: PETSc.Comm) -> list[Check]:
    """A cantilever of 1:100 that a dead load bends far."""
    table = {1: (0.301721, 0.056433), 2: (0.493457, 0.160642), 4: (0.669964, 0.328941), 10: (0.810609, 0.554996)}
    checks = []
    for load, (down, back) in table.items():
        row = first_frame(SCENES / "elastica.toml", [f"parameters.load={load}"], comm).row
        for name, wanted in (("down", down), ("back", back)):
            what = f"tip {name} at P L^2 / (E I) = {load} [L]"
            checks.append(Check(what, -row[f"q_{name}"], wanted, 1e-3, "Mattiasson 1981", PUBLISHED))
    return checks


def csm1(comm: PETSc.Comm) -> list[Check]:
    """Turek and Hron's beam at rest under gravity, of second order."""
    row = first_frame(SCENES / "csm1.toml", ["mesh.size=0.005", "mesh.near.a=5e-4", "mesh.near.d=5e-4"], comm).row
    source = "Turek and Hron 2006, CSM1"
    return [
        Check("x of the tip [m]", row["q_x"], -7.187e-3, 1e-4, source, PUBLISHED),
        Check("y of the tip [m]", row["q_y"], -66.10e-3, 1e-4, source, PUBLISHED),
    ]
