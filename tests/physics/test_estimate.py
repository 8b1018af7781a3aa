"""The error estimate of static solids: against exact solutions, where it must vanish, at materials that meet."""

import numpy as np
import pytest
from manufactured import SCENES, displacement, gradient
from small_scenes import HEAD, block, write_scene

from restshape import _kernels
from restshape.interface.first_frame import first_frame
from restshape.mesh.quadratic_basis import quadratic_basis
from restshape.mesh.quadrature import collapsed
from restshape.mesh.transfer import transfer

LINEAR = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])

TWO = f"""
{HEAD}{block()}[shape.regions.core]
polygon = [[0.3, 0.25], [0.7, 0.3], [0.65, 0.75], [0.25, 0.7]]
[material.soft]
E = 1e6
nu = 0.3
[material.hard]
E = 1e8
nu = 0.2
region = ["core"]
[effects.solid]
[supports.whole]
on = "all"
fix = {{ x = "1e-3*x + 2e-4*y", y = "-3e-4*y" }}
[mesh]
size = 0.1
"""


def true_error(mesh, x, slope, moduli):
    """The relative error of a displacement in the energy norm, by its exact gradients."""
    lame, shear = moduli
    points, weights = collapsed(5)
    if mesh.cells.shape[1] == 6:
        basis, rises = quadratic_basis(points[:, 1:])
    else:
        basis, rises = points, np.broadcast_to(LINEAR, (len(points), 3, 2))
    nodes, values, error, size = mesh.X[mesh.cells], x[mesh.cells], 0.0, 0.0

    def density(H):
        E = 0.5 * (H + H.transpose(0, 2, 1))
        return lame * np.einsum("eii->e", E) ** 2 + 2 * shear * (E**2).sum(axis=(1, 2))

    for shape, rise, weight in zip(basis, rises, weights):
        jacobian = np.einsum("ik,eij->ekj", rise, nodes)
        H = np.linalg.solve(jacobian, np.einsum("ik,eij->ekj", rise, values)).transpose(0, 2, 1)
        exact, area = slope(np.einsum("i,eij->ej", shape, nodes)), 0.5 * weight * np.linalg.det(jacobian)
        error += (area * density(H - exact)).sum()
        size += (area * density(exact)).sum()
    return np.sqrt(error / size)


@pytest.mark.parametrize("scene", ["manufactured.toml", "manufactured_hole.toml"])
@pytest.mark.parametrize(("order", "near"), [(1, 0.03), (2, 0.03)])
def test_effectivity_tends_to_1(scene, order, near):
    found = []
    for size in (0.24, 0.12, 0.06):
        analysis = first_frame(SCENES / scene, [f"mesh.size={size}", f"mesh.order={order}"]).analysis
        found.append(analysis.errors()["estimate"] / true_error(analysis.space, analysis.x, gradient, (1.0, 1.0)))
    assert all(0.9 < ratio < 1.15 for ratio in found), found
    assert abs(found[-1] - 1.0) < near


def test_estimate_is_of_the_displacement_that_is_shown():
    """The exact displacement at the nodes is nearer, or as near; twice the displacement has the same relative error."""
    analysis = first_frame(SCENES / "manufactured.toml", ["mesh.size=0.12"]).analysis
    estimate = analysis.problem.error_estimate()
    assert estimate.relative(2.0 * analysis.x) == pytest.approx(estimate.relative(analysis.x), rel=1e-12)
    assert estimate.distance(1.01 * analysis.x, analysis.x) == pytest.approx(0.01, rel=1e-9)
    mesh = analysis.space
    exact = estimate.distance(analysis.x, displacement(mesh.X))
    assert 0.0 < exact < 0.5 * analysis.errors()["estimate"]


@pytest.mark.parametrize("order", [1, 2])
def test_patch_test_has_no_error(order):
    assert first_frame(SCENES / "patch.toml", [f"mesh.order={order}"]).analysis.errors()["estimate"] < 1e-12


