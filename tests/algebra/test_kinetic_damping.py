"""Kinetic damping on a chain of springs whose equilibrium and periods are known."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape.algebra.nonlinear.descent import Descent
from restshape.algebra.nonlinear.kinetic_damping import KineticDamping, Steps
from restshape.errors import ReplayProblem

N = 8


class Chain:
    """Masses in a row, held at the left, each pulled by 1 N to the right; springs of 100 N/m harden with stretch."""

    def __init__(self, hard: float = 0.0) -> None:
        self.hard, self.constrained = hard, np.array([0])
        self.matrix = PETSc.Mat().createAIJ((N, N), nnz=3, comm=PETSc.COMM_SELF)
        self.load = np.ones((N, 1))

    def stretches(self, x):
        return np.diff(x[:, 0])

    def energy(self, x):
        s = self.stretches(x)
        return float((50.0 * s**2 + 0.25 * self.hard * s**4).sum() - (self.load[1:] * x[1:]).sum())

    def residual(self, x, out):
        s = self.stretches(x)
        pull = 100.0 * s + self.hard * s**3
        out[:] = -self.load
        out[1:, 0] += pull
        out[:-1, 0] -= pull
        out[self.constrained] = 0.0

    def step_matrix(self, x, inertia, blocks, out=None):
        if out is not None:
            self.residual(x, out)
        k = 100.0 + 3.0 * self.hard * self.stretches(x) ** 2
        K = np.diag(np.r_[k, 0] + np.r_[0, k]) - np.diag(k, 1) - np.diag(k, -1)
        K += inertia * np.eye(N)
        K[0], K[:, 0], K[0, 0] = 0.0, 0.0, 1.0
        self.matrix.zeroEntries()
        self.matrix.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
        for i in range(N):
            near = range(max(0, i - 1), min(N, i + 2))
            self.matrix.setValues([i], list(near), K[i, list(near)])
        self.matrix.assemble()
        return self.matrix

    def tangent(self, x):
        return self.step_matrix(x, 0.0, False)

    def rest(self):
        """Places where each spring bears the masses on its right."""
        forces = np.arange(N - 1, 0, -1.0)
        if not self.hard:
            s = forces / 100.0
        else:
            s = np.array([np.roots([self.hard, 0.0, 100.0, -f])[-1].real for f in forces])
        return np.r_[0.0, np.cumsum(s)]


def damping(chain, **keys):
    steps = Steps(**({"most": 3000} | keys))
    return KineticDamping(PETSc.COMM_SELF, "chain_", chain, np.ones(N), (N, 1), slice(0, N), steps)


@pytest.mark.parametrize("hard", [0.0, 1e5])
@pytest.mark.parametrize("kind", [{}, {"longest": 1 / 60}, {"damping": "rayleigh", "alpha": 5.0, "longest": 1 / 60}])
def test_comes_to_the_equilibrium(hard, kind):
    chain, x = Chain(hard), np.zeros((N, 1))
    way = damping(chain, **kind)
    assert way.run(x, 1e-8) <= 1e-8
    np.testing.assert_allclose(x[:, 0], chain.rest(), rtol=1e-8)
    assert way.snes.getConvergedReason() > 0


def test_energies_at_resets_never_rise():
    chain, x = Chain(1e6), np.random.default_rng(1).uniform(-1, 1, (N, 1))
    x[0] = 0.0
    way = damping(chain, time_step=1.0, longest=5.0)
    start = chain.energy(x)
    way.run(x, 1e-9)
    assert way.rejected > 0
    assert len(way.resets) > 3
    assert np.all(np.diff([start, *way.resets]) <= 1e-12 * abs(start))


class Unloaded(Chain):
    """The chain without its load."""

    def __init__(self):
        super().__init__()
        self.load = np.zeros((N, 1))


def lowest_mode(h, **keys):
    """Angular frequency of the lowest mode, and its amplitude at each step of h from 1 without velocity."""
    chain, x, states = Unloaded(), np.zeros((N, 1)), []
    K = chain.step_matrix(x, 0.0, False)[:, :][1:, 1:]
    values, modes = np.linalg.eigh(K)
    x[1:, 0] = modes[:, 0]
    way = damping(chain, time_step=h, longest=h, tolerance=1e-14, **keys)
    way.on_step = lambda x, norm: states.append(modes[:, 0] @ x[1:, 0])
    way.run(x, 0.0)
    return np.sqrt(values[0]), np.array(states)


def test_velocities_are_lost_where_the_kinetic_energy_has_its_peak():
    """One mode passes its equilibrium after a quarter of the period, by two steps, and goes no farther."""
    h = 0.01
    w, states = lowest_mode(h, most=200)
    quarter = round(np.pi / 2 / (w * h))
    assert 10 < quarter < 100
    assert np.all(np.diff(states[:quarter]) < 0)
    assert np.abs(states[quarter + 2 :]).max() <= 3 * w * h


def test_fixed_steps_are_those_of_implicit_euler():
    """One mass on a spring: after k steps of h the amplitude of backward Euler, (1 + (w h)^2)^(-k/2)."""
    h = 0.01
    w, states = lowest_mode(h, damping="rayleigh", most=20)

    u, v, expected = 1.0, 0.0, []
    for _ in range(21):
        expected.append(u)
        v = (v - h * w**2 * u) / (1.0 + (w * h) ** 2)
        u = u + h * v
    np.testing.assert_allclose(states, expected, rtol=1e-10)


def test_no_step_goes_farther_than_the_reach():
    chain, x = Chain(), np.zeros((N, 1))
    places = []
    way = damping(chain, reach=0.02, longest=10.0)
    way.on_step = lambda x, norm: places.append(x.copy()) or False
    way.run(x, 1e-8)
    assert np.abs(np.diff(places, axis=0)).max() <= 0.02
    np.testing.assert_allclose(x[:, 0], chain.rest(), rtol=1e-7)


def test_an_energy_that_is_no_number_is_reported():
    class WithoutEnergy(Chain):
        def energy(self, x):
            return np.nan if x.any() else 0.0

    with pytest.raises(ReplayProblem, match="no time step is short enough"):
        damping(WithoutEnergy()).run(np.zeros((N, 1)), 1e-8)


@pytest.mark.parametrize("kind", ["quasi", "newton", "cg"])
def test_descents_find_the_equilibrium(kind):
    chain, x = Chain(1e5), np.zeros((N, 1))
    way = Descent(PETSc.COMM_SELF, "chain_", chain, (N, 1), slice(0, N), kind)
    assert way.run(x, 1e-6, 500) <= 1e-6
    np.testing.assert_allclose(x[:, 0], chain.rest(), atol=1e-7)


def test_a_descent_keeps_within_its_reach():
    chain, x = Chain(), np.zeros((N, 1))
    places = []
    way = Descent(PETSc.COMM_SELF, "chain_", chain, (N, 1), slice(0, N), "newton", reach=0.02)
    way.on_step = lambda x, norm: places.append(x.copy()) or False
    way.run(x, 1e-8, 200)
    assert np.abs(np.diff(places, axis=0)).max() <= 0.02 * (1 + 1e-12)


class Wall:
    """Nothing goes beyond a place, which is below where the chain rests."""

    place = 0.1

    def share(self, x, d):
        to = x + d
        over = to > self.place
        return float(max(1e-6, ((self.place - x[over]) / np.maximum(d[over], 1e-12)).min())) if over.any() else 1.0


@pytest.mark.parametrize("kind", ["quasi", "newton", "cg"])
def test_a_descent_goes_only_the_share_of_a_step_that_it_may(kind):
    chain, x = Chain(1e5), np.zeros((N, 1))
    way, places = Descent(PETSc.COMM_SELF, "chain_", chain, (N, 1), slice(0, N), kind), []
    assert chain.rest().max() > 0.15
    way.step_share = Wall().share
    way.on_step = lambda x, norm: places.append(x.copy()) or False
    for _ in range(5):
        way.run(x, 1e-6, 20)
    assert 0.09 < x.max() <= Wall.place * (1 + 1e-4) and np.max(places) <= Wall.place * (1 + 1e-4)


def test_a_motion_goes_only_the_share_of_a_step_that_it_may():
    chain, x, places = Chain(), np.zeros((N, 1)), []
    way = damping(chain, most=50)
    way.step_share = Wall().share
    way.on_step = lambda x, norm: places.append(x.copy()) or False
    way.run(x, 1e-8)
    assert 0.09 < np.max(places) <= Wall.place * (1 + 1e-4)
