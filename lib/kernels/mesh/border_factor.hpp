// A dense Cholesky factor of what the parts of a mesh leave for the nodes between them.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <stdexcept>
#include <utility>

#include "quiet_intrinsics.hpp"

namespace restshape {

class BorderFactor {
 public:
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

    // Of a symmetric positive definite matrix (m, m).
    explicit BorderFactor(Rows matrix) : matrix_(std::move(matrix)), factor_(matrix_) {
        // Numbers that are none pass all comparisons with zero.
        if (factor_.info() != Eigen::Success || !matrix_.diagonal().allFinite())
            throw std::runtime_error("the matrix of the border is not positive definite");
    }
    BorderFactor(const BorderFactor&) = delete;
    BorderFactor& operator=(const BorderFactor&) = delete;

    // Solutions (m, k) for loads (m, k).
    Rows solve(const Eigen::Ref<const Rows>& loads) const { return factor_.solve(loads); }

 private:
    Rows matrix_;  // holds the factor
    Eigen::LLT<Eigen::Ref<Rows>> factor_;
};

}  // namespace restshape
