// Rows of blocks in single precision, made of scalar rows of PETSc's.
#pragma once

#include <petscsys.h>

#include <cstddef>
#include <cstring>
#include <vector>

namespace restshape {

// Scalar rows with ascending columns, as PETSc holds them.
struct StoredRows {
    PetscInt rows = 0;
    const PetscInt *start = nullptr, *column = nullptr;
    const double* value = nullptr;
};

// y -= block^T x, of a block by columns.
template <int R, int C>
inline void take_transposed(const float* block, const double* x, double* y) {
    for (int c = 0; c < C; ++c) {
        double own = 0.0;
        for (int r = 0; r < R; ++r) own += static_cast<double>(block[c * R + r]) * x[r];
        y[c] -= own;
    }
}

// A sum of products of blocks with vectors.
template <int R, int C>
struct ProductSum {
    double sum[R] = {};

    void add(const float* block, const double* x) {
        for (int c = 0; c < C; ++c)
            for (int r = 0; r < R; ++r) sum[r] += static_cast<double>(block[c * R + r]) * x[c];
    }
    double operator[](int r) const { return sum[r]; }
};

using FourSingle [[gnu::vector_size(16)]] = float;
using FourDouble [[gnu::vector_size(32)]] = double;

inline FourDouble four_at(const float* from) {
    FourSingle found;
    std::memcpy(&found, from, sizeof found);
    return __builtin_convertvector(found, FourDouble);
}

// Both columns of a block at once.
template <>
struct ProductSum<2, 2> {
    FourDouble sum = {};

    void add(const float* block, const double* x) { sum += four_at(block) * FourDouble{x[0], x[0], x[1], x[1]}; }
    double operator[](int r) const { return sum[r] + sum[r + 2]; }
};
template <>
inline void take_transposed<2, 2>(const float* block, const double* x, double* y) {
    const FourDouble products = four_at(block) * FourDouble{x[0], x[1], x[0], x[1]};
    y[0] -= products[0] + products[1];
    y[1] -= products[2] + products[3];
}

// A column a register, whose last number is the next column's and counts nowhere.
template <>
struct ProductSum<3, 3> {
    FourDouble sum = {};

    void add(const float* block, const double* x) {
        for (int c = 0; c < 3; ++c) sum += four_at(block + 3 * c) * x[c];
    }
    double operator[](int r) const { return sum[r]; }
};

// Blocks of R rows and C columns by rows of blocks.
template <int R, int C>
struct SingleBlocks {
    std::vector<PetscInt> start, column;
    std::vector<float> value;

    // Takes in `count` rows of blocks, all empty where `from` has no rows; `place` is where a column of theirs stands
    // among padded ones, and a block stays where `keeps` says so of its row and column. What a row of a block lacks is
    // zero.
    template <class Place, class Keeps>
    void set(const StoredRows& from, PetscInt count, const Place& place, const Keeps& keeps) {
        start.assign(1, 0);
        column.clear();
        value.clear();
        if (!from.rows) {
            start.assign(count + 1, 0);
            return;
        }
        start.reserve(count + 1);
        column.reserve(from.start[from.rows] / (R * C));
        value.reserve(from.start[from.rows] + 1);
        for (PetscInt i = 0; i < count; ++i) {
            add_row(from, i, place, keeps);
            start.push_back(static_cast<PetscInt>(column.size()));
        }
        value.push_back(0.0F);  // read with the last column, and counted nowhere
    }

    const float* block(PetscInt k) const { return value.data() + static_cast<std::size_t>(k) * R * C; }

    // The sum of a row's blocks times x.
    ProductSum<R, C> times(PetscInt row, const double* x) const {
        ProductSum<R, C> sum;
        for (PetscInt k = start[row]; k < start[row + 1]; ++k) sum.add(block(k), x + column[k] * C);
        return sum;
    }

    // x -= a row's blocks^T y, y of that row.
    void take_from(PetscInt row, const double* y, double* x) const {
        for (PetscInt k = start[row]; k < start[row + 1]; ++k) take_transposed<R, C>(block(k), y, x + column[k] * C);
    }

    PetscInt rows() const { return static_cast<PetscInt>(start.size()) - 1; }

 private:
    // The R rows of a node are merged: the least column that any of them still has is next.
    template <class Place, class Keeps>
    void add_row(const StoredRows& from, PetscInt i, const Place& place, const Keeps& keeps) {
        PetscInt at[R];
        for (int r = 0; r < R; ++r) at[r] = from.start[i * R + r];
        for (;;) {
            PetscInt next = -1;
            for (int r = 0; r < R; ++r) {
                if (at[r] == from.start[i * R + r + 1]) continue;
                const PetscInt here = place(from.column[at[r]]) / C;
                if (next < 0 || here < next) next = here;
            }
            if (next < 0) return;
            const bool kept = keeps(i, next);
            const std::size_t to = value.size();
            if (kept) {
                column.push_back(next);
                value.resize(to + R * C, 0.0F);
            }
            for (int r = 0; r < R; ++r)
                for (; at[r] < from.start[i * R + r + 1] && place(from.column[at[r]]) / C == next; ++at[r])
                    if (kept) value[to + place(from.column[at[r]]) % C * R + r] = static_cast<float>(from.value[at[r]]);
        }
    }
};

}  // namespace restshape
