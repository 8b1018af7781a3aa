"""The operator against a dense assembly, cold topologies after random flips, and PETSc's own event counts."""

import numpy as np
import pytest
from petsc4py import PETSc
from sample_meshes import flip_edges, second_order, unit_box

from restshape import _kernels as k

HOOKE = np.array([1.3, 0.7, 0.8, 0.3, -0.9])
HOOKE_3D = np.array([1.3, 0.7, 0.3, -0.9, 0.2])


def operator(n: int, fields: int, backend: str = "csr"):
    return k.Operator(False, fields, np.array([0, n], dtype=np.int32), 0, backend)


def entries(op) -> np.ndarray:
    """All entries, dense."""
    mat = op.mat if op.mat.getType() == "seqaij" else op.mat.convert("aij", PETSc.Mat())
    start, column, value = mat.getValuesCSR()
    dense = np.zeros(op.mat.getSize())
    for i in range(len(start) - 1):
        dense[i, column[start[i] : start[i + 1]]] = value[start[i] : start[i + 1]]
    return dense


def filled(op, element: str, X, x, params, coef=1.0, block=0) -> np.ndarray:
    rhs = np.zeros(X.shape[0] * k.Element(element).fields)
    op.begin()
    op.add(block, X, [(k.Element(element), x, params, coef)], rhs)
    op.end()
    return rhs


def reference(element: str, X, x, cells, params, constrained) -> tuple[np.ndarray, np.ndarray]:
    """Matrix and right side by adding up the cells' blocks, then eliminating rows and columns."""
    e = k.Element(element)
    params = np.broadcast_to(params, (len(cells), len(e.parameters)))
    K, diagonal = np.zeros((X.shape[0] * e.fields,) * 2), np.zeros(X.shape[0] * e.fields)
    for cell, p in zip(cells, params):
        block = e.tangent_block(X[cell], x[cell], p)
        dofs = (cell[:, None] * e.fields + np.arange(e.fields)).ravel()
        K[np.ix_(dofs, dofs)] += block
        diagonal[dofs] += np.abs(np.diag(block))
    residual = np.zeros_like(x)
    e.residual(X, x, cells, params, residual)
    fixed = constrained.astype(bool)
    K[fixed], K[:, fixed] = 0.0, 0.0
    K[fixed, fixed] = diagonal[fixed]
    return K, np.where(fixed, 0.0, -residual.ravel())


PLATE = np.array([2.0, 0.5, 1.5, 0.1, -0.2, 0.6, 0.4, 0.1, 0.5, 3.0, 0.2, 1.0, 0.0, 1.0])


