// Smoothing of a fresh mesh: nodes move to the mean of their neighbours, and no triangle gets worse than the worst.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace restshape {

// Area over the sum of squared sides: a cheap measure of quality, negative if inverted.
inline double shape_factor(const double* X, const std::int32_t* cell) {
    const double *a = X + 2 * cell[0], *b = X + 2 * cell[1], *c = X + 2 * cell[2];
    const double abx = b[0] - a[0], aby = b[1] - a[1], acx = c[0] - a[0], acy = c[1] - a[1];
    const double bcx = c[0] - b[0], bcy = c[1] - b[1];
    return (abx * acy - acx * aby) / (abx * abx + aby * aby + acx * acx + acy * acy + bcx * bcx + bcy * bcy);
}

// Jacobi sweeps over the nodes from `fixed` on; returns the worst shape factor that was there before.
inline double smooth_fresh(double* X, std::int32_t nodes, const std::int32_t* cells, std::int32_t count,
                           std::int32_t fixed, int sweeps) {
    double worst = 1.0;
    for (std::int32_t i = 0; i < count; ++i) worst = std::min(worst, shape_factor(X, cells + 3 * i));
    std::vector<double> former(2 * static_cast<std::size_t>(nodes)), sum(former.size());
    std::vector<std::int32_t> degree(nodes, 0);
    for (std::int32_t i = 0; i < 3 * count; ++i) ++degree[cells[i]];
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        former.assign(X, X + former.size());
        std::fill(sum.begin(), sum.end(), 0.0);
        for (std::int32_t i = 0; i < count; ++i) {
            const std::int32_t* cell = cells + 3 * i;
            for (int k = 0; k < 2; ++k) {
                const double a = X[2 * cell[0] + k], b = X[2 * cell[1] + k], c = X[2 * cell[2] + k];
                sum[2 * cell[0] + k] += b + c, sum[2 * cell[1] + k] += c + a, sum[2 * cell[2] + k] += a + b;
            }
        }
        // Around an inner node each neighbour is met in two triangles.
        for (std::int32_t i = fixed; i < nodes; ++i)
            for (int k = 0; k < 2; ++k) X[2 * i + k] = sum[2 * i + k] / (2.0 * degree[i]);
        for (bool again = true; again;) {
            again = false;
            for (std::int32_t i = 0; i < count; ++i) {
                const std::int32_t* cell = cells + 3 * i;
                if (shape_factor(X, cell) >= worst) continue;
                for (int j = 0; j < 3; ++j)
                    for (int k = 2 * cell[j]; k < 2 * cell[j] + 2; ++k)
                        if (X[k] != former[k]) X[k] = former[k], again = true;
            }
        }
    }
    return worst;
}

}  // namespace restshape
