// Bindings of what PETSc is extended by.
#include <pybind11/pybind11.h>

#include "algebra/block_product.hpp"
#include "algebra/node_cholesky.hpp"
#include "algebra/node_lu.hpp"
#include "algebra/node_relaxation.hpp"
#include "fem/operator.hpp"

namespace py = pybind11;

void bind_algebra(py::module_& m) {
    m.attr("node_blocks") = restshape::NODE_BLOCKS;
    m.def(
        "register_node_cholesky",
        [] { restshape::check(restshape::register_node_cholesky(), "MatSolverTypeRegister"); },
        "Make PETSc know the solver type NODE_BLOCKS: complete Cholesky factors in blocks of one node.");
    m.attr("node_lu") = restshape::NODE_LU;
    m.attr("node_lu_single") = restshape::NODE_LU_SINGLE;
    m.def(
        "register_node_lu", [] { restshape::check(restshape::register_node_lu(), "MatSolverTypeRegister"); },
        "Make PETSc know the solver types NODE_LU and NODE_LU_SINGLE: complete LU factors in blocks of one node.");
    m.attr("node_ssor") = restshape::NODE_SSOR;
    m.def(
        "register_node_relaxation", [] { restshape::check(restshape::register_node_relaxation(), "KSPRegister"); },
        "Make PETSc know the KSP type NODE_SSOR: conjugate gradients with symmetric over-relaxation, in blocks of "
        "three "
        "unknowns a node, which read the matrix once an iteration.");
    m.def(
        "multiply_in_registers",
        [](intptr_t mat) {
            restshape::check(restshape::multiply_in_registers(reinterpret_cast<Mat>(mat)), "MatSetOperation");
        },
        py::arg("mat"),
        "Have products of the matrix with this handle, of type seqbaij in blocks of three or four unknowns a node, "
        "made "
        "with a column of a block in one register. Matrices of other types or sizes stay as they are.");
    m.def(
        "ended_at_zero",
        [](intptr_t factor) {
            MatFactorError error = MAT_FACTOR_NOERROR;
            restshape::check(MatFactorGetError(reinterpret_cast<Mat>(factor), &error), "MatFactorGetError");
            return error == MAT_FACTOR_NUMERIC_ZEROPIVOT;
        },
        py::arg("factor"), "Whether the factor with this handle ended at a pivot that is zero.");
}
