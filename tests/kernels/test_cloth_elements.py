"""Elements of cloth: the inherited checks, rigid motions, compression, and patches in closed form."""

import numpy as np
import pytest
from cloth_parameters import isotropic_bending, membrane_params
from element_case import TRI3, ElementCase
from sample_meshes import unit_box
from scipy.linalg import solve_sylvester, sqrtm
from scipy.spatial.transform import Rotation

from restshape import _kernels as k
from restshape.physics.elasticity.stiffness import isotropic, orthotropic, plane_stress, turned

WOVEN = plane_stress(turned(orthotropic((3.0, 2.0, 1.0), (0.2, 0.3, 0.3), (0.4, 0.9, 0.3)), 0.4))
KNIT = plane_stress(isotropic(2.0, 0.3))
QUAD = np.array([[0.1, 0.0], [1.2, 0.2], [0.3, 0.9], [0.8, -0.7]])
TURN = Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()
SHIFT = np.array([0.3, -0.2, 0.5])


def flat(X: np.ndarray) -> np.ndarray:
    """The undeformed positions of material coordinates."""
    return np.column_stack([X, np.zeros(len(X))])


class ClothCase(ElementCase):
    """Checks of what depends on positions in space."""

    loads = 0  # how many of the last parameters are loads

    def rest(self) -> np.ndarray:
        return flat(self.X)

    def sample(self, element, seed):
        return self.rest() @ (1.2 * TURN.T) + super().sample(element, seed)

    @property
    def unloaded(self) -> np.ndarray:
        p = self.p.copy()
        p[len(p) - self.loads :] = 0.0
        return p

    def moved(self, x: np.ndarray) -> np.ndarray:
        return x @ TURN.T + SHIFT

    def forces(self, element, x, p=None) -> np.ndarray:
        out = np.zeros_like(x)
        element.residual(self.X, x, self.cells, self.unloaded if p is None else p, out)
        return out

    def test_forces_turn_with_the_cloth(self, element):
        x = self.sample(element, 20)
        np.testing.assert_allclose(
            self.forces(element, self.moved(x)), self.forces(element, x) @ TURN.T, rtol=0, atol=1e-13
        )
        energies = [element.energy(self.X, y, self.cells, self.unloaded)[0] for y in (x, self.moved(x))]
        np.testing.assert_allclose(*energies, rtol=1e-12)

    def test_rigid_motions_need_no_force(self, element):
        np.testing.assert_allclose(self.forces(element, self.moved(self.rest())), 0.0, atol=1e-14)
        energy = element.energy(self.X, self.moved(self.rest()), self.cells, self.unloaded)
        np.testing.assert_allclose(energy, 0.0, atol=1e-14)

    def rigid_velocities(self, x: np.ndarray) -> np.ndarray:
        """Six of them (6, nodes * 3) at the positions x."""
        shifts = [np.tile(axis, len(x)) for axis in np.eye(3)]
        return np.array(shifts + [np.cross(axis, x).ravel() for axis in np.eye(3)])

    def test_rigid_motions_are_in_the_null_space_at_rest(self, element):
        x = self.moved(self.rest())
        tangent = element.tangent_block(self.X, x, self.p)
        np.testing.assert_allclose(tangent @ self.rigid_velocities(x).T, 0.0, atol=1e-12 * np.abs(tangent).max())


class MembraneCase(ClothCase):
    params = tuple(membrane_params(WOVEN, (0.2, -0.1, -0.4)))
    loads = 3

    def compressed(self, seed: int) -> np.ndarray:
        """Positions of all sorts: inverted, collapsed, stretched."""
        return np.random.default_rng(seed).uniform(-0.7, 0.7, (3, 3))

    def test_other_motions_of_the_plane_need_force(self, element):
        tangent = element.tangent_block(self.X, self.moved(self.rest()), self.p)
        values = np.linalg.eigvalsh(tangent)
        # Of nine three stretch; out of its plane a membrane without tension gives way.
        assert np.abs(values[:6]).max() < 1e-13 * values[-1] and values[6] > 1e-3 * values[-1]

    def test_body_force_has_the_weight_of_the_patch(self, element):
        X, cells, _ = unit_box(2, 4)
        out = np.zeros((len(X), 3))
        element.residual(X, flat(X), cells, self.p, out)
        np.testing.assert_allclose(out.sum(axis=0), [-0.2, 0.1, 0.4], atol=1e-14)

    def deformed_patch(self, element):
        """A patch under one deformation gradient: inner forces, sum of force (x) X, energy, tensions."""
        X, cells, inner = unit_box(2, 4)
        F = TURN[:, :2] @ np.array([[1.3, 0.1], [0.1, 0.8]])
        x = X @ F.T + SHIFT
        out, tension = np.zeros_like(x), np.zeros((len(cells), 3))
        element.residual(X, x, cells, self.unloaded, out)
        element.stress(X, x, cells, self.unloaded, tension)
        np.testing.assert_allclose(out[inner], 0.0, atol=1e-14)
        assert len(inner) > 0
        return F, out.T @ X, element.energy(X, x, cells, self.unloaded).sum(), tension


