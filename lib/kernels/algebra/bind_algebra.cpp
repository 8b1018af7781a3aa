// Bindings of what PETSc is extended by.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stdexcept>
#include <vector>

#include "algebra/block_product.hpp"
#include "algebra/grid_cycle.hpp"
#include "algebra/node_cholesky.hpp"
#include "algebra/node_lu.hpp"
#include "algebra/node_relaxation.hpp"
#include "fem/operator.hpp"

namespace py = pybind11;

namespace {

using Indices = py::array_t<int32_t, py::array::c_style>;
using Reals = py::array_t<double, py::array::c_style>;
using restshape::check;

void set_schur_rows(intptr_t factor, const Indices& rows) {
    const std::vector<PetscInt> chosen(rows.data(), rows.data() + rows.size());
    IS is = nullptr;
    check(ISCreateGeneral(PETSC_COMM_SELF, static_cast<PetscInt>(chosen.size()), chosen.data(), PETSC_COPY_VALUES, &is),
          "ISCreateGeneral");
    check(MatFactorSetSchurIS(reinterpret_cast<Mat>(factor), is), "MatFactorSetSchurIS");
    check(ISDestroy(&is), "ISDestroy");
}

void schur_complement(intptr_t factor, Reals out) {
    Mat mat = reinterpret_cast<Mat>(factor), schur = nullptr;
    MatFactorSchurStatus status = MAT_FACTOR_SCHUR_UNFACTORED;
    check(MatFactorGetSchurComplement(mat, &schur, &status), "MatFactorGetSchurComplement");
    PetscInt rows = 0, columns = 0, stride = 0;
    check(MatGetSize(schur, &rows, &columns), "MatGetSize");
    if (out.ndim() != 2 || out.shape(0) != rows || out.shape(1) != columns)
        throw std::invalid_argument("out must be (k, k), k the rows that the factor leaves");
    check(MatDenseGetLDA(schur, &stride), "MatDenseGetLDA");
    const PetscScalar* value = nullptr;
    check(MatDenseGetArrayRead(schur, &value), "MatDenseGetArrayRead");
    for (PetscInt j = 0; j < columns; ++j)
        // A symmetric factor gives the lower triangle alone.
        for (PetscInt i = j; i < rows; ++i) *out.mutable_data(i, j) = *out.mutable_data(j, i) = value[j * stride + i];
    check(MatDenseRestoreArrayRead(schur, &value), "MatDenseRestoreArrayRead");
    check(MatFactorRestoreSchurComplement(mat, &schur, status), "MatFactorRestoreSchurComplement");
}

void border_complement(intptr_t factor, Reals out) {
    if (out.ndim() != 2 || out.shape(0) != out.shape(1)) throw std::invalid_argument("out must be square");
    check(restshape::border_complement(reinterpret_cast<Mat>(factor), out.mutable_data()), "border_complement");
}

using Half = PetscErrorCode (*)(Mat, const double*, double*);

// A half of a solution with unknowns that a factor keeps.
void half_solution(intptr_t handle, Half half, py::array_t<double, py::array::c_style> from, Reals to, bool forward) {
    Mat factor = reinterpret_cast<Mat>(handle);
    PetscInt n = 0, border = 0;
    check(MatGetSize(factor, &n, nullptr), "MatGetSize");
    check(restshape::kept_border(factor, &border), "kept_border");
    const py::ssize_t inside = n - border;
    if (from.ndim() != 1 || to.ndim() != 1 || from.size() != (forward ? inside : border) ||
        to.size() != (forward ? border : inside))
        throw std::invalid_argument("what is inside and on the border are all unknowns of the factor");
    check(half(factor, from.data(), to.mutable_data()), "a half of a solution");
}

}  // namespace

void bind_algebra(py::module_& m) {
    m.attr("node_blocks") = restshape::NODE_BLOCKS;
    m.def(
        "register_node_cholesky",
        [] { restshape::check(restshape::register_node_cholesky(), "MatSolverTypeRegister"); },
        "Make PETSc know the solver type NODE_BLOCKS: complete Cholesky factors in blocks of one node.");
    m.def(
        "keep_border",
        [](intptr_t factor, PetscInt unknowns, PetscInt fields) {
            restshape::check(restshape::keep_border(reinterpret_cast<Mat>(factor), unknowns, fields), "keep_border");
        },
        py::arg("factor"), py::arg("unknowns"), py::arg("fields"),
        "Have the factor with this handle, of NODE_BLOCKS and not made yet, keep the last unknowns, whole nodes of so "
        "many fields: they are no pivots, and 0 in solutions.");
    m.def("border_complement", &border_complement, py::arg("factor"), py::arg("out").noconvert(),
          "Writes the Schur complement (k, k) of the unknowns that a factor with this handle keeps; see keep_border.");
    m.def(
        "eliminate_inside",
        [](intptr_t factor, py::array_t<double, py::array::c_style> inside, Reals border) {
            half_solution(factor, restshape::eliminate_inside, inside, border, true);
        },
        py::arg("factor"), py::arg("inside").noconvert(), py::arg("border").noconvert(),
        "Writes what the equations of the unknowns that a factor with this handle keeps (k,) have on their right once "
        "the inside, whose right side is (n - k,), is eliminated; see keep_border.");
    m.def(
        "complete_inside",
        [](intptr_t factor, py::array_t<double, py::array::c_style> border, Reals inside) {
            half_solution(factor, restshape::complete_inside, border, inside, false);
        },
        py::arg("factor"), py::arg("border").noconvert(), py::arg("inside").noconvert(),
        "Writes the inside's unknowns (n - k,) after eliminate_inside, from those (k,) that the factor keeps.");
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
        "cycle_in_single",
        [](intptr_t pc) {
            PetscBool done = PETSC_FALSE;
            restshape::check(restshape::cycle_in_single(reinterpret_cast<PC>(pc), &done), "PCApply");
            return done == PETSC_TRUE;
        },
        py::arg("pc"),
        "Have the preconditioner with this handle, algebraic multigrid that has just been set up, go by V-cycles in "
        "single precision. Returns whether it does.");
    m.def(
        "forget_cycle",
        [](intptr_t pc) { restshape::check(restshape::forget_cycle(reinterpret_cast<PC>(pc)), "PetscObjectCompose"); },
        py::arg("pc"), "Let go of what cycle_in_single has made of the preconditioner with this handle.");
    m.def(
        "forget_failure",
        [](intptr_t pc) {
            restshape::check(PCSetFailedReason(reinterpret_cast<PC>(pc), PC_NOERROR), "PCSetFailedReason");
        },
        py::arg("pc"),
        "Let the next set-up of the preconditioner with this handle say itself whether it fails: PETSc's block Jacobi "
        "and "
        "additive Schwarz keep the failure of one block for ever.");
    m.def(
        "forget_products",
        [](intptr_t pc) { restshape::check(restshape::forget_products(reinterpret_cast<PC>(pc)), "MatProductClear"); },
        py::arg("pc"),
        "Free what multigrid with this handle keeps to make its coarse matrices again; it finds their patterns again.");
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
    m.def(
        "set_schur_rows", &set_schur_rows, py::arg("factor"), py::arg("rows").noconvert(),
        "Have the factor with this handle, of MUMPS's and not made yet, leave rows (k,) int32 out, which stay coupled "
        "by their Schur complement.");
    m.def("schur_complement", &schur_complement, py::arg("factor"), py::arg("out").noconvert(),
          "Writes the Schur complement (k, k) of the rows that a symmetric factor with this handle leaves out.");
}
