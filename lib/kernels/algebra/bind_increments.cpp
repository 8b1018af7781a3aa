// Guesses from solutions before: sums of vectors in one pass over them, and scalar products in the energy of a matrix,
// whose entries are read once for all vectors.
#include <petscmat.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <algorithm>
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

void weighted_sum(const py::list& weights, const py::list& rows, Reals out) {
    constexpr size_t most = 16;
    constexpr py::ssize_t strip = 512;  // numbers that stay in the first cache
    const size_t count = rows.size();
    if (weights.size() != count || count > most)
        throw std::invalid_argument("rows must be as many as weights, at most 16");
    double weight[most];
    const double* from[most];
    std::vector<Reals> kept;  // a row that is not contiguous is copied: it lives until the sum is made
    kept.reserve(count);
    for (size_t k = 0; k < count; ++k) {
        kept.push_back(py::cast<Reals>(rows[k]));
        if (kept.back().size() != out.size()) throw std::invalid_argument("rows must have the size of out");
        from[k] = kept.back().data();
        weight[k] = py::cast<double>(weights[k]);
    }
    double *to = out.mutable_data(), sum[strip];
    for (py::ssize_t start = 0; start < out.size(); start += strip) {
        const py::ssize_t size = std::min(strip, out.size() - start);
        std::fill(sum, sum + size, 0.0);
        for (size_t k = 0; k < count; ++k) {
            const double own = weight[k], *row = from[k] + start;
            for (py::ssize_t i = 0; i < size; ++i) sum[i] += own * row[i];
        }
        std::copy(sum, sum + size, to + start);
    }
}

bool take_increment(const Reals& now, Reals last, Reals step) {
    const py::ssize_t n = now.size();
    if (last.size() != n || step.size() != n) throw std::invalid_argument("now, last and step must have one size");
    const double* to = now.data();
    double *before = last.mutable_data(), *way = step.mutable_data();
    bool moved = false;
    for (py::ssize_t i = 0; i < n; ++i) {
        way[i] = to[i] - before[i];
        before[i] = to[i];
        moved |= way[i] != 0.0;
    }
    return moved;
}

}  // namespace

void bind_increments(py::module_& m) {
    m.def("weighted_sum", &weighted_sum, py::arg("weights"), py::arg("rows"), py::arg("out").noconvert(),
          "Writes the sum of at most 16 rows, arrays of one size, times as many weights to out, which may be one of "
          "them.");
    m.def("take_increment", &take_increment, py::arg("now").noconvert(), py::arg("last").noconvert(),
          py::arg("step").noconvert(),
          "Writes now - last to step, and then now to last, all of one size; whether a number has changed.");
    m.def("energy_products", &energy_products, py::arg("handle"), py::arg("x").noconvert(), py::arg("b").noconvert(),
          py::arg("steps").noconvert(), py::arg("gram").noconvert(), py::arg("right").noconvert(),
          "Writes steps . A steps into gram (m, m) and steps . (b - A x) into right (m,), of steps (m, n) and PETSc's "
          "matrix A with this handle, whose entries are read once. Returns whether it does: of matrices other than of "
          "one rank and by rows, and of more than seven steps, it writes nothing.");
}
