"""Derivatives of frequencies and modes: Taylor remainders against full solves, pairs, the outline, the material."""

import numpy as np
import pytest
from modal import SCENES, SMALL, solved

from restshape.algebra.eigenproblems.clusters import CLUSTER
from restshape.analysis.frame import Frame
from restshape.interface.first_frame import first_frame
from restshape.sensitivity.frequency_derivative import (
    clusters,
    design_products,
    frequency_derivatives,
    known_modes,
    material_derivatives,
    modal_derivative,
    nodal_gradient,
    parted,
    stands_alone,
)
from restshape.sensitivity.outline_density import outline_density, plane_gradient

NO_CELLS = np.empty(0, dtype=np.int32)


class Moved:
    """Full solves with the nodes of the plane mesh moved along a smooth direction."""

    def __init__(self, analysis):
        self.analysis, self.plane = analysis, analysis.space
        self.X = self.plane.X.copy()
        length = np.ptp(self.X[:, 0])
        x, y = self.X.T / length
        self.direction = length * np.column_stack([np.sin(2 * x + y), 0.3 * np.cos(3 * x) * y + 0.2 * x * y])
        self.direction[:, 1] *= np.ptp(self.X[:, 1]) / length

    def solve(self, h):
        """Values, modes and frequencies at X + h direction."""
        self.plane.X[...] = self.X + h * self.direction
        mesh = getattr(self.plane, "mesh", self.plane)
        if mesh is not self.plane:
            mesh.X[...] = self.plane.X[self.plane.corner_number]
        mesh.geometry += 1
        analysis = self.analysis
        analysis.solve(Frame(self.plane, NO_CELLS, None, analysis.state.scene, (None, (0.0, 0.0))))
        return analysis.state.modes.values.copy(), analysis.state.modes.vectors.copy(), analysis.frequencies.copy()


@pytest.mark.parametrize("model", SMALL)
def test_remainder_of_frequencies_is_of_second_order(model):
    analysis = solved(model)
    moved = Moved(analysis)
    rates = frequency_derivatives(analysis, analysis.state.body.motion(moved.direction[None])[0])
    f0, h = analysis.frequencies, 2e-3
    remainders = [np.abs(moved.solve(step)[2] - f0 - step * rates) for step in (h, h / 2)]
    assert np.all(remainders[0] > 1e-8 * f0), "nothing to compare with"
    assert np.log2(remainders[0] / remainders[1]) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("model", SMALL)
def test_remainder_of_modes_is_of_second_order(model):
    analysis = solved(model)
    moved = Moved(analysis)
    x, count = analysis.predictor.values().copy(), len(analysis.state.modes.values)
    motion = np.stack([moved.direction, np.zeros_like(moved.direction)])
    s = modal_derivative(analysis, motion, 1e-10)[0]
    wanted = analysis.state.modes.chosen.copy()
    remainders = []
    for h in (1e-3, 5e-4):
        analysis.predictor.set_values(x + h * s)
        predicted = analysis.state.modes.vectors
        modes = moved.solve(h)[1]
        remainders.append(np.linalg.norm(modes[wanted] - predicted[wanted], axis=1))
    change = np.linalg.norm(modes[wanted] - x[wanted, count:], axis=1)
    assert np.all(remainders[1] < 0.1 * change)
    assert np.log2(remainders[0] / remainders[1]) == pytest.approx(2.0, abs=0.25)


def test_predicted_pair_opens_as_the_full_solve_does():
    analysis = solved_square()
    f0 = analysis.frequencies[1:3]
    assert f0[1] - f0[0] < 1e-3 * f0[0]
    moved = Moved(analysis)
    moved.direction = np.column_stack([moved.X[:, 0], np.zeros(len(moved.X))])
    motion = np.stack([moved.direction, 0 * moved.direction])
    x = analysis.predictor.values().copy()
    s = modal_derivative(analysis, motion, 1e-9)[0]
    analysis.predictor.set_values(x + 0.01 * s)
    predicted = analysis.frequencies[1:3].copy()
    full = moved.solve(0.01)[2][1:3]
    opened = full[1] - full[0]
    assert opened > 5 * (f0[1] - f0[0])
    assert predicted == pytest.approx(full, abs=0.05 * opened)


