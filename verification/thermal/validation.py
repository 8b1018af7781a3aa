"""Validation cases of heat: a pipe in air, a cooling plate, heat that enters and leaves; in fluids."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, IDENTITY, ROUNDING, Case, Check
from restshape_verification.flow.gravity_waves import waves_in_space, waves_in_time
from restshape_verification.flow.heated_cavity import heated_cavity
from restshape_verification.flow.heated_orders import warm_motion, warm_vortices
from restshape_verification.flow.insulated_vessel import insulated
from restshape_verification.flow.validation_derivatives import heat_derivatives

from restshape.application import application
from restshape.interface.first_frame import first_frame

TOLERANCE = 1e-10
"""Of the solves."""
SCENES = application("thermal").folder / "scenes"


def pipe(comm: PETSc.Comm) -> list[Check]:
    """A pipe in air against the resistances of its wall and of the film in series."""
    flow = 2 * np.pi * 100 / (np.log(2) / 15 + 1 / (0.2 * 50))
    row = first_frame(SCENES / "pipe.toml", [f"solve.tolerance={TOLERANCE}"], comm).row
    skin = 300 + flow / (2 * np.pi * 0.2 * 50)
    source = "Incropera and DeWitt (2002), section 3.3"
    return [
        Check("temperature of the skin [K]", row["q_skin"], skin, 1e-5, source, CLOSED_FORM),
        Check("heat that enters by the bore [W]", -row["q_entering"], flow, 2e-5, source, CLOSED_FORM),
    ]


def balance(comm: PETSc.Comm) -> list[Check]:
    """The heat sink: what the chip gives off leaves to the air."""
    row = first_frame(SCENES / "fins.toml", [f"solve.tolerance={TOLERANCE}"], comm).row
    source = "3 kW/m^2 on 20 mm, for each metre"
    return [
        Check("heat of the chip [W]", -row["q_chip_heat"], 60.0, ROUNDING, source, IDENTITY),
        Check("heat to the air [W]", row["q_air_heat"], 60.0, TOLERANCE, source, IDENTITY),
    ]


CASES: dict[str, Case] = {
    "pipe": pipe,
    "balance": balance,
    "cavity": heated_cavity,
    "derivatives": heat_derivatives,
    "motion": warm_motion,
    "vortices": warm_vortices,
    "insulated": insulated,
    "waves_in_space": waves_in_space,
    "waves_in_time": waves_in_time,
}
