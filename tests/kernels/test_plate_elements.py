"""Plates with shear: the inherited checks, rigid motions, and patches of constant curvature."""

import numpy as np
import pytest
from element_case import TRI3, ElementCase
from sample_meshes import unit_box

from restshape import _kernels as k
from restshape.physics.elasticity.stiffness import isotropic, orthotropic, plane_stress, plate_params, turned

WOOD = turned(orthotropic((13.0, 2.0, 1.0), (0.36, 0.46, 0.6), (1.1, 0.9, 0.3)), 0.4)
CORNERS = np.column_stack([TRI3, [0.3, 0.2, 0.25]])


def rigid(X: np.ndarray, lift: float, about_x: float, about_y: float) -> np.ndarray:
    """Deflection and rotations (n, 3) of a plate that moves as a whole."""
    w = lift + about_x * X[:, 1] - about_y * X[:, 0]
    return np.column_stack([w, np.full(len(X), about_x), np.full(len(X), about_y)])


class PlateCase(ElementCase):
    """Checks of what depends on a thickness at the corners."""

    def test_moving_cell_and_design_together_changes_nothing(self, element):
        """In the plane: a thicker plate is another one."""
        derivative, dX = np.zeros((3, 3)), np.tile([1.0, -2.0, 0.0], (3, 1))
        element.design(self.X, dX, self.sample(element, 8), self.cells, self.p, derivative)
        np.testing.assert_allclose(derivative, 0.0, atol=1e-13)

    def test_corners_may_be_counted_from_any(self, element):
        x = self.sample(element, 4)
        turn = [1, 2, 0]
        np.testing.assert_allclose(
            self.residual(element, self.X[turn], x[turn]), self.residual(element, self.X, x)[turn], atol=1e-14
        )


class TestPlate(PlateCase):
    name, params, X = "plate_tri3", tuple(plate_params(isotropic(2.0, 0.3), 0.7, load=0.4)), CORNERS

    def test_rigid_motions_need_no_force(self, element):
        out = np.zeros((3, 3))
        p = self.p
        p[10] = 0.0
        element.residual(self.X, rigid(self.X, 0.3, -0.7, 1.1), self.cells, p, out)
        np.testing.assert_allclose(out, 0.0, atol=1e-15)

    def test_all_other_motions_do(self, element):
        stiff = np.linalg.eigvalsh(element.tangent_block(self.X, np.zeros((3, 3)), self.p))
        assert np.abs(stiff[:3]).max() < 1e-12 * stiff[-1]
        assert stiff[3] > 1e-4 * stiff[-1]

    def test_load_is_its_area_times_itself(self, element):
        area = np.linalg.det(np.column_stack([np.ones(3), TRI3])) / 2
        force = -self.residual(element, self.X, np.zeros((3, 3)))
        np.testing.assert_allclose(force[:, 0].sum(), 0.4 * area, rtol=1e-13)


class TestPlateWithFreeSides(TestPlate):
    """All three: what they take leaves the element stiff."""

    params = (*plate_params(WOOD, 0.7, load=0.4)[:11], 1.0, 1.0, 1.0)


class TestWoodenPlate(TestPlate):
    params = tuple(plate_params(WOOD, 0.7, load=0.4))


class TestPlateMass(PlateCase):
    name, params, X = "mass_plate_tri3", tuple(plate_params(WOOD, 0.7)), CORNERS

    def test_inertia_of_rigid_motions(self, element):
        """m v^2, and rho h x^2 + rho h^3 / 12 of a turn, integrated over the triangle by its middles of sides."""
        X = np.column_stack([TRI3, [0.2, 0.2, 0.2]])
        area = np.linalg.det(np.column_stack([np.ones(3), TRI3])) / 2
        middles = (TRI3 + np.roll(TRI3, 1, axis=0)) / 2
        for motion, square in (((1, 0, 0), 1.0), ((0, 0, 1), np.mean(middles[:, 0] ** 2) + 0.2**2 / 12)):
            energy = element.energy(X, rigid(X, *motion), self.cells, self.p)[0]
            np.testing.assert_allclose(2 * energy, 0.7 * 0.2 * area * square, rtol=1e-13)

    @pytest.mark.parametrize("thickness", [1e-4, 1e-2, 1.0])
    def test_every_motion_has_inertia(self, element, thickness):
        X = np.column_stack([TRI3, np.full(3, thickness)])
        M = element.tangent_block(X, np.zeros((3, 3)), self.p)
        scale = 1 / np.sqrt(np.diag(M))
        assert np.linalg.eigvalsh(M * np.outer(scale, scale)).min() > 1e-7


