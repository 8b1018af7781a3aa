// The numbers of an LU factor of a matrix in blocks whose pattern is symmetric, and substitutions with them.
//
// Up-looking: row k of U and column k of L come from all rows before it that have an entry in column k. Both have the
// same pattern, so that the column lies, transposed, where the row does, and one sweep of row operations makes both.
// S. C. Eisenstat, M. C. Gursky, M. H. Schultz and A. H. Sherman, Int. J. Numer. Meth. Engng 18 (1982) 1145.
#pragma once

#include <petscsys.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "algebra/block_factor.hpp"

namespace restshape {

// Block rows right of the diagonal, ascending.
struct LuPattern {
    std::vector<PetscInt> start{0}, column;
    PetscInt rows() const { return static_cast<PetscInt>(start.size()) - 1; }
    // The pattern of a factor, from that of its matrix: a row has the columns of all rows whose first column it is.
    static LuPattern filled(const LuPattern& a) {
        const PetscInt n = a.rows();
        LuPattern u;
        std::vector<PetscInt> first(n, -1), next(n, -1), seen(n, -1), own;
        for (PetscInt k = 0; k < n; ++k) {
            own.clear();
            seen[k] = k;
            const auto take = [&](const PetscInt* from, const PetscInt* to) {
                for (; from < to; ++from)
                    if (seen[*from] != k) seen[*from] = k, own.push_back(*from);
            };
            take(a.column.data() + a.start[k], a.column.data() + a.start[k + 1]);
            for (PetscInt i = first[k]; i >= 0; i = next[i])
                take(u.column.data() + u.start[i], u.column.data() + u.start[i + 1]);
            std::sort(own.begin(), own.end());
            u.column.insert(u.column.end(), own.begin(), own.end());
            u.start.push_back(static_cast<PetscInt>(u.column.size()));
            if (!own.empty()) next[k] = first[own[0]], first[own[0]] = k;
        }
        return u;
    }
};

// Where the blocks of a matrix are: of each entry right of the diagonal, its own and the one across; of the diagonal.
struct LuSources {
    std::vector<PetscInt> upper, lower, diagonal;
};

template <int size>
class LuRows {
 public:
    static constexpr std::size_t numbers = size * size;
    using Block = Eigen::Matrix<double, size, size>;

    // From the blocks of a matrix, each by columns. Returns how many products of blocks it took.
    double make(const LuPattern& a, const LuSources& from, const double* value, const LuPattern& u) {
        const PetscInt n = u.rows();
        row_.assign(static_cast<std::size_t>(n) * size, Column::Zero());
        low_.assign(row_.size(), Column::Zero());
        next_.assign(n, -1);
        first_.assign(n, -1);
        at_.resize(n);
        upper_.resize(u.column.size() * numbers);
        lower_.resize(upper_.size());
        inverse_.resize(static_cast<std::size_t>(n) * numbers);
        double products = 0.0;
        zero_ = 0;
        for (PetscInt k = 0; k < n; ++k) {
            load(a, from, value, k);
            for (PetscInt i = first_[k]; i >= 0;) {
                const PetscInt other = next_[i], place = at_[i], end = u.start[i + 1];
                eliminate(u, place, end, k);
                products += 2.0 * (end - place);
                follow(u, i, place + 1);
                i = other;
            }
            store(u, k);
        }
        return products;
    }

    PetscInt zero() const { return zero_; }  // blocks of the diagonal without an inverse
    Eigen::Map<const Block> upper(PetscInt place) const { return map(upper_, place); }
    // Of L, transposed.
    Eigen::Map<const Block> lower(PetscInt place) const { return map(lower_, place); }
    Eigen::Map<const Block> inverse(PetscInt k) const { return map(inverse_, k); }

 private:
    static constexpr int lanes = 4;
    using Column = Eigen::Array<double, lanes, 1>;
    using Columns = std::vector<Column, Eigen::aligned_allocator<Column>>;

    static Eigen::Map<const Block> map(const std::vector<double>& from, PetscInt place) {
        return Eigen::Map<const Block>(from.data() + place * numbers);
    }

    static void put(const double* block, Column* to, bool across) {
        for (int c = 0; c < size; ++c)
            for (int r = 0; r < size; ++r) (across ? to[r][c] : to[c][r]) = block[c * size + r];
    }

    void load(const LuPattern& a, const LuSources& from, const double* value, PetscInt k) {
        put(value + from.diagonal[k] * numbers, &row_[k * size], false);
        for (PetscInt j = a.start[k]; j < a.start[k + 1]; ++j) {
            put(value + from.upper[j] * numbers, &row_[a.column[j] * size], false);
            put(value + from.lower[j] * numbers, &low_[a.column[j] * size], true);
        }
    }

    // Row k less the multiple of the row whose entry in column k is at a place, and column k likewise.
    void eliminate(const LuPattern& u, PetscInt place, PetscInt end, PetscInt k) {
        Column of_row[size], of_column[size];
        negative_rows(&lower_[place * numbers], of_row);
        negative_rows(&upper_[place * numbers], of_column);
        add(of_row, &upper_[place * numbers], &row_[k * size]);
        for (PetscInt j = place + 1; j < end; ++j) {
            const std::size_t to = static_cast<std::size_t>(u.column[j]) * size;
            add(of_row, &upper_[j * numbers], &row_[to]);
            add(of_column, &lower_[j * numbers], &low_[to]);
        }
    }