class TestMembrane(MembraneCase):
    name, X = "membrane_tri3", TRI3

    def test_patch_holds_a_linear_deformation_exactly(self, element):
        F, moments, energy, tension = self.deformed_patch(element)
        E = (F.T @ F - np.eye(2)) / 2
        strain = np.array([E[0, 0], E[1, 1], 2 * E[0, 1]])
        S = WOVEN @ strain
        np.testing.assert_allclose(tension, np.tile(S, (len(tension), 1)), atol=1e-13)
        np.testing.assert_allclose(energy, strain @ S / 2, rtol=1e-13)
        np.testing.assert_allclose(moments, F @ [[S[0], S[2]], [S[2], S[1]]], atol=1e-13)

    def test_compressed_tangent_is_indefinite(self, element):
        lowest = [np.linalg.eigvalsh(element.tangent_block(self.X, self.compressed(s), self.p))[0] for s in range(20)]
        assert min(lowest) < -0.01


class TestTension(ElementCase):
    """Tensions that strains do not change: the inherited checks, and the tangent in closed form."""

    name, X, params = "membrane_tension_tri3", TRI3, (0.7, -0.3, 0.2)

    def sample(self, element, seed):
        return flat(self.X) @ (1.2 * TURN.T) + super().sample(element, seed)

    def test_tangent_is_that_of_springs_between_the_corners_wherever_they_are(self, element):
        corners = np.column_stack([np.ones(3), self.X])
        G, area = np.linalg.inv(corners)[1:].T, np.linalg.det(corners) / 2
        expected = area * np.kron(G @ [[0.7, 0.2], [0.2, -0.3]] @ G.T, np.eye(3))
        for seed in range(3):
            found = element.tangent_block(self.X, self.sample(element, seed), self.p)
            np.testing.assert_allclose(found, expected, atol=1e-13)

    def test_unstretched_cloth_stores_nothing(self, element):
        x = flat(self.X) @ TURN.T
        np.testing.assert_allclose(element.energy(self.X, x, self.cells, self.p), 0.0, atol=1e-15)


class TestStabilisedMembrane(MembraneCase):
    """Its tangent is the true one where the samples of the inherited checks are in tension."""

    name, X = "membrane_stabilised_tri3", TRI3

    def test_residual_is_that_of_the_true_membrane(self, element):
        x = self.compressed(3)
        np.testing.assert_array_equal(
            self.forces(element, x, self.p), self.forces(k.Element("membrane_tri3"), x, self.p)
        )

    def test_tangent_in_tension_is_the_true_one(self, element):
        for seed in range(20):
            x = self.rest() @ (1.5 * TURN.T) + 0.1 * self.direction((3, 3), seed)
            true = k.Element("membrane_tri3").tangent_block(self.X, x, self.p)
            np.testing.assert_array_equal(element.tangent_block(self.X, x, self.p), true)

    def test_tangent_is_semidefinite_in_any_state(self, element):
        for seed in range(200):
            values = np.linalg.eigvalsh(element.tangent_block(self.X, self.compressed(seed), self.p))
            assert values[0] > -1e-14 * values[-1]

    def test_tangent_has_the_positive_part_of_the_tension(self, element):
        """Against a spectral decomposition: the difference to the true tangent is that of the tensions."""
        for seed in range(20):
            x = self.compressed(seed)
            s = np.zeros((1, 3))
            element.stress(self.X, x, self.cells, self.unloaded, s)
            values, axes = np.linalg.eigh([[s[0, 0], s[0, 2]], [s[0, 2], s[0, 1]]])
            negative = (axes * np.minimum(values, 0.0)) @ axes.T
            corners = np.column_stack([np.ones(3), self.X])
            G = np.linalg.inv(corners)[1:].T
            removed = np.kron(G @ negative @ G.T, np.eye(3)) * np.linalg.det(corners) / 2
            true = k.Element("membrane_tri3").tangent_block(self.X, x, self.p)
            np.testing.assert_allclose(element.tangent_block(self.X, x, self.p), true - removed, atol=1e-12)