def plate_of(box: tuple[np.ndarray, np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The same nodes with a thickness as a third coordinate."""
    X, cells, inner = box
    return np.column_stack([X, 0.2 + 0.1 * X[:, 0]]), cells, inner


CASES = {
    "linear_elastic_tri3": (lambda: unit_box(2, 6), HOOKE),
    "linear_elastic_tri6": (lambda: second_order(*unit_box(2, 4), bend=0.02), HOOKE),
    "linear_elastic_tet4": (lambda: unit_box(3, 3), HOOKE_3D),
    "linear_elastic_tet10": (lambda: second_order(*unit_box(3, 2)), HOOKE_3D),
    "stvk_tri3": (lambda: unit_box(2, 6), HOOKE),
    "stvk_tri6": (lambda: second_order(*unit_box(2, 4), bend=0.02), HOOKE),
    "stvk_tet10": (lambda: second_order(*unit_box(3, 2)), HOOKE_3D),
    "stvk_dilatation_tri6": (lambda: second_order(*unit_box(2, 4), bend=0.02), HOOKE),
    "anisotropic_tet10": (
        lambda: second_order(*unit_box(3, 2), bend=0.02),
        np.array([*np.diag(np.arange(1.0, 7.0))[np.triu_indices(6)], 0.3, -0.9, 0.2]),
    ),
    "plate_tri3": (lambda: plate_of(unit_box(2, 5)), PLATE),
    "mass_plate_tri3": (lambda: plate_of(unit_box(2, 5)), PLATE),
    "mass_tet4": (lambda: unit_box(3, 3), np.array([2.0])),
    "mass_tet10": (lambda: second_order(*unit_box(3, 2)), np.array([2.0])),
    "mass_tri3": (lambda: unit_box(2, 5), np.array([2.0])),
    "mass_tri6": (lambda: second_order(*unit_box(2, 4), bend=0.02), np.array([2.0])),
    "lumped_mass_tri6": (lambda: second_order(*unit_box(2, 4), bend=0.02), np.array([2.0])),
}


@pytest.mark.parametrize("backend", ["csr", "bcsr"])
@pytest.mark.parametrize("name", CASES)
def test_matrix_and_right_side_equal_a_dense_assembly(name, backend):
    (X, cells, _), params = CASES[name][0](), CASES[name][1]
    element = k.Element(name)
    rng = np.random.default_rng(2)
    x = 0.05 * rng.uniform(-1, 1, (len(X), element.fields))
    params = params * rng.uniform(0.9, 1.1, (len(cells), 1))
    constrained = (rng.random(len(X) * element.fields) < 0.15).astype(np.uint8)
    op = operator(len(X), element.fields, backend)
    op.set_constraints(constrained)
    op.set_topology([cells])
    rhs = filled(op, name, X, x, params)
    K, expected_rhs = reference(name, X, x, cells, params, constrained)
    np.testing.assert_allclose(entries(op), K, rtol=0, atol=1e-14 * np.abs(K).max())
    np.testing.assert_allclose(rhs, expected_rhs, rtol=0, atol=1e-14)
    np.testing.assert_allclose(entries(op), entries(op).T, rtol=0, atol=1e-15 * np.abs(K).max())


def test_backends_agree_and_repeat_bit_for_bit():
    X, cells, _ = unit_box(2, 12)
    x = np.zeros_like(X)
    results = {}
    for backend in ("csr", "bcsr"):
        op = operator(len(X), 2, backend)
        op.set_topology([cells])
        op.set_constraints(np.arange(2 * len(X), dtype=np.uint8) < 26)
        filled(op, "linear_elastic_tri3", X, x, HOOKE)
        results[backend] = entries(op)
        filled(op, "linear_elastic_tri3", X, x, HOOKE)
        assert np.array_equal(entries(op), results[backend])
    # Of a symmetric tangent blocks take the other half, which is the same up to rounding.
    assert np.array_equal(results["bcsr"], results["csr"].T)


@pytest.mark.parametrize("odd", [False, True])
def test_products_of_pairs_are_those_of_petsc(odd):
    """To the last bit where PETSc rounds each product, as the distribution's does."""
    X, cells, _ = unit_box(2, 7)
    rng = np.random.default_rng(3)
    # Rows of other lengths, from one pair on, whose numbers differ by much.
    cells = cells[rng.permutation(len(cells))[: len(cells) // 2]] if odd else cells
    op = operator(len(X), 2)
    op.set_topology([cells])
    filled(op, "linear_elastic_tri3", X, np.zeros_like(X), HOOKE)
    own = PETSc.Mat().createAIJ(op.mat.getSizes(), csr=op.mat.getValuesCSR(), comm=PETSc.COMM_SELF)
    x, added = (op.mat.createVecRight() for _ in "xa")
    for vector in (x, added):
        vector.setArray(rng.standard_normal(vector.size) * 10.0 ** rng.integers(-4, 4, vector.size))
    found, wanted = [], []
    for mat, values in ((op.mat, found), (own, wanted)):
        sums = added.copy()
        mat.multAdd(x, sums, sums)
        values += [(mat * x).array, sums.array]
        mat.multAdd(x, added, sums)
        values.append(sums.array)
    sizes = abs(entries(op)) @ abs(x.array) + abs(added.array)
    assert np.all(np.abs(np.subtract(found, wanted)) <= 4.0 * np.finfo(float).eps * sizes)


def test_relaxation_in_blocks_takes_in_new_values():
    """PETSc keeps the inverses of diagonal blocks, and must be notified that they are of another matrix."""
    X, cells, _ = unit_box(2, 6)
    x = np.zeros_like(X)
    op = operator(len(X), 2, "bcsr")
    op.set_topology([cells])
    op.set_constraints(np.arange(X.size, dtype=np.uint8) < 14)
    rhs, way = op.mat.createVecs()
    rhs.setArray(np.random.default_rng(3).uniform(-1, 1, X.size))
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setType("sor")
    found = []
    for coef in (1.0, 4.0):
        filled(op, "linear_elastic_tri3", X, x, HOOKE, coef)
        pc.setOperators(op.mat)
        pc.setUp()
        pc.apply(rhs, way)
        found.append(way.getArray().copy())
    assert found[0] == pytest.approx(4.0 * found[1], rel=1e-12)
    pc.destroy()


@pytest.mark.parametrize("backend", ["csr", "bcsr"])
def test_blocks_and_coefficients_add_up(backend):
    """Newmark's matrix K + c M with residual K u + M a, and a load on one side, which has no tangent."""
    X, cells, _ = unit_box(2, 5)
    rng = np.random.default_rng(8)
    u, a = rng.uniform(-1, 1, (2, len(X), 2)) * 0.01
    bottom = np.flatnonzero(X[:, 1] == 0)
    facets = np.column_stack([bottom[:-1], bottom[1:]]).astype(np.int32)
    pressure = np.array([0, 0, 0, 0, 2.0, 2.0, 0.8])
    fixed = np.zeros(2 * len(X), dtype=np.uint8)
    fixed[:2] = 1
    op = operator(len(X), 2, backend)
    op.set_topology([cells, facets])
    op.set_constraints(fixed)
    rhs = np.zeros(2 * len(X))
    op.begin()
    solid, mass = k.Element("linear_elastic_tri3"), k.Element("mass_tri3")
    op.add(0, X, [(solid, u, HOOKE, 1.0), (mass, a, np.array([2.0]), 40.0, 1.0)], rhs)
    op.add(1, X, [(k.Element("traction_edge2"), u, pressure, 1.0)], rhs)
    op.end()
    K, rhs_K = reference("linear_elastic_tri3", X, u, cells, HOOKE, fixed)
    M, rhs_M = reference("mass_tri3", X, a, cells, np.array([2.0]), fixed)
    load = np.zeros_like(X)
    load[bottom[[0, -1]], 1] = 2.0 * 0.8 / 5 / 2
    load[bottom[1:-1], 1] = 2.0 * 0.8 / 5
    expected = K + 40 * M
    np.testing.assert_allclose(entries(op), expected, rtol=0, atol=1e-14 * np.abs(expected).max())
    np.testing.assert_allclose(rhs, rhs_K + rhs_M + np.where(fixed, 0, load.ravel()), rtol=0, atol=1e-14)


@pytest.mark.parametrize("backend", ["csr", "bcsr"])
@pytest.mark.parametrize("order", [1, 2])
def test_follower_pressure_is_a_block_of_its_own_that_outlives_flips(order, backend):
    """Its tangent is not symmetric: rows are residuals, columns unknowns. Flips touch the block of cells only."""
    X, cells, _ = unit_box(2, 6)
    corners = cells
    if order == 2:
        X, cells, _ = second_order(X, cells, np.empty(0, dtype=int))
    bottom = np.flatnonzero(X[:, 1] == 0)
    bottom = bottom[np.argsort(X[bottom, 0])]
    starts = range(0, 6 * order, order)
    facets = np.array([[bottom[i], bottom[i + order], *bottom[i + 1 : i + order]] for i in starts], dtype=np.int32)
    rng = np.random.default_rng(5)
    u = 0.02 * rng.uniform(-1, 1, X.shape)
    fixed = (rng.random(X.size) < 0.1).astype(np.uint8)
    pressure = rng.uniform(1, 2, (len(facets), 3))
    solid, follower = f"stvk_tri{3 * order}", f"pressure_edge{order + 1}"
    op = operator(len(X), 2, backend)
    op.set_topology([cells, facets])
    op.set_constraints(fixed)
    for _ in range(3):
        rhs = np.zeros(X.size)
        op.begin()
        op.add(0, X, [(k.Element(solid), u, HOOKE, 1.0)], rhs)
        op.add(1, X, [(k.Element(follower), u, pressure, 1.0)], rhs)
        op.end()
        K, expected = reference(solid, X, u, cells, HOOKE, fixed)
        P, more = reference(follower, X, u, facets, pressure, fixed)
        assert np.abs(P - P.T).max() > 0.1
        np.testing.assert_allclose(entries(op), K + P, rtol=0, atol=1e-14 * np.abs(K).max())
        np.testing.assert_allclose(rhs, expected + more, rtol=0, atol=1e-14)
        changed = flip_edges(X, cells, 4, rng) if order == 1 else flip_second_order(X, cells, corners, 4, rng)
        assert len(changed)
        op.patch(0, changed)


def flip_second_order(X, cells, corners, count, rng) -> np.ndarray:
    """Flips inner edges of second-order cells in place, the mid-side node of each moved to its new middle."""
    before = corners.copy()
    changed = flip_edges(X, corners, count, rng)
    for left, right in zip(changed[::2], changed[1::2]):
        sides = {}
        for e, old in ((left, before[left]), (right, before[right])):
            for s in range(3):
                sides[frozenset((old[s], old[(s + 1) % 3]))] = cells[e, 3 + s]
        for e in (left, right):
            cells[e, :3] = corners[e]
        diagonal = sides.pop(frozenset(before[left]) & frozenset(before[right]))
        for e in (left, right):
            for s in range(3):
                ends = (corners[e, s], corners[e, (s + 1) % 3])
                cells[e, 3 + s] = sides.get(frozenset(ends), diagonal)
                if frozenset(ends) not in sides:
                    X[diagonal] = X[list(ends)].mean(axis=0)
    return changed


@pytest.mark.parametrize("backend", ["csr", "bcsr"])
@pytest.mark.parametrize("seed", range(5))
def test_patched_operator_equals_a_cold_one(seed, backend):
    X, cells, _ = unit_box(2, 9)
    side = np.flatnonzero(X[:, 0] == 0)
    facets = np.column_stack([side[:-1], side[1:]]).astype(np.int32)
    fixed = np.zeros(2 * len(X), dtype=np.uint8)
    fixed[2 * side[:4]] = 1
    rng = np.random.default_rng(seed)
    x = 0.01 * rng.uniform(-1, 1, X.shape)
    warm = operator(len(X), 2, backend)
    warm.set_topology([cells, facets])
    warm.set_constraints(fixed)
    for _ in range(6):
        changed = flip_edges(X, cells, int(rng.integers(1, 12)), rng)
        assert len(changed)
        warm.patch(0, changed)
        cold = operator(len(X), 2, "csr")
        cold.set_topology([cells, facets])
        cold.set_constraints(fixed)
        rhs = filled(warm, "linear_elastic_tri3", X, x, HOOKE)
        np.testing.assert_allclose(rhs, filled(cold, "linear_elastic_tri3", X, x, HOOKE), rtol=0, atol=1e-15)
        K = entries(cold)
        np.testing.assert_allclose(entries(warm), K, rtol=1e-13, atol=1e-15 * np.abs(K).max())


def test_patch_keeps_old_pairs_and_makes_a_matrix_only_for_new_ones():
    X, cells, _ = unit_box(2, 6)
    op = operator(len(X), 2)
    op.set_topology([cells])
    before, start = op.nnz, cells.copy()
    old = op.mat
    generation = op.generation
    changed = flip_edges(X, cells, 1, np.random.default_rng(1))
    op.patch(0, changed)
    assert op.generation == generation + 1 and op.nnz == before + 2 * 4
    assert old.norm() == 0.0  # still whole, though another matrix has taken over
    columns = op.mat.getValuesCSR()
    assert all(np.all(np.diff(columns[1][a:b]) > 0) for a, b in zip(columns[0], columns[0][1:]))
    cells[changed] = start[changed]
    op.patch(0, changed)
    assert op.generation == generation + 1 and op.nnz == before + 2 * 4
    op.set_topology([cells])
    assert op.nnz == before


def test_matrix_is_a_petsc4py_matrix_with_references_that_balance():
    X, cells, _ = unit_box(2, 3)
    op = operator(len(X), 2)
    op.set_topology([cells])
    mat = op.mat
    assert mat.handle == op.handle and mat.getRefCount() == 2 and mat.getBlockSize() == 2
    del op
    assert mat.getRefCount() == 1
    assert mat.norm() == 0.0


def test_thousand_topologies_do_not_grow_the_process():
    X, cells, _ = unit_box(2, 12)
    op = operator(len(X), 2)
    rng = np.random.default_rng(0)

    def resident() -> int:
        with open("/proc/self/statm") as f:
            return int(f.read().split()[1]) * 4

    changed = flip_edges(X, cells, 5, rng)
    flipped, straight = cells[changed].copy(), unit_box(2, 12)[1][changed]
    sizes = []
    for repeat in range(1000):
        cells[changed] = straight
        op.set_topology([cells])
        cells[changed] = flipped
        op.patch(0, changed)
        mat = op.mat
        assert mat.getSize()[0] == 2 * len(X)
        if repeat in (99, 999):
            sizes.append(resident())
    assert sizes[1] - sizes[0] < 1024  # KiB


def test_new_values_log_no_pattern():
    X, cells, _ = unit_box(2, 5)
    PETSc.Log.begin()
    op = operator(len(X), 2)

    def counts():
        return [
            PETSc.Log.Event(name).getPerfInfo()["count"]
            for name in ("RestshapePattern", "RestshapePatch", "RestshapeValues")
        ]

    before = counts()
    op.set_topology([cells])
    for _ in range(3):
        filled(op, "linear_elastic_tri3", X, np.zeros_like(X), HOOKE)
    op.patch(0, flip_edges(X, cells, 1, np.random.default_rng(3)))
    assert [b - a for a, b in zip(before, counts())] == [1, 1, 3]


def test_supported_node_without_elements_keeps_a_regular_row():
    X = np.array([[0.0, 0], [1, 0], [0, 1], [5, 5]])
    cells = np.array([[0, 1, 2]], dtype=np.int32)
    for backend in ("csr", "bcsr"):
        op = operator(4, 2, backend)
        op.set_topology([cells])
        op.set_constraints(np.array([0, 0, 0, 0, 0, 0, 1, 1], dtype=np.uint8))
        filled(op, "linear_elastic_tri3", X, np.zeros_like(X), HOOKE)
        np.testing.assert_array_equal(entries(op)[6:, 6:], np.eye(2))


def test_bad_use_is_refused():
    X, cells, _ = unit_box(2, 3)
    op = operator(len(X), 2)
    with pytest.raises(RuntimeError, match="set_topology"):
        op.begin()
    with pytest.raises(ValueError, match="int32"):
        op.set_topology([cells.astype(np.int64)])
    with pytest.raises(ValueError, match="does not exist"):
        op.set_topology([cells + 5])
    with pytest.raises(ValueError, match="there are csr, bcsr"):
        operator(3, 2, "dense")
    op.set_topology([cells])
    with pytest.raises(ValueError, match="does not exist"):
        op.patch(0, np.array([len(cells)], dtype=np.int32))
    with pytest.raises(RuntimeError, match="begin before add"):
        op.add(0, X, [(k.Element("linear_elastic_tri3"), 0 * X, HOOKE, 1.0)])
    op.begin()
    with pytest.raises(ValueError, match="nodes"):
        op.add(0, X, [(k.Element("traction_edge2"), 0 * X, np.zeros(7), 1.0)])
    with pytest.raises(ValueError, match="not in the topology"):
        op.add(1, X, [(k.Element("linear_elastic_tri3"), 0 * X, HOOKE, 1.0)])


def test_flips_that_no_patch_names_are_noticed():
    X, cells, _ = unit_box(2, 4)
    op = operator(len(X), 2)
    op.set_topology([cells])
    changed = flip_edges(X, cells, 8, np.random.default_rng(0))
    with pytest.raises(RuntimeError, match="no patch has named it"):
        op.patch(0, changed[:2])
    op.set_topology([cells])
    filled(op, "linear_elastic_tri3", X, np.zeros_like(X), HOOKE)
    K, _ = reference("linear_elastic_tri3", X, np.zeros_like(X), cells, HOOKE, np.zeros(2 * len(X)))
    np.testing.assert_allclose(entries(op), K, rtol=0, atol=1e-14)
