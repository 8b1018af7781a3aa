// Unknowns of other ranks that the rows of a matrix of PETSc's read, and the exchange of their values.
#pragma once

#include <petscmat.h>

#include <vector>

#include "algebra/single_blocks.hpp"

namespace restshape {

class Ghosts {
 public:
    Ghosts() = default;
    ~Ghosts() { release(); }
    Ghosts(const Ghosts&) = delete;
    Ghosts& operator=(const Ghosts&) = delete;

    // Those of a matrix of type seqaij, which has none, or mpiaij, with so many unknowns a node.
    PetscErrorCode set(Mat mat, PetscInt size);

    // Fetches their values from the vector of which this rank owns `own`, into `values`, by whole nodes.
    PetscErrorCode fetch(const double* own);

    // Adds `values` to the vector of which this rank owns `own`.
    PetscErrorCode add_to(double* own);

    bool none() const { return !scatter_; }

    std::vector<PetscInt> place;  // where each column of the coupling stands in `values`
    std::vector<double> values;

 private:
    void release();

    Vec own_ = nullptr, ghost_ = nullptr;
    VecScatter scatter_ = nullptr;
};

}  // namespace restshape