class TestCorotatedMembrane(MembraneCase):
    name, X = "membrane_corotated_tri3", TRI3

    def test_patch_holds_a_linear_deformation_exactly(self, element):
        """F = R U with U known: energy of U - I; U S + S U is twice the tension of U - I."""
        F, moments, energy, tension = self.deformed_patch(element)
        U = np.array([[1.3, 0.1], [0.1, 0.8]])
        strain = np.array([0.3, -0.2, 0.2])
        T = WOVEN @ strain
        np.testing.assert_allclose(energy, strain @ T / 2, rtol=1e-13)
        S = tension[0][[0, 2, 2, 1]].reshape(2, 2)
        np.testing.assert_allclose(U @ S + S @ U, 2 * T[[0, 2, 2, 1]].reshape(2, 2), atol=1e-13)
        np.testing.assert_allclose(moments, F @ S, atol=1e-13)


class TestStabilisedCorotatedMembrane(MembraneCase):
    """Its tangent is the true one where nothing is strained, where the inherited checks of it take their samples."""

    name, X = "membrane_corotated_stabilised_tri3", TRI3

    def sample(self, element, seed):
        return self.moved(self.rest()) if seed in (3, 6) else super().sample(element, seed)

    def test_residual_is_that_of_the_true_membrane(self, element):
        true = k.Element("membrane_corotated_tri3")
        for seed in range(3):
            x = self.compressed(seed)
            np.testing.assert_array_equal(self.forces(element, x, self.p), self.forces(true, x, self.p))

    def test_tangent_is_semidefinite_in_any_state(self, element):
        """That of the true one is not."""
        true = k.Element("membrane_corotated_tri3")
        lowest = []
        for seed in range(200):
            x = self.compressed(seed)
            values = np.linalg.eigvalsh(element.tangent_block(self.X, x, self.p))
            assert values[0] > -1e-14 * values[-1]
            lowest.append(np.linalg.eigvalsh(true.tangent_block(self.X, x, self.p))[0])
        assert min(lowest) < -0.01

    @pytest.mark.parametrize("stretched", [True, False])
    def test_tangent_is_that_of_green_strains_and_of_the_tension(self, element, stretched):
        """In closed form: Hooke's law of changes of the Green strain, and the positive part of S, S U + U S = 2 T."""
        corners = np.column_stack([np.ones(3), self.X])
        G, area = np.linalg.inv(corners)[1:].T, np.linalg.det(corners) / 2
        for seed in range(10):
            x = self.compressed(seed)
            if stretched:
                x = self.rest() @ (1.5 * TURN.T) + 0.1 * self.direction((3, 3), seed)
            F = x.T @ G
            U = sqrtm(F.T @ F).real
            T = WOVEN @ [U[0, 0] - 1.0, U[1, 1] - 1.0, 2.0 * U[0, 1]]
            values, axes = np.linalg.eigh(solve_sylvester(U, U, 2.0 * T[[0, 2, 2, 1]].reshape(2, 2)))
            assert (values[0] > 0.05) if stretched else (values[0] < 0.0)
            tension = (axes * np.maximum(values, 0.0)) @ axes.T
            # Columns: the change of F^T F/2 with each of the nine positions.
            changes = [F.T @ np.outer(axis, g) for g in G for axis in np.eye(3)]
            B = np.array([[c[0, 0], c[1, 1], c[0, 1] + c[1, 0]] for c in changes]).T
            expected = area * (B.T @ WOVEN @ B + np.kron(G @ tension @ G.T, np.eye(3)))
            np.testing.assert_allclose(
                element.tangent_block(self.X, x, self.p), expected, atol=1e-12 * np.abs(expected).max()
            )


class HingeCase(ClothCase):
    params = (0.7,)

    def folded(self, angle: float) -> np.ndarray:
        """Flat, but for node 3, which is turned about the edge."""
        x = flat(QUAD)
        edge = (x[1] - x[0]) / np.linalg.norm(x[1] - x[0])
        x[3] = x[0] + Rotation.from_rotvec(angle * edge).apply(x[3] - x[0])
        return self.moved(x)

    @property
    def scale(self) -> float:
        """k/2 3 |e|^2 / (A0 + A1), the areas by Heron's formula."""

        def area(*corners):
            a, b, c = (np.linalg.norm(QUAD[i] - QUAD[j]) for i, j in zip(corners, np.roll(corners, 1)))
            s = (a + b + c) / 2
            return np.sqrt(s * (s - a) * (s - b) * (s - c))

        return 0.35 * 3 * np.sum((QUAD[1] - QUAD[0]) ** 2) / (area(0, 1, 2) + area(0, 1, 3))


