// Triangles with curved sides: is the map from the reference triangle one-to-one?
#pragma once

#include <algorithm>
#include <cstdint>

namespace restshape {

// A lower bound of the Jacobian of a second-order triangle [m^2]; twice the area where its sides are straight.
//
// The determinant is quadratic, so it lies in the convex hull of its six Bernstein coefficients. Those of the corners
// are its values; that of a side is 2 times the value in the middle less the mean of the ends. All positive: valid.
// Source: Johnen, Remacle and Geuzaine, J. Comput. Phys. 233 (2013) 359.
inline double curved_jacobian_bound(const double* X, const int32_t* cell) {
    double p[6][2];
    for (int i = 0; i < 6; ++i)
        for (int a = 0; a < 2; ++a) p[i][a] = X[2 * static_cast<size_t>(cell[i]) + a];
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
    double least = std::min({cross(0, 0), cross(1, 1), cross(2, 2)});
    for (int c = 0; c < 3; ++c) {
        const int d = (c + 1) % 3;
        least = std::min(least, 0.5 * (cross(c, d) + cross(d, c)));
    }
    return least;
}

}  // namespace restshape
