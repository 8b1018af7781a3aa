// Second-order nodes over a triangle mesh: where mid-sides lie, whether curved triangles are valid, fields at points.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "fem/shapes.hpp"
#include "mesh/curved.hpp"
#include "mesh/location.hpp"

namespace restshape {

// Corners of a quadratic triangle first, then the middles of its sides (0, 1), (1, 2), (2, 0).
inline void gather_quadratic(const double* X, const std::int32_t* cell, double (&x)[6][2]) {
    for (int i = 0; i < 6; ++i)
        for (int a = 0; a < 2; ++a) x[i][a] = X[2 * cell[i] + a];
}

// The bound of the Jacobian over twice the area of the corners' triangle: 1 where all sides are straight.
inline double jacobian_share(const double* X, const std::int32_t* cell) {
    const double *a = X + 2 * cell[0], *b = X + 2 * cell[1], *c = X + 2 * cell[2];
    const double straight = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    return straight > 0.0 ? curved_jacobian_bound(X, cell) / straight : -1.0;
}

struct Sides {
    const std::int32_t* ends;    // (count, 2) corners, numbered as in the mesh of the corners
    const std::int32_t* number;  // (count,) second-order node in the middle
    std::ptrdiff_t count;
    const std::int32_t* curved;  // (curved_count,) sides on curved edges of the outline
    const double* offset;        // (curved_count, 2) from the middle of the ends to the node
    std::ptrdiff_t curved_count;
};

// Second-order nodes: corners from the mesh, then the middle of the ends plus, on curved sides, their offset.
inline void place_second_order(const double* corner, const std::int32_t* number, std::ptrdiff_t n, const Sides& sides,
                               double* X) {
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        X[2 * number[i]] = corner[2 * i];
        X[2 * number[i] + 1] = corner[2 * i + 1];
    }
    for (std::ptrdiff_t e = 0; e < sides.count; ++e) {
        const double *a = corner + 2 * sides.ends[2 * e], *b = corner + 2 * sides.ends[2 * e + 1];
        double* middle = X + 2 * sides.number[e];
        middle[0] = 0.5 * (a[0] + b[0]);
        middle[1] = 0.5 * (a[1] + b[1]);
    }
    for (std::ptrdiff_t k = 0; k < sides.curved_count; ++k) {
        double* middle = X + 2 * sides.number[sides.curved[k]];
        middle[0] += sides.offset[2 * k];
        middle[1] += sides.offset[2 * k + 1];
    }
}

// Finds points in quadratic triangles and evaluates the second-order basis there.
class QuadraticLocator {
 public:
    // X (n, 2), corners (count, 3) and cells (count, 6) of the same triangles.
    QuadraticLocator(const double* X, const std::int32_t* corners, const std::int32_t* cells, std::ptrdiff_t count)
        : X_(X), cells_(cells), straight_(X, corners, count) {}

    // Triangle of a point and the values of its six basis functions; outside, at the nearest place of the boundary. The
    // straight triangle `tried` as of Locator.
    std::int32_t locate(const double* point, double* values, std::int32_t tried = -1) {
        double w[3];
        const std::int32_t cell = straight_.locate(point, w, tried);
        double x[6][2], xi[2] = {w[1], w[2]};
        gather_quadratic(X_, cells_ + 6 * cell, x);
        if (curved(x)) bend(x, point, xi);
        Quadratic<2>::values(xi, values);
        return cell;
    }

 private:
    static constexpr double outside = -0.3;  // least barycentric coordinate that is still near the triangle

    static bool curved(const double (&x)[6][2]) {
        const double size = std::abs(x[1][0] - x[0][0]) + std::abs(x[1][1] - x[0][1]);
        for (int i = 0; i < 3; ++i)
            for (int a = 0; a < 2; ++a)
                if (std::abs(x[3 + i][a] - 0.5 * (x[i][a] + x[(i + 1) % 3][a])) > 1e-12 * size) return true;
        return false;
    }

    // Newton's method from the coordinates in the straight triangle, which stay where it finds nothing near.
    static void bend(const double (&x)[6][2], const double* point, double (&xi)[2]) {
        double at[2] = {xi[0], xi[1]};
        for (int step = 0; step < 12; ++step) {
            double value[6] = {}, slope[6][2] = {}, r[2] = {-point[0], -point[1]}, J[2][2] = {};
            Quadratic<2>::values(at, value);
            Quadratic<2>::slopes(at, slope);
            for (int i = 0; i < 6; ++i)
                for (int a = 0; a < 2; ++a) {
                    r[a] += x[i][a] * value[i];
                    for (int b = 0; b < 2; ++b) J[a][b] += x[i][a] * slope[i][b];
                }
            const double determinant = J[0][0] * J[1][1] - J[0][1] * J[1][0];
            const double d0 = (J[1][1] * r[0] - J[0][1] * r[1]) / determinant;
            const double d1 = (J[0][0] * r[1] - J[1][0] * r[0]) / determinant;
            at[0] -= d0, at[1] -= d1;
            if (!(std::abs(d0) + std::abs(d1) < 2.0)) return;
            if (std::abs(d0) + std::abs(d1) < 1e-14) break;
        }
        if (std::min({at[0], at[1], 1.0 - at[0] - at[1]}) < outside) return;
        xi[0] = at[0], xi[1] = at[1];
    }

    const double* X_;
    const std::int32_t* cells_;
    Locator straight_;
};

}  // namespace restshape
