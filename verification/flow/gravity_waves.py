"""Validation cases of buoyancy: waves in a fluid that is warmer above, which a stream carries, at an angle."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_studies.stability.scenery import across, drag
from restshape_studies.validation.case import CLOSED_FORM, Check
from restshape_verification.flow.heated_scenes import BUOYANT, in_time, warm_everywhere
from restshape_verification.flow.shown import played, shown, swing

from restshape.fem.elements import MASS
from restshape.fem.space import Space

UP, ACROSS, STREAM = np.array([-0.6, 0.8]), np.array([0.8, 0.6]), np.array([0.5, 0.3])
"""Directions against gravity and across it; the velocity of the stream [m/s]."""
PULL, STRATIFIED, NEUTRAL = 4.0, 2.0, 5.0
"""Gravity times expansion [m/(s^2 K)], what temperatures rise by [K/m], and that which lifts nothing [K]."""
WAVE = 1.5 * np.pi
"""Number of the waves [1/m]."""
DENSITY, VISCOSITY, DIFFUSIVITY = 1.2, 0.05 / 1.2, 0.1 / (1.2 * 1.5)
"""Of the fluid of `warm_everywhere` [kg/m^3], [m^2/s]."""
DECAY = 0.5 * (VISCOSITY + DIFFUSIVITY) * WAVE**2
SLOWER = 0.5 * (VISCOSITY - DIFFUSIVITY) * WAVE**2
FREQUENCY = float(np.sqrt(PULL * STRATIFIED - SLOWER**2))
"""Of the waves [1/s]: how fast they decay, half of what the two rates differ by, and in radians."""
END = 0.8
"""When they are looked at [s]."""
WAVES = "a plane wave in a fluid with a linear temperature: J. S. Turner, Buoyancy Effects in Fluids (1973), chapter 2"
WAYS = {"still": 0.0, "dragged": 0.1}
"""How far a body is dragged until then [m]."""
SIZES, STEPS = (48, 96), (32, 64, 128)
"""Time steps in all where they shrink with the mesh, and on one mesh."""


def waves_at(X: np.ndarray, time: float) -> np.ndarray:
    """Velocity, pressure less its mean, and temperature (n, 4) of the waves at places (n, 2).

    The velocity along `UP` and what the temperature differs by depend on the place across it alone, so that waves do
    not advect each other: u = c + e a cos(k s), T = T0 + G (h - c e t) + b cos(k s), s = n x - c n t and h = e x obey
    a' = -nu k^2 a + g beta b and b' = -alpha k^2 b - G a.
    """
    height = X @ UP - STREAM @ UP * time
    shape = np.cos(WAVE * (X @ ACROSS - STREAM @ ACROSS * time)) * np.exp(-DECAY * time)
    turn = FREQUENCY * time
    rising = shape * np.cos(turn)
    warmer = shape * (SLOWER * np.cos(turn) - FREQUENCY * np.sin(turn)) / PULL
    pressure = 0.5 * DENSITY * PULL * STRATIFIED * height**2
    velocity = STREAM + rising[:, None] * UP
    return np.column_stack([velocity, pressure - pressure.mean(), NEUTRAL + STRATIFIED * height + warmer])


def waving(time_step: float, size: float) -> str:
    """The scene of these waves around a window, by their velocity and temperature at it and on all sides."""
    (ex, ey), (nx, ny), (cx, cy) = UP.tolist(), ACROSS.tolist(), STREAM.tolist()
    phase = f"{WAVE!r}*({nx!r}*x + {ny!r}*y - {float(STREAM @ ACROSS)!r}*t)"
    shape, turn = f"cos({phase})*exp(-{DECAY!r}*t)", f"{FREQUENCY!r}*t"
    rising = f"{shape}*cos({turn})"
    warmer = f"{shape}*({SLOWER / PULL!r}*cos({turn}) - {FREQUENCY / PULL!r}*sin({turn}))"
    height = f"({ex!r}*x + {ey!r}*y - {float(STREAM @ UP)!r}*t)"
    velocity = f'["{cx!r} + {ex!r}*{rising}", "{cy!r} + {ey!r}*{rising}"]'
    temperature = f'"{NEUTRAL!r} + {STRATIFIED!r}*{height} + {warmer}"'
    effects = in_time(time_step) + BUOYANT.replace('[0, "-1 m/s^2"]', f"{(-PULL * UP).tolist()}")
    text = warm_everywhere(velocity, temperature, effects, 1e-10, size)
    return text.replace("heat_capacity", f"reference = {NEUTRAL!r}\nexpansion = 1\nheat_capacity")


@each_week(WAYS={"dragged": WAYS["dragged"]})
def waves_in_space(comm: PETSc.Comm) -> list[Check]:
    """Waves in a warm fluid: orders of velocity and temperature where time steps shrink with the mesh."""
    checks = []
    for name, way in WAYS.items():
        found = []
        for frames in SIZES:
            path = across((0.4, 0.5), (0.4 + way, 0.5 + way / 2), frames)
            events = drag("window", (0.4, 0.5), path) if way else [{"do": "idle", "frames": frames}]
            off = []
            played(waving(END / frames, 1.2 / frames), events, waves_at, _kept(off))
            found.append(off[-1])
        for what, order in zip(("velocity", "temperature"), np.log2(np.divide(*found))):
            checks.append(Check(f"order of the {what}, {name} mesh", float(order), 2.0, 0.1, WAVES, CLOSED_FORM))
    return checks


def waves_in_time(comm: PETSc.Comm) -> list[Check]:
    """Waves in a warm fluid: orders of velocity and temperature in time on one mesh, that lies still or swings."""
    checks = []
    for name, way in (("still", 0.0), ("swinging", 0.05)):
        found = [_swung(comm, steps, way) for steps in STEPS]
        norms = [np.linalg.norm(after - before, axis=0) for before, after in pairwise(found)]
        rates = np.log2([np.linalg.norm(norms[0][:2]) / np.linalg.norm(norms[1][:2]), norms[0][2] / norms[1][2]])
        for what, order in zip(("velocity", "temperature"), rates):
            checks.append(
                Check(f"order of the {what} in time, {name} mesh", float(order), 2.0, 0.1, WAVES, CLOSED_FORM)
            )
    return checks


def _swung(comm: PETSc.Comm, steps: int, way: float) -> np.ndarray:
    """Velocities and temperatures (n, 3) after so many steps, in which nodes go to and fro by a way [m]."""
    analysis = shown(waving(END / steps, 0.05), comm).analysis
    analysis.begin(waves_at(analysis.space.X, 0.0))
    swing(analysis, steps, way)
    return analysis.x[:, [0, 1, 3]].copy()


def _kept(found: list[tuple[float, float]]) -> Callable[[Space, np.ndarray], float]:
    """What adds the L2 norms of nodal errors (n, 4) of velocity [m^2/s] and temperature [K m] to a list."""

    def measure(space: Space, off: np.ndarray) -> float:
        warm = np.column_stack([off[:, 3], np.zeros(len(off))])
        parts = (np.ascontiguousarray(off[:, :2]), warm)
        norms = [float(np.sqrt(2.0 * MASS["tri3"].energy(space.X, p, space.cells, np.ones(1)).sum())) for p in parts]
        found.append((norms[0], norms[1]))
        return norms[0]

    return measure
