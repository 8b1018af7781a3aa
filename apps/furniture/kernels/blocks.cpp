// The order, the factors and the solutions of a matrix of blocks.
#include "blocks.hpp"

#include <cmath>
#include <utility>

namespace restshape::planks {

namespace {

// The inverse by Gauss and Jordan's elimination in place with row pivots. Rows are padded to whole registers, and
// changed as a whole: a number that is written into a row would have to reach the memory before the row is read.
Block inverse_of(const Block& block) {
    using Row = Eigen::Array<double, 8, 1>;
    static const Eigen::Array<double, 8, 8> units = Eigen::Matrix<double, 8, 8>::Identity(), rest = 1.0 - units;
    Row rows[6];
    for (int r = 0; r < 6; ++r) rows[r] << block.row(r).transpose().array(), 0.0, 0.0;
    int from[6];
    for (int k = 0; k < 6; ++k) {
        from[k] = k;
        for (int r = k + 1; r < 6; ++r)
            if (std::abs(rows[r][k]) > std::abs(rows[from[k]][k])) from[k] = r;
        if (from[k] != k) std::swap(rows[k], rows[from[k]]);
        const auto unit = units.col(k), others = rest.col(k);
        const double part = 1.0 / rows[k][k];
        rows[k] = (rows[k] * others + unit) * part;
        for (int r = 0; r < 6; ++r) {
            const double factor = rows[r][k];
            if (r != k) rows[r] = rows[r] * others - factor * rows[k];
        }
    }
    Block inverse;
    for (int r = 0; r < 6; ++r) inverse.row(r) = rows[r].head<6>().matrix().transpose();
    for (int k = 5; k >= 0; --k)
        if (from[k] != k) inverse.col(k).swap(inverse.col(from[k]));
    return inverse;
}

}  // namespace

Blocks::Blocks(int n, const std::vector<std::pair<int, int>>& pairs) : n_(n), order_(n), slot_(n * n, -1) {
    std::vector<char> linked(n * n, 0), gone(n, 0);
    for (auto [i, j] : pairs) linked[i * n + j] = linked[j * n + i] = 1;
    for (int step = 0; step < n; ++step) {
        int best = -1, least = n + 1;
        for (int i = 0; i < n; ++i) {
            if (gone[i]) continue;
            int degree = 0;
            for (int j = 0; j < n; ++j) degree += !gone[j] && linked[i * n + j];
            if (degree < least) least = degree, best = i;
        }
        gone[best] = 1;
        order_[step] = best;
        std::vector<int> left;
        for (int j = 0; j < n; ++j)
            if (!gone[j] && linked[best * n + j]) left.push_back(j);
        for (int a : left)
            for (int b : left)
                if (a != b) linked[a * n + b] = 1;
        later_.push_back(left);
    }
    int slots = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            if (i == j || linked[i * n + j]) slot_[i * n + j] = slots++;
    values_.resize(slots);
    inverse_.resize(n);
    clear();
}

void Blocks::factor() {
    for (int step = 0; step < n_; ++step) {
        const int k = order_[step];
        inverse_[step] = inverse_of(at(k, k));
        for (int i : later_[step]) {
            Block& lower = at(i, k);
            const Block quotient = lower * inverse_[step];
            for (int j : later_[step]) at(i, j).noalias() -= quotient * at(k, j);
            lower = quotient;
        }
    }
}

void Blocks::solve(Rows& b) {
    for (int step = 0; step < n_; ++step)
        for (int i : later_[step])
            b.middleRows<6>(6 * i).noalias() -= at(i, order_[step]) * b.middleRows<6>(6 * order_[step]);
    Rows y(6, b.cols());
    for (int step = n_ - 1; step >= 0; --step) {
        const int k = order_[step];
        y = b.middleRows<6>(6 * k);
        for (int j : later_[step]) y.noalias() -= at(k, j) * b.middleRows<6>(6 * j);
        b.middleRows<6>(6 * k).noalias() = inverse_[step] * y;
    }
}

void Blocks::solve(std::vector<double>& b) {
    using Six = Eigen::Matrix<double, 6, 1>;
    const auto part = [&b](int i) { return Eigen::Map<Six>(b.data() + 6 * i); };
    for (int step = 0; step < n_; ++step)
        for (int i : later_[step]) part(i).noalias() -= at(i, order_[step]) * part(order_[step]);
    for (int step = n_ - 1; step >= 0; --step) {
        const int k = order_[step];
        Six y = part(k);
        for (int j : later_[step]) y.noalias() -= at(k, j) * part(j);
        part(k).noalias() = inverse_[step] * y;
    }
}

}  // namespace restshape::planks
