"""Newton's method on small systems whose roots are known: where full steps fail, and what ends a run."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape.algebra.linear import LinearSolver
from restshape.algebra.nonlinear.newton import Newton
from restshape.algebra.nonlinear.newton_convergence import INDEFINITE, MOST_SEARCHED
from restshape.algebra.reuse.traits import Traits
from restshape.algebra.stages import Stages
from restshape.calibration import Calibration

COUPLED = np.array([[2.0, 1.0, 0.0], [0.5, 3.0, -1.0], [0.0, 1.0, 2.0]])
ROOT = np.array([1.0, -2.0, 0.5])


class System:
    """r(x) = 0 for x (n, 1), from functions of (n,) arrays; counts its evaluations."""

    def __init__(self, r, jacobian, energy=None):
        self.r, self.jacobian, self.of = r, jacobian, energy
        self.potential = energy is not None
        self.mat: PETSc.Mat | None = None
        self.tangents = self.residuals = self.version = 0

    def constrain(self, rows):
        pass

    def residual(self, x, out):
        self.residuals += 1
        with np.errstate(all="ignore"):
            out[:, 0] = self.r(x[:, 0])

    def assemble(self, x, out):
        self.tangents += 1
        with np.errstate(all="ignore"):
            if out is not None:
                out[:, 0] = self.r(x[:, 0])
            dense = np.atleast_2d(self.jacobian(x[:, 0]))
        n = len(dense)
        if self.mat is None:
            self.mat = PETSc.Mat().createAIJ([n, n], nnz=n, comm=PETSc.COMM_SELF)
        self.mat.setValues(range(n), range(n), dense)
        self.mat.assemble()
        return self.mat

    def energy(self, x):
        with np.errstate(all="ignore"):
            return float(self.of(x[:, 0]))


def newton_of(system, n, method="direct", tolerance=1e-10, traits=None):
    calibration = Calibration.load()
    linear = LinearSolver(
        PETSc.COMM_SELF,
        "newton_test_",
        method,
        tolerance,
        calibration,
        Stages(),
        traits=traits or Traits(system.potential),
    )
    newton = Newton(PETSc.COMM_SELF, "newton_test_", linear, (n, 1), slice(0, n))
    newton.set_equations(system)
    return newton


def run(system, start, goal=1e-10, scale=1.0, newton=None, **more):
    """Where a run from a start leads, and its outcome."""
    x = np.array(start, dtype=float).reshape(-1, 1)
    made = newton or newton_of(system, len(x))
    made.begin(newton is None, False, None)
    outcome = made.solve(x, goal, scale, **more)
    return x[:, 0], outcome


def arctangents(potential):
    """A gradient A^T arctan(A (x - root)), or a system arctan(A (x - root)) that is none."""
    A = COUPLED

    def slopes(x):
        return A / (1.0 + (A @ (x - ROOT)) ** 2)[:, None]

    def energy(x):
        z = A @ (x - ROOT)
        return np.sum(z * np.arctan(z) - 0.5 * np.log1p(z * z))

    if potential:
        return System(lambda x: A.T @ np.arctan(A @ (x - ROOT)), lambda x: A.T @ slopes(x), energy)
    return System(lambda x: np.arctan(A @ (x - ROOT)), slopes)


def exponential():
    """The gradient of exp(x) - x, which is least at 0."""
    return System(lambda x: np.exp(x) - 1.0, lambda x: np.diag(np.exp(x)), lambda x: np.sum(np.exp(x) - x))


@pytest.mark.parametrize("potential", [True, False])
def test_a_line_search_finds_what_full_steps_run_away_from(potential):
    # Full steps diverge from |A (x - root)| > 1.3917 on.
    near = ROOT + np.linalg.solve(COUPLED, [0.5, -0.3, 0.4])
    far = ROOT + np.linalg.solve(COUPLED, [1.8, -1.6, 2.0])
    x, outcome = run(arctangents(potential), near)
    assert outcome.converged
    np.testing.assert_allclose(x, ROOT, atol=1e-9)
    _, outcome = run(arctangents(potential), far)
    assert not outcome.converged and outcome.why
    x, outcome = run(arctangents(potential), far, searched=True)
    assert outcome.converged
    np.testing.assert_allclose(x, ROOT, atol=1e-9)


def test_an_added_load_moves_the_root():
    system, wanted = arctangents(True), ROOT + np.linalg.solve(COUPLED, [0.2, 0.3, -0.1])
    offset = (COUPLED.T @ np.arctan([0.2, 0.3, -0.1]))[:, None]
    for searched in (False, True):
        x, outcome = run(system, ROOT, offset=offset, searched=searched)
        assert outcome.converged
        np.testing.assert_allclose(x, wanted, atol=1e-9)


def test_an_indefinite_tangent_is_refused_or_stiffened():
    # The energy (x^2 - 1)^2 / 4 has a hill at 0 and valleys at -1 and 1.
    system = System(lambda x: x**3 - x, lambda x: np.diag(3 * x * x - 1), lambda x: np.sum((x * x - 1) ** 2) / 4)
    start = [0.1, -0.2, 1.1]
    _, outcome = run(system, start)
    assert not outcome.converged and outcome.why == INDEFINITE
    x, outcome = run(system, start, searched=True)
    assert outcome.converged and not outcome.why
    np.testing.assert_allclose(x, [1.0, -1.0, 1.0], atol=1e-9)


@pytest.mark.parametrize("goal", [1e-3, 1e-12])
def test_growth_is_measured_against_the_load_and_not_against_the_goal(goal):
    # The first step from -s leads to exp(s) - 1 - s.
    _, outcome = run(exponential(), [-3.0], goal)
    assert not outcome.converged and "grows without bound" in outcome.why and outcome.newton == 1
    _, outcome = run(exponential(), [-3.0], goal, scale=1e6)
    assert not outcome.converged and "does not come to an end" in outcome.why
    x, outcome = run(exponential(), [-2.0], goal)
    assert outcome.converged and not outcome.monotone and abs(x[0]) <= 1.1 * goal


def test_a_residual_without_a_number_ends_the_run():
    _, outcome = run(exponential(), [-8.0])
    assert not outcome.converged and "no number" in outcome.why


def test_a_line_search_takes_as_many_steps_as_it_says():
    # Steps from far above are of length 1.
    x, outcome = run(exponential(), [MOST_SEARCHED - 4.0], searched=True)
    assert outcome.converged and outcome.newton > 50 and abs(x[0]) <= 1e-9
    _, outcome = run(exponential(), [MOST_SEARCHED + 10.0], searched=True)
    assert not outcome.converged and "does not come to an end" in outcome.why


class TestRounding:
    """The residual 1e8 (x^2 - 2) cannot be lowered below about 1e8 times the distance of numbers at 2."""

    STIFF = 1e8

    def squares(self):
        stiff = self.STIFF
        return System(
            lambda x: stiff * (x * x - 2.0),
            lambda x: np.diag(2 * stiff * x),
            lambda x: stiff * np.sum(x**3 / 3 - 2 * x),
        )

    def test_a_goal_below_rounding_is_not_met_but_the_root_is_found(self):
        x, outcome = run(self.squares(), [3.0], goal=1e-12, rounding=1e-13 * self.STIFF)
        assert outcome.converged and x[0] == pytest.approx(np.sqrt(2.0), rel=1e-15)
        # It is reported, so that nobody takes the goal for met.
        assert 1e-12 < outcome.norm == self.STIFF * abs(x[0] ** 2 - 2.0) < 1e-13 * self.STIFF * x[0]

    def test_without_the_rule_the_run_does_not_end(self):
        _, outcome = run(self.squares(), [3.0], goal=1e-12)
        assert not outcome.converged and "does not come to an end" in outcome.why

    def test_a_goal_within_reach_is_met(self):
        _, outcome = run(self.squares(), [3.0], goal=1e-4, rounding=1e-13 * self.STIFF)
        assert outcome.converged and outcome.norm <= 1e-4

    def test_steps_that_lower_the_residual_go_on(self):
        # Far below the level of rounding, but by half and more in each step.
        _, outcome = run(self.squares(), [3.0], goal=1e-6, rounding=1e3 * self.STIFF)
        assert outcome.converged and outcome.norm <= 1e-6


def cubes(b):
    """K x + x^3 / 10 = b with a spring between neighbours, whose tangent hardly changes near a solution."""
    K = np.diag([3.0, 3.0, 3.0]) - np.diag([1.0, 1.0], 1) - np.diag([1.0, 1.0], -1)
    return System(
        lambda x: K @ x + 0.1 * x**3 - b,
        lambda x: K + np.diag(0.3 * x * x),
        lambda x: 0.5 * x @ K @ x + np.sum(0.025 * x**4) - b @ x,
    ), K


@pytest.mark.parametrize("method", ["stale", "direct"])
def test_a_tangent_is_kept_for_a_last_small_step(method):
    counts = []
    goals = np.geomspace(1e-3, 1e-9, 25)
    newton = None
    for goal in goals:
        # The right side of which x is the answer; guesses come closer and closer, as in a drag that slows down.
        x = np.array([0.7, -0.4, 0.2])
        _, K = cubes(np.zeros(3))
        system, _ = cubes(K @ x + 0.1 * x**3)
        newton = newton or newton_of(system, 3, method, 1e-10)
        newton.set_equations(system)
        found, outcome = run(system, x + 0.1, goal, newton=newton)
        assert outcome.converged
        np.testing.assert_allclose(found, x, atol=2 * goal)
        counts.append((outcome.newton, system.tangents))
    kept = [steps - tangents for steps, tangents in counts]
    # One tangent a step at least where each is factored; fewer where a preconditioner and the tangent are kept.
    assert max(kept) == (1 if method == "stale" else 0), counts


class TestSaddle:
    """The nearest point to a given one on an ellipse, with its multiplier: a symmetric tangent that is indefinite."""

    AXES, TRAITS = np.array([4.0, 1.0]), Traits(definite=False, fields=1)

    def system(self, given):
        def residual(z):
            x, multiplier = z[:2], z[2]
            return np.append(x - given + multiplier * x / self.AXES, 0.5 * (np.sum(x * x / self.AXES) - 1.0))

        def tangent(z):
            stiffness = np.diag(1.0 + z[2] / self.AXES)
            row = (z[:2] / self.AXES)[None]
            return np.block([[stiffness, row.T], [row, np.zeros((1, 1))]])

        return System(residual, tangent)

    @staticmethod
    def nearest(given):
        """By the angle on the ellipse, by search."""
        angle = np.linspace(0, 2 * np.pi, 2_000_001)
        points = np.column_stack([2.0 * np.cos(angle), np.sin(angle)])
        return points[np.argmin(((points - given) ** 2).sum(axis=1))]

    @pytest.mark.parametrize("method", ["direct", "stale", "auto"])
    @pytest.mark.parametrize("searched", [False, True])
    def test_it_is_found(self, method, searched):
        given = np.array([2.5, 1.5])
        system = self.system(given)
        newton = newton_of(system, 3, method, traits=self.TRAITS)
        start = np.append(given / np.sqrt(np.sum(given**2 / self.AXES)), 0.0)
        z, outcome = run(system, start, newton=newton, searched=searched)
        assert outcome.converged and not outcome.why
        np.testing.assert_allclose(z[:2], self.nearest(given), atol=1e-5)
        values = np.linalg.eigvalsh(system.jacobian(z))
        assert values[0] < 0.0 < values[1]
        assert outcome.newton <= 8

    def test_a_singular_tangent_is_not_taken_for_an_unstable_equilibrium(self):
        # At the centre of the ellipse the constraint has no gradient.
        system = self.system(np.array([2.5, 1.5]))
        _, outcome = run(system, [0.0, 0.0, 0.0], newton=newton_of(system, 3, traits=self.TRAITS))
        assert not outcome.converged and outcome.why and outcome.why != INDEFINITE


@pytest.mark.parametrize("searched", [False, True])
def test_no_step_goes_farther_than_its_share(searched):
    seen = []
    system = System(lambda x: x - 1.0, lambda x: np.eye(len(x)), lambda x: 0.5 * ((x - 1.0) ** 2).sum())
    newton = newton_of(system, 2)

    def share(x, d):
        seen.append((x.copy(), d.copy()))
        return 0.5

    newton.step_share = share
    x, outcome = run(system, [0.0, 0.0], goal=0.2, newton=newton, searched=searched)
    # Each step halves the distance: from sqrt(2) to below 0.2 in three.
    assert outcome.newton == 3 and x == pytest.approx([0.875, 0.875])
    assert seen[0][1].ravel() == pytest.approx([1.0, 1.0]), "the step leads downwards, where SNES has its negative"
