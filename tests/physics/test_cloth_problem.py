"""Cloth as a problem: forces are slopes of the energy, tangents are slopes of forces, with and without their matrix."""

from dataclasses import replace

import numpy as np
import pytest
from cloths import BALL, CONTACT, PIN, cloth
from petsc4py import PETSc

from restshape.algebra.operator import Operator
from restshape.application import application
from restshape.fem.assembled import Assembled
from restshape.fem.problem import INTERNAL, MASS, STIFFNESS
from restshape.fem.space import Space
from restshape.mesh.generate import generate
from restshape.mesh.morley import MorleySpace
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.scene import cloth_arguments, cloth_problem
from restshape.scene.plan import plan
from restshape.shape.build import outline_from_spec

KINDS = ("morley", "hinge", "nonlinear", "none")


def problem_of(folder, kind: str) -> tuple[ClothProblem, np.ndarray]:
    """Pinned cloth in a ball, crumpled, whose friction has been updated once."""
    scene = cloth(folder, PIN, BALL, CONTACT, overrides=(f"effects.cloth.bending={kind}", "mesh.size=0.25"))
    mesh = generate(outline_from_spec(scene.shape, scene.folder), scene.mesh)
    arguments = cloth_arguments(scene, plan(scene, application("cloth")), mesh)
    problem = cloth_problem(mesh, arguments)
    x = problem.flat(arguments.start - [0.0, 0.0, 0.06])
    x += 0.01 * np.random.default_rng(1).uniform(-1, 1, x.shape) * problem.boundary.free
    problem.update_friction(x)
    return problem, x + 1e-3 * np.random.default_rng(2).uniform(-1, 1, x.shape) * problem.boundary.free


@pytest.mark.parametrize("kind", KINDS)
def test_forces_are_the_slope_of_the_energy(tmp_path, kind):
    problem, x = problem_of(tmp_path, kind)
    d, h = np.random.default_rng(3).uniform(-1, 1, x.shape), 1e-7
    out = np.empty_like(x)
    problem.unconstrained_residual(x, out)
    slope = (problem.energy(x + h * d) - problem.energy(x - h * d)) / (2 * h)
    assert slope == pytest.approx(np.vdot(out, d), rel=1e-5)
    problem.residual(x, out)
    assert not out.ravel()[problem.boundary.constrained].any()


@pytest.mark.parametrize("kind", KINDS)
def test_products_are_slopes_of_forces_and_those_of_the_matrix(tmp_path, kind):
    problem, x = problem_of(tmp_path, kind)
    d, h = np.random.default_rng(4).uniform(-1, 1, x.shape) * problem.boundary.free, 1e-7
    internal = Assembled(problem.integrals(INTERNAL))
    product = internal.tangent_product(x, d)
    differences = (internal.residual(x + h * d) - internal.residual(x - h * d)) / (2 * h)
    scale = np.abs(product).max()
    np.testing.assert_allclose(product, differences, atol=1e-4 * scale)
    operator = Operator(PETSc.COMM_SELF, 3, problem.space.node_offsets)
    operator.set_topology(problem.blocks(), problem.boundary.mask)
    matrix = Assembled(problem.integrals(INTERNAL), operator).tangent(x)
    right, out = PETSc.Vec().createWithArray(d.ravel()), PETSc.Vec().createSeq(d.size)
    matrix.mult(right, out)
    found = out.getArray().reshape(x.shape) * problem.boundary.free
    np.testing.assert_allclose(found, product * problem.boundary.free, atol=1e-11 * scale)


def test_design_products_are_slopes_of_forces_where_corners_move(tmp_path):
    problem, x = problem_of(tmp_path, "none")
    dX, dx = (np.random.default_rng(seed).uniform(-1, 1, (len(x), width)) for seed, width in ((5, 2), (6, 3)))
    X, h = problem.mesh.X.copy(), 1e-7

    def forces(step: float) -> tuple[np.ndarray, np.ndarray]:
        problem.mesh.X[:] = X + step * dX
        problem.update()
        problem.contact.area = problem.lumped.area[problem.corner_number]
        membrane, contact, *_ = ([one] for one in problem.integrals(INTERNAL))
        return tuple(Assembled(one).residual(x + step * dx) for one in (membrane, contact))

    both = [(after - before) / (2 * h) for after, before in zip(forces(h), forces(-h))]
    forces(0.0)
    for part, differences in zip(problem.integrals(INTERNAL), both):
        product = Assembled([part]).design_product(x, dX, dx)
        np.testing.assert_allclose(product, differences, atol=1e-5 * np.abs(product).max())
    still = Assembled(problem.integrals(INTERNAL)[1:]).design_product(x, np.zeros_like(dX), dx)
    assert np.abs(both[1] - still).max() > 1e-2 * np.abs(both[1]).max()


def test_kinds_of_integrals(tmp_path):
    problem, x = problem_of(tmp_path, "morley")
    assert problem.integrals(MASS) == []
    energy = Assembled(problem.integrals(STIFFNESS)).energy(x)
    assert energy == pytest.approx(problem.membrane_energy(x) + problem.bending_energy(x))


def test_versions_show_what_has_changed(tmp_path):
    problem, x = problem_of(tmp_path, "hinge")
    seen = [problem.version]
    for change in (lambda: problem.update_friction(x), lambda: problem.soften(0.5), problem.update):
        change()
        assert all(problem.version != before for before in seen)
        seen.append(problem.version)
    history = problem.contact.history
    problem.contact.history = replace(history)
    assert problem.version != seen[-1]


@pytest.mark.parametrize("kind", ["morley", "hinge"])
def test_nodes_and_cells_are_a_space(tmp_path, kind):
    problem, _ = problem_of(tmp_path, kind)
    space = problem.space
    assert isinstance(space, Space) and isinstance(space, MorleySpace) is (kind == "morley")
    assert len(space.X) == problem.n_nodes and space.dofs is space.cells
    np.testing.assert_array_equal(space.corners, space.cells[:, :3])
    np.testing.assert_array_equal(space.X[space.nodes_of("left")][:, 0], 0.0)
    field = np.random.default_rng(5).normal(size=(problem.n_nodes, 3))
    np.testing.assert_array_equal(space.interpolate(field, ()), field)
