"""One base test for every element: list its name, parameters and a sample cell, and inherit the checks."""

import numpy as np
import pytest

from restshape import _kernels as k

LAMBDA, MU = 1.3, 0.7

TRI3 = np.array([[0.1, 0.0], [1.2, 0.2], [0.3, 0.9]])
TET4 = np.array([[0.0, 0.1, 0.0], [1.1, 0.0, 0.2], [0.1, 0.9, 0.1], [0.2, 0.3, 1.0]])
SIDES = {3: ((0, 1), (1, 2), (2, 0)), 4: ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)), 2: ((0, 1),)}


def curved(corners: np.ndarray, bend: float = 0.05) -> np.ndarray:
    """Nodes of the second-order cell on these corners, its mid-sides moved off the straight sides."""
    middles = np.array([(corners[a] + corners[b]) / 2 for a, b in SIDES[len(corners)]])
    return np.vstack([corners, middles + bend * np.random.default_rng(7).uniform(-1, 1, middles.shape)])


def taylor_slope(f, derivative: np.ndarray | float, step: float = 0.02) -> float:
    """Order in h of f(h) - f(0) - h derivative; infinite where that is rounding, as for a linear f."""
    remainders = []
    for h in (step, step / 2):
        remainders.append(np.linalg.norm(np.atleast_1d(f(h) - f(0.0) - h * derivative)))
    scale = np.linalg.norm(np.atleast_1d(f(0.0))) + np.linalg.norm(np.atleast_1d(derivative))
    if remainders[0] < 1e-14 * scale:
        return np.inf
    return np.log2(remainders[0] / remainders[1])


class ElementCase:
    """Checks of any element: consistent energy, residual, tangent and design derivative."""

    name: str
    params: tuple[float, ...]
    X: np.ndarray
    amplitude = 0.1  # of the sample unknowns

    @pytest.fixture
    def element(self):
        return k.Element(self.name)

    @property
    def cells(self) -> np.ndarray:
        return np.arange(len(self.X), dtype=np.int32)[None]

    @property
    def p(self) -> np.ndarray:
        return np.array(self.params)

    def sample(self, element, seed: int) -> np.ndarray:
        return self.amplitude * np.random.default_rng(seed).uniform(-1, 1, (element.nodes, element.fields))

    def direction(self, shape: tuple[int, ...], seed: int) -> np.ndarray:
        return np.random.default_rng(seed).uniform(-1, 1, shape)

    def residual(self, element, X, x) -> np.ndarray:
        out = np.zeros((element.nodes, element.fields))
        element.residual(X, x, self.cells, self.p, out)
        return out

    def test_parameters_are_named(self, element):
        assert len(element.parameters) == len(self.params)
        assert element.nodes == len(self.X) and element.dim == self.X.shape[1]

    def test_residual_is_the_gradient_of_the_energy(self, element):
        x, v = self.sample(element, 1), self.direction((element.nodes, element.fields), 2)
        slope = taylor_slope(
            lambda h: element.energy(self.X, x + h * v, self.cells, self.p)[0],
            float(np.sum(self.residual(element, self.X, x) * v)),
        )
        assert slope > 1.9

    def test_tangent_is_the_derivative_of_the_residual(self, element):
        x, v = self.sample(element, 3), self.direction((element.nodes, element.fields), 4)
        tangent = element.tangent_block(self.X, x, self.p)
        slope = taylor_slope(lambda h: self.residual(element, self.X, x + h * v).ravel(), tangent @ v.ravel())
        assert slope > 1.9

    def test_tangent_is_symmetric(self, element):
        tangent = element.tangent_block(self.X, self.sample(element, 5), self.p)
        assert element.symmetric
        np.testing.assert_allclose(tangent, tangent.T, rtol=0, atol=1e-14 * max(1.0, np.abs(tangent).max()))

    def test_design_is_the_derivative_of_the_residual_in_X(self, element):
        x, dX = self.sample(element, 6), self.direction(self.X.shape, 7)
        derivative = np.zeros((element.nodes, element.fields))
        element.design(self.X, dX, x, self.cells, self.p, derivative)
        slope = taylor_slope(
            lambda h: self.residual(element, self.X + h * dX, x).ravel(), derivative.ravel(), step=2e-3
        )
        assert slope > 1.9

    def test_design_takes_in_moving_unknowns(self, element):
        x, dX = self.sample(element, 6), self.direction(self.X.shape, 7)
        dx = self.direction((element.nodes, element.fields), 13)
        together, alone = np.zeros((2, element.nodes, element.fields))
        element.design(self.X, dX, x, self.cells, self.p, together, dx=dx)
        element.design(self.X, dX, x, self.cells, self.p, alone)
        expected = alone.ravel() + element.tangent_block(self.X, x, self.p) @ dx.ravel()
        np.testing.assert_allclose(together.ravel(), expected, atol=1e-12 * np.abs(expected).max())

    def test_moving_cell_and_design_together_changes_nothing(self, element):
        derivative = np.zeros((element.nodes, element.fields))
        element.design(self.X, np.ones_like(self.X), self.sample(element, 8), self.cells, self.p, derivative)
        np.testing.assert_allclose(derivative, 0.0, atol=1e-13)