def solved_square(*overrides):
    settings = ["mesh.size=0.8", "effects.modal.modes=3", "solve.tolerance=1e-9"]
    return first_frame(SCENES / "supported.toml", [*settings, *overrides]).analysis


class Stretched(Moved):
    """Full solves with the plate stretched along x."""

    def __init__(self, analysis):
        super().__init__(analysis)
        self.direction = np.column_stack([self.X[:, 0], np.zeros(len(self.X))])

    @property
    def rates(self):
        return frequency_derivatives(self.analysis, self.analysis.state.body.motion(self.direction[None])[0])


@pytest.mark.parametrize("length", [9.997, 9.998, 10.001, 10.003])
def test_close_frequencies_keep_their_own_rates(length):
    sides = [f"shape.vertices.{corner}=[{length}, {y}]" for corner, y in (("b", 0), ("c", 10))]
    moved = Stretched(solved_square("mesh.size=0.5", "solve.tolerance=1e-10", *sides))
    low, high = moved.analysis.state.modes.values[1:3]
    assert 1e-5 < high / low - 1.0 < 1e-3
    reported, h = moved.rates, 1e-5
    ahead, behind = (moved.solve(step)[2] for step in (h, -h))
    assert reported[1:3] == pytest.approx((ahead - behind)[1:3] / (2.0 * h), rel=1e-3)


def test_rates_of_eigenvalues_that_coincide_do_not_hang_on_the_basis():
    rates = np.array([[1.0, 2.0, 9.0], [2.0, 1.0, 9.0], [9.0, 9.0, 5.0]])
    assert parted(np.array([1.0, 1.0 + 1e-12, 1.1]), rates, 1e-9) == pytest.approx([-1.0, 3.0, 5.0])
    assert parted(np.array([1.0, 1.0001, 1.1]), rates, 1e-9) == pytest.approx([1.0, 1.0, 5.0])
    # What is solved for to 1e-2 only does not distinguish them.
    assert parted(np.array([1.0, 1.0001, 1.1]), rates, 1e-2) == pytest.approx([-1.0, 3.0, 5.0])


@pytest.mark.parametrize("size", [0.5, 0.33])
def test_a_pair_is_not_cut(size):
    """Modes 4 and 5 of a free square plate are one pair: with either asked for, both are solved for and predicted."""
    plates = []
    for modes in (4, 5):
        overrides = [f"effects.modal.modes={modes}", f"mesh.size={size}", "solve.tolerance=1e-9"]
        plates.append(Stretched(first_frame(SCENES / "square.toml", overrides).analysis))
    four, five = plates
    assert len(four.analysis.frequencies) == 4 and list(known_modes(four.analysis)) == [0, 1, 2, 3, 4]
    assert not stands_alone(four.analysis, 3) and stands_alone(four.analysis, 0)
    assert four.rates == pytest.approx(five.rates[:4], rel=1e-6)
    velocity = four.analysis.state.body.motion(four.direction[None])[0]
    together = [frequency_derivatives(plate.analysis, velocity, CLUSTER) for plate in plates]
    assert together[0] == pytest.approx(together[1][:4], rel=1e-6)
    x, motion = four.analysis.predictor.values().copy(), np.stack([four.direction, 0 * four.direction])
    four.analysis.predictor.set_values(x + 0.005 * modal_derivative(four.analysis, motion, 1e-9)[0])
    predicted, before = four.analysis.frequencies[3], five.analysis.frequencies
    full = five.solve(0.005)[2]
    assert full[4] - full[3] > 10 * (before[4] - before[3])
    assert together[1][3:] == pytest.approx((full[3:] - before[3:].mean()) / 0.005, rel=0.03)
    assert predicted == pytest.approx(full[3], abs=0.02 * (full[4] - full[3]))


