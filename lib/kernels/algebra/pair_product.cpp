#include "algebra/pair_product.hpp"

#include <cstring>

// PETSc adds to each row the products of two columns at a time, each rounded in the distribution: so does this.
#pragma GCC optimize("fp-contract=off")

namespace restshape {
namespace {

using Two [[gnu::vector_size(16)]] = double;
using Four [[gnu::vector_size(32)]] = double;

template <class Numbers>
Numbers read(const double* from) {
    Numbers found;
    std::memcpy(&found, from, sizeof(Numbers));
    return found;
}

// The sums of neighbours in both rows' products, side by side.
Two sums(Two upper, Two lower) { return Two{upper[0], lower[0]} + Two{upper[1], lower[1]}; }
Four sums(Four upper, Four lower) {
    return Four{upper[0], lower[0], upper[2], lower[2]} + Four{upper[1], lower[1], upper[3], lower[3]};
}

// Both rows of a node, with the columns of the first one, times x, added to a sum.
Two plus_times(Two sum, const double* upper, const double* lower, const PetscInt* column, PetscInt count,
               const double* x) {
    PetscInt k = 0;
    for (; k + 4 <= count; k += 4) {
        const Two first = read<Two>(x + column[k]), second = read<Two>(x + column[k + 2]);
        const Four at{first[0], first[1], second[0], second[1]};
        const Four both = sums(read<Four>(upper + k) * at, read<Four>(lower + k) * at);
        sum += Two{both[0], both[1]};
        sum += Two{both[2], both[3]};
    }
    for (; k < count; k += 2) {
        const Two at = read<Two>(x + column[k]);
        sum += sums(read<Two>(upper + k) * at, read<Two>(lower + k) * at);
    }
    return sum;
}

// to = mat x, or mat x + `added` where that is given.
PetscErrorCode multiply(Mat mat, const double* x, const double* added, double* to) {
    PetscInt n;
    const PetscInt *start, *column;
    const double* value;
    PetscBool done;
    PetscFunctionBegin;
    PetscCall(MatGetRowIJ(mat, 0, PETSC_FALSE, PETSC_FALSE, &n, &start, &column, &done));
    PetscCheck(done, PETSC_COMM_SELF, PETSC_ERR_SUP, "the rows of a matrix are not to be had");
    PetscCall(MatSeqAIJGetArrayRead(mat, &value));
    for (PetscInt i = 0; i < n; i += 2) {
        const double *upper = value + start[i], *lower = value + start[i + 1];
        const Two before = added ? read<Two>(added + i) : Two{0.0, 0.0};
        const Two sum = plus_times(before, upper, lower, column + start[i], start[i + 1] - start[i], x);
        std::memcpy(to + i, &sum, sizeof(Two));
    }
    PetscCall(PetscLogFlops(2.0 * start[n] - (added ? 0 : n)));
    PetscCall(MatSeqAIJRestoreArrayRead(mat, &value));
    PetscCall(MatRestoreRowIJ(mat, 0, PETSC_FALSE, PETSC_FALSE, &n, &start, &column, &done));
    PetscFunctionReturn(0);
}

PetscErrorCode product(Mat mat, Vec x, Vec y) {
    const double* from;
    double* to;
    PetscFunctionBegin;
    PetscCall(VecGetArrayRead(x, &from));
    PetscCall(VecGetArrayWrite(y, &to));
    PetscCall(multiply(mat, from, nullptr, to));
    PetscCall(VecRestoreArrayWrite(y, &to));
    PetscCall(VecRestoreArrayRead(x, &from));
    PetscFunctionReturn(0);
}

// y = z + mat x, where y may be z.
PetscErrorCode product_and_sum(Mat mat, Vec x, Vec z, Vec y) {
    const double *from, *added;
    double* to;
    PetscFunctionBegin;
    PetscCall(VecGetArrayRead(x, &from));
    if (y == z) {
        PetscCall(VecGetArray(y, &to));
        PetscCall(multiply(mat, from, to, to));
        PetscCall(VecRestoreArray(y, &to));
    } else {
        PetscCall(VecGetArrayRead(z, &added));
        PetscCall(VecGetArrayWrite(y, &to));
        PetscCall(multiply(mat, from, added, to));
        PetscCall(VecRestoreArrayWrite(y, &to));
        PetscCall(VecRestoreArrayRead(z, &added));
    }
    PetscCall(VecRestoreArrayRead(x, &from));
    PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode multiply_by_pairs(Mat mat) {
    PetscFunctionBegin;
    PetscCall(MatSetOperation(mat, MATOP_MULT, reinterpret_cast<void (*)(void)>(product)));
    PetscCall(MatSetOperation(mat, MATOP_MULT_ADD, reinterpret_cast<void (*)(void)>(product_and_sum)));
    PetscFunctionReturn(0);
}

}  // namespace restshape
