// A complete Cholesky factor of a sparse matrix of numbers, positive definite: Eigen's order of minimal degree, the
// pattern found once, and the numbers of `BlockFactor` with blocks of one number.
#pragma once

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "algebra/block_factor.hpp"

namespace restshape {

class ScalarCholesky {
 public:
    using Matrix = Eigen::SparseMatrix<double>;

    // Takes up the pattern of a matrix, of which the lower triangle by columns is given, the diagonal first. The last
    // unknowns, as many as are kept, are no pivots.
    void analyse(const Matrix& lower, PetscInt kept = 0) {
        const auto n = static_cast<PetscInt>(lower.cols());
        kept_ = kept;
        order(lower);
        arrange(lower);
        // Each row has the columns of the matrix, and of the rows above whose first column it is, less itself.
        std::vector<PetscInt> next(n, -1), last(n, -1);  // rows above with one first column, in a chain
        std::vector<PetscInt> mark(n, -1);
        start_.assign(1, n);
        // One that grows leaves holes of half its size where others lie behind it.
        column_.reserve(n + count_beyond());
        column_.assign(n, 0);
        for (PetscInt k = 0; k < n; ++k) {
            mark[k] = k;
            const auto take = [&](PetscInt column) {
                if (mark[column] != k) mark[column] = k, column_.push_back(column);
            };
            for (PetscInt j = from_[k] + 1; j < from_[k + 1]; ++j) take(to_[j]);
            for (PetscInt row = last[k]; row >= 0; row = next[row])
                for (PetscInt j = start_[row]; j < start_[row + 1]; ++j) take(column_[j]);
            std::sort(column_.begin() + start_[k], column_.end());
            start_.push_back(static_cast<PetscInt>(column_.size()));
            if (start_[k] == start_[k + 1]) continue;
            const PetscInt first = column_[start_[k]];
            next[k] = last[first], last[first] = k;
        }
        value_.resize(column_.size());
    }

    // Makes the factor of a matrix with that pattern; false where a pivot is 0 or no number.
    bool factorise(const Matrix& lower) {
        const auto n = static_cast<PetscInt>(lower.cols());
        // Blocks of one number have one row: its length is read, and is of no use.
        const StoredBlocks a{n, from_.data(), to_.data(), slot_.data(), slot_.data(), lower.valuePtr()};
        // Its workspace is of no use to substitutions.
        BlockFactor<1>().make(a, rows(), kept_);
        return std::all_of(value_.begin(), value_.begin() + n, [](double pivot) { return std::isfinite(pivot); });
    }

    template <int columns>
    using Fields =
        std::vector<Eigen::Array<double, 1, columns>, Eigen::aligned_allocator<Eigen::Array<double, 1, columns>>>;

    // Solves for all columns together; load and found are (n, columns) by rows.
    template <int columns>
    void solve(const double* load, double* found) const {
        Fields<columns> x = forward<columns>(load);
        backward<columns>(x);
        using Row = Eigen::Array<double, 1, columns>;
        for (std::size_t i = 0; i < x.size(); ++i) Eigen::Map<Row>(found + columns * i) = x[place_of_[i]];
    }

    // Where the solution for an unknown stands.
    PetscInt place(PetscInt unknown) const { return place_of_[unknown]; }

    // What loads (n, columns) leave at each place; at the last ones what the unknowns that are kept have to bear.
    template <int columns>
    Fields<columns> forward(const double* load) const {
        const auto n = static_cast<PetscInt>(place_of_.size());
        Fields<columns> x(n);
        using Row = Eigen::Array<double, 1, columns>;
        for (PetscInt i = 0; i < n; ++i) x[place_of_[i]] = Eigen::Map<const Row>(load + columns * i);
        for (PetscInt k = 0; k < n - kept_; ++k) {
            const Row own = x[k];
            for (PetscInt j = start_[k]; j < start_[k + 1]; ++j) x[column_[j]] += value_[j] * own;
        }
        return x;
    }

    // Solves from that, with the solution at the places of the unknowns that are kept.
    template <int columns>
    void backward(Fields<columns>& x) const {
        const auto n = static_cast<PetscInt>(place_of_.size());
        using Row = Eigen::Array<double, 1, columns>;
        for (PetscInt k = n - kept_ - 1; k >= 0; --k) {
            Row own = value_[k] * x[k];
            for (PetscInt j = start_[k]; j < start_[k + 1]; ++j) own += value_[j] * x[column_[j]];
            x[k] = own;
        }
    }

