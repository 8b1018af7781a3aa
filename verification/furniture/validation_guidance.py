"""Validation of what guides a designer: derivatives, and the end of a valid range."""

import numpy as np
from petsc4py import PETSc
from restshape_apps.furniture.physics.derivatives import force_derivative
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.pieces import cantilever, shelf_1, table
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.shape.planks import FREEDOMS
from restshape_studies.validation.case import CLOSED_FORM, IDENTITY, Check
from restshape_verification.furniture.validation_statics import G, in_equilibrium

from restshape.guidance.ranges import valid_ranges

STEPS = np.array([4e-3, 2e-3, 1e-3])
ORDER = 5e-3
"""Tolerance of an order found from `STEPS`: the next term of the series is of the size of a step."""


def modes_of(furniture: Furniture) -> DesignModes:
    """The valid design modes of a model."""
    return DesignModes.of(furniture.piece, furniture.kernel.freedoms())


def taylor(comm: PETSc.Comm) -> list[Check]:
    """What the derivatives of forces leave over as a design step is halved."""
    checks = []
    for piece in (table(), table(push=30.0), shelf_1()):
        furniture = in_equilibrium(piece)
        modes, case = modes_of(furniture), len(furniture.cases) - 1
        weights = np.random.default_rng(7).normal(size=len(modes))
        weights /= np.linalg.norm(weights)
        change, base = force_derivative(furniture, modes.directions, case), furniture.forces(case)
        gamma = (weights @ modes.directions).reshape(-1, 8)
        for name in ("u", "tension", "bending", "shear"):
            rest, slope = [], np.tensordot(weights, getattr(change, name), axes=1)
            for step in STEPS:
                furniture.test(step * gamma)
                rest.append(
                    float(np.abs(getattr(furniture.forces(case), name) - getattr(base, name) - step * slope).max())
                )
            furniture.test()
            pushed = " pushed" if case else ""
            order = float(np.log2(rest[0] / rest[-1]) / (len(STEPS) - 1))
            what = f"{piece.name}{pushed}: order of the remainder of {name}"
            checks.append(Check(what, order, 2.0, ORDER, "Taylor", IDENTITY))
    return checks


def range_ends(comm: PETSc.Comm) -> list[Check]:
    """The end of a valid range by hand: how long a nail cantilever may be."""
    furniture = in_equilibrium(cantilever(kilograms=0.9))
    modes = modes_of(furniture)
    number = next(k for k, (p, f) in enumerate(modes.freedoms) if p == 2 and FREEDOMS[f] == "length x")
    ranges = valid_ranges(furniture.kernel, modes.direction(np.array([number]), np.array([1.0])), -0.3, 0.5)
    own, load, moment = 700.0 * 0.06 * 0.012 * G / 2, 0.9 * G, 5.2e3 * 0.02 * 3 * 0.006
    longest = (-load + np.sqrt(load**2 + 4 * own * moment)) / (2 * own)
    source = "W l + w l^2 / 2 = what its nails bear"
    by_hand = float(0.19 + ranges.intervals[-1, 1] * modes.unit)
    return [Check("longest arm of a nail cantilever [m]", by_hand, float(longest), 2e-6, source, CLOSED_FORM)]
