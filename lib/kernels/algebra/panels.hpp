// Substitutions with a Cholesky factor in panels: rows with nearly the same columns, which are read once for all of
// them.
//
// The unknowns of a node, and those that a minimum degree ordering eliminates together, have the same columns. Their
// values lie in dense rows, so that of a column there is one index a panel, and many values in an instruction.
// Source: E. G. Ng and B. W. Peyton, Block sparse Cholesky algorithms on advanced uniprocessor computers, SIAM J. Sci.
// Comput. 14 (1993) 1034: supernodes, and their amalgamation with a few zeros.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace restshape {

// Rows of PETSc's factor U^T D U in blocks of one node, in the order of elimination: those of -U right of the diagonal,
// and the pivots' inverses. Of single numbers each row ends with its pivot; blocks lie by columns, pivots before all
// rows.
template <class Index>
struct FactorRows {
    Index count;  // of nodes
    int size;     // unknowns a node
    const Index *start, *column;

    const Index* operator[](Index k) const { return column + start[k]; }
    Index beyond(Index k) const { return start[k + 1] - start[k] - (size == 1); }  // blocks right of the diagonal
    size_t values() const { return static_cast<size_t>(start[count]) * size * size; }
    // Where row r, column s of a block is: of the block at that place of the rows, or of a node's pivot.
    size_t entry(Index place, int r, int s) const { return (static_cast<size_t>(place) * size + s) * size + r; }
    size_t pivot(Index k, int r, int s) const { return entry(size == 1 ? start[k + 1] - 1 : k, r, s); }
};

template <class Index>
class PanelFactor {
 public:
    using Rows = FactorRows<Index>;

    // Throws std::invalid_argument where these are no rows of a complete factor.
    explicit PanelFactor(const Rows& rows) : n_(rows.count * rows.size), size_(rows.size), target_(rows.values(), 0) {
        if (size_ < 1 || size_ > 3) throw std::invalid_argument("blocks of a factor have up to three rows");
        for (Index k = 0; k < rows.count; ++k) check(rows, k);
        for (Index first = 0; first < rows.count; first += panels_.back().width / size_) add_panel(rows, first);
        values_.resize(count_, 0.0);
        x_.resize(n_ + lanes, 0.0);
    }

    Index size() const { return n_; }
    size_t entries() const { return target_.size(); }

    // The values of all entries of the rows.
    void set(const double* value) {
        double* to = values_.data();
        for (size_t k = 0; k < target_.size(); ++k) to[target_[k]] = value[k];
    }

    // x = (U^T D U)^-1 b, where row i of the factor is number order[i] of b and x.
    void solve(const double* b, const Index* order, double* x) {
        for (Index i = 0; i < n_; ++i) x_[i] = b[order[i]];
        // What was not a number in the last substitution has left none here.
        std::fill(x_.begin() + n_, x_.end(), 0.0);
        with_size([&](auto size) { substitute<size()>(); });
        for (Index i = 0; i < n_; ++i) x[order[i]] = x_[i];
    }

 private:
    static constexpr int lanes = 4, widest = 8;
    static constexpr double slack = 1.25;  // entries with the zeros of a panel over those without
    using Lanes = Eigen::Array<double, lanes, 1>;
    template <class T>
    using Aligned = std::vector<T, Eigen::aligned_allocator<T>>;

    // Values: width rows of `length` columns right of the panel, then the triangle and the pivots, (width, width).
    struct Panel {
        Index first;  // unknown
        int width, length;
        size_t columns, values;
    };

    template <class Visit>
    void with_size(Visit visit) const {
        if (size_ == 1) return visit(std::integral_constant<int, 1>{});
        if (size_ == 2) return visit(std::integral_constant<int, 2>{});
        return visit(std::integral_constant<int, 3>{});
    }

    // A panel of so many nodes, of `most` at most.
    template <int most, class Visit>
    static void with_nodes(int nodes, Visit visit) {
        if constexpr (most > 1) {
            if (nodes < most) return with_nodes<most - 1>(nodes, visit);
        }
        visit(std::integral_constant<int, most>{});
    }

    template <int S>
    void substitute() {
        constexpr int most = widest / S;
        for (const Panel& p : panels_) with_nodes<most>(p.width / S, [&](auto nodes) { forward<nodes() * S, S>(p); });
        for (size_t k = panels_.size(); k-- > 0;)
            with_nodes<most>(panels_[k].width / S, [&](auto nodes) { backward<nodes() * S, S>(panels_[k]); });
    }

    static void check(const Rows& rows, Index k) {
        const Index count = rows.beyond(k);
        if (count < 0 || (rows.size == 1 && rows[k][count] != k))
            throw std::invalid_argument("rows of a factor end with their diagonals");
        Index last = k;
        for (Index j = 0; j < count; last = rows[k][j++])
            if (rows[k][j] <= last || rows[k][j] >= rows.count)
                throw std::invalid_argument("rows of a factor ascend right of their diagonals");
    }

