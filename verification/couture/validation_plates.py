"""Validation cases of cloth as a plate: squares under so small a load that they bend linearly."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, Check

from restshape.application import application
from restshape.interface.first_frame import first_frame

SCENES = application("couture").folder / "scenes"
LOAD = 0.25
"""q a^4/D of square_plate.toml [m]."""

SIDES = {
    "simply supported": ('["x","y","z"]', 0.00406235, 0.01),
    "clamped": ('["x","y","z","slope"]', 0.00126532, 0.05),
}
"""What is held along the sides, deflection of the middle over q a^4/D, tolerance on the second mesh."""


def plates(comm: PETSc.Comm) -> list[Check]:
    """The middle of square plates of Morley's triangles, and how fast it comes to the exact one on nested meshes."""
    source, checks = "Timoshenko and Woinowsky-Krieger", []
    for name, (fix, exact, tolerance) in SIDES.items():
        found = []
        for level in (1, 2):
            mesh = [f"mesh.size={0.1 / level}", f"mesh.levels={level}"]
            row = first_frame(SCENES / "square_plate.toml", [f"supports.sides.fix={fix}", *mesh], comm).row
            found.append(-row["q_middle"] / LOAD)
        slope = float(np.log2((found[0] - exact) / (found[1] - exact)))
        # What is left of an error that goes with the square of the size.
        limit = found[1] + (found[1] - found[0]) / 3.0
        checks += [
            Check(f"{name}, 20 triangles a side: w D/(q a^4)", found[1], exact, tolerance, source, CLOSED_FORM),
            Check(f"{name}, of two nested meshes extrapolated", limit, exact, 5e-3, source, CLOSED_FORM),
            Check(f"{name}: slope of the error", slope, 2.0, 0.05, "Morley's triangle: second order", CLOSED_FORM),
        ]
    return checks
