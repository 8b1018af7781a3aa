"""Validation cases of the orders of flow: Kovasznay's flow in space, decaying vortices in time, on meshes that move."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from petsc4py import PETSc
from restshape_studies.stability.scenery import across, drag
from restshape_studies.validation.case import CLOSED_FORM, Check
from restshape_verification.flow.scenes import everywhere, in_time, kovasznay
from restshape_verification.flow.shown import played, shown, swing

from restshape.analysis.analysis import Analysis
from restshape.fem.elements import MASS
from restshape.fem.space import Space

Field = Callable[[np.ndarray], np.ndarray]
KOVASZNAY = "L. I. G. Kovasznay, Proc. Camb. Phil. Soc. 44 (1948) 58"
VORTICES = "G. I. Taylor and A. E. Green, Proc. R. Soc. Lond. A 158 (1937) 499"
ORDERS = "E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I (1993), III.3; " + VORTICES
RATE = 0.1 * np.pi**2
"""Of the decay of vortices 1 m wide in a fluid of a kinematic viscosity of 0.05 m^2/s [1/s]."""
END = 1.6
"""When they are looked at [s]."""
LEAST = 1.0
"""Order of the pressure that is called for; what is better counts as much."""


def kovasznay_rates(comm: PETSc.Comm) -> list[Check]:
    """The orders of velocity and pressure behind a grid (Kovasznay), at Re = 40."""
    decay, found = float(20.0 - np.sqrt(400.0 + 4.0 * np.pi**2)), []
    for size in (0.05, 0.025, 0.0125):
        text = kovasznay(decay, 1 / 40) + f"[solve]\ntolerance = 1e-9\n[mesh]\nsize = {size!r}\n"
        analysis = shown(text, comm).analysis
        x, space = analysis.x.copy(), analysis.space
        x[:, 2] = analysis.problem.pressure(x)
        found.append((len(space.cells) ** -0.5, *norms(space, x - behind_a_grid(space.X, decay))))
    (coarse, *first), *_, (fine, *last) = np.log(np.array(found))
    velocity, pressure = (np.array(last) - np.array(first)) / (fine - coarse)
    return [
        Check("order of the velocity", float(velocity), 2.0, 0.05, KOVASZNAY, CLOSED_FORM),
        Check("order of the pressure, as far as 1", min(float(pressure), LEAST), LEAST, 0.0, KOVASZNAY, CLOSED_FORM),
    ]


def behind_a_grid(X: np.ndarray, decay: float) -> np.ndarray:
    """Kovasznay's velocity and pressure (n, 3), of mean 0 in the unit square, at places (n, 2)."""
    e, y = np.exp(decay * X[:, 0]), 2 * np.pi * X[:, 1]
    mean = -np.expm1(2 * decay) / (4 * decay)
    return np.column_stack([1 - e * np.cos(y), decay / (2 * np.pi) * e * np.sin(y), -e * e / 2 - mean])


def norms(space: Space, off: np.ndarray) -> tuple[float, float]:
    """The L2 norms of nodal errors (n, 3) of velocity [m^2/s] and of pressure [Pa m]."""
    mass = MASS["tri3"]
    parts = (off[:, :2], np.column_stack([off[:, 2], np.zeros(len(off))]))
    velocity, pressure = (
        np.sqrt(2.0 * mass.energy(space.X, np.ascontiguousarray(part), space.cells, np.ones(1)).sum()) for part in parts
    )
    return float(velocity), float(pressure)


def vortices_at(X: np.ndarray, time: float) -> np.ndarray:
    """Velocity and pressure (n, 3) of decaying vortices at places (n, 2), of a density of 1.2 kg/m^3."""
    (x, y), decay = np.pi * X.T, np.exp(-RATE * time)
    pressure = -0.3 * (np.cos(2 * x) + np.cos(2 * y)) * decay**2
    return np.column_stack([-np.cos(x) * np.sin(y) * decay, np.sin(x) * np.cos(y) * decay, pressure])


def _vortices(effects: str, size: float) -> str:
    """The scene of these vortices around a window, by their velocity at it and on all sides."""
    decay = "exp(-0.1*pi^2*t)"
    velocity = f'["-cos(pi*x)*sin(pi*y)*{decay}", "sin(pi*x)*cos(pi*y)*{decay}"]'
    return everywhere(velocity, effects, mu=0.06, tolerance=1e-10, size=size)


def vortices_in_space(comm: PETSc.Comm) -> list[Check]:
    """Decaying vortices: the order of the velocity where time steps shrink with the mesh, still and dragged."""
    checks = []
    for name, way in (("still", 0.0), ("dragged", 0.1)):
        found = []
        for frames in (24, 48, 96):
            path = across((0.4, 0.5), (0.4 + way, 0.5 + way / 2), frames)
            events = drag("window", (0.4, 0.5), path) if way else [{"do": "idle", "frames": frames}]
            text = _vortices(in_time(END / frames), 1.6 / frames)
            found.append(played(text, events, vortices_at, lambda space, off: norms(space, off)[0])[-1])
        order = np.log2(found[0] / found[-1]) / 2
        checks.append(Check(f"order of the velocity, {name} mesh", float(order), 2.0, 0.1, VORTICES, CLOSED_FORM))
    return checks


def vortices_in_time(comm: PETSc.Comm) -> list[Check]:
    """Decaying vortices: the order of the time steps on one mesh, that lies still or swings to and fro."""
    checks = []
    for scheme, order, fewest in (("bdf2", 2.0, 8), ("backward_euler", 1.0, 32)):
        for name, way in (("still", 0.0), ("moving", 0.05)):
            found = [_swung(comm, scheme, steps, way) for steps in (fewest, 2 * fewest, 4 * fewest)]
            first, second = (np.linalg.norm(after - before) for before, after in pairwise(found))
            what = f"order in time, {scheme}, {name} mesh"
            checks.append(Check(what, float(np.log2(first / second)), order, 0.1, ORDERS, CLOSED_FORM))
    return checks


def _swung(comm: PETSc.Comm, scheme: str, steps: int, way: float) -> np.ndarray:
    """The velocities (n, 2) after so many steps, in which nodes go to and fro by a way [m]."""
    analysis: Analysis = shown(_vortices(in_time(END / steps, scheme), 0.03), comm).analysis
    analysis.begin(vortices_at(analysis.space.X, 0.0))
    swing(analysis, steps, way)
    return analysis.x[:, :2].copy()