class TestHinge(HingeCase):
    name, X = "hinge_flap4", QUAD

    def test_hessian_is_constant_and_of_rank_one_each_component(self, element):
        tangents = [element.tangent_block(self.X, self.sample(element, s), self.p) for s in (1, 2)]
        np.testing.assert_array_equal(*tangents)
        values = np.linalg.eigvalsh(tangents[0])
        assert np.abs(values[:9]).max() < 1e-13 * values[-1] and values[9] > 0.99 * values[-1]

    def test_flat_states_have_no_energy_however_stretched(self, element):
        x = QUAD @ np.array([[1.7, 0.2, -0.4], [0.3, 0.6, 0.1]]) + SHIFT
        assert element.energy(self.X, x, self.cells, self.p)[0] < 1e-28

    def test_a_fold_costs_the_square_of_its_chord(self, element):
        """|K x| is the length of the edge times 2 sin(angle/2)."""
        energy = element.energy(self.X, self.folded(0.8), self.cells, self.p)[0]
        np.testing.assert_allclose(energy, self.scale * (2 * np.sin(0.4)) ** 2, rtol=1e-12)


class TestNonlinearHinge(HingeCase):
    name, X = "hinge_nonlinear_flap4", QUAD

    def sample(self, element, seed):
        return self.folded(0.9) + 0.1 * self.direction((4, 3), seed)

    @pytest.mark.parametrize("angle", [-3.0, -0.5, 1e-3, 1.6, 3.1])
    def test_a_fold_costs_the_square_of_its_angle(self, element, angle):
        energy = element.energy(self.X, self.folded(angle), self.cells, self.p)[0]
        np.testing.assert_allclose(energy, self.scale * angle**2, rtol=1e-9)

    def test_forces_balance(self, element):
        x = self.sample(element, 9)
        forces = self.forces(element, x)
        np.testing.assert_allclose(forces.sum(axis=0), 0.0, atol=1e-13)
        np.testing.assert_allclose(np.cross(x, forces).sum(axis=0), 0.0, atol=1e-13)

    def test_tangent_of_the_flat_state_is_that_of_the_quadratic_hinge(self, element):
        """Along the normal; within the plane both give nothing and the quadratic hinge as much as along the normal."""
        tangents = [e.tangent_block(self.X, flat(QUAD), self.p) for e in (element, k.Element("hinge_flap4"))]
        np.testing.assert_allclose(tangents[0][2::3, 2::3], tangents[1][2::3, 2::3], atol=1e-13)
        np.testing.assert_allclose(np.delete(tangents[0], np.s_[2::3], axis=0), 0.0, atol=1e-13)


def morley_rest(X: np.ndarray, signs: np.ndarray) -> np.ndarray:
    """Flat positions of a cell: the normals of its sides in the plane at the sides."""
    d = np.roll(X[:3], -1, axis=0) - X[:3]
    N = np.column_stack([d[:, 1], -d[:, 0], np.zeros(3)])
    return np.vstack([flat(X[:3]), signs[:, None] * N])


