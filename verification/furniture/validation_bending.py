"""Validation of furniture against beams in closed form: how far planks deflect, and where a floor lets go of them."""

import numpy as np
from petsc4py import PETSc
from restshape_apps.furniture.physics.plank_bending import plank_bending
from restshape_apps.furniture.pieces import cantilever
from restshape_apps.furniture.small_pieces import bench, nailed_along, placed
from restshape_studies.validation.case import CLOSED_FORM, Check
from restshape_verification.furniture.validation_statics import FINE, G, in_equilibrium

MDF, PINE = (2.5e9, 700.0), (11e9, 420.0)
"""E [Pa] and density [kg/m^3] of planks here, as EN 622-5 and EN 338 have them."""


def max_deflection(comm: PETSc.Comm) -> list[Check]:
    """A cantilever, a board on two supports, one on the floor, and a shelf that is nailed along its long side."""
    arm, load = 0.4, 0.3 * G
    stiff, own = MDF[0] * 0.06 * 0.012**3 / 12, MDF[1] * 0.06 * 0.012 * G
    hung = plank_bending(in_equilibrium(cantilever(arm=arm, kilograms=0.3)), 2)
    checks = [
        Check(
            "sag of a cantilever [m]",
            hung.max_deflection,
            load * arm**3 / (3 * stiff) + own * arm**4 / (8 * stiff),
            1e-5,
            "P l^3 / 3EI + w l^4 / 8EI",
            CLOSED_FORM,
        )
    ]
    stiff, own, over, load = PINE[0] * 0.3 * 0.02**3 / 12, PINE[1] * 0.3 * 0.02 * G, 0.1, 20.0 * G
    found = plank_bending(in_equilibrium(bench(0.0, mu=0.0), FINE), 0)
    middle = 5 * own / 384 + load / 48 - own * over**2 / 16
    checks.append(
        Check(
            "sag between two supports, with overhangs [m]",
            -float(np.interp(0.0, found.along[0].s, found.along[0].deflection)),
            middle / stiff,
            1e-5,
            "5 w L^4 / 384EI + P L^3 / 48EI - w a^2 L^2 / 16EI",
            CLOSED_FORM,
        )
    )
    between = 30.0 * G * 1.2**3 / (48 * PINE[0] * 0.2 * 0.018**3 / 12)
    checks += [
        Check(
            f"sag of a board on the floor with a mass {place:g} m aside, over that on its ends",
            plank_bending(in_equilibrium(placed(place)), 0).max_deflection / between,
            0.0,
            1e-6,
            "a rigid floor bears what lies on it",
            CLOSED_FORM,
        )
        for place in (0.0, 0.3, 0.6)
    ]
    load, stiff, own, wide = 5.0 * G, MDF[0] * 0.012**3 / 12, MDF[1] * 0.012 * G, 0.2
    borne = plank_bending(in_equilibrium(nailed_along(5.0)), 1)
    return [
        *checks,
        Check(
            "sag of a shelf nailed along its side [m]",
            borne.max_deflection,
            (load * wide**3 * 5 / 48 + own * wide**4 / 8) / stiff,
            1e-4,
            "5 P b^3 / 48EI + w b^4 / 8EI",
            CLOSED_FORM,
        ),
    ]


def lifted_foot(comm: PETSc.Comm) -> list[Check]:
    """The foot of a cantilever's post: it lifts behind, and lies on the floor from where loads have no moment on."""
    arm, kilograms, half, t = 0.19, 2.0, 0.3, 0.012
    furniture = in_equilibrium(cantilever(arm=arm, kilograms=kilograms, fastener="nail-thesis"))
    found = plank_bending(furniture, 1)
    stiff, own = MDF[0] * 0.2 * t**3 / 12, MDF[1] * 0.2 * t * G
    beam, post = MDF[1] * 0.06 * t * arm * G, own * float(furniture.piece.planks[0].size[0])
    down, couple = post + beam + kilograms * G, kilograms * G * (t / 2 + arm) + beam * (t / 2 + arm / 2)
    flat = max(np.roots([own / 2, down + own * half, own * half**2 / 2 - couple]))
    far = half + flat
    lift = couple * flat * (2 * far - flat) / 2 - down * flat**2 * (3 * far - flat) / 6 - own * far**4 / 8
    most = float(np.abs(found.along[0].moment).max())
    source = "a cantilever from where the moment of all loads behind is nothing"
    return [
        Check("how far it lifts [m]", found.max_deflection, float(lift / stiff), 2e-3, source, CLOSED_FORM),
        Check("largest moment [N m]", most, couple - own * half**2 / 2, 1e-6, "M - w b^2 / 2", CLOSED_FORM),
    ]
