"""Validation cases of a closed insulated vessel whose lid is dragged: how much heat there is in it."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from petsc4py import PETSc
from restshape_studies.stability.scenery import across, drag, make_run, write_scene, write_script
from restshape_studies.validation.case import CLOSED_FORM, IDENTITY, Check
from restshape_verification.flow.heated_scenes import BUOYANT, HEAD, SQUARE, in_time

from restshape.fem.observer import area
from restshape.fem.space import PlaneSpace

DIFFUSIVITY, NEUTRAL = 0.02, 5.0
"""Of the fluid [m^2/s]; a temperature of it [K]."""
END, LOWERED = 1.0, 0.7
"""How long the lid goes down [s]; the height at which it is then, of 1 m at time 0."""
SIZES = (40, 80)
"""Time steps in all; the mesh shrinks with them."""
WAVE = "a wave along x, which lids at any height insulate: J. Fourier, Theorie analytique de la chaleur (1822)"
BALANCE = "O. Reynolds' transport theorem: heat changes by what the lid sweeps over, as no wall lets any through"


def vessel(time_step: float, size: float, buoyant: bool) -> str:
    """A closed vessel with insulated walls."""
    lift = BUOYANT.replace("-1 m", "-10 m") if buoyant else ""
    return (
        f"{HEAD}{SQUARE}[fluid]\nrho = 1\nmu = 0.02\nconductivity = {DIFFUSIVITY!r}\nheat_capacity = 1\nexpansion = 1\n"
        f"reference = {NEUTRAL!r}\n[boundary.walls]\non = 'outline'\nwall = true\ninsulated = true\n"
        f"[heat.lamp]\non = 'all'\nsource = 1\n{in_time(time_step)}{lift}"
        f"[solve]\ntolerance = 1e-9\n[mesh]\nsize = {size!r}\n"
    )


def insulated(comm: PETSc.Comm) -> list[Check]:
    """A closed insulated vessel that is squeezed: the heat in it at rest and with plumes, and its order."""
    heat, _, time = _played(SIZES[-1], buoyant=False)
    moved = [_played(steps, buoyant=True)[:2] for steps in SIZES]
    coarse, fine = (abs(heat - balance) for heat, balance in moved[-2:])
    exact = (NEUTRAL + time) * LOWERED
    return [
        Check("heat in a vessel at rest [J]", heat, exact, 1e-5, WAVE, CLOSED_FORM),
        Check("heat in a vessel with plumes [J]", *moved[-1], 2e-4, BALANCE, IDENTITY),
        Check("order of the heat in it", float(np.log2(coarse / fine)), 2.0, 0.1, BALANCE, IDENTITY),
    ]


def _played(steps: int, buoyant: bool) -> tuple[float, float, float]:
    """The heat in the vessel after so many steps of its lid, what it had and was given [J], and when [s]."""
    text = vessel(END / steps, 2.0 / steps, buoyant)
    events = drag("top", (0.5, 1.0), across((0.5, 1.0), (0.5, LOWERED), steps))
    with TemporaryDirectory() as folder:
        run = make_run(write_scene(Path(folder), text), write_script(Path(folder), events))
        made = run.replay
        balance, before = 0.0, None
        for _ in run.rows():
            space, analysis = made.analysis.space, made.analysis
            if before is None:
                analysis.begin(_warm(space.X))
                balance = _heat(space, analysis.x[:, 3])
            else:
                balance += _swept(space, before, analysis.x[:, 3]) + 0.5 * (before[2] + area(space)) * END / steps
            before = space.X.copy(), analysis.x[:, 3].copy(), area(space)
        return _heat(space, analysis.x[:, 3]), balance, analysis.time


def _warm(X: np.ndarray) -> np.ndarray:
    """Unknowns (n, 4) of a fluid at rest at places (n, 2), warm on the left."""
    return np.column_stack([np.zeros((len(X), 3)), NEUTRAL + np.cos(np.pi * X[:, 0])])


def _heat(space: PlaneSpace, warm: np.ndarray) -> float:
    """The heat [J] of temperatures (n,) of all nodes."""
    (ax, ay), (bx, by), (cx, cy) = (space.X[nodes].T for nodes in space.cells.T)
    areas = 0.5 * ((bx - ax) * (cy - ay) - (cx - ax) * (by - ay))
    return float(areas @ warm[space.cells].mean(axis=1))


def _swept(space: PlaneSpace, before: tuple[np.ndarray, np.ndarray, float], warm: np.ndarray) -> float:
    """The heat [J] that the border sweeps over from places and temperatures before to those now, linear in between."""
    X, was, _ = before
    a, b = space.facets.T
    step = space.X - X
    heat = 0.0
    for at, of in ((X, was), (space.X, warm)):
        along = at[b] - at[a]
        for i, j in ((a, b), (b, a)):
            out = step[i, 0] * along[:, 1] - step[i, 1] * along[:, 0]
            heat += 0.5 * float(out @ (2.0 * of[i] + of[j])) / 6.0
    return heat
