"""Plates against closed forms and converged values: static, free, supported, clamped, thick, thin, wooden, tapered."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.sparse.linalg import spsolve
from vibrating_bodies import disc, lowest, matrix, rectangle

from restshape import _kernels
from restshape.mesh.plate import PlateMesh
from restshape.physics.elasticity.stiffness import (
    FREE_SIDES,
    isotropic,
    orthotropic,
    plane_stress,
    plate_params,
    turned,
)
from restshape.scene.expressions import Expression

NU = 0.3
UNIT = isotropic(12 * (1 - NU**2), NU)
"""Stiffness with which a plate of thickness h has D = h^3 [N m]."""

ROSEWOOD_LIKE = orthotropic((13e9, 2.2e9, 1.1e9), (0.36, 0.43, 0.6), (1.1e9, 0.9e9, 0.3e9))
FREE_SQUARE = [13.4682, 19.5961, 24.2702, 34.8009, 34.8009, 61.0932, 61.0932, 63.6861]


class Plate:
    """A plate with its matrices.

    Args:
        mesh: its triangles; thickness: number or formula [m]; C: stiffness (6, 6) [Pa]; rho: density [kg/m^3].
        load: along z [Pa]; factor: of the shear moduli; free: sides of the boundary may twist.
    """

    def __init__(self, mesh, thickness, C, rho=1.0, load=0.0, factor=5 / 6, free=True):
        self.body = PlateMesh(mesh, thickness)
        self.X, self.cells = self.body.X, self.body.cells
        self.params = np.tile(plate_params(C, rho, load, factor), (len(self.cells), 1))
        self.params[:, FREE_SIDES[0]] = free and self.body.rim()
        self.K = matrix("plate_tri3", self.X, self.cells, self.params)
        self.M = matrix("mass_plate_tri3", self.X, self.cells, self.params)
        self.constrained = np.zeros((len(self.X), 3), dtype=bool)

    def supported(self, *edges, clamped=False, hard=True):
        """Holds the deflection on edges; hard supports hold the rotation about their normal as well."""
        for edge in edges:
            nodes = self.body.nodes_of(edge)
            self.constrained[nodes, 0] = True
            if clamped:
                self.constrained[nodes] = True
            elif hard:
                # Along an edge of constant y the normal turns about y alone, along one of constant x about x.
                self.constrained[nodes, 2 if edge in ("bottom", "top") else 1] = True
        return self

    def frequencies(self, count):
        """Lowest angular frequencies [rad/s] above the rigid modes, if there are any."""
        return lowest(self.K, self.M, count, 0 if self.constrained.any() else 3, self.constrained)[0]

    def deflection(self):
        """Unknowns (n, 3) under the load."""
        force = np.zeros_like(self.X)
        _kernels.Element("plate_tri3").residual(self.X, np.zeros_like(self.X), self.cells, self.params, force)
        free = ~self.constrained.ravel()
        u = np.zeros(self.X.size)
        u[free] = spsolve(self.K[free][:, free].tocsc(), -force.ravel()[free])
        return u.reshape(-1, 3)


ALL = ("bottom", "right", "top", "left")


@pytest.mark.parametrize("thickness", [1e-2, 1e-3, 1e-4, 1e-6])
def test_thin_square_under_pressure_does_not_lock(thickness):
    """w_max D / (q a^4) is 0.00406235 with supported edges and 0.00126532 with clamped ones, at any thinness."""
    mesh = rectangle(1, 1, 0.05)
    for clamped, exact, tolerance in ((False, 0.00406235266, 2e-3), (True, 0.00126532, 6e-3)):
        plate = Plate(mesh, thickness, UNIT, load=1.0, free=False).supported(*ALL, clamped=clamped)
        assert plate.deflection()[:, 0].max() * thickness**3 == pytest.approx(exact, rel=tolerance)


def test_disc_under_pressure():
    """q a^4 / 64 D where it is clamped, times (5 + nu)/(1 + nu) where it is supported (softly, for it is round)."""
    mesh = disc(1.0, 0.1)
    for clamped, exact in ((True, 1 / 64), (False, (5 + NU) / (1 + NU) / 64)):
        plate = Plate(mesh, 1e-3, UNIT, load=1.0, free=not clamped)
        plate.supported("outline", clamped=clamped, hard=False)
        assert plate.deflection()[:, 0].max() * 1e-9 == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize("ratio, exact", [(1.0, FREE_SQUARE), (1.5, [20.0955, 21.4133, 46.3470, 49.9099, 57.7135])])
def test_free_thin_plate(ratio, exact):
    """omega a^2 sqrt(rho h / D) by a converged Ritz method, a the long side."""
    plate = Plate(rectangle(ratio, 1, 0.05), 1e-3, UNIT)
    ours = plate.frequencies(len(exact)) * ratio**2 / 1e-3
    np.testing.assert_allclose(ours, exact, rtol=2e-3)


def test_free_plate_of_the_benchmark_fv12():
    """NAFEMS FV12, 10 x 10 x 0.05 m: Mindlin's plate by a converged method [Hz]."""
    plate = Plate(rectangle(10, 10, 0.5), 0.05, isotropic(200e9, 0.3), rho=8000.0)
    exact = [1.61839, 2.35922, 2.92177, 4.18197, 4.18197, 7.35316]
    np.testing.assert_allclose(plate.frequencies(6) / (2 * np.pi), exact, rtol=1e-3)


