// Rows of a Cholesky factor of single numbers, laid out as those of blocks are: pivots before all rows.
#pragma once

#include <petscsys.h>

#include <algorithm>
#include <vector>

#include "algebra/block_factor.hpp"

namespace restshape {

// PETSc's factor in blocks of one number has the pivot at the end of its row.
class NumberRows {
 public:
    // Takes in the pattern of PETSc's factor, each row with its pivot.
    void set_pattern(PetscInt rows, const PetscInt* start, const PetscInt* column) {
        start_.assign(1, rows);
        column_.assign(rows, 0);
        column_.reserve(start[rows]);
        for (PetscInt k = 0; k < rows; ++k) {
            column_.insert(column_.end(), column + start[k], column + start[k + 1] - 1);
            start_.push_back(static_cast<PetscInt>(column_.size()));
        }
        value_.resize(column_.size());
    }

    BlockRows rows() {
        return {static_cast<PetscInt>(start_.size()) - 1, start_.data(), column_.data(), value_.data()};
    }
    double* pivots() { return value_.data(); }

    // Writes all values to where PETSc's factor has them.
    void copy(double* to) const {
        for (std::size_t k = 0; k + 1 < start_.size(); ++k) {
            to = std::copy(value_.begin() + start_[k], value_.begin() + start_[k + 1], to);
            *to++ = value_[k];
        }
    }

 private:
    std::vector<PetscInt> start_, column_;
    std::vector<double> value_;
};

}  // namespace restshape
