"""Cells that are evaluated several at once: the same numbers as one by one, whatever their number."""

import numpy as np
import pytest
from petsc4py import PETSc
from sample_meshes import second_order, unit_box

from restshape import _kernels as k

SOLIDS = ("linear_elastic_tri3", "stvk_tri3", "linear_elastic_tet4", "linear_elastic_tri6")
FLOWS = (
    "slow_flow_tri3",
    "flow_tri3",
    "unsteady_flow_on_moving_mesh_tri3",
    "unsteady_oseen_flow_tri3",
    "heated_flow_tri3",
    "unsteady_heated_flow_on_moving_mesh_tri3",
    "unsteady_heated_slow_flow_on_moving_mesh_tri3",
    "unsteady_lifted_flow_tri3",
)
MEMBRANES = ("membrane_tri3", "membrane_stabilised_tri3")
ELEMENTS = (*SOLIDS, *MEMBRANES, "mass_tri3", "mass_tet4", "mass_tri6", "heat_capacity_tri6", *FLOWS)
BEND = 0.02
"""By which mid-sides of second order are moved off the middle: sides are curved."""


def sample(element: str, count: int, seed: int = 0):
    """The element, nodes, unknowns, cells, a row of parameters for each cell, and coefficients of the nodes."""
    X, cells, inner = unit_box(3, 2) if element.endswith("tet4") else unit_box(2, 5)
    if element.endswith("tri6"):
        X, cells, _ = second_order(X, cells, inner, BEND)
    rng = np.random.default_rng(seed)
    e = k.Element(element)
    x = 0.2 * rng.normal(size=(len(X), e.fields))
    w = rng.normal(size=(len(X), len(e.coefficients))) if e.coefficients else None
    params = rng.uniform(0.5, 2.0, (count, len(e.parameters)))
    return e, X, x, np.ascontiguousarray(cells[:count]), params, w


def residual(e, X, x, cells, params, w, subset=None):
    out = np.zeros_like(x)
    e.residual(X, x, cells, params, out, subset, w)
    return out


@pytest.mark.parametrize("element", SOLIDS)
@pytest.mark.parametrize("count", [1, 7, 8, 9, 23])
def test_residuals_are_the_derivative_of_the_energy(element, count):
    e, X, x, cells, params, w = sample(element, count)
    d = np.random.default_rng(1).normal(size=x.shape)
    h = 1e-5
    ahead, behind = (e.energy(X, x + s * h * d, cells, params).sum() for s in (1, -1))
    found = np.vdot(residual(e, X, x, cells, params, w), d)
    assert found == pytest.approx((ahead - behind) / (2 * h), rel=1e-7)


@pytest.mark.parametrize("element", ELEMENTS)
def test_bits_do_not_hang_on_the_neighbours(element):
    """Each cell alone, those of a subset, and all together; parameters of each cell, or the same for all."""
    e, X, x, cells, params, w = sample(element, 21)
    chosen = np.array([20, 3, 4, 11, 0, 7, 8, 9, 15, 16], dtype=np.int32)
    alone = [residual(e, X, x, cells[[c]], params[[c]], w) for c in chosen]
    np.testing.assert_array_equal(residual(e, X, x, cells, params, w, chosen), np.sum(alone, axis=0))
    same = np.broadcast_to(params[0], params.shape).copy()
    np.testing.assert_array_equal(residual(e, X, x, cells, params[0], w), residual(e, X, x, cells, same, w))


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("count", [1, 8, 23])
@pytest.mark.parametrize("coefficient", [1.0, -2.5])
@pytest.mark.parametrize("backend", ["csr", "bcsr"])
def test_the_tangent_is_the_sum_of_the_cells_own(element, count, coefficient, backend):
    """Of one cell each, with supports; and the residual that comes with it."""
    e, X, x, cells, params, w = sample(element, count)
    f = e.fields
    op = k.Operator(PETSc.COMM_WORLD.size > 1, f, np.array([0, len(X)], dtype=np.int32), 0, backend)
    op.set_topology([cells])
    mask = np.zeros(x.size, dtype=np.uint8)
    mask[cells[0, 0] * f] = 1
    op.set_constraints(mask)
    right = np.zeros(x.size)
    op.begin()
    op.add(0, X, [(e, x, params, coefficient, -1.0, w)], right)
    op.end()
    K = np.zeros((x.size, x.size))
    for cell, p in zip(cells, params):
        dofs = (cell[:, None] * f + np.arange(f)).ravel()
        K[np.ix_(dofs, dofs)] += coefficient * e.tangent_block(X[cell], x[cell], p, None if w is None else w[cell])
    free = mask == 0
    start, column, value = op.mat.getValuesCSR()
    found = np.zeros_like(K)
    for i in range(x.size):
        found[i, column[start[i] : start[i + 1]]] = value[start[i] : start[i + 1]]
    np.testing.assert_allclose(found[np.ix_(free, free)], K[np.ix_(free, free)], rtol=0, atol=1e-12 * np.abs(K).max())
    assert not found[np.ix_(~free, free)].any() and not found[np.ix_(free, ~free)].any()
    np.testing.assert_allclose(right[free], residual(e, X, x, cells, params, w).ravel()[free], rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("shape", ["tri3", "tri6"])
@pytest.mark.parametrize("coefficients", [(1.0, 0.5), (2.0, -0.5), (1.0, 0.5, 0.1, 0.2, 0.3)])
def test_a_sum_of_terms_is_that_of_each(coefficients, shape):
    """With states and factors of their own, on supports too, where each term adds its size to the diagonal."""
    solid, X, x, cells, params, _ = sample(f"linear_elastic_{shape}", 23)
    mass, _, y, _, density, _ = sample(f"mass_{shape}", 23, seed=1)
    parts = [(solid, x, params), *[(mass, y, density)] * (len(coefficients) - 1)]
    terms = [(*part, c, -0.7 * c) for part, c in zip(parts, coefficients)]
    mask = np.zeros(X.size, dtype=np.uint8)
    mask[cells[0] * 2] = 1

    def made(some):
        op, right = k.Operator(False, 2, np.array([0, len(X)], dtype=np.int32), 0, "csr"), np.zeros(X.size)
        op.set_topology([cells])
        op.set_constraints(mask)
        op.begin()
        op.add(0, X, some, right)
        op.end()
        mat: PETSc.Mat = op.mat
        return mat.getValuesCSR()[2], right

    each = [made([term]) for term in terms]
    values, right = made(terms)
    np.testing.assert_allclose(values, sum(own for own, _ in each), rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(right, sum(own for _, own in each), rtol=1e-12, atol=1e-14)


def test_cells_and_nodes_that_do_not_exist_are_refused():
    e, X, x, cells, params, w = sample("stvk_tri3", 9)
    with pytest.raises(ValueError, match="subset names cell 9"):
        residual(e, X, x, cells, params, w, np.array([9], dtype=np.int32))
    wrong = cells.copy()
    wrong[8, 1] = len(X)
    with pytest.raises(ValueError, match="cell 8 names node"):
        residual(e, X, x, wrong, params, w)
