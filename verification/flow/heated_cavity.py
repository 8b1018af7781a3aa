"""Validation case of a square vessel that is heated on the left and cooled on the right."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_studies.validation.case import IDENTITY, PUBLISHED, Check
from restshape_verification.flow.heated_scenes import BUOYANT, CAVITY, STEADY
from restshape_verification.flow.shown import shown

from restshape.fem.space import PlaneSpace
from restshape.mesh.transfer import Transfer

CHEBYSHEV = (
    "Chebyshev collocation of stream function and temperature, digits that 22 and 28 points share; G. de Vahl Davis, "
    "Int. J. Numer. Methods Fluids 3 (1983) 249, within 0.1 %"
)
LE_QUERE = "P. Le Quere, Computers and Fluids 20 (1991) 29"
VESSELS = {
    1e3: (0.03, 0.03, (1.117790, 3.64945, 3.69744), CHEBYSHEV),
    1e4: (0.025, 0.012, (2.244816, 16.18333, 19.62822), CHEBYSHEV),
    1e6: (0.02, 0.004, (8.82521, 64.83, 220.6), LE_QUERE),
}
"""By the Rayleigh number: mesh sizes inside and at walls [m]; Nusselt number, largest u and v of the middle lines."""
STRIP = 0.05
"""Half the width about the middle over which the heat that passes there is averaged [m]."""
NEUTRAL = 300.0
"""Mean of the temperatures of the walls [K], from which heat that is advected is counted."""


@each_week(VESSELS=dict(list(VESSELS.items())[:2]))
def heated_cavity(comm: PETSc.Comm) -> list[Check]:
    """A square vessel of air (Pr = 0.71) between a hot and a cold wall: Nusselt numbers and largest velocities."""
    checks, s = [], np.linspace(0.0, 1.0, 4001)
    middle = np.full_like(s, 0.5)
    for rayleigh, (size, near, (nusselt, fast_u, fast_v), source) in VESSELS.items():
        text = CAVITY.replace("Ra = 1e4", f"Ra = {rayleigh!r}") + STEADY + BUOYANT
        made = shown(f"{text}[mesh]\nsize = {size!r}\nnear = {{ outline = {near!r} }}\n", comm)
        space, x, hot = made.analysis.space, made.analysis.x, made.row["q_hot"]
        u = Transfer(space, np.column_stack([middle, s]))(x)[:, 0].max()
        v = Transfer(space, np.column_stack([s, middle]))(x)[:, 1].max()
        of = f"Ra = {rayleigh:g}"
        checks += [
            Check(f"Nusselt number, {of}", hot, nusselt, 0.005, source, PUBLISHED),
            Check(f"Nusselt number of the middle, {of}", passing(space, x, s), hot, 0.005, "heat is kept", IDENTITY),
            Check(f"largest u at x = 1/2, {of}", float(u), fast_u, 0.01, source, PUBLISHED),
            Check(f"largest v at y = 1/2, {of}", float(v), fast_v, 0.01, source, PUBLISHED),
        ]
    return checks


def passing(space: PlaneSpace, x: np.ndarray, y: np.ndarray) -> float:
    """The Nusselt number of the heat that passes the middle, at heights y (m,), of unknowns x (n, 4)."""
    places = np.linspace(0.5 - STRIP, 0.5 + STRIP, 11)
    planes = [Transfer(space, np.column_stack([np.full_like(y, at), y]))(x) for at in places]
    advected = np.mean([np.mean(plane[:, 0] * (plane[:, 3] - NEUTRAL)) for plane in planes])
    return float(advected + np.mean(planes[0][:, 3] - planes[-1][:, 3]) / (2.0 * STRIP))
