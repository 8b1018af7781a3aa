"""Validation cases of temperatures that vortices and shears carry, on meshes that are dragged."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_studies.stability.scenery import across, drag
from restshape_studies.validation.case import CLOSED_FORM, Check
from restshape_verification.flow.heated_scenes import in_time, warm_everywhere
from restshape_verification.flow.shown import played
from restshape_verification.flow.validation_orders import VORTICES, vortices_at

from restshape.fem.elements import MASS
from restshape.fem.space import Space

DIFFUSIVITY = 0.1 / (1.2 * 1.5)
"""Of the fluid of `warm_everywhere` [m^2/s]."""
RATE = 2.0 * np.pi**2 * DIFFUSIVITY
"""Of the decay of temperatures in vortices 1 m wide [1/s]."""
WARM = VORTICES + "; a temperature that is one along stream lines is not advected, and decays by conduction alone"
END = 0.8
"""When temperatures are looked at [s]."""
WAYS = {"still": 0.0, "dragged": 0.1}
"""How far a body is dragged until then [m]."""
STEADY = "fields that are linear in space and do not change in time"
ROUNDED = 1e-9
"""Of temperatures of some kelvins; residuals are solved to 1e-11."""


def warm_motion(comm: PETSc.Comm) -> list[Check]:
    """A steady temperature across a shear stays exact while a body is dragged, through flips and new meshes."""
    path, checks = drag("window", (0.4, 0.5), across((0.4, 0.5), (0.75, 0.75), 30)), []
    for scheme, carry in (("bdf2", "ale"), ("backward_euler", "ale"), ("bdf2", "remap")):
        effects = in_time(0.05, scheme, heat="initial = 1").replace("steps = 1", f'carry = "{carry}"')
        error = max(played(warm_everywhere('["y", 0]', '"1 + 2*y"', effects), path, warm_shear, largest))
        checks.append(Check(f"largest error, {scheme}, {carry} [K]", error, 0.0, ROUNDED, STEADY, CLOSED_FORM))
    return checks


@each_week(WAYS={"dragged": WAYS["dragged"]})
def warm_vortices(comm: PETSc.Comm) -> list[Check]:
    """The order of a temperature in decaying vortices where time steps shrink with the mesh, still and dragged."""
    decay, checks = "exp(-0.05/1.2*2*pi^2*t)", []
    velocity = f'["-cos(pi*x)*sin(pi*y)*{decay}", "sin(pi*x)*cos(pi*y)*{decay}"]'
    warm = f'"2 + cos(pi*x)*cos(pi*y)*exp(-{DIFFUSIVITY!r}*2*pi^2*t)"'
    for name, way in WAYS.items():
        found = []
        for frames in (48, 96):
            path = across((0.4, 0.5), (0.4 + way, 0.5 + way / 2), frames)
            events = drag("window", (0.4, 0.5), path) if way else [{"do": "idle", "frames": frames}]
            text = warm_everywhere(velocity, warm, in_time(END / frames, heat="initial = 2"), 1e-9, 1.0 / frames)
            found.append(played(text, events, warm_eddies, in_the_mean)[-1])
        order = float(np.log2(found[0] / found[1]))
        checks.append(Check(f"order of the temperature, {name} mesh", order, 2.0, 0.1, WARM, CLOSED_FORM))
    return checks


def warm_shear(X: np.ndarray, time: float) -> np.ndarray:
    """Velocity, pressure and temperature (n, 4) of a shear (y, 0) at places (n, 2)."""
    y = X[:, 1]
    return np.column_stack([y, 0 * y, 0 * y, 1 + 2 * y])


def warm_eddies(X: np.ndarray, time: float) -> np.ndarray:
    """Velocity, pressure and temperature (n, 4) of decaying vortices at places (n, 2)."""
    # Those of `vortices_at` decay with a kinematic viscosity of 0.05 m^2/s, these with 0.05 / 1.2.
    flow = vortices_at(X, time / 1.2)
    return np.column_stack([flow, 2 + np.cos(np.pi * X).prod(axis=1) * np.exp(-RATE * time)])


def largest(space: Space, off: np.ndarray) -> float:
    """The largest error of the temperature among nodal errors (n, 4) [K]."""
    return float(np.abs(off[:, 3]).max())


def in_the_mean(space: Space, off: np.ndarray) -> float:
    """The L2 norm of nodal errors (n, 4) of the temperature [K m]."""
    both = np.column_stack([off[:, 3], np.zeros(len(off))])
    return float(np.sqrt(2.0 * MASS["tri3"].energy(space.X, both, space.cells, np.ones(1)).sum()))