    // The Schur complement (kept, kept) of the unknowns that are kept, by rows.
    void complement(double* out) const {
        const auto first = static_cast<PetscInt>(place_of_.size()) - kept_;
        std::fill(out, out + static_cast<std::size_t>(kept_) * kept_, 0.0);
        for (PetscInt k = 0; k < kept_; ++k) {
            out[k * kept_ + k] = value_[first + k];
            for (PetscInt j = start_[first + k]; j < start_[first + k + 1]; ++j) {
                const PetscInt to = column_[j] - first;
                out[k * kept_ + to] = out[to * kept_ + k] = value_[j];
            }
        }
    }

 private:
    BlockRows rows() { return {static_cast<PetscInt>(place_of_.size()), start_.data(), column_.data(), value_.data()}; }

    // Entries of the factor beyond its diagonal, by walks up the elimination tree: J. W. H. Liu, SIAM J. Matrix Anal.
    // Appl. 11 (1990) 134.
    std::size_t count_beyond() const {
        const auto n = static_cast<PetscInt>(place_of_.size());
        std::vector<PetscInt> first(n + 1, 0), above(to_.size() - n);  // rows above with an entry in each column
        for (PetscInt k = 0; k < n; ++k)
            for (PetscInt j = from_[k] + 1; j < from_[k + 1]; ++j) ++first[to_[j] + 1];
        for (PetscInt k = 0; k < n; ++k) first[k + 1] += first[k];
        std::vector<PetscInt> next(first.begin(), first.end() - 1), parent(n, -1), seen(n, -1);
        for (PetscInt k = 0; k < n; ++k)
            for (PetscInt j = from_[k] + 1; j < from_[k + 1]; ++j) above[next[to_[j]]++] = k;
        std::size_t count = 0;
        for (PetscInt k = 0; k < n; ++k) {
            seen[k] = k;
            for (PetscInt j = first[k]; j < first[k + 1]; ++j)
                for (PetscInt row = above[j]; seen[row] != k; row = parent[row]) {
                    if (parent[row] < 0) parent[row] = k;
                    seen[row] = k, ++count;
                }
        }
        return count;
    }

    void order(const Matrix& lower) {
        Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> found;
        Eigen::AMDOrdering<int>()(lower.selfadjointView<Eigen::Lower>(), found);
        place_of_.resize(lower.cols());
        // Its indices are the unknown at each place; those that are kept come last, as they are.
        const auto pivots = static_cast<PetscInt>(lower.cols()) - kept_;
        PetscInt place = 0;
        for (Eigen::Index k = 0; k < lower.cols(); ++k) {
            const PetscInt unknown = found.indices()[k];
            place_of_[unknown] = unknown < pivots ? place++ : unknown;
        }
    }

    // The upper triangle by rows in that order, with the place in the lower one of each entry.
    void arrange(const Matrix& lower) {
        const auto n = static_cast<PetscInt>(lower.cols());
        const auto* first = lower.outerIndexPtr();
        const auto* row = lower.innerIndexPtr();
        std::vector<std::pair<PetscInt, PetscInt>> entries(lower.nonZeros());  // column, place in the lower one
        from_.assign(n + 1, 0);
        const auto each = [&](auto&& visit) {
            for (PetscInt c = 0; c < n; ++c)
                for (auto j = first[c]; j < first[c + 1]; ++j) {
                    const PetscInt a = place_of_[c], b = place_of_[row[j]];
                    visit(std::min(a, b), std::max(a, b), static_cast<PetscInt>(j));
                }
        };
        each([&](PetscInt a, PetscInt, PetscInt) { ++from_[a + 1]; });
        for (PetscInt k = 0; k < n; ++k) from_[k + 1] += from_[k];
        std::vector<PetscInt> next(from_.begin(), from_.end() - 1);
        each([&](PetscInt a, PetscInt b, PetscInt j) { entries[next[a]++] = {b, j}; });
        to_.resize(entries.size());
        slot_.resize(entries.size());
        for (PetscInt k = 0; k < n; ++k) std::sort(entries.begin() + from_[k], entries.begin() + from_[k + 1]);
        for (std::size_t j = 0; j < entries.size(); ++j) to_[j] = entries[j].first, slot_[j] = entries[j].second;
    }

    std::vector<PetscInt> place_of_;          // of each unknown in the order
    std::vector<PetscInt> from_, to_, slot_;  // the matrix in that order, and where its entries are
    std::vector<PetscInt> start_, column_;    // the factor, its pivots first
    std::vector<double> value_;
    PetscInt kept_ = 0;
};

}  // namespace restshape
