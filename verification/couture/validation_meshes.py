"""Validation case of cloth on nested meshes: the rate at which errors fall."""

from collections.abc import Sequence
from itertools import islice

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, IDENTITY, Check
from restshape_verification.couture.validation_cantilever import bent, off, tip

from restshape.application import application
from restshape.interface.run import Run
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

FOLDER = application("couture").folder
SCENES, EDITS = FOLDER / "scenes", FOLDER / "edits"


def meshes(comm: PETSc.Comm) -> list[Check]:
    """Nested meshes where the equilibrium is unique: errors go with the square of the size."""
    errors = [
        off(tip(bent(1, [f'mesh.size="{size} mm"', f"mesh.levels={level}"], comm)), 1)
        for level, size in ((1, 3.125), (2, 1.5625))
    ]
    sags = [
        sag(nested, comm)
        for nested in ([f"mesh.size={0.04 / 2**level}", f"mesh.levels={level + 1}"] for level in range(3))
    ]
    return [
        Check("strip, Gamma = 1: slope of the tip's error", slope(errors), 2.0, 0.05, "second order", CLOSED_FORM),
        Check("chain, d/l = 0.9: slope of the sag", slope(np.diff(sags)), 2.0, 0.05, "second order", IDENTITY),
    ]


def sag(overrides: Sequence[str], comm: PETSc.Comm) -> float:
    """Of the chain at d/l = 0.9, where the script's fifth frame has it [m]."""
    scene = load_scene(SCENES / "catenary.toml", overrides)
    script = load_script(EDITS / "catenary.jsonl", scene)
    run = Run(Request.of(scene, script, "auto"), summed=False, comm=comm)
    return float(next(islice(run.rows(), 4, None))["q_sag"])


def slope(errors: Sequence[float]) -> float:
    """The power of the size that errors on a mesh and on one of half of its size go with."""
    return float(np.log2(errors[0] / errors[1]))
