// Scalar products in the energy of a matrix: its entries are read once for all vectors.
#include <petscmat.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <stdexcept>
#include <vector>

#include "algebra/matrix_rows.hpp"

namespace py = pybind11;
using restshape::check;
using restshape::MatrixRows;
using Reals = py::array_t<double, py::array::c_style>;

namespace {

constexpr int lanes = 8;
using Lanes = Eigen::Array<double, lanes, 1>;

bool energy_products(intptr_t handle, const Reals& x, const Reals& b, const Reals& steps, Reals gram, Reals right) {
    Mat mat = reinterpret_cast<Mat>(handle);
    PetscBool plain = PETSC_FALSE;
    check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(mat), MATSEQAIJ, &plain), "PetscObjectTypeCompare");
    const int count = steps.ndim() == 2 ? static_cast<int>(steps.shape(0)) : 0;
    if (!plain || count + 1 > lanes) return false;
    const MatrixRows a(mat);
    if (!a.done) return false;
    if (count < 1 || steps.shape(1) != a.n || x.size() != a.n || b.size() != a.n || gram.size() != count * count ||
        right.size() != count)
        throw std::invalid_argument("x and b must be (n,), steps (m, n), gram (m, m), right (m,)");
    // Side by side, the steps and then x: a product with all of them is one with a register.
    std::vector<Lanes, Eigen::aligned_allocator<Lanes>> beside(a.n);
    for (PetscInt i = 0; i < a.n; ++i) {
        beside[i].setZero();
        for (int k = 0; k < count; ++k) beside[i][k] = steps.data()[k * static_cast<size_t>(a.n) + i];
        beside[i][count] = x.data()[i];
    }
    Lanes energies[lanes], forces = Lanes::Zero();
    for (Lanes& one : energies) one.setZero();
    for (PetscInt i = 0; i < a.n; ++i) {
        Lanes product = Lanes::Zero();
        for (PetscInt k = a.start[i]; k < a.start[i + 1]; ++k) product += a.value[k] * beside[a.column[k]];
        for (int k = 0; k < count; ++k) energies[k] += beside[i][k] * product;
        forces += (b.data()[i] - product[count]) * beside[i];
    }
    for (int k = 0; k < count; ++k) {
        right.mutable_data()[k] = forces[k];
        for (int l = 0; l < count; ++l) gram.mutable_data()[k * count + l] = energies[k][l];
    }
    check(PetscLogFlops(2.0 * static_cast<double>(a.start[a.n]) * (count + 1)), "PetscLogFlops");
    return true;
}

}  // namespace

void bind_increments(py::module_& m) {
    m.def("energy_products", &energy_products, py::arg("handle"), py::arg("x").noconvert(), py::arg("b").noconvert(),
          py::arg("steps").noconvert(), py::arg("gram").noconvert(), py::arg("right").noconvert(),
          "Writes steps . A steps into gram (m, m) and steps . (b - A x) into right (m,), of steps (m, n) and PETSc's "
          "matrix A with this handle, whose entries are read once. Returns whether it does: of matrices other than of "
          "one rank and by rows, and of more than seven steps, it writes nothing.");
}