@pytest.mark.parametrize("thickness, size", [(1.0, 0.5), (1.0, 0.25), (0.05, 0.5)])
def test_supported_plate_is_mindlins(thickness, size):
    """Closed form of Mindlin's plate with hard supports, rotary inertia and the factor pi^2/12 (NAFEMS FV52, FV13)."""
    E, rho, factor = 200e9, 8000.0, np.pi**2 / 12
    plate = Plate(rectangle(10, 10, size), thickness, isotropic(E, 0.3), rho, factor=factor, free=False).supported(*ALL)
    D, S, I = E * thickness**3 / 12 / 0.91, factor * E / 2.6 * thickness, rho * thickness**3 / 12
    exact = []
    for m, n in ((1, 1), (1, 2), (2, 1), (2, 2)):
        q = np.hypot(m, n) * np.pi / 10
        inertia = rho * thickness
        a, b, c = inertia * I, inertia * (D * q * q + S) + I * S * q * q, S * D * q**4
        exact.append(np.sqrt((b - np.sqrt(b * b - 4 * a * c)) / (2 * a)))
    if thickness == 1.0:
        np.testing.assert_allclose(np.array(exact) / 2 / np.pi, [45.8951, 109.4440, 109.4440, 167.8864], rtol=1e-6)
    np.testing.assert_allclose(plate.frequencies(4), exact, rtol=5e-3 * (size / 0.5) ** 2)


def test_clamped_disc():
    """omega a^2 sqrt(rho h / D): roots of J_n I_n' = J_n' I_n squared."""
    plate = Plate(disc(1.0, 0.08), 1e-3, UNIT, free=False).supported("outline", clamped=True)
    exact = [10.2158262, 21.2603977, 21.2603977, 34.8770354, 34.8770354, 39.7711482]
    np.testing.assert_allclose(plate.frequencies(6) / 1e-3, exact, rtol=4e-3)


@pytest.mark.parametrize("case", ["free", "supported", "thick"])
def test_frequencies_converge_with_the_square_of_the_size(case):
    thickness = 0.1 if case == "thick" else 1e-3
    exact = {"free": FREE_SQUARE[0] * 1e-3, "supported": 2 * np.pi**2 * 1e-3}
    if case == "thick":
        G, q2 = 12 * 0.91 / 2.6, 2 * np.pi**2
        D, S, I = 1e-3, 5 / 6 * G * 0.1, 1e-3 / 12
        b = 0.1 * (D * q2 + S) + I * S * q2
        exact["thick"] = np.sqrt((b - np.sqrt(b * b - 4 * 0.1 * I * S * D * q2**2)) / (2 * 0.1 * I))
    errors, sizes = [], []
    for size in (0.2, 0.1, 0.05):
        plate = Plate(rectangle(1, 1, size), thickness, UNIT, free=case == "free")
        if case != "free":
            plate.supported(*ALL)
        errors.append(abs(plate.frequencies(1)[0] / exact[case] - 1))
        sizes.append(len(plate.cells) ** -0.5)
    assert np.polyfit(np.log(sizes), np.log(errors), 1)[0] > 1.5