class TestMorley(ClothCase):
    name = "morley_tri6"
    D = plane_stress(turned(orthotropic((3.0, 2.0, 1.0), (0.2, 0.3, 0.3), (0.4, 0.9, 0.3)), 0.4))
    signs = np.array([1.0, -1.0, 1.0])
    params = (*membrane_params(D)[:6], 1.0, -1.0, 1.0)
    X = np.vstack([TRI3, (TRI3 + np.roll(TRI3, -1, axis=0)) / 2])

    def rest(self):
        return morley_rest(self.X, self.signs)

    @property
    def unloaded(self):
        return self.p

    def moved(self, x):
        """Slopes turn, and do not shift."""
        return x @ TURN.T + np.vstack([np.tile(SHIFT, (3, 1)), np.zeros((3, 3))])

    def rigid_velocities(self, x):
        velocities = super().rigid_velocities(x)
        velocities[:3, 9:] = 0.0
        return velocities

    def test_hessian_is_constant_with_the_kernel_of_linear_functions(self, element):
        tangents = [element.tangent_block(self.X, self.sample(element, s), self.p) for s in (1, 2)]
        np.testing.assert_array_equal(*tangents)
        values = np.linalg.eigvalsh(tangents[0])
        assert np.abs(values[:9]).max() < 1e-13 * values[-1] and values[9] > 1e-3 * values[-1]

    def test_quadratic_deflection_has_the_energy_of_a_plate(self, element):
        """w = X . H X / 2: area/2 (Hxx, Hyy, 2 Hxy) . D (Hxx, Hyy, 2 Hxy)."""
        H = np.array([[0.7, -0.3], [-0.3, 0.4]])
        rest = self.rest()
        x = rest.copy()
        x[:3, 2] = np.einsum("ia,ab,ib->i", TRI3, H, TRI3) / 2
        x[3:, 2] = np.einsum("ia,ab,ib->i", rest[3:, :2], H, self.X[3:])
        curvature = np.array([0.7, 0.4, -0.6])
        area = np.linalg.det(np.column_stack([np.ones(3), TRI3])) / 2
        energy = element.energy(self.X, x, self.cells, self.p)[0]
        np.testing.assert_allclose(energy, area / 2 * curvature @ self.D @ curvature, rtol=1e-12)

    def test_isotropic_energy_is_that_of_both_curvatures(self, element):
        """D/2 ((k1 + k2)^2 - 2 (1 - nu) k1 k2) an area, on a saddle of curvatures 0.7 and -0.4."""
        p = np.concatenate([membrane_params(isotropic_bending(1.7, 0.3))[:6], self.signs])
        rest = self.rest()
        x = rest.copy()
        x[:3, 2] = TRI3**2 @ [0.35, -0.2]
        x[3:, 2] = (rest[3:, :2] * self.X[3:]) @ [0.7, -0.4]
        area = np.linalg.det(np.column_stack([np.ones(3), TRI3])) / 2
        energy = element.energy(self.X, x, self.cells, p)[0]
        np.testing.assert_allclose(energy, area * 1.7 / 2 * (0.3**2 + 2 * 0.7 * 0.7 * 0.4), rtol=1e-12)


class TestPointPotential(ElementCase):
    name, X = "potential_point1", np.array([[0.2, 0.3]])
    params = (0.1, -0.2, 0.3, 1.0, -2.0, 0.5, 3.0, 4.0, 5.0, 0.6, 0.7, 0.8)

    def test_at_its_place_it_is_what_it_was_given(self, element):
        x = self.p[None, :3].copy()
        np.testing.assert_array_equal(self.residual(element, self.X, x)[0], [1.0, -2.0, 0.5])
        H = [[3.0, 0.8, 0.7], [0.8, 4.0, 0.6], [0.7, 0.6, 5.0]]
        np.testing.assert_array_equal(element.tangent_block(self.X, x, self.p), H)


class TestTrianglePotential(ElementCase):
    name, X = "potential_tri3", TRI3
    params = (0.2, 0.5, 0.3, *TestPointPotential.params)

    def test_its_forces_are_those_of_its_point_shared_by_the_corners(self, element):
        x = np.random.default_rng(4).uniform(-1, 1, (3, 3))
        b = np.array(self.params[:3])
        point, alone = k.Element("potential_point1"), np.zeros((1, 3))
        point.residual(self.X[:1], (b @ x)[None], np.zeros((1, 1), np.int32), np.array(self.params[3:]), alone)
        np.testing.assert_allclose(self.residual(element, self.X, x), np.outer(b, alone[0]), rtol=1e-12)


class TestPointCoupling(ElementCase):
    name, X = "coupling_point2", np.array([[0.2, 0.3], [0.4, -0.1]])
    params = (0.1, -0.2, 0.3, 1.0, -2.0, 0.5, 3.0, 4.0, 5.0, 0.6, 0.7, 0.8, -1.0, 2.0, 0.4)

    def test_at_its_places_it_couples_and_does_nothing_else(self, element):
        x = np.array(self.params[:6]).reshape(2, 3)
        np.testing.assert_array_equal(self.residual(element, self.X, x), np.zeros((2, 3)))
        B, none = np.array(self.params[6:]).reshape(3, 3), np.zeros((3, 3))
        np.testing.assert_array_equal(element.tangent_block(self.X, x, self.p), np.block([[none, B], [B.T, none]]))