@pytest.mark.parametrize("model", ["tet4", "tet10", "plate"])
def test_rigid_motions_change_nothing(model):
    analysis = solved(model)
    X = analysis.space.X
    turn = np.column_stack([-X[:, 1], X[:, 0]])
    for motion in (np.ones_like(X), turn):
        rates = frequency_derivatives(analysis, analysis.state.body.motion(motion[None])[0])
        size = np.abs(motion).max() / np.ptp(X[:, 0])
        assert np.all(np.abs(rates) < 1e-7 * size * analysis.frequencies)


@pytest.mark.parametrize("model", SMALL)
def test_nodal_gradient_is_what_all_directions_give(model):
    analysis = solved(model)
    mode = int(analysis.state.modes.chosen[0])
    gradient = nodal_gradient(analysis, mode)
    velocity = np.random.default_rng(0).standard_normal(gradient.shape)
    phi = analysis.state.modes.vectors[mode : mode + 1]
    stiff, heavy = design_products(analysis, phi, velocity)
    expected = float(phi[0] @ (stiff[0] - analysis.state.modes.values[mode] * heavy[0]))
    assert float((gradient * velocity).sum()) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("model", ["plane", "tet4", "tet10", "plate"])
def test_gradient_of_the_corners_is_the_derivative_along_a_motion_of_them(model):
    analysis = solved(model)
    moved = Moved(analysis)
    plane = analysis.space
    mesh = getattr(plane, "mesh", plane)
    direction = moved.direction if mesh is plane else moved.direction[plane.corner_number]
    if mesh is not plane:
        moved.direction[plane.side_number] = direction[mesh.edge_nodes].mean(axis=1)
    rate = frequency_derivatives(analysis, analysis.state.body.motion(moved.direction[None])[0])[0]
    found = (plane_gradient(analysis, int(analysis.state.modes.chosen[0])) * direction).sum()
    assert float(found) == pytest.approx(float(rate), rel=1e-8)


def test_density_on_the_ends_of_a_bar_is_that_of_its_length():
    analysis = solved("plate", 'mesh.size="4 mm"')
    density = outline_density(analysis, int(analysis.state.modes.chosen[0]))
    f, length, width = analysis.frequencies[0], 0.1, 0.03
    X = (analysis.space.X)[density.nodes]
    right = np.isclose(X[:, 0], length)
    # f ~ 1/L^2 in bending: what moving the end along x does is the integral of its density.
    along = np.where(np.isclose(X[:, 1], 0.0) | np.isclose(X[:, 1], width), 0.5, 1.0)
    assert density.gradient[right, 0].sum() == pytest.approx(-2.0 * f / length, rel=0.03)
    inner = right & (along == 1.0)
    assert np.all(density.density[inner] < 0.0)
    assert density.normal[inner] == pytest.approx(np.tile([1.0, 0.0], (inner.sum(), 1)))


def test_material_derivatives_follow_full_solves():
    base = solved("tet4")
    found = material_derivatives(base, int(base.state.modes.chosen[0]))["aluminium"]
    for key, unit, value in (("E", "Pa", 70e9), ("rho", "kg/m^3", 2700.0)):
        ahead, behind = (
            solved("tet4", f'material.aluminium.{key}="{value * (1 + h):.9g} {unit}"').frequencies[0]
            for h in (1e-4, -1e-4)
        )
        assert found[key] == pytest.approx((ahead - behind) / (2e-4 * value), rel=1e-5)


def test_clusters_are_runs_of_close_values():
    groups = clusters(np.array([1.0, 1.0005, 2.0, 3.0, 3.001, 3.002]))
    assert [list(group) for group in groups] == [[0, 1], [2], [3, 4, 5]]
