"""Scenes of the validation cases, solved, and closed forms of beams and plates with shear."""

from collections.abc import Sequence

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.shear_waves import SHEAR, thick_wave

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.application import application
from restshape.interface.first_frame import first_frame

FOLDER = application("metallophone").folder
SCENES, EDITS = FOLDER / "scenes", FOLDER / "edits"


def solved(scene: str, comm: PETSc.Comm, overrides: Sequence[str] = ()) -> ModalAnalysis:
    """The modes of a scene's first shape."""
    return first_frame(SCENES / scene, overrides, comm).analysis


def timoshenko(k: int, length: float, height: float, E: float, nu: float, rho: float) -> float:
    """The k-th frequency [Hz] of a simply supported Timoshenko beam of unit width, shear factor 5/6."""
    shear, bending = SHEAR * E / (2 * (1 + nu)) * height, E * height**3 / 12
    return thick_wave(k * np.pi / length, shear, bending, rho * height, rho * height**3 / 12)
