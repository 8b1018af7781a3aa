// Bindings of a correction of old factors around edges that have been flipped since.
//
// A symmetric multiplicative Schwarz method of two subspaces: the unknowns of nodes around flips, solved for with the
// matrix as it is, and all unknowns, with the old factor. Source: J. Xu, Iterative methods by space decomposition and
// subspace correction, SIAM Review 34 (1992) 581.
#include <petscmat.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <memory>
#include <stdexcept>
#include <vector>

#include "algebra/node_cholesky.hpp"
#include "fem/operator.hpp"

namespace py = pybind11;
using restshape::check;

namespace {

constexpr const char* key = "restshape_correction";
using Solve = PetscErrorCode (*)(Mat, Vec, Vec);

PetscErrorCode solve(Mat factor, Vec b, Vec x);

// The matrix at chosen unknowns: its rows, and the factor of the block between them.
class Correction {
 public:
    Correction(PetscInt n, Solve own) : own_(own), place_(n, -1) {
        check(VecCreateSeq(PETSC_COMM_SELF, n, &right_), "VecCreateSeq");
    }
    ~Correction() { (void)VecDestroy(&right_); }
    Correction(const Correction&) = delete;
    Correction& operator=(const Correction&) = delete;

    Solve own() const { return own_; }

    // Whether the block has a factor. The nodes ascend.
    bool set(Mat mat, const int32_t* nodes, py::ssize_t count, PetscInt fields) {
        for (const PetscInt row : unknowns_) place_[row] = -1;
        unknowns_.clear();
        for (py::ssize_t k = 0; k < count; ++k)
            for (PetscInt f = 0; f < fields; ++f) {
                place_[nodes[k] * fields + f] = static_cast<PetscInt>(unknowns_.size());
                unknowns_.push_back(nodes[k] * fields + f);
            }
        take_rows(mat);
        inner_.compute(block_);
        return inner_.info() == Eigen::Success;
    }

    PetscErrorCode apply(Mat factor, Vec b, Vec x) {
        const double* given = nullptr;
        double* to = nullptr;
        PetscFunctionBegin;
        PetscCall(VecCopy(b, right_));
        PetscCall(VecGetArrayRead(b, &given));
        for (size_t k = 0; k < unknowns_.size(); ++k) local_[k] = given[unknowns_[k]];
        PetscCall(VecRestoreArrayRead(b, &given));
        first_ = inner_.solve(local_);
        // The matrix is symmetric: its rows are its columns.
        PetscCall(VecGetArray(right_, &to));
        for (size_t k = 0; k < unknowns_.size(); ++k)
            for (PetscInt j = starts_[k]; j < starts_[k + 1]; ++j) to[columns_[j]] -= values_[j] * first_[k];
        PetscCall(VecRestoreArray(right_, &to));
        PetscCall(own_(factor, right_, x));
        PetscCall(VecGetArray(x, &to));
        for (size_t k = 0; k < unknowns_.size(); ++k) {
            double force = 0.0;
            for (PetscInt j = starts_[k]; j < starts_[k + 1]; ++j) force += values_[j] * to[columns_[j]];
            local_[k] = -force;
        }
        first_ += inner_.solve(local_);
        for (size_t k = 0; k < unknowns_.size(); ++k) to[unknowns_[k]] += first_[k];
        PetscCall(VecRestoreArray(x, &to));
        PetscFunctionReturn(PetscLogFlops(4.0 * static_cast<double>(values_.size())));
    }

 private:
    void take_rows(Mat mat) {
        const PetscInt *row = nullptr, *column = nullptr;
        const double* value = nullptr;
        PetscInt n = 0;
        PetscBool done = PETSC_FALSE;
        check(MatGetRowIJ(mat, 0, PETSC_FALSE, PETSC_FALSE, &n, &row, &column, &done), "MatGetRowIJ");
        check(MatSeqAIJGetArrayRead(mat, &value), "MatSeqAIJGetArrayRead");
        starts_.assign(1, 0);
        columns_.clear();
        values_.clear();
        entries_.clear();
        for (const PetscInt i : unknowns_) {
            for (PetscInt j = row[i]; j < row[i + 1]; ++j)
                if (place_[column[j]] >= 0 && column[j] <= i)
                    entries_.emplace_back(place_[i], place_[column[j]], value[j]);
            columns_.insert(columns_.end(), column + row[i], column + row[i + 1]);
            values_.insert(values_.end(), value + row[i], value + row[i + 1]);
            starts_.push_back(static_cast<PetscInt>(columns_.size()));
        }
        check(MatSeqAIJRestoreArrayRead(mat, &value), "MatSeqAIJRestoreArrayRead");
        check(MatRestoreRowIJ(mat, 0, PETSC_FALSE, PETSC_FALSE, &n, &row, &column, &done), "MatRestoreRowIJ");
        const auto size = static_cast<Eigen::Index>(unknowns_.size());
        block_.resize(size, size);
        block_.setFromTriplets(entries_.begin(), entries_.end());
        local_.resize(size);
    }