    // The panel of a node and of those after it that have nearly the same columns. What a row has right of the first
    // column, the row of that column has too: the last row of a panel has all columns right of it.
    void add_panel(const Rows& rows, Index first) {
        size_t own = rows.beyond(first) + 1;
        Index last = first;
        const Index most = widest / size_;
        for (; last + 1 < rows.count && last + 1 - first < most && rows.beyond(last) > 0 && rows[last][0] == last + 1;
             ++last) {
            const size_t height = last + 2 - first, more = own + rows.beyond(last + 1) + 1;
            const size_t held = height * rows.beyond(last + 1) + height * (height + 1) / 2;
            if (static_cast<double>(held) > slack * static_cast<double>(more)) break;
            own = more;
        }
        const int width = static_cast<int>(last + 1 - first) * size_, count = static_cast<int>(rows.beyond(last));
        const int length = (count * size_ + lanes - 1) / lanes * lanes;
        const Panel panel{first * size_, width, length, columns_.size(), count_};
        for (int j = 0; j < count; ++j)
            for (int s = 0; s < size_; ++s) columns_.push_back(rows[last][j] * size_ + s);
        // Columns beyond the last are zeros, at a place of their own each.
        for (int j = count * size_; j < length; ++j) columns_.push_back(n_ + j - count * size_);
        count_ += (static_cast<size_t>(width) * (length + width) + lanes - 1) / lanes * lanes;
        if (count_ > std::numeric_limits<uint32_t>::max())
            throw std::invalid_argument("the factor has too many entries");
        for (Index k = first; k <= last; ++k) place_rows(rows, panel, k, rows[last], count);
        panels_.push_back(panel);
    }

    // Of node k of a panel whose last row has the columns `all`.
    void place_rows(const Rows& rows, const Panel& p, Index k, const Index* all, int count) {
        const Index first = p.first / size_, end = first + p.width / size_;
        const size_t triangle = p.values + static_cast<size_t>(p.width) * p.length;
        const auto place = [&](size_t entry, int r, size_t base, int length, size_t column) {
            target_[entry] = static_cast<uint32_t>(base + ((k - first) * size_ + r) * length + column);
        };
        int at = 0;
        for (Index j = 0; j < rows.beyond(k); ++j) {
            const Index column = rows[k][j];
            while (column >= end && at < count && all[at] != column) ++at;
            if (column >= end && at == count) throw std::invalid_argument("these are no rows of a complete factor");
            for (int r = 0; r < size_; ++r)
                for (int s = 0; s < size_; ++s) {
                    const size_t entry = rows.entry(rows.start[k] + j, r, s);
                    if (column < end)
                        place(entry, r, triangle, p.width, (column - first) * size_ + s);
                    else
                        place(entry, r, p.values, p.length, static_cast<size_t>(at) * size_ + s);
                }
        }
        for (int r = 0; r < size_; ++r)
            for (int s = 0; s < size_; ++s) place(rows.pivot(k, r, s), r, triangle, p.width, (k - first) * size_ + s);
    }

    // W rows of a panel, S a node.
    template <int W, int S>
    void forward(const Panel& p) {
        const double *v = values_.data() + p.values, *t = v + static_cast<size_t>(W) * p.length;
        double* x = x_.data() + p.first;
        double own[W];
        for (int k = 0; k < W; ++k) {
            own[k] = x[k];
            for (int l = 0; l < k / S * S; ++l) own[k] += t[l * W + k] * own[l];
        }
        for (int k = 0; k < W; ++k) {
            const int node = k / S * S;
            x[k] = t[k * W + node] * own[node];
            for (int s = 1; s < S; ++s) x[k] += t[k * W + node + s] * own[node + s];
        }
        const Index* column = columns_.data() + p.columns;
        for (int j = 0; j < p.length; j += lanes) {
            Lanes sum = own[0] * Eigen::Map<const Lanes, Eigen::Aligned32>(v + j);
            for (int k = 1; k < W; ++k) sum += own[k] * Eigen::Map<const Lanes, Eigen::Aligned32>(v + k * p.length + j);
            for (int l = 0; l < lanes; ++l) x_[column[j + l]] += sum[l];
        }
    }

    template <int W, int S>
    void backward(const Panel& p) {
        const double *v = values_.data() + p.values, *t = v + static_cast<size_t>(W) * p.length;
        const Index* column = columns_.data() + p.columns;
        Lanes sum[W];
        for (int k = 0; k < W; ++k) sum[k].setZero();
        for (int j = 0; j < p.length; j += lanes) {
            const Lanes at(x_[column[j]], x_[column[j + 1]], x_[column[j + 2]], x_[column[j + 3]]);
            for (int k = 0; k < W; ++k) sum[k] += at * Eigen::Map<const Lanes, Eigen::Aligned32>(v + k * p.length + j);
        }
        double* x = x_.data() + p.first;
        for (int k = W - 1; k >= 0; --k) {
            double own = x[k] + sum[k].sum();
            for (int l = k / S * S + S; l < W; ++l) own += t[k * W + l] * x[l];
            x[k] = own;
        }
    }

    Index n_;
    int size_;                      // of a node
    std::vector<uint32_t> target_;  // where each of its entries is in values_
    std::vector<Panel> panels_;
    std::vector<Index> columns_;  // of all panels
    size_t count_ = lanes;        // the first ones take values of the rows that say nothing
    Aligned<double> values_, x_;
};

}  // namespace restshape
