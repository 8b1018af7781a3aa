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
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace restshape {

// Rows of PETSc's factor U^T D U in blocks of one node, in the order of elimination: those of -U right of the diagonal,
// and the pivots' inverses. Blocks lie by columns, pivots before all rows; of single numbers each row of PETSc's ends
// with its pivot.
template <class Index>
struct FactorRows {
    Index count;  // of nodes
    int size;     // unknowns a node
    const Index *start, *column;
    bool pivot_last = size == 1;  // of its row

    const Index* operator[](Index k) const { return column + start[k]; }
    Index beyond(Index k) const { return start[k + 1] - start[k] - pivot_last; }  // blocks right of the diagonal
    size_t values() const { return static_cast<size_t>(start[count]) * size * size; }
    // Where row r of the diagonal of a node's pivot is.
    size_t pivot(Index k, int r) const {
        return pivot_last ? start[k + 1] - 1 : (static_cast<size_t>(k) * size + r) * size + r;
    }
};

// What an instruction reads.
using Doubles [[gnu::vector_size(32), gnu::may_alias]] = double;
using Floats [[gnu::vector_size(32), gnu::may_alias]] = float;
using TwoDoubles [[gnu::vector_size(16), gnu::may_alias]] = double;
using FourPairs [[gnu::vector_size(32), gnu::may_alias]] = int64_t;

inline Doubles join(const TwoDoubles (&pair)[2]) { return Doubles{pair[0][0], pair[0][1], pair[1][0], pair[1][1]}; }
inline Floats join(const int64_t (&pair)[4]) {
    return reinterpret_cast<Floats>(FourPairs{pair[0], pair[1], pair[2], pair[3]});
}
inline void split(const Doubles& all, TwoDoubles (&pair)[2]) {
    pair[0] = TwoDoubles{all[0], all[1]};
    pair[1] = TwoDoubles{all[2], all[3]};
}
inline void split(const Floats& all, int64_t (&pair)[4]) {
    const FourPairs pairs = reinterpret_cast<FourPairs>(all);
    for (int l = 0; l < 4; ++l) pair[l] = pairs[l];
}

// What holds a row's values and a pair of them; no std::conditional_t, whose arguments lose their alignment.
template <class Value>
struct Registers {
    using Values = Doubles;
    using Pair = TwoDoubles;
};
template <>
struct Registers<float> {
    using Values = Floats;
    using Pair = int64_t;
};

// Values of a row that meet the unknowns of some columns; of two unknowns a node a column is that of both.
template <class Value, int S>
struct Lanes {
    static constexpr int count = 32 / sizeof(Value), step = S == 2 ? 2 : 1, columns = count / step;
    using Values = typename Registers<Value>::Values;
    using Pair = typename Registers<Value>::Pair;

    static Values read(const Value* from) { return *reinterpret_cast<const Values*>(from); }

    template <class Index>
    static Values gather(const Value* x, const Index* column) {
        if constexpr (step == 2) {
            Pair pair[columns];
            for (int l = 0; l < columns; ++l) std::memcpy(&pair[l], x + column[l], sizeof(Pair));
            return join(pair);
        }
        Values found;
        for (int l = 0; l < count; ++l) found[l] = x[column[l]];
        return found;
    }

    template <class Index>
    static void scatter(const Values& values, Value* x, const Index* column) {
        if constexpr (step == 2) {
            Pair pair[columns];
            split(values, pair);
            for (int l = 0; l < columns; ++l) std::memcpy(x + column[l], &pair[l], sizeof(Pair));
        } else {
            for (int l = 0; l < count; ++l) x[column[l]] = values[l];
        }
    }

    static Value sum(const Values& values) {
        Value found = 0;
        for (int l = 0; l < count; ++l) found += values[l];
        return found;
    }
};

template <class Index, class Value>
class PanelFactor {
 public:
    using Rows = FactorRows<Index>;

    // Throws std::invalid_argument where these are no rows of a complete factor.
    explicit PanelFactor(const Rows& rows)
        : n_(rows.count * rows.size),
          size_(rows.size),
          pivot_last_(rows.pivot_last),
          begin_(rows.start[0]),
          entries_(rows.values()) {
        if (size_ < 1 || size_ > 3) throw std::invalid_argument("blocks of a factor have up to three rows");
        for (Index k = 0; k < rows.count; ++k) check(rows, k);
        target_.reserve(rows.start[rows.count]);
        for (Index first = 0; first < rows.count; first += panels_.back().width / size_) add_panel(rows, first);
        values_.resize(count_, 0);
        x_.resize(n_ + lanes, 0);
    }

    Index size() const { return n_; }
    size_t entries() const { return entries_; }

    // The values of all entries of the rows.
    void set(const double* value) {
        with_size([&](auto size) { copy<size()>(value); });
    }

    // x = (U^T D U)^-1 b, where row i of the factor is number order[i] of b and x.
    void solve(const double* b, const Index* order, double* x) {
        for (Index i = 0; i < n_; ++i) x_[i] = static_cast<Value>(b[order[i]]);
        // What was not a number in the last substitution has left none here.
        std::fill(x_.begin() + n_, x_.end(), Value(0));
        with_size([&](auto size) {
            go_forward<size()>();
            go_backward<size()>();
        });
        for (Index i = 0; i < n_; ++i) x[order[i]] = x_[i];
    }

    // The halves of it: x = (U^T D)^-1 b in the factor's order, and x = U^-1 b.
    void forward_half(const double* b, double* x) {
        half(b, x, [&](auto size) { go_forward<size()>(); });
    }
    void backward_half(const double* b, double* x) {
        half(b, x, [&](auto size) { go_backward<size()>(); });
    }

 private:
    static constexpr int lanes = Lanes<Value, 1>::count, widest = 8;
    static constexpr double slack = 1.25;  // entries with the zeros of a panel over those without
    template <class T>
    using Aligned = std::vector<T, Eigen::aligned_allocator<T>>;

    // Values: width rows of `length` columns right of the panel, then the triangle and the pivots, (width, width).
    struct Panel {
        Index first;  // unknown
        int width, length;
        size_t columns, values;
        size_t triangle() const { return values + static_cast<size_t>(width) * length; }
    };

    // Blocks of a row inside of its panel's triangle, and right of it.
    struct Side {
        Index inside, right;
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

    template <class Way>
    void half(const double* b, double* x, Way way) {
        for (Index i = 0; i < n_; ++i) x_[i] = static_cast<Value>(b[i]);
        std::fill(x_.begin() + n_, x_.end(), Value(0));
        with_size(way);
        for (Index i = 0; i < n_; ++i) x[i] = x_[i];
    }

    template <int S>
    void go_forward() {
        constexpr int most = widest / S;
        for (const Panel& p : panels_) with_nodes<most>(p.width / S, [&](auto nodes) { forward<nodes() * S, S>(p); });
    }

    template <int S>
    void go_backward() {
        constexpr int most = widest / S;
        for (size_t k = panels_.size(); k-- > 0;)
            with_nodes<most>(panels_[k].width / S, [&](auto nodes) { backward<nodes() * S, S>(panels_[k]); });
    }

    static void check(const Rows& rows, Index k) {
        const Index count = rows.beyond(k);
        if (count < 0 || (rows.pivot_last && rows[k][count] != k))
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
        // Of pairs the first; columns beyond the last are zeros, at a place of their own each.
        const int step = size_ == 2 ? 2 : 1;
        for (int j = 0; j < length; j += step)
            columns_.push_back(j < count * size_ ? rows[last][j / size_] * size_ + j % size_ : n_ + j - count * size_);
        count_ += (static_cast<size_t>(width) * (length + width) + lanes - 1) / lanes * lanes;
        if (count_ > std::numeric_limits<uint32_t>::max())
            throw std::invalid_argument("the factor has too many entries");
        for (Index k = first; k <= last; ++k) place_rows(rows, panel, k, rows[last], count);
        panels_.push_back(panel);
    }

    // Of node k of a panel whose last row has the columns `all`: where the first value of each block goes.
    void place_rows(const Rows& rows, const Panel& p, Index k, const Index* all, int count) {
        const Index first = p.first / size_, end = first + p.width / size_, held = rows.beyond(k);
        const size_t row = static_cast<size_t>(k - first) * size_, triangle = p.triangle() + row * p.width;
        Index j = 0;
        for (; j < held && rows[k][j] < end; ++j)
            target_.push_back(static_cast<uint32_t>(triangle + static_cast<size_t>(rows[k][j] - first) * size_));
        sides_.push_back({j, held - j});
        for (int at = 0; j < held; ++j, ++at) {
            while (at < count && all[at] != rows[k][j]) ++at;
            if (at == count) throw std::invalid_argument("these are no rows of a complete factor");
            target_.push_back(static_cast<uint32_t>(p.values + row * p.length + static_cast<size_t>(at) * size_));
        }
    }

    // A block, by columns, to where its first value goes; its rows lie so far from each other.
    template <int S>
    static void put(const double* block, Value* to, int stride) {
        for (int r = 0; r < S; ++r)
            for (int s = 0; s < S; ++s) to[r * stride + s] = static_cast<Value>(block[s * S + r]);
    }

    template <int S>
    void copy(const double* value) {
        const uint32_t* target = target_.data();
        const Side* side = sides_.data();
        const double *pivot = value, *block = value + begin_ * S * S;
        for (const Panel& p : panels_) {
            Value *to = values_.data(), *diagonal = to + p.triangle();
            for (int row = 0; row < p.width; row += S, ++side, diagonal += S * (p.width + 1)) {
                for (Index j = 0; j < side->inside; ++j, block += S * S) put<S>(block, to + *target++, p.width);
                for (Index j = 0; j < side->right; ++j, block += S * S) put<S>(block, to + *target++, p.length);
                put<S>(S == 1 && pivot_last_ ? block++ : pivot, diagonal, p.width);
                pivot += S * S;
            }
        }
    }

    // W rows of a panel, S a node.
    template <int W, int S>
    void forward(const Panel& p) {
        using L = Lanes<Value, S>;
        const Value *v = values_.data() + p.values, *t = v + static_cast<size_t>(W) * p.length;
        Value* x = x_.data() + p.first;
        Value own[W];
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
        for (int j = 0; j < p.length; j += lanes, column += L::columns) {
            typename L::Values sum = own[0] * L::read(v + j);
            for (int k = 1; k < W; ++k) sum += own[k] * L::read(v + k * p.length + j);
            L::scatter(L::gather(x_.data(), column) + sum, x_.data(), column);
        }
    }

    template <int W, int S>
    void backward(const Panel& p) {
        using L = Lanes<Value, S>;
        const Value *v = values_.data() + p.values, *t = v + static_cast<size_t>(W) * p.length;
        const Index* column = columns_.data() + p.columns;
        typename L::Values sum[W] = {};
        for (int j = 0; j < p.length; j += lanes, column += L::columns) {
            const typename L::Values at = L::gather(x_.data(), column);
            for (int k = 0; k < W; ++k) sum[k] += at * L::read(v + k * p.length + j);
        }
        Value* x = x_.data() + p.first;
        for (int k = W - 1; k >= 0; --k) {
            Value own = x[k] + L::sum(sum[k]);
            for (int l = k / S * S + S; l < W; ++l) own += t[k * W + l] * x[l];
            x[k] = own;
        }
    }

    Index n_;
    int size_;  // of a node
    bool pivot_last_;
    size_t begin_, entries_;        // blocks before all rows; entries in all
    std::vector<uint32_t> target_;  // where each block of the rows begins in values_
    std::vector<Side> sides_;
    std::vector<Panel> panels_;
    std::vector<Index> columns_;  // of all panels
    size_t count_ = 0;
    Aligned<Value> values_, x_;
};

}  // namespace restshape
