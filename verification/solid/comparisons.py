"""Solids beside restshape's own values: buckling beside large deformation."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import OWN, Case, Check
from restshape_verification.solid.buckling import LOAD, SCENES

from restshape.errors import UserError
from restshape.interface.first_frame import first_frame

STRAIGHT = 5e-3
"""Sideways displacement, over the length, of a column that is not bent."""


def critical_load(comm: PETSc.Comm) -> list[Check]:
    """The load at which the tangent of the straight column of large deformation ceases to be positive definite."""
    critical = LOAD * float(first_frame(SCENES / "euler.toml", comm=comm).analysis.load_factors[0])
    text = (SCENES / "euler.toml").read_text()
    text = text.replace("[effects.buckling]\nmodes = 3", "[effects.large_deformation]").partition("[quantities]")[0]

    def stands(path: Path, force: float) -> bool:
        try:
            analysis = first_frame(
                path, [f"loads.head.force=[0,{-force}]", f"loads.foot.force=[0,{force}]"], comm
            ).analysis
        except UserError:
            return False
        # Rounding may lead to the bent column, which is stable where the straight one is not any more.
        return bool(np.abs(analysis.x[:, 0]).max() < STRAIGHT * np.ptp(analysis.space.X[:, 1]))

    low, high = 0.95 * critical, 1.05 * critical
    with TemporaryDirectory() as folder:
        path = Path(folder) / "large.toml"
        path.write_text(text)
        while high - low > 1e-4 * critical:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if stands(path, middle) else (low, middle)
    source = "where large deformation finds no straight, stable equilibrium any more"
    return [Check("critical load of a hinged column, h/L = 1/50 [N]", critical, 0.5 * (low + high), 2e-3, source, OWN)]


COMPARISONS: dict[str, Case] = {"critical_load": critical_load}
