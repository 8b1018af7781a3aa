#include "algebra/block_product.hpp"

#include <Eigen/Core>

// PETSc 3.18 fetches blocks past the second cache, which a matrix of a few thousand unknowns fits in: python
// scripts/unsymmetric.py prints both.

namespace restshape {
namespace {

using Row = Eigen::Array<double, 4, 1>;

// A row of blocks, each by columns, times x; `whole` reads no number beyond the last block.
template <int size, bool whole>
Eigen::Array<double, size, 1> times(const double* block, const PetscInt* column, PetscInt count, const double* x) {
    constexpr int lanes = whole ? size : 4;
    using Column = Eigen::Array<double, lanes, 1>;
    Column sums[size];
    for (Column& one : sums) one.setZero();
    for (PetscInt k = 0; k < count; ++k, block += size * size) {
        const double* at = x + static_cast<size_t>(column[k]) * size;
        for (int c = 0; c < size; ++c) sums[c] += Eigen::Map<const Column>(block + c * size) * at[c];
    }
    for (int c = 1; c < size; ++c) sums[0] += sums[c];
    return sums[0].template head<size>();
}

template <int size>
PetscErrorCode multiply(Mat mat, Vec x, Vec y) {
    PetscInt n;
    const PetscInt *start, *column;
    const double* from;
    double *value, *to;
    PetscBool done;
    PetscFunctionBegin;
    PetscCall(MatGetRowIJ(mat, 0, PETSC_FALSE, PETSC_TRUE, &n, &start, &column, &done));
    PetscCheck(done, PETSC_COMM_SELF, PETSC_ERR_SUP, "the rows of a matrix in blocks are not to be had");
    PetscCall(MatSeqBAIJGetArray(mat, &value));
    PetscCall(VecGetArrayRead(x, &from));
    PetscCall(VecGetArrayWrite(y, &to));
    for (PetscInt i = 0; i < n; ++i) {
        const PetscInt first = start[i], count = start[i + 1] - first;
        const double* block = value + static_cast<size_t>(first) * size * size;
        Eigen::Map<Eigen::Array<double, size, 1>> own(to + static_cast<size_t>(i) * size);
        own = i + 1 < n ? times<size, false>(block, column + first, count, from)
                        : times<size, true>(block, column + first, count, from);
    }
    PetscCall(VecRestoreArrayWrite(y, &to));
    PetscCall(VecRestoreArrayRead(x, &from));
    PetscCall(PetscLogFlops(2.0 * size * size * start[n] - size * static_cast<double>(n)));
    PetscCall(MatSeqBAIJRestoreArray(mat, &value));
    PetscCall(MatRestoreRowIJ(mat, 0, PETSC_FALSE, PETSC_TRUE, &n, &start, &column, &done));
    PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode multiply_in_registers(Mat mat) {
    PetscBool blocks;
    PetscInt size;
    PetscFunctionBegin;
    PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(mat), MATSEQBAIJ, &blocks));
    PetscCall(MatGetBlockSize(mat, &size));
    if (blocks && (size == 3 || size == 4)) {
        void (*own)(void) = reinterpret_cast<void (*)(void)>(size == 3 ? multiply<3> : multiply<4>);
        PetscCall(MatSetOperation(mat, MATOP_MULT, own));
    }
    PetscFunctionReturn(0);
}

}  // namespace restshape
