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

// Of U^T D U with unit diagonals, in the order of elimination. PETSc stores the rows of -U right of the diagonal, and
// after them the pivot's reciprocal.
template <class Index>
class PanelFactor {
 public:
    // Rows of the factor: columns from start[i] to start[i + 1], ascending, the diagonal last. Throws
    // std::invalid_argument where these are no rows of a complete factor.
    PanelFactor(Index n, const Index* start, const Index* column) : n_(n), target_(start[n]) {
        const Rows rows{start, column};
        for (Index i = 0; i < n_; ++i) check(rows, i);
        for (Index first = 0; first < n_; first += panels_.back().width) add_panel(rows, first);
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
        for (const Panel& p : panels_) with_width(p.width, [&](auto width) { forward<width()>(p); });
        for (size_t k = panels_.size(); k-- > 0;)
            with_width(panels_[k].width, [&](auto width) { backward<width()>(panels_[k]); });
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
        Index first;
        int width, length;
        size_t columns, values;
    };

    template <class Visit>
    static void with_width(int width, Visit visit) {
        switch (width) {
            case 1:
                return visit(std::integral_constant<int, 1>{});
            case 2:
                return visit(std::integral_constant<int, 2>{});
            case 3:
                return visit(std::integral_constant<int, 3>{});
            case 4:
                return visit(std::integral_constant<int, 4>{});
            case 5:
                return visit(std::integral_constant<int, 5>{});
            case 6:
                return visit(std::integral_constant<int, 6>{});
            case 7:
                return visit(std::integral_constant<int, 7>{});
            default:
                return visit(std::integral_constant<int, widest>{});
        }
    }

    struct Rows {
        const Index *start, *column;
        const Index* operator[](Index i) const { return column + start[i]; }
        Index beyond(Index i) const { return start[i + 1] - start[i] - 1; }  // columns right of the diagonal
    };

    void check(const Rows& rows, Index i) const {
        const Index count = rows.start[i + 1] - rows.start[i];
        if (count < 1 || rows[i][count - 1] != i)
            throw std::invalid_argument("rows of a factor end with their diagonals");
        Index last = i;
        for (Index k = 0; k + 1 < count; last = rows[i][k++])
            if (rows[i][k] <= last || rows[i][k] >= n_)
                throw std::invalid_argument("rows of a factor ascend right of their diagonals");
    }

    // The panel of a row and of those after it that have nearly the same columns. What a row has right of the first
    // column, the row of that column has too: the last row of a panel has all columns right of it.
    void add_panel(const Rows& rows, Index first) {
        size_t own = rows.beyond(first) + 1;
        Index last = first;
        for (; last + 1 < n_ && last + 1 - first < widest && rows.beyond(last) > 0 && rows[last][0] == last + 1;
             ++last) {
            const size_t height = last + 2 - first, more = own + rows.beyond(last + 1) + 1;
            const size_t held = height * rows.beyond(last + 1) + height * (height + 1) / 2;
            if (static_cast<double>(held) > slack * static_cast<double>(more)) break;
            own = more;
        }
        const int width = static_cast<int>(last + 1 - first), count = static_cast<int>(rows.beyond(last));
        const Panel panel{first, width, (count + lanes - 1) / lanes * lanes, columns_.size(), count_};
        columns_.insert(columns_.end(), rows[last], rows[last] + count);
        // Columns beyond the last are zeros, at a place of their own each.
        for (int k = count; k < panel.length; ++k) columns_.push_back(n_ + k - count);
        count_ += (static_cast<size_t>(width) * (panel.length + width) + lanes - 1) / lanes * lanes;
        if (count_ > std::numeric_limits<uint32_t>::max())
            throw std::invalid_argument("the factor has too many entries");
        for (int k = 0; k < width; ++k) place_row(rows, panel, k, rows[last], count);
        panels_.push_back(panel);
    }

    void place_row(const Rows& rows, const Panel& p, int k, const Index* all, int count) {
        const Index i = p.first + k, end = p.first + p.width;
        const size_t right = p.values + static_cast<size_t>(k) * p.length;
        const size_t triangle = p.values + static_cast<size_t>(p.width) * p.length + k * p.width;
        int at = 0;
        for (Index entry = rows.start[i]; entry + 1 < rows.start[i + 1]; ++entry) {
            const Index column = rows.column[entry];
            if (column > i && column < end) {
                target_[entry] = static_cast<uint32_t>(triangle + (column - p.first));
                continue;
            }
            while (at < count && all[at] != column) ++at;
            if (at == count) throw std::invalid_argument("these are no rows of a complete factor");
            target_[entry] = static_cast<uint32_t>(right + at);
        }
        target_[rows.start[i + 1] - 1] = static_cast<uint32_t>(triangle + k);
    }

    template <int W>
    void forward(const Panel& p) {
        const double *v = values_.data() + p.values, *t = v + static_cast<size_t>(W) * p.length;
        double* x = x_.data() + p.first;
        double own[W];
        for (int k = 0; k < W; ++k) {
            own[k] = x[k];
            for (int l = 0; l < k; ++l) own[k] += t[l * W + k] * own[l];
            x[k] = own[k] * t[k * W + k];
        }
        const Index* column = columns_.data() + p.columns;
        for (int j = 0; j < p.length; j += lanes) {
            Lanes sum = own[0] * Eigen::Map<const Lanes, Eigen::Aligned32>(v + j);
            for (int k = 1; k < W; ++k) sum += own[k] * Eigen::Map<const Lanes, Eigen::Aligned32>(v + k * p.length + j);
            for (int l = 0; l < lanes; ++l) x_[column[j + l]] += sum[l];
        }
    }

    template <int W>
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
            for (int l = k + 1; l < W; ++l) own += t[k * W + l] * x[l];
            x[k] = own;
        }
    }

    Index n_;
    std::vector<uint32_t> target_;  // where each of its entries is in values_
    std::vector<Panel> panels_;
    std::vector<Index> columns_;  // of all panels
    size_t count_ = 0;
    Aligned<double> values_, x_;
};

}  // namespace restshape