    Solve own_;
    Vec right_ = nullptr;
    std::vector<PetscInt> place_, unknowns_, starts_, columns_;  // place of each unknown of the matrix, -1 of others
    std::vector<double> values_;
    std::vector<Eigen::Triplet<double>> entries_;
    Eigen::SparseMatrix<double> block_;
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> inner_;
    Eigen::VectorXd local_, first_;
};

PetscErrorCode release(void* context) {
    delete static_cast<Correction*>(context);
    return 0;
}

// The correction of a factor, whether it is in use or not; null before the first.
Correction* correction_of(Mat factor) {
    PetscObject container = nullptr;
    void* context = nullptr;
    if (PetscObjectQuery(reinterpret_cast<PetscObject>(factor), key, &container) || !container) return nullptr;
    if (PetscContainerGetPointer(reinterpret_cast<PetscContainer>(container), &context)) return nullptr;
    return static_cast<Correction*>(context);
}

// What MatSolve calls.
PetscErrorCode solve(Mat factor, Vec b, Vec x) { return correction_of(factor)->apply(factor, b, x); }

Correction* made(Mat factor) {
    if (Correction* found = correction_of(factor)) return found;
    void (*own)(void) = nullptr;
    PetscInt n = 0;
    check(MatGetOperation(factor, MATOP_SOLVE, &own), "MatGetOperation");
    check(MatGetSize(factor, &n, nullptr), "MatGetSize");
    auto found = std::make_unique<Correction>(n, reinterpret_cast<Solve>(own));
    PetscContainer container = nullptr;
    check(PetscContainerCreate(PETSC_COMM_SELF, &container), "PetscContainerCreate");
    check(PetscContainerSetPointer(container, found.get()), "PetscContainerSetPointer");
    check(PetscContainerSetUserDestroy(container, release), "PetscContainerSetUserDestroy");
    Correction* kept = found.release();
    check(PetscObjectCompose(reinterpret_cast<PetscObject>(factor), key, reinterpret_cast<PetscObject>(container)),
          "PetscObjectCompose");
    check(PetscContainerDestroy(&container), "PetscContainerDestroy");
    return kept;
}

void go_by(Mat factor, Solve solve) {
    check(MatSetOperation(factor, MATOP_SOLVE, reinterpret_cast<void (*)(void)>(solve)), "MatSetOperation");
}

bool correct_around(intptr_t handle, intptr_t matrix, const py::array_t<int32_t, py::array::c_style>& nodes,
                    int fields) {
    Mat factor = reinterpret_cast<Mat>(handle), mat = reinterpret_cast<Mat>(matrix);
    if (!restshape::in_node_blocks(factor)) return false;
    if (nodes.size() == 0) {
        if (const Correction* known = correction_of(factor)) go_by(factor, known->own());
        return false;
    }
    PetscInt n = 0, columns = 0;
    check(MatGetSize(factor, &n, nullptr), "MatGetSize");
    check(MatGetSize(mat, &columns, nullptr), "MatGetSize");
    const int32_t* node = nodes.data();
    for (py::ssize_t k = 0; k < nodes.size(); ++k)
        if (node[k] < 0 || (k && node[k] <= node[k - 1]) || (static_cast<PetscInt>(node[k]) + 1) * fields > n)
            throw std::invalid_argument("nodes must ascend, and be those of the factor");
    if (columns != n) throw std::invalid_argument("the matrix must be as large as the one of the factor");
    Correction* correction = made(factor);
    const bool serves = correction->set(mat, node, nodes.size(), fields);
    go_by(factor, serves ? solve : correction->own());
    return serves;
}

}  // namespace

void bind_correction(py::module_& m) {
    m.def(
        "correct_around", &correct_around, py::arg("factor"), py::arg("matrix"), py::arg("nodes").noconvert(),
        py::arg("fields"),
        "Lets MatSolve of a factor in blocks of nodes solve besides, before and after, for the unknowns of nodes (k,), "
        "which ascend, with a symmetric matrix of another pattern than the factor's; none end that. Returns whether "
        "it does: other factors stay as they are, and so where the block of these unknowns has no factor.");
}