def strain_and_stress(gradient: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Small strain and Hooke's stress of a displacement gradient, plane strain in 2D."""
    strain = (gradient + gradient.T) / 2
    return strain, LAMBDA * np.trace(strain) * np.eye(len(gradient)) + 2 * MU * strain


class SolidCase(ElementCase):
    """Checks of solids besides: rigid motions, body force, and the patch test on `patch()`."""

    volume: float | None = None  # of the sample cell, where it is known in closed form

    @property
    def dim(self) -> int:
        return self.X.shape[1]

    @property
    def thickness(self) -> float:
        return self.params[2] if self.dim == 2 else 1.0

    @property
    def unloaded(self) -> np.ndarray:
        p = self.p.copy()
        p[-self.dim :] = 0.0
        return p

    def patch(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Nodes, cells and inner nodes of a distorted patch of volume 1."""
        raise NotImplementedError

    def rotation(self) -> np.ndarray:
        """A displacement gradient without strain."""
        skew = np.zeros((self.dim, self.dim))
        skew[0, 1], skew[1, 0] = -0.3, 0.3
        return skew

    def test_rigid_motions_need_no_force(self, element):
        u = self.X @ self.rotation().T + 0.4
        out = np.zeros_like(u)
        element.residual(self.X, u, self.cells, self.unloaded, out)
        np.testing.assert_allclose(out, 0.0, atol=1e-14)

    def test_forces_balance(self, element):
        out = np.zeros_like(self.X)
        element.residual(self.X, self.sample(element, 9), self.cells, self.unloaded, out)
        np.testing.assert_allclose(out.sum(axis=0), 0.0, atol=1e-14)

    def test_body_force_has_the_weight_of_the_patch(self, element):
        X, cells, _ = self.patch()
        out = np.zeros_like(X)
        element.residual(X, np.zeros_like(X), cells, self.p, out)
        np.testing.assert_allclose(out.sum(axis=0), -self.p[-self.dim :] * self.thickness, atol=1e-14)

    def test_patch_holds_a_linear_field_exactly(self, element):
        X, cells, inner = self.patch()
        gradient = 1e-3 * np.random.default_rng(11).uniform(-1, 1, (self.dim, self.dim))
        u = X @ gradient.T
        strain, stress = strain_and_stress(gradient)
        assert len(inner) > 0
        out = np.zeros_like(X)
        element.residual(X, u, cells, self.unloaded, out)
        tolerance = self.law_tolerance(np.abs(stress).max())
        np.testing.assert_allclose(out[inner], 0.0, atol=1e-14)
        # sum of X (x) force = volume times stress
        np.testing.assert_allclose(out.T @ X, stress * self.thickness, atol=tolerance)
        energy = element.energy(X, u, cells, self.unloaded).sum()
        np.testing.assert_allclose(
            energy, np.sum(strain * stress) / 2 * self.thickness, atol=self.law_tolerance(np.abs(strain * stress).max())
        )

    def test_stress_of_a_linear_field(self, element):
        X, cells, _ = self.patch()
        gradient = 1e-3 * np.random.default_rng(12).uniform(-1, 1, (self.dim, self.dim))
        strain, stress = strain_and_stress(gradient)
        out = np.zeros((len(cells), element.stress_components))
        element.stress(X, X @ gradient.T, cells, self.unloaded, out)
        expected = [stress[0, 0], stress[1, 1], stress[0, 1]]
        expected += [LAMBDA * np.trace(strain)] if self.dim == 2 else [stress[2, 2], stress[1, 2], stress[0, 2]]
        np.testing.assert_allclose(
            out, np.tile(expected, (len(cells), 1)), atol=self.law_tolerance(np.abs(stress).max())
        )

    def test_stress_at_points_is_that_of_their_place(self, element):
        """A field u = (a x^2, 0) on a straight second-order cell, a linear one on first-order cells."""
        straight = curved(self.X[: self.dim + 1], 0.0)[: element.nodes]
        points = np.array([np.eye(self.dim + 1)[c][1:] for c in range(self.dim + 1)] + [np.full(self.dim, 0.2)])
        at = straight[0] + points @ (straight[1 : self.dim + 1] - straight[0])
        squared = element.nodes > self.dim + 1
        x = straight[:, 0]
        u = np.zeros_like(straight)
        u[:, 0] = 1e-5 * (x**2 if squared else x)
        strain = 1e-5 * (2 * at[:, 0] if squared else np.ones(len(at)))
        out = np.zeros((1, len(points), element.stress_components))
        element.stress(straight, u, self.cells, self.unloaded, out, points)
        mean = self.mean_dilatation(straight, strain, at)
        np.testing.assert_allclose(out[0, :, 0], LAMBDA * mean + 2 * MU * strain, rtol=1e-3, atol=1e-9)
        np.testing.assert_allclose(out[0, :, 1], LAMBDA * mean, rtol=1e-3, atol=1e-9)

    def mean_dilatation(self, X: np.ndarray, dilatation: np.ndarray, at: np.ndarray) -> np.ndarray:
        """The dilatation that the stress at places `at` of the cell X knows of, where it is `dilatation`."""
        return dilatation

    def law_tolerance(self, scale: float) -> float:
        """How far the law may be from Hooke's at strains of 1e-3."""
        return 1e-12 * scale


class LargeCase(SolidCase):
    """Checks of St. Venant-Kirchhoff solids besides: finite rotations, and stresses in closed form."""

    def law_tolerance(self, scale):
        return 1e-2 * scale

    def rotation(self):
        c, s = np.cos(1.1), np.sin(1.1)
        turn = np.eye(self.dim)
        turn[:2, :2] = [[c, -s], [s, c]]
        if self.dim == 3:
            turn = turn @ np.array([[1, 0, 0], [0, np.cos(2.0), -np.sin(2.0)], [0, np.sin(2.0), np.cos(2.0)]])
        return turn - np.eye(self.dim)

    def stress_of(self, element, F: np.ndarray) -> np.ndarray:
        out = np.zeros((1, element.stress_components))
        element.stress(self.X, self.X @ (F - np.eye(self.dim)).T, self.cells, self.unloaded, out)
        return out[0]

    def test_tangent_at_rest_is_that_of_small_strains(self, element):
        """On straight sides, where both are integrated exactly."""
        small = k.Element(self.name.replace("stvk", "linear_elastic"))
        X = curved(self.X[: self.dim + 1], 0.0)[: element.nodes]
        tangents = [e.tangent_block(X, np.zeros_like(X), self.unloaded) for e in (element, small)]
        np.testing.assert_allclose(*tangents, rtol=0, atol=1e-14)

    def test_simple_shear(self, element):
        """sigma_12 = mu g + (lambda/2 + mu) g^3, sigma_22 = (lambda/2 + mu) g^2, and sigma_11."""
        g = 0.7
        F = np.eye(self.dim)
        F[0, 1] = g
        sxx = (LAMBDA / 2 + 2 * MU) * g**2 + (LAMBDA / 2 + MU) * g**4
        syy, sxy = (LAMBDA / 2 + MU) * g**2, MU * g + (LAMBDA / 2 + MU) * g**3
        expected = [sxx, syy, sxy, LAMBDA / 2 * g**2] + [0, 0] * (self.dim - 2)
        np.testing.assert_allclose(self.stress_of(element, F), expected, rtol=1e-12, atol=1e-14)

    def test_energy_and_stress_of_a_stretch_that_is_turned(self, element):
        """F = Q diag(1.2, 0.9[, 1]): E and S in closed form, Cauchy stress F S F^T / J."""
        stretch = np.diag([1.2, 0.9, 1.0][: self.dim])
        F = (self.rotation() + np.eye(self.dim)) @ stretch
        E = (np.diag(stretch) ** 2 - 1) / 2
        S = LAMBDA * E.sum() + 2 * MU * E
        X, cells, _ = self.patch()
        energy = element.energy(X, X @ (F - np.eye(self.dim)).T, cells, self.unloaded).sum()
        np.testing.assert_allclose(energy, np.sum(S * E) / 2 * self.thickness, rtol=1e-12)
        cauchy = F @ np.diag(S) @ F.T / (1.2 * 0.9)
        expected = [cauchy[0, 0], cauchy[1, 1], cauchy[0, 1]]
        expected += [LAMBDA * E.sum() / 1.08] if self.dim == 2 else [cauchy[2, 2], cauchy[1, 2], cauchy[0, 2]]
        np.testing.assert_allclose(self.stress_of(element, F), expected, rtol=1e-12, atol=1e-14)

    def pulled(self, element, stretch: float, young: float, nu: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Nodes, forces and the change of forces a unit of stretch, in a patch pulled along x with free sides."""
        lateral = np.sqrt(1 - nu * (stretch**2 - 1))
        change = np.diag([1.0] + [-nu * stretch / lateral] * (self.dim - 1))
        mu = young / (2 * (1 + nu))
        lam = young * nu / (1 - nu**2) if self.dim == 2 else young * nu / ((1 + nu) * (1 - 2 * nu))
        p = np.array([lam, mu, 1.0, 0, 0] if self.dim == 2 else [lam, mu, 0, 0, 0])
        X, cells, _ = self.patch()
        u = X @ (np.diag([stretch] + [lateral] * (self.dim - 1)) - np.eye(self.dim))
        forces, slope = np.zeros_like(X), np.zeros_like(X)
        element.residual(X, u, cells, p, forces)
        for cell in cells:
            tangent = element.tangent_block(X[cell], u[cell], p)
            slope[cell] += (tangent @ (X[cell] @ change).ravel()).reshape(-1, self.dim)
        return X, forces, slope

    @pytest.mark.parametrize("stretch", [0.8, 1.3])
    def test_uniaxial_pull(self, element, stretch):
        """P / E = l (l^2 - 1) / 2 whatever nu is: in plane stress and in space."""
        X, forces, _ = self.pulled(element, stretch, young=2.0, nu=0.3)
        end = X[:, 0] > 1 - 1e-9
        np.testing.assert_allclose(forces[end, 0].sum(), 2.0 * stretch * (stretch**2 - 1) / 2, rtol=1e-12)
        np.testing.assert_allclose(forces[~end & (X[:, 0] > 1e-9)], 0, atol=1e-14)

    def test_uniaxial_compression_has_a_limit_point(self, element):
        """At l = 1/sqrt(3) the force P / E = -0.192450 changes no more."""
        X, forces, slope = self.pulled(element, 1 / np.sqrt(3), young=1.0, nu=0.3)
        end = X[:, 0] > 1 - 1e-9
        np.testing.assert_allclose(forces[end, 0].sum(), -0.192450, atol=1e-6)
        np.testing.assert_allclose(slope[end, 0].sum(), 0, atol=1e-14)
