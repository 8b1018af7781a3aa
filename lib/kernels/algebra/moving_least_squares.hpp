// Generalised moving least squares in the plane: values and derivatives at a few places, mixed for another one.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace restshape {

// Factors of the rows (x^0, x^1, s_1^1, s_2^1, x^2, ...) whose sum is the fitted value at `hand`.
//
// The polynomials are those of the way from the weighted mean of the places, in parts of `size`: then the first row and
// column of G are those of the identity, which leaves 2 x 2 to be factored, and no digits are lost where the hand is
// far from the samples, or they from where coordinates begin. Without `last` the first factor is 0. Arguments: hand,
// last: 2 numbers; places: 2 numbers for each sample with derivatives; epsilon2: added to squares of distances.
inline std::vector<double> gmls_factors(const double* hand, const double* last, const double* places, size_t count,
                                        double size, double epsilon2) {
    std::vector<std::array<double, 3>> at(1 + count, {0.0, 0.0, 0.0});
    double total = 0.0, mean[2] = {0.0, 0.0};
    for (size_t m = last ? 0 : 1; m <= count; ++m) {
        const double* place = m ? places + 2 * (m - 1) : last;
        const double dx = (place[0] - hand[0]) / size, dy = (place[1] - hand[1]) / size;
        at[m] = {dx, dy, 1.0 / (dx * dx + dy * dy + epsilon2)};
        total += at[m][2];
    }
    for (auto& [dx, dy, w] : at) {
        w /= total;
        mean[0] += w * dx, mean[1] += w * dy;
    }
    double a = 0.0, b = 0.0, c = 0.0;
    for (size_t m = 0; m <= count; ++m) {
        auto& [dx, dy, w] = at[m];
        dx -= mean[0], dy -= mean[1];
        a += w * (dx * dx + (m > 0)), b += w * dx * dy, c += w * (dy * dy + (m > 0));
    }
    // (a, b; b, c) y = way from the mean to the hand, by L D L^T.
    const double l = b / a, y1 = (-mean[1] + l * mean[0]) / (c - l * b), y0 = -mean[0] / a - l * y1;
    std::vector<double> factors(1 + 3 * count);
    for (size_t m = 0; m <= count; ++m) {
        const auto& [dx, dy, w] = at[m];
        factors[m ? 3 * m - 2 : 0] = w * (1.0 + y0 * dx + y1 * dy);
        if (!m) continue;
        // Derivatives are those by the hand's coordinates: by its parts of the size they are as many times as large.
        factors[3 * m - 1] = w * y0 * size;
        factors[3 * m] = w * y1 * size;
    }
    return factors;
}

// The sum of rows (r, n) times their factors, in one pass over them.
inline void combine_rows(const std::vector<double>& factors, const double* rows, size_t n, double* out) {
    constexpr size_t block = 1024;
    using Part = Eigen::Map<const Eigen::ArrayXd>;
    std::vector<size_t> used;
    for (size_t k = 0; k < factors.size(); ++k)
        if (factors[k] != 0.0) used.push_back(k);
    for (size_t begin = 0; begin < n; begin += block) {
        const Eigen::Index length = static_cast<Eigen::Index>(std::min(block, n - begin));
        const auto part = [&](size_t i) { return Part(rows + used[i] * n + begin, length); };
        const auto factor = [&](size_t i) { return factors[used[i]]; };
        Eigen::Map<Eigen::ArrayXd> sum(out + begin, length);
        sum.setZero();
        size_t i = 0;
        for (; i + 4 <= used.size(); i += 4)
            sum += factor(i) * part(i) + factor(i + 1) * part(i + 1) + factor(i + 2) * part(i + 2) +
                   factor(i + 3) * part(i + 3);
        for (; i < used.size(); ++i) sum += factor(i) * part(i);
    }
}

}  // namespace restshape
