#pragma once

#include <petscmat.h>

#include "fem/operator.hpp"

namespace restshape {

// Rows of a matrix of one rank, for as long as this lives.
struct MatrixRows {
    explicit MatrixRows(Mat mat) : mat(mat) {
        check(MatGetRowIJ(mat, 0, PETSC_FALSE, PETSC_FALSE, &n, &start, &column, &done), "MatGetRowIJ");
        check(MatSeqAIJGetArrayRead(mat, &value), "MatSeqAIJGetArrayRead");
    }
    ~MatrixRows() {
        (void)MatSeqAIJRestoreArrayRead(mat, &value);
        (void)MatRestoreRowIJ(mat, 0, PETSC_FALSE, PETSC_FALSE, &n, &start, &column, &done);
    }
    MatrixRows(const MatrixRows&) = delete;
    MatrixRows& operator=(const MatrixRows&) = delete;

    Mat mat;
    PetscInt n = 0;
    const PetscInt *start = nullptr, *column = nullptr;
    const double* value = nullptr;
    PetscBool done = PETSC_FALSE;
};

}  // namespace restshape
