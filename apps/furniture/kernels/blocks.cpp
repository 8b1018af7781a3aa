// The order, the factors and the solutions of a matrix of blocks.
#include "blocks.hpp"

#include <Eigen/LU>

namespace restshape::planks {

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
        inverse_[step] = at(k, k).inverse();
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