@pytest.mark.parametrize("thickness", [1e-3, 0.3])
@pytest.mark.parametrize("C", [isotropic(2.0, 0.3), WOOD], ids=["isotropic", "wood"])
def test_patch_holds_a_constant_curvature_exactly(C, thickness):
    """w = -(a x^2 + b y^2 + c x y)/2 bends without shear; the moments are h^3/12 Q (a, b, 2 c / 2)."""
    X2, cells, inner = unit_box(2, 4)
    a, b, c = 0.3, -0.5, 0.7
    x, y = X2.T
    w = -(a * x**2 + b * y**2 + c * x * y) / 2
    slope = np.column_stack([a * x + c * y / 2, b * y + c * x / 2])
    u = np.column_stack([w, -slope[:, 1], slope[:, 0]])
    kappa = np.array([a, b, c])
    X, p = np.column_stack([X2, np.full(len(X2), thickness)]), plate_params(C, 1.0)
    element, out = k.Element("plate_tri3"), np.zeros_like(u)
    element.residual(X, u, cells, p, out)
    moment = thickness**3 / 12 * plane_stress(C) @ kappa
    np.testing.assert_allclose(out[inner], 0.0, atol=1e-13 * np.abs(moment).max())
    np.testing.assert_allclose(element.energy(X, u, cells, p).sum(), kappa @ moment / 2, rtol=1e-11)


@pytest.mark.parametrize("C", [isotropic(2.0, 0.3), WOOD], ids=["isotropic", "wood"])
def test_thick_patch_holds_a_constant_shear(C):
    """Where the plate is far thicker than its triangles are wide, w = x shears it and bends nothing."""
    X2, cells, _ = unit_box(2, 4)
    thickness = 1e4
    X, p = np.column_stack([X2, np.full(len(X2), thickness)]), plate_params(C, 1.0)
    u = np.column_stack([X2 @ [0.6, -0.2], np.zeros((len(X2), 2))])
    energy = k.Element("plate_tri3").energy(X, u, cells, p).sum()
    shear = np.array([-0.2, 0.6])
    np.testing.assert_allclose(energy, thickness / 2 * shear @ (5 / 6 * C[3:5, 3:5]) @ shear, rtol=1e-6)


@pytest.mark.parametrize("sides, left", [(1, 0.59), (2, 0.18)])
def test_free_sides_leave_triangles_stiff(sides, left):
    """Each takes at most 2/(sqrt(6) 2) = 0.41 of the energy of any motion, whatever the triangle and the grain."""
    rng, element, least = np.random.default_rng(3), k.Element("plate_tri3"), 1.0
    for _ in range(400):
        corners = rng.uniform(0, 1, (3, 2))
        if np.linalg.det(corners[1:] - corners[0]) < 0.05:
            continue
        X = np.column_stack([corners, np.full(3, 10 ** rng.uniform(-2, 0.5))])
        p = plate_params(
            isotropic(1.0, rng.uniform(0, 0.45)) if rng.random() < 0.5 else turned(WOOD, rng.uniform(0, 3)), 1
        )
        free = p.copy()
        free[11 : 11 + sides] = 1.0
        size, motions = np.linalg.eigh(element.tangent_block(X, np.zeros((3, 3)), p))
        motions = motions[:, 3:] / np.sqrt(size[3:])
        least = min(
            least, np.linalg.eigvalsh(motions.T @ element.tangent_block(X, np.zeros((3, 3)), free) @ motions)[0]
        )
    assert left - 1e-6 < least < 0.9


def test_free_side_takes_the_energy_of_its_layer():
    """Pure twist of a triangle far wider than thick: delta h^3/12 G kappa^2/2 a length, delta = h/sqrt(10)."""
    h, G, kappa = 1e-4, 0.8, 0.3
    x, y = TRI3.T
    u = np.column_stack([kappa * x * y / 2, kappa * x / 2, -kappa * y / 2])
    X, cells = np.column_stack([TRI3, np.full(3, h)]), np.array([[0, 1, 2]], np.int32)
    p = plate_params(isotropic(2 * G * 1.25, 0.25), 1.0)
    element, side = k.Element("plate_tri3"), TRI3[1] - TRI3[0]
    free = p + np.eye(len(p))[11]
    taken = element.energy(X, u, cells, p)[0] - element.energy(X, u, cells, free)[0]
    length = np.linalg.norm(side)
    twist = kappa * (side[0] ** 2 - side[1] ** 2) / length**2
    np.testing.assert_allclose(taken, h / np.sqrt(10) * h**3 / 12 * G * twist**2 / 2 * length, rtol=1e-6)
