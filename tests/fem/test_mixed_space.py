"""Several fields with different nodes: Taylor and Hood's flow as a problem on a `MixedSpace`, solved as any other."""

import numpy as np
import pytest
from mesh.mesh_samples import SQUARE, grid, mesh_of, polygon_outline, shaken
from petsc4py import PETSc
from stokes import Stokes, flow

from restshape import _kernels
from restshape.algebra.linear import LinearSolver
from restshape.algebra.stages import Stages
from restshape.analysis.static.linear_system import LinearSystem
from restshape.calibration import Calibration
from restshape.fem.assembled import Assembled
from restshape.fem.elements import STOKES
from restshape.fem.mixed import MixedSpace
from restshape.fem.problem import INTERNAL
from restshape.fem.residuals import dead_loads, internal_norm, residual_norm
from restshape.mesh.lagrange_space import EdgeInterpolation, LagrangeSpace


def base(per_side: int) -> LagrangeSpace:
    """A square of triangles whose inner corners are shaken."""
    mesh = mesh_of(polygon_outline(SQUARE), *grid(per_side, per_side, 1.0, 1.0))
    return LagrangeSpace(shaken(mesh, 0.15 / per_side))


def solved(problem: Stokes, method: str) -> np.ndarray:
    """The unknowns (m, 1), by the library's linear system and solver."""
    traits = problem.traits(None)
    system = LinearSystem(PETSc.COMM_SELF, problem, None, traits)
    solver = LinearSolver(
        PETSc.COMM_SELF, "mixed_test_", method, 1e-10, Calibration.load(), Stages(), traits=traits
    )  # fmt: skip
    dead_loads(problem, system.right)
    internal = Assembled(problem.integrals(INTERNAL), system.operator)
    system.mat = internal.system(problem.boundary.values, system.right)
    system.b.stateIncrease()
    solver.solve(system.mat, system.b, system.solution, True)
    system.gather()
    return system.full.reshape(-1, 1) + problem.boundary.values


def errors(per_side: int, method: str) -> tuple[float, float]:
    """L2 errors of velocity and of pressure."""
    problem = Stokes(None, None, base(per_side))
    x, space = solved(problem, method), problem.space
    assert residual_norm(problem, x) < 1e-9 * internal_norm(problem, x)
    velocity, pressure = flow(space.X)
    mesh, one = space.mesh, np.ones(1)
    off = space.values("pressure", x) - pressure[space.base.corner_number][:, None]
    energies = (
        _kernels.Element("mass_tri6").energy(space.X, space.values("velocity", x) - velocity, space.cells, one),
        _kernels.Element("mass_tri3").energy(mesh.X, np.hstack([off, 0 * off]), mesh.cells, one),
    )
    return tuple(float(np.sqrt(2 * part.sum())) for part in energies)


@pytest.mark.parametrize("method", ["direct", "stale", "auto"])
def test_velocity_is_of_order_3_and_pressure_of_order_2(method):
    sizes = (5, 15)
    rates = np.log(np.divide(errors(5, method), errors(15, method))) / np.log(sizes[1] / sizes[0])
    assert rates[0] > 2.8 and rates[1] > 1.8, rates


def test_its_residual_follows_nodes_that_move():
    problem = Stokes(None, None, base(3))
    rng = np.random.default_rng(2)
    x, X = rng.uniform(-1, 1, problem.boundary.mask.shape), problem.space.X
    dX, kept = rng.uniform(-1, 1, X.shape), X.copy()
    assembled = Assembled(problem.integrals(INTERNAL))
    start, rate = assembled.residual(x), assembled.design_product(x, dX)
    remainders = []
    for h in (2e-4, 1e-4):
        X[:] = kept + h * dX
        remainders.append(np.linalg.norm(assembled.residual(x) - start - h * rate))
    assert remainders[0] / remainders[1] == pytest.approx(4.0, rel=0.05)


def test_unknowns_of_a_node_follow_each_other_and_fields_know_their_nodes():
    space = MixedSpace(base(2), STOKES["tri6"].layout)
    corners = space.base.corner_number
    assert len(space.node) == 2 * len(space.X) + len(corners) and np.all(np.diff(space.node) >= 0)
    assert space.node_offsets.tolist() == [0, len(space.node)]
    rows = np.hstack([space.rows(name).ravel() for name in ("velocity", "pressure")])
    assert np.array_equal(np.sort(rows), np.arange(len(space.node)))
    np.testing.assert_array_equal(space.dof_X[space.rows("pressure")[:, 0]], space.X[corners])
    assert np.array_equal(space.node[space.dofs[:, 12:]], space.corners)
    with pytest.raises(ValueError, match="'pressure' does not live"):
        space.rows("pressure", space.base.side_number[:1])


def test_after_a_flip_the_velocity_is_interpolated_and_the_pressure_stays():
    space = MixedSpace(base(2), STOKES["tri6"].layout)
    x = np.random.default_rng(4).uniform(-1, 1, (len(space.node), 1))
    node, weights = space.cells[0, 3:4], np.array([[0.1, -0.1, 0.2, 0.5, 0.2, 0.1]])
    moved = space.interpolate(x, (EdgeInterpolation(node, space.cells[1:2], weights),))
    expected = weights @ x[space.rows("velocity", space.cells[1]), 0]
    np.testing.assert_allclose(moved[space.rows("velocity", node), 0], expected)
    others = np.setdiff1d(np.arange(len(x)), space.rows("velocity", node))
    assert np.array_equal(moved[others], x[others])


def test_cells_that_flips_have_changed_get_their_unknowns():
    space = MixedSpace(base(2), STOKES["tri6"].layout)
    right = space.dofs.copy()
    space.dofs[1:3] = 0
    assert space.follow(np.array([1, 2])).tolist() == [1, 2] and np.array_equal(space.dofs, right)