@pytest.mark.parametrize("overrides", [[], ["mesh.order=2"], ["effects.solid.model=plane_strain"]])
def test_jump_of_stress_between_materials_is_no_error(tmp_path, overrides):
    analysis = first_frame(write_scene(tmp_path, TWO), overrides).analysis
    stress = analysis.problem.stresses.cauchy(analysis.x)[:, 0]
    assert stress.max() > 20 * stress.min()
    assert analysis.errors()["estimate"] < 1e-12
    # Recovered across the border it would be one.
    mesh, physics = analysis.space, analysis.problem
    if mesh.cells.shape[1] == 3:
        nodal = np.empty((len(mesh.X), 4))
        patches = _kernels.PatchRecovery(mesh.cells, mesh.cells, len(mesh.X))
        patches(mesh.X, physics.stresses.cauchy(analysis.x), nodal)
        estimate = analysis.error_estimate
        error, size = estimate._energies(mesh.cells, nodal, estimate.flux(analysis.x, None))
        assert error > 1e-3 * size


def test_stress_is_nothing_to_relate_to(tmp_path):
    displaced = write_scene(tmp_path, TWO.replace('{ x = "1e-3*x + 2e-4*y", y = "-3e-4*y" }', "{ x = 0.3, y = 0.1 }"))
    assert np.isnan(first_frame(displaced).analysis.errors()["estimate"])


@pytest.mark.parametrize(
    ("overrides", "least"), [(["mesh.size=0.02"], 0.85), (["mesh.size=0.03", "mesh.order=1"], 0.7)]
)
def test_large_strains_against_a_fine_mesh(overrides, least):
    """Green's strain of Turek and Hron's beam, which bends far; the fine mesh has a fifth of the error or less."""
    fine = first_frame(SCENES / "csm1.toml", ["mesh.size=0.004", "mesh.near.a=1e-3", "mesh.near.d=1e-3"]).analysis
    coarse = first_frame(SCENES / "csm1.toml", overrides).analysis
    there = transfer(coarse.space, fine.space, coarse.x)
    ratio = coarse.errors()["estimate"] / fine.error_estimate.distance(there, fine.x)
    assert least < ratio < 1.3


def test_mean_dilatation_against_a_fine_mesh():
    """The stress of a nearly incompressible membrane, against nodal stresses of a fine mesh."""
    rubber = ["material.unit.nu=0.4999", "effects.solid.model=plane_strain"]
    fine = first_frame(SCENES / "cook.toml", [*rubber, "mesh.size=1.5"]).analysis
    coarse = first_frame(SCENES / "cook.toml", [*rubber, "mesh.size=6"]).analysis
    assert coarse.problem.element.name == "linear_elastic_dilatation_tri6"
    of, at = fine.error_estimate, coarse.error_estimate
    nodal = transfer(fine.space, coarse.space, of.recovery(of.flux(fine.x, of.recovery.points)))
    error, size = at._energies(coarse.space.cells, np.ascontiguousarray(nodal), at.flux(coarse.x, at._points))
    assert coarse.errors()["estimate"] / np.sqrt(error / size) == pytest.approx(1.0, abs=0.15)


def test_energies_of_a_linear_field_are_exact():
    """d . C d of linear d on one triangle, integrated by hand: area/12 (sum of squares + square of the sum)."""
    X, cells = np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 2.0]]), np.array([[0, 1, 2]], dtype=np.int32)
    nodal, samples = np.zeros((3, 4)), np.zeros((1, 4))
    nodal[:, 0], samples[0, 0] = [1.0, 4.0, 9.0], 2.0
    C = np.zeros((1, 4, 4))
    C[0, 0, 0] = 7.0
    d = nodal[:, 0] - 2.0
    found = _kernels.recovery_energies(X, cells, cells, nodal, samples, C, np.empty(0, dtype=np.int32))
    assert found == pytest.approx((7 * 3.0 / 12 * ((d**2).sum() + d.sum() ** 2), 7 * 3.0 * 4.0))


def unit_simplex(nodes):
    """Places X and cells (1, nodes) of the triangle or tetrahedron between the origin and the unit vectors."""
    d = 2 if nodes in (3, 6) else 3
    corners = np.vstack([np.zeros(d), np.eye(d)])
    sides = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)][: nodes - d - 1]
    X = np.vstack([corners, [0.5 * (corners[i] + corners[j]) for i, j in sides]]) if sides else corners
    return X, np.arange(nodes, dtype=np.int32)[None]


