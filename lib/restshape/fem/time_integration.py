"""Integration in time: schemes of first and second order, states of a motion, damping and base excitation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import NamedTuple, Protocol, TypedDict

import numpy as np

from restshape import _kernels
from restshape.fem.plain_steps import PlainSystem, newmark_steps, theta_steps


class TimeState(NamedTuple):
    """A motion, or a diffusion, at one time; its arrays are never changed in place.

    Args:
        y, v: (n, f) unknowns less the prescribed ones, and their rates [1/s].
        a: (n, f) rates of rates [1/s^2]; None where the scheme does without.
        time: [s].
    """

    y: np.ndarray
    v: np.ndarray
    a: np.ndarray | None
    time: float


class Scheme(Protocol):
    """One step of length dt: M a' + C v' + r(y') = 0 in second order, M v' + r(y') = 0 in first.

    The step from y to y' solves r(y') + a3 r(y) + (a0 M + a1 C) (y' - y) = M a2 v + C ((a4 - a3) v + a5 a), which
    the coefficients name. In first order M is the capacity and there is no C.

    Attributes:
        order: of the equation in time.
        dt: [s].
        error_factor: of dt^order times the change of the highest rate over a step: the local error; 0: it is of a
            higher rate, dt^2 / 12 times the change of the second one, which first order knows.
    """

    order: int
    dt: float

    @property
    def a0(self) -> float: ...
    @property
    def a1(self) -> float: ...
    @property
    def a2(self) -> float: ...
    @property
    def a3(self) -> float: ...
    @property
    def a4(self) -> float: ...
    @property
    def a5(self) -> float: ...
    @property
    def error_factor(self) -> float: ...
    def after(self, state: TimeState, y: np.ndarray) -> TimeState:
        """The state after a step from another to unknowns y (n, f)."""

    def plain_steps(
        self, system: PlainSystem, y: np.ndarray, v: np.ndarray, time: float, steps: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Unknowns and rates (k,) after steps from y, v (k,) at a time [s], by another formula: what verifies."""


@dataclass(frozen=True)
class Newmark:
    """One step u, v, a -> u', v', a' of Newmark's method.

    a' = a0 (u' - u) - a2 v - a3 a and v' = a1 (u' - u) - a4 v - a5 a, with M a' + C v' + K u' = f'.

    Args:
        beta, gamma: 1/4 and 1/2 are the average acceleration: unconditionally stable, no damping of its own.
        dt: step [s].

    Source: docs/theory/solids.md; N. M. Newmark, A method of computation for structural dynamics, 1959.
    """

    beta: float
    gamma: float
    dt: float
    order = 2

    @cached_property
    def a0(self) -> float:
        """1 / (beta dt^2) [1/s^2]."""
        return 1.0 / (self.beta * self.dt**2)

    @cached_property
    def a1(self) -> float:
        """gamma / (beta dt) [1/s]."""
        return self.gamma / (self.beta * self.dt)

    @cached_property
    def a2(self) -> float:
        """1 / (beta dt) [1/s]."""
        return 1.0 / (self.beta * self.dt)

    @cached_property
    def a3(self) -> float:
        """1 / (2 beta) - 1."""
        return 0.5 / self.beta - 1.0

    @cached_property
    def a4(self) -> float:
        """gamma / beta - 1."""
        return self.gamma / self.beta - 1.0

    @cached_property
    def a5(self) -> float:
        """dt (gamma / (2 beta) - 1) [s]: 0 for gamma = 2 beta, where the step needs M a alone, never a itself."""
        return self.dt * (0.5 * self.gamma - self.beta) / self.beta

    @property
    def error_factor(self) -> float:
        """beta - 1/6. Source: Zienkiewicz and Xie, Earthquake Engng Struct. Dyn. 20 (1991) 871."""
        return self.beta - 1.0 / 6.0

    def after(self, state: TimeState, y: np.ndarray) -> TimeState:
        """The state after a step from another to displacements y (n, f)."""
        v, a = _kernels.rates_after(y, state.y, state.v, self.a1, self.a4), None
        if state.a is not None:
            v -= self.a5 * state.a
            a = self.a0 * (y - state.y) - self.a2 * state.v - self.a3 * state.a
        return TimeState(y, v, a, state.time + self.dt)

    def plain_steps(
        self, system: PlainSystem, y: np.ndarray, v: np.ndarray, time: float, steps: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """See `Scheme`; with the accelerations as unknowns."""
        return newmark_steps(system, y, v, time, steps, self.dt, self.beta, self.gamma)


@dataclass(frozen=True)
class Theta:
    """One step of the theta method for M y' + r(y) = 0.

    Args:
        theta: 1 is the backward Euler method, 1/2 that of Crank and Nicolson; stable at any step from 1/2 on.
        dt: step [s].

    Source: Hairer and Wanner, Solving Ordinary Differential Equations II (1996), section IV.3.
    """

    theta: float
    dt: float
    order = 1
    a1 = a2 = a4 = a5 = 0.0

    @property
    def a0(self) -> float:
        """1 / (theta dt) [1/s]."""
        return 1.0 / (self.theta * self.dt)

    @property
    def a3(self) -> float:
        """1 / theta - 1."""
        return 1.0 / self.theta - 1.0

    @property
    def error_factor(self) -> float:
        """theta - 1/2; 0 for 1/2, whose error is that of a higher rate."""
        return self.theta - 0.5

    def after(self, state: TimeState, y: np.ndarray) -> TimeState:
        """The state after a step from another to unknowns y (n, f)."""
        return TimeState(y, (y - state.y) / self.dt, None, state.time + self.dt)

    def plain_steps(
        self, system: PlainSystem, y: np.ndarray, v: np.ndarray, time: float, steps: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """See `Scheme`; with the rates as unknowns."""
        return theta_steps(system, y, v, steps, self.dt, self.theta)


class DampingSettings(Protocol):
    """How a scene says how much damping there is.

    Attributes:
        ratio: of critical damping at the two `frequencies` [Hz]; None: `alpha` [1/s] and `beta` [s] say it.
    """

    ratio: float | None
    frequencies: Sequence[float] | None
    alpha: float | None
    beta: float | None


@dataclass(frozen=True)
class Rayleigh:
    """Damping C = alpha M + beta K: a mode of angular frequency w has the ratio alpha / (2 w) + beta w / 2.

    Args:
        alpha: [1/s].
        beta: [s].
    """

    alpha: float = 0.0
    beta: float = 0.0

    @classmethod
    def of(cls, settings: DampingSettings | None) -> Rayleigh:
        """The damping that ``[effects.damping]`` asks for; none when it is off (None)."""
        if settings is None:
            return cls()
        if settings.ratio is None:
            return cls(settings.alpha or 0.0, settings.beta or 0.0)
        first, second = (2 * pi * f for f in settings.frequencies or ())
        return cls(2 * settings.ratio * first * second / (first + second), 2 * settings.ratio / (first + second))


class Excitation(Protocol):
    """Motion of the base that unknowns are relative to.

    Attributes:
        direction: (f,) of length 1, along which it moves.
    """

    direction: np.ndarray

    def acceleration(self, t: float) -> np.ndarray:
        """The base's acceleration (f,) at the time t [s]."""


@dataclass(frozen=True, eq=False)
class TimeIntegration:
    """How a problem is integrated in time.

    Args:
        scheme: of a step.
        steps: of a frame.
        damping: of second order.
        excitation: of the base; None: it stands still.
    """

    scheme: Scheme
    steps: int
    damping: Rayleigh = Rayleigh()
    excitation: Excitation | None = None

    def base_acceleration(self, t: float, fields: int) -> np.ndarray:
        """The base's acceleration (f,) at the time t [s]."""
        return np.zeros(fields) if self.excitation is None else self.excitation.acceleration(t)

    def step_acceleration(self, t: float, fields: int) -> np.ndarray:
        """What a step from the time t [s] sees of the base's acceleration (f,): a' + a3 a."""
        if self.excitation is None:
            return np.zeros(fields)
        acceleration, scheme = self.excitation.acceleration, self.scheme
        return acceleration(t + scheme.dt) + scheme.a3 * acceleration(t)


class IntegrationChanges(TypedDict, total=False):
    """Changes of a `TimeIntegration`, each by the name of its argument."""

    scheme: Scheme
    steps: int
    damping: Rayleigh
    excitation: Excitation | None


@dataclass(frozen=True, eq=False)
class Motion:
    """What quantities of a motion see beside its unknowns.

    Args:
        v: (n, f) rates, relative to the base.
        edit: work of all edits so far [J].
        remesh: energy that new meshes have added to the motion so far [J].
        started: a step has been taken; before, rates are not known.
        modes: evaluates `eigenfrequencies`; None: no modes are computed.
        dynamic_forces: evaluates `inertia_and_damping`.
    """

    v: np.ndarray
    edit: float = 0.0
    remesh: float = 0.0
    dynamic_forces: Callable[[], np.ndarray] | None = None
    started: bool = True
    modes: Callable[[], np.ndarray] | None = None

    @cached_property
    def eigenfrequencies(self) -> np.ndarray:
        """Lowest eigenfrequencies (k,) of the present shape [Hz]; none where no modes are computed."""
        return np.empty(0) if self.modes is None else self.modes()

    @cached_property
    def inertia_and_damping(self) -> np.ndarray:
        """M (a + a_base) + C v (n, f) at all nodes, prescribed ones too; evaluated when a quantity first asks."""
        return np.zeros_like(self.v) if self.dynamic_forces is None else self.dynamic_forces()
