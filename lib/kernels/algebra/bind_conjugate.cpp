// Some steps of conjugate gradients with PETSc's matrix and preconditioner, for what needs no more than an estimate.
#include <petsc/private/petscimpl.h>
#include <petscpc.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "algebra/matrix_rows.hpp"

namespace py = pybind11;
using restshape::check;
using Reals = py::array_t<double, py::array::c_style>;

namespace {

// An array of the process that PETSc sees as a vector of one rank.
class Wrapped {
 public:
    Wrapped(MPI_Comm comm, py::ssize_t n) : own_(n, 0.0) {
        check(VecCreateSeqWithArray(comm, 1, static_cast<PetscInt>(n), own_.data(), &vector_), "VecCreateSeqWithArray");
    }
    ~Wrapped() { (void)VecDestroy(&vector_); }
    Wrapped(const Wrapped&) = delete;
    Wrapped& operator=(const Wrapped&) = delete;

    std::vector<double>& numbers() {
        // PETSc keeps norms of a vector until it is notified of other numbers.
        (void)PetscObjectStateIncrease(reinterpret_cast<PetscObject>(vector_));
        return own_;
    }
    const std::vector<double>& read() const { return own_; }
    Vec vector() const { return vector_; }

 private:
    std::vector<double> own_;
    Vec vector_ = nullptr;
};

double dot(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

bool conjugate_steps(intptr_t mat_handle, intptr_t pc_handle, const Reals& right, Reals out, double known, int delay,
                     double enough, int most) {
    Mat mat = reinterpret_cast<Mat>(mat_handle);
    PC pc = reinterpret_cast<PC>(pc_handle);
    const py::ssize_t n = right.size();
    PetscInt rows = 0;
    check(MatGetSize(mat, &rows, nullptr), "MatGetSize");
    if (out.size() != n || rows != n) throw std::invalid_argument("right and out must have a number for each row");
    MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(mat));
    Wrapped residual(comm, n), step(comm, n), force(comm, n), z(comm, n);
    double* found = out.mutable_data();
    std::fill(found, found + n, 0.0);
    std::copy_n(right.data(), n, residual.numbers().begin());
    check(PCApply(pc, residual.vector(), step.vector()), "PCApply");
    double weight = dot(residual.read(), step.read()), all = known;
    std::vector<double> gains;
    for (int k = 0; k < most; ++k) {
        check(MatMult(mat, step.vector(), force.vector()), "MatMult");
        const double stiffness = dot(step.read(), force.read());
        if (!(weight > 0.0 && stiffness > 0.0)) return true;
        const double length = weight / stiffness;
        std::vector<double>& rest = residual.numbers();
        for (py::ssize_t i = 0; i < n; ++i) {
            found[i] += length * step.read()[i];
            rest[i] -= length * force.read()[i];
        }
        gains.push_back(length * weight);
        all += gains.back();
        const auto last = gains.end() - std::min<std::ptrdiff_t>(delay, static_cast<std::ptrdiff_t>(gains.size()));
        if (delay && std::accumulate(last, gains.end(), 0.0) <= enough * all) return true;
        check(PCApply(pc, residual.vector(), z.vector()), "PCApply");
        const double before = weight;
        weight = dot(residual.read(), z.read());
        if (!delay && 0.0 <= weight && weight <= enough * all) {
            for (py::ssize_t i = 0; i < n; ++i) found[i] += z.read()[i];
            return true;
        }
        std::vector<double>& way = step.numbers();
        for (py::ssize_t i = 0; i < n; ++i) way[i] = z.read()[i] + weight / before * way[i];
    }
    return false;
}

}  // namespace

void bind_conjugate(py::module_& m) {
    m.def("conjugate_steps", &conjugate_steps, py::arg("mat"), py::arg("pc"), py::arg("right").noconvert(),
          py::arg("out").noconvert(), py::arg("known"), py::arg("delay"), py::arg("enough"), py::arg("most"),
          "Writes about the solution (n,) for a right side (n,) to out: steps of conjugate gradients from 0, with "
          "handles "
          "of PETSc's matrix and preconditioner of one rank, until the gains of the last `delay` are at most the share "
          "`enough` of all and `known`; without a delay the last step is the preconditioned residual. Returns whether "
          "`most` steps suffice.");
}
