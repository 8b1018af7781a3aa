// Triangles with curved sides: is the map from the reference triangle one-to-one?
#pragma once

#include <algorithm>
#include <cstdint>

namespace restshape {

// The Bernstein coefficients of the Jacobian of a second-order triangle: those of the corners, then of the sides 01,
// 12, 20.
//
// The determinant is quadratic, so it lies in the convex hull of them. Those of the corners are its values; that of a
// side is 2 times the value in the middle less the mean of the ends.
// Source: Johnen, Remacle and Geuzaine, J. Comput. Phys. 233 (2013) 359.
inline void jacobian_coefficients(const double (*p)[2], double (&b)[6]) {
    // The slopes along xi and eta are linear: their values at the corners 0, 1, 2.
    double slope[3][2][2];
    for (int a = 0; a < 2; ++a) {
        const double straight[2] = {p[1][a] - p[0][a], p[2][a] - p[0][a]};
        const double bend[3] = {4 * p[3][a] - 2 * (p[0][a] + p[1][a]), 4 * p[4][a] - 2 * (p[1][a] + p[2][a]),
                                4 * p[5][a] - 2 * (p[2][a] + p[0][a])};  // of the sides 01, 12, 20
        slope[0][0][a] = straight[0] + bend[0];
        slope[0][1][a] = straight[1] + bend[2];
        slope[1][0][a] = straight[0] - bend[0];
        slope[1][1][a] = straight[1] - bend[0] + bend[1];
        slope[2][0][a] = straight[0] + bend[1] - bend[2];
        slope[2][1][a] = straight[1] - bend[2];
    }
    const auto cross = [&slope](int c, int d) {
        return slope[c][0][0] * slope[d][1][1] - slope[c][0][1] * slope[d][1][0];
    };
    for (int c = 0; c < 3; ++c) {
        const int d = (c + 1) % 3;
        b[c] = cross(c, c);
        b[3 + c] = 0.5 * (cross(c, d) + cross(d, c));
    }
}

// A lower bound of the Jacobian of a second-order triangle [m^2]; twice the area where its sides are straight.
inline double curved_jacobian_bound(const double* X, const int32_t* cell) {
    double p[6][2], b[6];
    for (int i = 0; i < 6; ++i)
        for (int a = 0; a < 2; ++a) p[i][a] = X[2 * static_cast<size_t>(cell[i]) + a];
    jacobian_coefficients(p, b);
    return *std::min_element(b, b + 6);
}

// The least value of the Jacobian in a second-order triangle, from its Bernstein coefficients: at a corner, or where a
// parabola along a side or the quadratic inside has its minimum.
inline double least_jacobian(const double (&b)[6]) {
    double least = std::min({b[0], b[1], b[2]});
    for (int c = 0; c < 3; ++c) {
        const double from = b[c] - b[3 + c], to = b[(c + 1) % 3] - b[3 + c], bend = from + to;
        if (from > 0 && to > 0) least = std::min(least, b[c] - from * from / bend);
    }
    // b0 + 2 g.xi + xi.H xi
    const double g[2] = {b[3] - b[0], b[5] - b[0]};
    const double H[3] = {b[0] - 2 * b[3] + b[1], b[0] - b[3] - b[5] + b[4], b[0] - 2 * b[5] + b[2]};
    const double det = H[0] * H[2] - H[1] * H[1];
    if (H[0] > 0 && det > 0) {
        const double xi = (H[1] * g[1] - H[2] * g[0]) / det, eta = (H[1] * g[0] - H[0] * g[1]) / det;
        if (xi > 0 && eta > 0 && xi + eta < 1) least = std::min(least, b[0] + g[0] * xi + g[1] * eta);
    }
    return least;
}

}  // namespace restshape