    static void negative_rows(const double* block, Column* rows) {
        for (int r = 0; r < size; ++r) {
            rows[r].setZero();
            for (int c = 0; c < size; ++c) rows[r][c] = -block[c * size + r];
        }
    }

    // target += factor^T block, of a factor given by its rows.
    static void add(const Column (&factor)[size], const double* block, Column* target) {
        for (int c = 0; c < size; ++c) {
            Column sum = target[c];
            for (int r = 0; r < size; ++r) sum += factor[r] * block[c * size + r];
            target[c] = sum;
        }
    }

    void store(const LuPattern& u, PetscInt k) {
        Block pivot;
        for (int c = 0; c < size; ++c) pivot.col(c) = row_[k * size + c].template head<size>();
        const Block inverse = inverse_of<size>(pivot);
        zero_ += !inverse.allFinite();
        Eigen::Map<Block>{&inverse_[k * numbers]} = inverse;
        for (int c = 0; c < size; ++c) row_[k * size + c].setZero();
        for (PetscInt j = u.start[k]; j < u.start[k + 1]; ++j) {
            Column *row = &row_[u.column[j] * size], *low = &low_[u.column[j] * size];
            Block across;
            for (int c = 0; c < size; ++c) {
                for (int r = 0; r < size; ++r) upper_[j * numbers + c * size + r] = row[c][r];
                across.col(c) = low[c].template head<size>();
                row[c].setZero();
                low[c].setZero();
            }
            Eigen::Map<Block>{&lower_[j * numbers]}.noalias() = inverse.transpose() * across;
        }
        follow(u, k, u.start[k]);
    }

    // Row i is next wanted in the column of this place.
    void follow(const LuPattern& u, PetscInt i, PetscInt place) {
        at_[i] = place;
        if (place >= u.start[i + 1]) return;
        const PetscInt column = u.column[place];
        next_[i] = first_[column];
        first_[column] = i;
    }

    Columns row_, low_;  // of row k of U, and of column k of L transposed, by columns of blocks
    std::vector<PetscInt> next_, first_, at_;
    std::vector<double> upper_, lower_, inverse_;
    PetscInt zero_ = 0;
};

// Substitutions: columns of L with a unit diagonal, inverted pivots, rows of U with a unit diagonal.
template <int size, class Value>
class LuSubstitution {
 public:
    void set(const LuPattern& u, const LuRows<size>& rows) {
        const PetscInt n = u.rows();
        lower_.resize(u.column.size() * numbers + 1);
        upper_.resize(lower_.size());
        inverse_.resize(static_cast<std::size_t>(n) * numbers + 1);
        for (PetscInt k = 0; k < n; ++k) {
            put(rows.inverse(k), &inverse_[k * numbers]);
            for (PetscInt j = u.start[k]; j < u.start[k + 1]; ++j) {
                put(rows.lower(j).transpose(), &lower_[j * numbers]);
                put(rows.inverse(k) * rows.upper(j), &upper_[j * numbers]);
            }
        }
        x_.assign(n, Row::Zero());
    }

    // x = A^-1 b, where block row k of the factor is number order[k] of b and x.
    void solve(const LuPattern& u, const PetscInt* order, const double* b, double* x) {
        const PetscInt n = u.rows();
        const PetscInt *start = u.start.data(), *column = u.column.data();
        for (PetscInt k = 0; k < n; ++k)
            for (int r = 0; r < size; ++r) x_[k][r] = static_cast<Value>(b[order[k] * size + r]);
        for (PetscInt k = 0; k < n; ++k) {
            const Row own = x_[k];
            for (PetscInt j = start[k]; j < start[k + 1]; ++j) {
                Row& to = x_[column[j]];
                to = to - times(&lower_[j * numbers], own);
            }
            x_[k] = times(&inverse_[k * numbers], own);
        }
        for (PetscInt k = n; k-- > 0;) {
            Row sums[size];
            for (Row& one : sums) one.setZero();
            for (PetscInt j = start[k]; j < start[k + 1]; ++j) {
                const Value* block = &upper_[j * numbers];
                const Row& at = x_[column[j]];
                for (int c = 0; c < size; ++c) sums[c] += read(block + c * size) * at[c];
            }
            for (int c = 1; c < size; ++c) sums[0] += sums[c];
            x_[k] -= sums[0];
            for (int r = 0; r < size; ++r) x[order[k] * size + r] = x_[k][r];
        }
    }

 private:
    static constexpr std::size_t numbers = size * size;
    // Of three numbers the fourth one is one of the next column, and stays in its lane.
    using Row = Eigen::Array<Value, 4, 1>;

    static Row read(const Value* from) { return Eigen::Map<const Row>(from); }

    static Row times(const Value* block, const Row& x) {
        Row sum = read(block) * x[0];
        for (int c = 1; c < size; ++c) sum += read(block + c * size) * x[c];
        return sum;
    }

    template <class Block>
    static void put(const Block& block, Value* to) {
        Eigen::Map<Eigen::Matrix<Value, size, size>>{to} = block.template cast<Value>();
    }

    std::vector<Value> lower_, upper_, inverse_;  // one number more than there are: rows of three read four
    std::vector<Row, Eigen::aligned_allocator<Row>> x_;
};

}  // namespace restshape
