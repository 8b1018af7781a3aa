"""Validation cases of cloth that hangs: a chain between two supports, strips under their own weight."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, Check
from scipy.optimize import brentq

from restshape.application import application
from restshape.interface.first_frame import first_frame
from restshape.interface.replays import replay_files

FOLDER = application("couture").folder
SCENES, EDITS = FOLDER / "scenes", FOLDER / "edits"
WEIGHT = 0.02 * 0.2e-3 * 500 * 9.81
"""Of the strip of catenary.toml, which is 1 m long [N]."""


def chain(distance: float) -> tuple[float, float]:
    """Sag, and tension at the supports over the weight, of a chain of length 1 between supports at a distance."""
    c = brentq(lambda c: 2 * c * np.sinh(distance / (2 * c)) - 1.0, 0.05, 50.0, xtol=1e-15)
    sag = c * (np.cosh(distance / (2 * c)) - 1.0)
    return float(sag), float(c + sag)


def catenary(comm: PETSc.Comm) -> list[Check]:
    """A strip without bending between two supports that come nearer: its sag, and the tension at its ends."""
    rows = replay_files(SCENES / "catenary.toml", EDITS / "catenary.jsonl", "auto")["rows"]
    # Frame 0 is the start and frame 1 idle; then 3, 4 and 10 frames lead to the three distances.
    checks = []
    for distance, row in zip((0.9, 0.8, 0.5), (rows[4], rows[8], rows[18])):
        sag, tension = chain(distance)
        at, source = f"d/l = {distance:g}", "catenary: 2 c sinh(d/2c) = l"
        pull = np.hypot(row["q_up"], row["q_along"]) / WEIGHT
        checks += [
            Check(f"{at}: sag [l]", -row["q_sag"], sag, 1e-3, source, CLOSED_FORM),
            Check(f"{at}: tension at the end [w l]", pull, tension, 1e-3, source, CLOSED_FORM),
        ]
    return checks


def stretched(weight: float) -> float:
    """How far the foot of a strip of length 1 sinks under rho g L/E: the integral of l - 1, l (l^2 - 1)/2 = W s."""
    s, weights = np.polynomial.legendre.leggauss(40)
    tension = weight * 0.5 * (s + 1.0)
    # The real root of l^3 - l = 2 t, from above, by Newton's method, which cannot fail on this convex function.
    stretch = 1.0 + tension
    for _ in range(40):
        stretch -= (stretch**3 - stretch - 2.0 * tension) / (3.0 * stretch**2 - 1.0)
    return float(0.5 * weights @ (stretch - 1.0))


def hanging(comm: PETSc.Comm) -> list[Check]:
    """How far the foot of a strip sinks that stretches under its own weight, by both laws of the membrane."""
    path, checks = SCENES / "hanging.toml", []
    for W in (0.1, 0.5, 1.0):
        row = first_frame(path, [f"effects.gravity.g=[0,{-10 * W},0]"], comm).row
        source = "F S = tension, S = E (l^2 - 1)/2, integrated"
        what = f"StVK, rho g L/E = {W:g}: sinking [L]"
        checks.append(Check(what, -row["q_foot"], stretched(W), 5e-5, source, CLOSED_FORM))
    row = first_frame(path, ["effects.cloth.membrane=corotated"], comm).row
    return [*checks, Check("Hooke, rho g L/E = 0.5: sinking [L]", -row["q_foot"], 0.25, 5e-6, "W L/2", CLOSED_FORM)]