def first_component(d):
    """The compliance by which the energy is the square of the first component alone."""
    C = np.zeros((1, 4, 4) if d == 2 else (1, 6, 6))
    C[0, 0, 0] = 1.0
    return C


def power_integral(d, power):
    """The integral of a coordinate's power over the unit simplex: power!/(power + d)!."""
    return 1 / np.prod(np.arange(power + 1, power + d + 1))


@pytest.mark.parametrize(("nodes", "degree"), [(3, 2), (6, 4), (4, 2), (10, 5)])
def test_rules_integrate_squares_of_what_is_interpolated(nodes, degree):
    points, (X, cells) = _kernels.estimate_points(nodes), unit_simplex(nodes)
    C, k = first_component(X.shape[1]), degree // 2
    samples, nodal = np.zeros((1, len(points), C.shape[1])), np.zeros((nodes, C.shape[1]))
    samples[0, :, 0] = points[:, 0] ** k
    size = _kernels.recovery_energies(X, cells, cells, nodal, samples, C, np.empty(0, dtype=np.int32))[1]
    assert size == pytest.approx(power_integral(X.shape[1], 2 * k), rel=1e-12)


@pytest.mark.parametrize(("nodes", "a"), [(6, 1 / 6), (10, (5 - np.sqrt(5)) / 20)])
def test_stresses_are_linear_between_samples_near_the_corners(nodes, a):
    """A sample a corner, whose barycentric coordinates are a but for its own: x is x, in a cell and at its nodes."""
    X, cells = unit_simplex(nodes)
    d, C = X.shape[1], first_component(X.shape[1])
    samples, nodal = np.zeros((1, d + 1, C.shape[1])), np.zeros((nodes, C.shape[1]))
    samples[0, :, 0] = a
    samples[0, 1, 0] = 1 - d * a
    whole = power_integral(d, 2)
    nothing = np.empty(0, dtype=np.int32)
    found = _kernels.recovery_energies(X, cells, cells, nodal, samples, C, nothing)
    assert found == pytest.approx((whole, whole), rel=1e-12)
    nodal[:, 0] = X[:, 0]
    found = _kernels.recovery_energies(X, cells, cells, nodal, samples, C, nothing)
    assert found == pytest.approx((0.0, whole), rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("nodes", [3, 4])
def test_stresses_that_are_constant_in_cells_are_as_those_at_all_points(nodes):
    """Two materials: the closed form of constant stresses is the integral of the same ones, given at each point."""
    rng, (X, cells) = np.random.default_rng(8), unit_simplex(nodes)
    d = X.shape[1]
    X, cells = np.vstack([X, X + 2.0]) + rng.uniform(-0.2, 0.2, (2 * nodes, d)), np.vstack([cells, cells + nodes])
    components = 4 if d == 2 else 6
    nodal, samples = rng.normal(size=(2 * nodes, components)), rng.normal(size=(2, components))
    C = rng.normal(size=(2, components, components))
    C, kinds = np.ascontiguousarray(C + C.transpose(0, 2, 1)), np.array([1, 0], dtype=np.int32)
    at_points = np.repeat(samples[:, None], len(_kernels.estimate_points(nodes)), axis=1)
    found, expected = (_kernels.recovery_energies(X, cells, cells, nodal, s, C, kinds) for s in (samples, at_points))
    assert found == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("node", [-1, 3])
def test_nodes_that_do_not_exist_are_refused(node):
    X, cells = unit_simplex(3)
    wrong = np.array([[0, 1, node]], dtype=np.int32)
    for places, rows in ((wrong, cells), (cells, wrong)):
        with pytest.raises(ValueError, match="do not exist"):
            _kernels.recovery_energies(
                X, places, rows, np.zeros((3, 4)), np.zeros((1, 4)), np.zeros((1, 4, 4)), np.empty(0, dtype=np.int32)
            )
