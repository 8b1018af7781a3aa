// The numbers of a Cholesky factor U^T D U in symmetric blocks, in the place and the form of PETSc's own: pivots
// inverted, before all rows, and rows of -U.
//
// Up-looking, as PETSc does it (S. C. Eisenstat, M. C. Gursky, M. H. Schultz and A. H. Sherman, Yale sparse matrix
// package I, Int. J. Numer. Meth. Engng 18 (1982) 1145), for some rows of blocks with nearly the same columns at once,
// whose numbers in a column lie in one or two registers: what is read of a row above is used for all of them. Rows
// above that have the same columns are taken out together, so that what is written is written once for some of them.
#pragma once

#include <petscsys.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
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
    // Of a matrix in two parts `from` goes on in the second one from this number on; below 0 it is a block of zeros.
    PetscInt first_part = std::numeric_limits<PetscInt>::max();
    const PetscInt* second_length = nullptr;
    const double* second_value = nullptr;
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
    // Returns how many products of two blocks it took. The last rows, as many as are kept, are no pivots: they end as
    // the upper triangle of their Schur complement, its diagonal blocks where pivots are.
    double make(const StoredBlocks& a, const BlockRows& u, PetscInt kept = 0) {
        const PetscInt n = a.count;
        pivots_ = n - kept;
        group(u);
        // Each group leaves its columns as zeros.
        row_.resize(static_cast<std::size_t>(n) * size * most_lanes, 0.0);
        next_.assign(n, -1);
        first_.assign(n, -1);
        at_.resize(n);
        products_ = 0.0;
        for (PetscInt k = 0; k < n; k = end_[k]) {
            const PetscInt high = end_[k] - k;
            if (high == 1)
                make_rows<1>(a, u, k);
            else if (high == 2)
                make_rows<2>(a, u, k);
            else
                make_rows<widest>(a, u, k);
        }
        // Of large factors it is as much as an eighth of their numbers.
        if (row_.size() > kept_room) Room().swap(row_);
        return products_;
    }

 private:
    static constexpr int most_lanes = 16, widest = most_lanes / size, most_above = 4;
    static constexpr double slack = 1.3;  // what a group's rows hold if all have the columns of the last, over theirs
    static constexpr std::size_t numbers = size * size, kept_room = 1 << 20;
    using Block = Eigen::Matrix<double, size, size>;

    // Rows of a group: a number each in every column, at least so many that registers are full.
    static constexpr int lanes(int rows) {
        int found = 2;
        while (found < rows * size) found *= 2;
        return found;
    }
    template <int rows>
    using Column = Eigen::Array<double, lanes(rows), 1>;
    template <int rows>
    using Columns = Eigen::Map<Column<rows>, Eigen::AlignedMax>;

    // Groups of rows of blocks: each row's first column is the next row, so that this has all columns that it has.
    void group(const BlockRows& u) {
        const PetscInt n = u.count;
        head_.resize(n);
        end_.resize(n);
        for (PetscInt k = 0; k < n;) {
            PetscInt end = k + 1;
            double own = static_cast<double>(beyond(u, k) + 1);
            for (; end < n && end != pivots_ && end - k < widest && beyond(u, end - 1) &&
                   u.column[u.start[end - 1]] == end;
                 ++end) {
                const auto wide = static_cast<double>(beyond(u, end) + 1), high = static_cast<double>(end - k);
                if ((high + 1.0) * (wide + 0.5 * high) > slack * (own + wide)) break;
                own += wide;
            }
            for (const PetscInt first = k; k < end; ++k) head_[k] = first, end_[k] = end;
        }
    }
    static PetscInt beyond(const BlockRows& u, PetscInt k) { return u.start[k + 1] - u.start[k]; }

    template <int rows>
    void make_rows(const StoredBlocks& a, const BlockRows& u, PetscInt k) {
        const PetscInt end = end_[k];
        for (PetscInt row = k; row < end; ++row) load<rows>(a, row, row - k);
        // Rows above with an entry in a column of the group, each with those right of it.
        for (PetscInt i = first_[k]; i >= 0;) {
            PetscInt above[most_above];
            int count = 0;
            do above[count++] = i, i = next_[i];
            while (i >= 0 && count < most_above && alike(u, above[0], i));
            if (count == 1) eliminate<rows, 1>(u, k, end, above);
            if (count == 2) eliminate<rows, 2>(u, k, end, above);
            if (count == 3) eliminate<rows, 3>(u, k, end, above);
            if (count == 4) eliminate<rows, 4>(u, k, end, above);
        }
        for (PetscInt row = k; row < end; ++row) {
            store<rows>(u, row, row - k);
            if (row >= pivots_) continue;
            at_[row] = u.start[row];
            eliminate<rows, 1>(u, k, end, &row);
        }
        for (PetscInt row = k; row < end; ++row) clear<rows>(row);
        for (PetscInt j = u.start[end - 1]; j < u.start[end]; ++j) clear<rows>(u.column[j]);
    }

    template <int rows>
    double* column(PetscInt k) {
        return &row_[static_cast<std::size_t>(k) * size * lanes(rows)];
    }
    template <int rows>
    void clear(PetscInt k) {
        std::fill_n(column<rows>(k), size * lanes(rows), 0.0);
    }

    template <int rows>
    void load(const StoredBlocks& a, PetscInt k, PetscInt own) {
        for (PetscInt j = a.start[k]; j < a.start[k + 1]; ++j) {
            const PetscInt from = a.from[j];
            if (from < 0) continue;
            const bool second = from >= a.first_part;
            const double* value = second ? a.second_value + (from - a.first_part) : a.value + from;
            const PetscInt length = second ? a.second_length[k] : a.length[k];
            double* to = column<rows>(a.column[j]) + own * size;
            for (int c = 0; c < size; ++c)
                for (int r = 0; r < size; ++r) to[c * lanes(rows) + r] = value[r * length + c];
        }
    }

    // Whether what is left of two rows above has the same columns: in a group each row has all columns of that before.
    bool alike(const BlockRows& u, PetscInt i, PetscInt j) const {
        return head_[i] == head_[j] && u.start[i + 1] - at_[i] == u.start[j + 1] - at_[j];
    }

    // Takes rows above, which are alike, out of those of a group from k to an end.
    template <int rows, int count>
    void eliminate(const BlockRows& u, PetscInt k, PetscInt end, const PetscInt* above) {
        const PetscInt *columns = u.column + at_[above[0]], wide = u.start[above[0] + 1] - at_[above[0]];
        double* value[count];
        Block scaled[count][rows];
        Column<rows> factor[count * size];
        for (int r = 0; r < count * size; ++r) factor[r].setZero();
        PetscInt past = 0;
        for (; past < wide && columns[past] < end; ++past) products_ += static_cast<double>(count * (wide - past));
        for (int i = 0; i < count; ++i) {
            value[i] = u.value + at_[above[i]] * numbers;
            const Block inverse = Eigen::Map<const Block>(u.value + above[i] * numbers);
            for (PetscInt j = 0; j < past; ++j) {
                const PetscInt own = columns[j] - k;
                scaled[i][j] = -inverse * Eigen::Map<const Block>(value[i] + j * numbers);
                for (int r = 0; r < size; ++r)
                    for (int c = 0; c < size; ++c) factor[i * size + r][own * size + c] = scaled[i][j](r, c);
            }
        }
        if (past > 0)
            for (PetscInt j = 0; j < wide; ++j) add<rows, count>(factor, value, j * numbers, column<rows>(columns[j]));
        for (int i = 0; i < count; ++i) {
            for (PetscInt j = 0; j < past; ++j) Eigen::Map<Block>(value[i] + j * numbers) = scaled[i][j];
            follow(u, above[i], at_[above[i]] + past);
        }
    }

    // target += factor^T block, for some rows above, one after the other.
    template <int rows, int count>
    static void add(const Column<rows> (&factor)[count * size], const double* const (&value)[count], std::size_t at,
                    double* target) {
        for (int c = 0; c < size; ++c) {
            Columns<rows> place(target + c * lanes(rows));
            Column<rows> sum = place;
            for (int i = 0; i < count; ++i)
                for (int r = 0; r < size; ++r) sum += factor[i * size + r] * value[i][at + c * size + r];
            place = sum;
        }
    }

    template <int rows>
    void store(const BlockRows& u, PetscInt k, PetscInt own) {
        const auto copy = [&](const double* from, double* to) {
            for (int c = 0; c < size; ++c)
                for (int r = 0; r < size; ++r) to[c * size + r] = from[c * lanes(rows) + own * size + r];
        };
        Block pivot;
        copy(column<rows>(k), pivot.data());
        Eigen::Map<Block>(u.value + k * numbers) = k < pivots_ ? inverse_of<size>(pivot) : pivot;
        for (PetscInt j = u.start[k]; j < u.start[k + 1]; ++j) copy(column<rows>(u.column[j]), u.value + j * numbers);
    }

    // Row i is next wanted in the group of the column of this place.
    void follow(const BlockRows& u, PetscInt i, PetscInt place) {
        at_[i] = place;
        if (place >= u.start[i + 1]) return;
        const PetscInt group = head_[u.column[place]];
        next_[i] = first_[group];
        first_[group] = i;
    }

    using Room = std::vector<double, Eigen::aligned_allocator<double>>;
    Room row_;  // by columns of blocks, between two factors where it is small
    std::vector<PetscInt> next_, first_, at_;
    PetscInt pivots_ = 0;               // rows that are
    std::vector<PetscInt> head_, end_;  // the first row of each row's group, and the first one after it
    double products_ = 0.0;
};

}  // namespace restshape
