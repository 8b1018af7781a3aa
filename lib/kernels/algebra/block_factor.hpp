// The numbers of a Cholesky factor U^T D U in symmetric blocks, in the place and the form of PETSc's own: pivots
// inverted, before all rows, and rows of -U.
//
// Up-looking, row after row, as PETSc does it (S. C. Eisenstat, M. C. Gursky, M. H. Schultz and A. H. Sherman, Yale
// sparse matrix package I, Int. J. Numer. Meth. Engng 18 (1982) 1145), with a column of a block in one register.
#pragma once

#include <petscsys.h>

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <vector>

namespace restshape {

// Rows of blocks of the factor that ascend, right of the diagonal.
struct BlockRows {
    PetscInt count;
    const PetscInt *start, *column;
    double* value;
};

// Rows of blocks of the matrix that ascend from the diagonal on, read where the matrix has stored them by rows.
struct StoredBlocks {
    PetscInt count;
    const PetscInt *start, *column;
    const PetscInt *from,
        *length;  // where a block's first value is; values from one row to the next of a row of blocks
    const double* value;
};

// The inverse of a block, by elimination with exchanges of rows; not finite where the block has none.
template <int size>
Eigen::Matrix<double, size, size> inverse_of(Eigen::Matrix<double, size, size> block) {
    Eigen::Matrix<double, size, size> found = Eigen::Matrix<double, size, size>::Identity();
    for (int k = 0; k < size; ++k) {
        int pivot = k;
        for (int i = k + 1; i < size; ++i)
            if (std::abs(block(i, k)) > std::abs(block(pivot, k))) pivot = i;
        if (pivot != k) block.row(k).swap(block.row(pivot)), found.row(k).swap(found.row(pivot));
        for (int i = k + 1; i < size; ++i) {
            const double factor = block(i, k) / block(k, k);
            for (int c = k + 1; c < size; ++c) block(i, c) -= factor * block(k, c);
            found.row(i) -= factor * found.row(k);
        }
    }
    for (int k = size - 1; k >= 0; --k) {
        for (int i = k + 1; i < size; ++i) found.row(k) -= block(k, i) * found.row(i);
        found.row(k) /= block(k, k);
    }
    return found;
}

template <int size>
class BlockFactor {
 public:
    // Returns how many products of two blocks it took.
    double make(const StoredBlocks& a, const BlockRows& u) {
        const PetscInt n = a.count;
        row_.assign(static_cast<std::size_t>(n) * size, Column::Zero());
        next_.assign(n, -1);
        first_.assign(n, -1);
        at_.resize(n);
        products_ = 0.0;
        for (PetscInt k = 0; k < n; ++k) {
            load(a, k);
            // Rows with an entry in this column, each with those right of it.
            for (PetscInt i = first_[k]; i >= 0;) {
                const PetscInt other = next_[i];
                eliminate(u, k, i);
                i = other;
            }
            store(u, k);
        }
        return products_;
    }

 private:
    static constexpr int lanes = size == 3 ? 4 : 2;
    static constexpr std::size_t numbers = size * size;
    using Block = Eigen::Matrix<double, size, size>;
    using Column = Eigen::Array<double, lanes, 1>;

    void load(const StoredBlocks& a, PetscInt k) {
        for (PetscInt j = a.start[k]; j < a.start[k + 1]; ++j)
            for (int c = 0; c < size; ++c)
                for (int r = 0; r < size; ++r)
                    row_[a.column[j] * size + c][r] = a.value[a.from[j] + r * a.length[k] + c];
    }

    void eliminate(const BlockRows& u, PetscInt k, PetscInt i) {
        const PetscInt place = at_[i], end = u.start[i + 1];
        Eigen::Map<Block> own(u.value + place * numbers);
        const Block inverse = Eigen::Map<const Block>(u.value + i * numbers), scaled = -inverse * own;
        Column factor[size];
        for (int r = 0; r < size; ++r) {
            factor[r].setZero();
            for (int c = 0; c < size; ++c) factor[r][c] = scaled(r, c);
        }
        for (PetscInt j = place; j < end; ++j) add(factor, u.value + j * numbers, &row_[u.column[j] * size]);
        products_ += static_cast<double>(end - place);
        own = scaled;
        follow(u, i, place + 1);
    }

    // target += factor^T block.
    static void add(const Column (&factor)[size], const double* block, Column* target) {
        for (int c = 0; c < size; ++c) {
            Column sum = target[c];
            for (int r = 0; r < size; ++r) sum += factor[r] * block[c * size + r];
            target[c] = sum;
        }
    }

    void store(const BlockRows& u, PetscInt k) {
        Block pivot;
        for (int c = 0; c < size; ++c) pivot.col(c) = row_[k * size + c].template head<size>();
        Eigen::Map<Block>(u.value + k * numbers) = inverse_of<size>(pivot);
        for (int c = 0; c < size; ++c) row_[k * size + c].setZero();
        for (PetscInt j = u.start[k]; j < u.start[k + 1]; ++j) {
            Column* from = &row_[u.column[j] * size];
            for (int c = 0; c < size; ++c) {
                for (int r = 0; r < size; ++r) u.value[j * numbers + c * size + r] = from[c][r];
                from[c].setZero();
            }
        }
        follow(u, k, u.start[k]);
    }

    // Row i is next wanted in the column of this place.
    void follow(const BlockRows& u, PetscInt i, PetscInt place) {
        at_[i] = place;
        if (place >= u.start[i + 1]) return;
        const PetscInt column = u.column[place];
        next_[i] = first_[column];
        first_[column] = i;
    }

    std::vector<Column, Eigen::aligned_allocator<Column>> row_;  // by columns of blocks
    std::vector<PetscInt> next_, first_, at_;
    double products_ = 0.0;
};

}  // namespace restshape
