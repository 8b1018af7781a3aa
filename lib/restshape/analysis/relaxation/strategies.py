"""Ways of cloth to rest, by name: the usual one, and those that it is compared with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from restshape.algebra.descent import MEMORY, Descent
from restshape.algebra.kinetic_damping import KineticDamping
from restshape.analysis.relaxation.equilibrium import DRAGGED, FALLS, Arrival, Rest
from restshape.errors import ReplayProblem

Way = Callable[[Rest, np.ndarray, int, Arrival], Arrival]
FREELY = 1e-6
"""Inertia [1/s^2] of plain and stabilised Newton's methods: enough for a factor where cloth lies loosely."""
ALPHA, BETA = 4.0, 1e-3
"""Rayleigh damping [1/s], [s]: about half of the critical one of a cloth that swings by half a metre."""
LONG = 150
"""Steps of conjugate gradients between which friction follows: they begin anew with each run."""
ROUNDS = 200
"""Runs of a method, between which friction follows, after which it is given up."""


def moved(rest: Rest, x: np.ndarray, most: int, arrival: Arrival, damping: str = "kinetic") -> Arrival:
    """Motion alone, with kinetic damping, until it rests."""
    if damping == "kinetic":
        return _in_rounds(rest, rest.moving, lambda: rest.moving.snes.getIterationNumber(), x, most, arrival)
    steps = replace(rest.motion, damping="rayleigh", alpha=ALPHA, beta=BETA)
    equations = rest.equations
    moving = KineticDamping(rest.comm, "drape_rayleigh_", equations, rest.sheet.mass, x.shape, equations.rows, steps)
    moving.on_step, moving.on_move = rest.moving.on_step, rest.moving.on_move
    try:
        return _in_rounds(rest, moving, lambda: moving.snes.getIterationNumber(), x, most, arrival)
    finally:
        moving.free()


def descended(rest: Rest, x: np.ndarray, most: int, arrival: Arrival, kind: str, stabilised: bool = True) -> Arrival:
    """One kind of SNES alone, until it rests."""
    equations = rest.equations
    equations.stabilised, equations.inertia = stabilised, FREELY
    descent = Descent(rest.comm, f"drape_{kind}_", equations, x.shape, equations.rows, kind, reach=rest.motion.reach)
    descent.on_step = rest.descent.on_step
    try:
        return _in_rounds(rest, descent, lambda: descent.steps, x, most, arrival)
    finally:
        equations.stabilised = True
        descent.destroy()


def _in_rounds(
    rest: Rest, method: KineticDamping | Descent, steps: Callable[[], int], x: np.ndarray, most: int, arrival: Arrival
) -> Arrival:
    """Runs of a method from x (n, 3), which is changed, with friction following in between, until all rests."""
    for _ in range(ROUNDS):
        arrival.dragged = rest.lag(x)
        arrival.residual = rest.residual(x)
        if arrival.residual <= rest.goal and arrival.dragged <= DRAGGED * rest.slip:
            arrival.at_rest, arrival.why = True, ""
            return arrival
        left = most - arrival.steps
        before = x.copy()
        try:
            if isinstance(method, Descent):
                # Without friction that follows cloth would slide off what it lies on.
                norm = method.run(x, rest.goal * rest.scale(x), min(left, MEMORY if method.kind.tangent else LONG))
            else:
                method.steps = replace(method.steps, most=left)
                norm = method.run(x, rest.goal * rest.scale(x))
                arrival.iterations += method.iterations
        except ReplayProblem as problem:
            arrival.why = str(problem)
            return arrival
        arrival.steps += steps()
        if not rest.sound(x):
            x[:], arrival.why = before, "it goes where positions, or their energy, are no numbers"
            return arrival
        arrival.residual = norm / rest.scale(x)
        if rest.sheet.falls(x):
            arrival.falls, arrival.why = True, FALLS
            return arrival
        if steps() == 0 or arrival.steps >= most:
            break
    arrival.why = f"{arrival.steps} steps are over" if arrival.steps >= most else "no step gets any further"
    return arrival


def settled(rest: Rest, x: np.ndarray, most: int, arrival: Arrival) -> Arrival:
    """Descent, then Newton's method."""
    return rest.settle(x, most, arrival)


WAYS: dict[str, Way] = {
    "auto": settled,
    "kinetic": moved,
    "rayleigh": lambda *a: moved(*a, damping="rayleigh"),
    "newton": lambda *a: descended(*a, kind="newton", stabilised=False),
    "stabilised": lambda *a: descended(*a, kind="newton"),
    "cg": lambda *a: descended(*a, kind="cg"),
}
"""By the name that a scene gives in ``effects.drape.way``."""
