"""Validation cases of conduction: a pipe in air, a cooling plate, heat that enters and leaves."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import Case, Check

from restshape.application import application
from restshape.replay.first_frame import first_frame

SCENES = application("thermal").folder / "scenes"


def pipe(comm: PETSc.Comm) -> list[Check]:
    """A pipe in air against the resistances of its wall and of the film in series."""
    flow = 2 * np.pi * 100 / (np.log(2) / 15 + 1 / (0.2 * 50))
    row = first_frame(SCENES / "pipe.toml", ["solve.tolerance=1e-10"], comm).row
    source = "Incropera and DeWitt (2002), section 3.3"
    return [
        Check("temperature of the skin [K]", row["q_skin"], 300 + flow / (2 * np.pi * 0.2 * 50), 1e-4, source),
        Check("heat that enters by the bore [W]", -row["q_entering"], flow, 1e-3, source),
    ]


def balance(comm: PETSc.Comm) -> list[Check]:
    """The heat sink: what the chip gives off leaves to the air."""
    row = first_frame(SCENES / "fins.toml", ["solve.tolerance=1e-10"], comm).row
    source = "3 kW/m^2 on 20 mm, for each metre"
    return [
        Check("heat of the chip [W]", -row["q_chip_heat"], 60.0, 1e-9, source),
        Check("heat to the air [W]", row["q_air_heat"], 60.0, 1e-6, source),
    ]


CASES: dict[str, Case] = {"pipe": pipe, "balance": balance}