def test_wooden_plate_supported_along_its_grain():
    """omega^2 = pi^4/(rho h) (D11 (m/a)^4 + 2 (D12 + 2 D66) (m n/a b)^2 + D22 (n/b)^4), thin (Leissa 1969, 9.1)."""
    a, b, h, rho = 0.4, 0.3, 4e-4, 800.0
    plate = Plate(rectangle(a, b, 0.015), h, ROSEWOOD_LIKE, rho, free=False).supported(*ALL)
    D = plane_stress(ROSEWOOD_LIKE) * h**3 / 12
    waves = [(m / a, n / b) for m in range(1, 5) for n in range(1, 5)]
    squares = [D[0, 0] * m**4 + 2 * (D[0, 1] + 2 * D[2, 2]) * (m * n) ** 2 + D[1, 1] * n**4 for m, n in waves]
    exact = np.sort(np.pi**2 * np.sqrt(np.array(squares) / (rho * h)))[:5]
    np.testing.assert_allclose(plate.frequencies(5), exact, rtol=5e-3)


def test_turning_the_plate_with_its_grain_changes_nothing():
    mesh = rectangle(0.4, 0.3, 0.04)
    straight = Plate(mesh, 4e-3, ROSEWOOD_LIKE, 800.0).frequencies(5)
    angle = 0.7
    mesh.X[...] = mesh.X @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    aslant = Plate(mesh, 4e-3, turned(ROSEWOOD_LIKE, angle), 800.0).frequencies(5)
    np.testing.assert_allclose(aslant, straight, rtol=1e-9)
    assert abs(Plate(mesh, 4e-3, ROSEWOOD_LIKE, 800.0).frequencies(1)[0] / straight[0] - 1) > 0.01


def test_tapered_cantilever_under_pressure():
    """Without nu a strip is a Timoshenko beam: tip deflection by quadrature of moments and shear forces."""
    q, E, length, taper = 100.0, 10e9, 1.0, "0.1*(1 - 0.6*x)"
    plate = Plate(rectangle(length, 0.2, 0.05), Expression(taper), isotropic(E, 0.0), load=q)
    plate.supported("left", clamped=True)

    def rate(x):
        h, arm = 0.1 * (1 - 0.6 * x), length - x
        return q * arm**3 / 2 / (E * h**3 / 12) + q * arm / (5 / 6 * E / 2 * h)

    tip = plate.deflection()[plate.body.nodes_of("right"), 0]
    np.testing.assert_allclose(tip, quad(rate, 0, length)[0], rtol=5e-3)


@pytest.mark.parametrize("what", ["size", "thickness", "place"])
def test_design_derivative_of_a_frequency(what):
    """lambda' = phi (K' - lambda M') phi: -2 lambda for all lengths, 0 for a shift, else a Taylor remainder."""
    mesh = rectangle(1.3, 1, 0.2)
    plate = Plate(mesh, 0.03, UNIT)
    omega, modes = lowest(plate.K, plate.M, 3, 3)
    value, mode = omega[0] ** 2, modes[:, 0].reshape(-1, 3)
    mode = mode / np.sqrt(mode.ravel() @ plate.M @ mode.ravel())
    dX = {"size": plate.X, "place": np.tile([1.0, 2.0, 0.0], (len(plate.X), 1))}.get(what)
    if dX is None:
        dX = np.column_stack([0 * plate.X[:, :2], 0.03 * np.cos(3 * plate.X[:, 0])])
    change = {}
    for name in ("plate_tri3", "mass_plate_tri3"):
        out = np.zeros_like(mode)
        _kernels.Element(name).design(plate.X, dX, mode, plate.cells, plate.params, out)
        change[name] = np.sum(out * mode)
    slope = change["plate_tri3"] - value * change["mass_plate_tri3"]
    if what == "thickness":
        values = []
        for h in (0.02, 0.01):
            K, M = (matrix(name, plate.X + h * dX, plate.cells, plate.params) for name in change)
            values.append(lowest(K, M, 1, 3)[0][0] ** 2 - value - h * slope)
        assert np.log2(abs(values[0] / values[1])) > 1.9
    else:
        assert slope == pytest.approx(-2 * value if what == "size" else 0, rel=1e-7, abs=1e-7 * value)


