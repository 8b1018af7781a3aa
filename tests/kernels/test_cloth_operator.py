"""One matrix for cloth: membrane, bending and contact in one pattern, against the sum of their elements."""

import numpy as np
import pytest
from cloth_parameters import membrane_params
from element_case import taylor_slope
from petsc4py import PETSc
from sample_meshes import unit_box

from restshape import _kernels as k
from restshape.algebra.operator import Operator
from restshape.mesh.hinges import hinges
from restshape.mesh.mesh import edges_of_cells
from restshape.physics.cloth.contact.contact import Contact
from restshape.physics.cloth.sheet.parameters import lumped
from restshape.physics.elasticity.stiffness import isotropic, plane_stress

C = plane_stress(isotropic(2.0, 0.3))
SPHERE = k.Body.sphere([0.5, 0.5, -0.9], 1.0)


class Cloth:
    """A sheet over a sphere: its blocks and their terms."""

    def __init__(self, bending: str) -> None:
        X, cells, _ = unit_box(2, 5)
        edge_nodes, cell_edges = edges_of_cells(cells, len(X))
        corners = len(X)
        if bending == "morley_tri6":
            sides = (corners + cell_edges[:, [2, 0, 1]]).astype(np.int32)
            bent = np.ascontiguousarray(np.hstack([cells, sides]))
            signs = np.where(cells == edge_nodes[cell_edges[:, [2, 0, 1]], 0], 1.0, -1.0)
            moduli = np.tile(membrane_params(0.01 * C)[:6], (len(cells), 1))
            params = np.hstack([moduli, signs])
            X = np.vstack([X, X[edge_nodes].mean(axis=1)])
        else:
            bent, params = hinges(cells, cell_edges), np.array([0.01])
        self.X, self.corners = X, corners
        self.contact = Contact([SPHERE], lumped(X, cells), 50.0, 0.1, friction=0.3, slip=0.5)
        nodes = np.arange(corners, dtype=np.int32)[:, None]
        self.blocks = [cells, bent, np.ascontiguousarray(nodes)]
        self.elements = [k.Element("membrane_tri3"), k.Element(bending), k.Element("potential_point1")]
        self.params = [membrane_params(C, (0.0, 0.0, -0.1)), params, None]
        self.rng = np.random.default_rng(4)
        self.x = np.column_stack([X, np.zeros(len(X))]) + 0.05 * self.rng.uniform(-1, 1, (len(X), 3))
        self.contact.update_friction(self.x)

    def terms(self, x):
        energy, table = self.contact.potential(x)
        return energy, zip(self.blocks, self.elements, [*self.params[:2], table[: self.corners]])

    def energy(self, x) -> float:
        energy, terms = self.terms(x)
        return energy + sum(e.energy(self.X, x, cells, p).sum() for cells, e, p in list(terms)[:2])

    def residual(self, x) -> np.ndarray:
        out = np.zeros_like(x)
        for cells, element, p in self.terms(x)[1]:
            element.residual(self.X, x, cells, p, out)
        return out

    def operator(self) -> k.Operator:
        op = k.Operator(world=False, fields=3, node_offsets=np.array([0, len(self.X)], dtype=np.int32))
        op.set_topology(self.blocks)
        return op

    def assemble(self, op, x) -> np.ndarray:
        rhs = np.zeros(x.size)
        op.begin()
        for block, (_, element, p) in enumerate(self.terms(x)[1]):
            op.add(block, self.X, [(element, x, p, 1.0)], rhs)
        op.end()
        return rhs


def times(op: k.Operator, v: np.ndarray) -> np.ndarray:
    """The matrix times v."""
    out = np.empty(v.size)
    op.mat.mult(PETSc.Vec().createWithArray(v.ravel().copy()), PETSc.Vec().createWithArray(out))
    return out


@pytest.mark.parametrize("bending", ["hinge_flap4", "hinge_nonlinear_flap4", "morley_tri6"])
class TestTotal:
    def test_residual_is_the_gradient_of_the_energy(self, bending):
        cloth = Cloth(bending)
        v = cloth.rng.uniform(-1, 1, cloth.x.shape)
        slope = taylor_slope(lambda h: cloth.energy(cloth.x + h * v), np.sum(cloth.residual(cloth.x) * v), step=1e-3)
        assert slope > 1.9

    def test_matrix_is_the_derivative_of_the_residual(self, bending):
        cloth = Cloth(bending)
        op = cloth.operator()
        rhs = cloth.assemble(op, cloth.x)
        np.testing.assert_allclose(rhs, -cloth.residual(cloth.x).ravel(), atol=1e-13)
        v, w = cloth.rng.uniform(-1, 1, (2, *cloth.x.shape))
        np.testing.assert_allclose(w.ravel() @ times(op, v), v.ravel() @ times(op, w), rtol=1e-10)
        slope = taylor_slope(lambda h: cloth.residual(cloth.x + h * v).ravel(), times(op, v), step=1e-3)
        assert slope > 1.9

    def test_pattern_stays(self, bending):
        cloth = Cloth(bending)
        op = cloth.operator()
        cloth.assemble(op, cloth.x)
        before = op.generation, op.nnz
        cloth.assemble(op, cloth.x + 0.1)
        assert (op.generation, op.nnz) == before


@pytest.mark.parametrize("backend", ["csr", "bcsr"])
class TestKept:
    """Bending assembled once, against all of it assembled again."""

    def both(self, backend, mask):
        cloth = Cloth("morley_tri6")
        terms = [
            (block, element, cloth.X, cloth.x, p, 1.0) for block, (_, element, p) in enumerate(cloth.terms(cloth.x)[1])
        ]
        op = Operator(PETSc.COMM_SELF, 3, np.array([0, len(cloth.X)], dtype=np.int32), backend)
        op.set_topology(cloth.blocks, mask(cloth))
        whole = op.assemble(terms, None).copy()
        op.keep(terms[1:2])
        return op, [terms[0], terms[2]], whole

    @pytest.mark.parametrize("held", [0, 7])
    def test_matrix_is_the_whole_one(self, backend, held):
        op, rest, whole = self.both(backend, lambda cloth: np.arange(cloth.x.size) < 3 * held)
        for _ in range(2):
            difference = op.assemble(rest, None, kept=True).copy()
            difference.axpy(-1.0, whole)
            assert difference.norm() < 1e-14 * whole.norm()

    def test_new_constraints_forget_it(self, backend):
        op, rest, _ = self.both(backend, lambda cloth: np.zeros(cloth.x.size))
        op.set_constraints(np.ones(3 * len(rest[0][2])))
        with pytest.raises(RuntimeError, match="keeps no values"):
            op.assemble(rest, None, kept=True)