BARS = {100: [2089.35, 4008.1, 5737.3, 8358.8, 11128.5], 200: [523.31, 1443.0, 1984.5, 2828.2, 4027.2]}
"""Frequencies [Hz] out of the plane of aluminium bars L x 30 x 4 mm in three-dimensional elasticity, by L [mm]."""


@pytest.mark.parametrize("length", BARS)
@pytest.mark.parametrize("size", [0.01, 0.007, 0.005, 0.0025])
def test_bar_twists_like_a_solid_at_any_size(length, size):
    """Free sides take the layer that triangles do not resolve; without it torsion is up to 4.7 % too stiff."""
    aluminium = isotropic(70e9, 0.33)
    mesh = rectangle(length * 1e-3, 0.03, size)
    ours = Plate(mesh, 0.004, aluminium, 2700.0).frequencies(5) / (2 * np.pi)
    np.testing.assert_allclose(ours, BARS[length], rtol=6e-3)
    bare = Plate(mesh, 0.004, aluminium, 2700.0, free=False).frequencies(5) / (2 * np.pi)
    assert np.abs(bare / BARS[length] - 1).max() > 0.009


@pytest.mark.slow
def test_layer_along_free_sides_vanishes_as_triangles_resolve_it():
    """A thick free square, whose sides twist in a third of its thickness: the same with and without, when fine."""
    gaps = []
    for size in (0.1, 0.05, 0.025):
        mesh = rectangle(1, 1, size)
        with_layer, bare = (Plate(mesh, 0.2, UNIT, free=free).frequencies(1)[0] for free in (True, False))
        gaps.append(bare / with_layer - 1)
    assert gaps[0] > 4 * gaps[1] > 16 * gaps[2] > 0


@pytest.mark.slow
@pytest.mark.parametrize("grain", [None, 0.0, 0.7, np.pi / 2])
def test_coarse_plates_with_a_layer_are_near_those_that_resolve_it(grain):
    """A thick square, or a wooden bar with its grain aslant; the fine triangles are a third as wide as the layer."""
    if grain is None:
        C, thickness, measures, sizes = UNIT, 0.2, (1.0, 1.0), (0.2, 0.025)
    else:
        C, thickness, measures, sizes = turned(ROSEWOOD_LIKE, grain), 0.004, (0.1, 0.03), (0.005, 0.0012)
    fine = Plate(rectangle(*measures, sizes[1]), thickness, C, free=False).frequencies(5)
    coarse = rectangle(*measures, sizes[0])
    errors = [np.abs(Plate(coarse, thickness, C, free=free).frequencies(5) / fine - 1).max() for free in (True, False)]
    assert errors[0] < min(0.6 * errors[1], 0.02)


@pytest.mark.parametrize("degrees", [30, 45, 60])
def test_layer_where_the_grain_is_aslant_to_the_side(degrees):
    """A wooden bar against one whose triangles resolve the layer; across its sides bending and shear give way."""
    C = turned(ROSEWOOD_LIKE, np.radians(degrees))
    fine = Plate(rectangle(0.1, 0.02, 0.0012), 0.004, C, free=False).frequencies(5)
    found, bare = (Plate(rectangle(0.1, 0.02, 0.008), 0.004, C, free=free).frequencies(5) for free in (True, False))
    np.testing.assert_allclose(found, fine, rtol=0.03)
    assert np.abs(bare / fine - 1).max() > 0.07
