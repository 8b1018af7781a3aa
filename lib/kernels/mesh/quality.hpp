// Shape quality of triangles, and the whole relocation step of a level-1 frame in one pass.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "fem/corners.hpp"
#include "fem/pack.hpp"

namespace restshape {

struct CellQuality {
    double min_quality = 1.0;
    int invalid = 0;
    int low_quality = 0;
};

// Checks triangles against the two thresholds of a criterion (docs/theory/levels-of-reuse.md). The quality is inscribed
// radius over longest edge, scaled to 1 for the equilateral triangle and signed like the area; the author's ratio
// longest edge x half perimeter / area is 2 sqrt(3) over it, so that one number serves both criteria.
//
// No side is longer than the longest, so that 2 area / longest^2 times 2 / sqrt(3) is a quality from below: roots are
// taken where that is less than a floor, or than the worst so far.
inline CellQuality check_cells(const double* X, const std::int32_t* cells, std::ptrdiff_t count, double area_floor,
                               double quality_floor) {
    const double scale = 2.0 * std::sqrt(3.0);
    constexpr double sides = 3.0 * (1.0 + 1e-12);  // with room for rounding
    CellQuality found;
    for (std::ptrdiff_t first = 0; first < count; first += pack_lanes) {
        const int size = static_cast<int>(std::min<std::ptrdiff_t>(pack_lanes, count - first));
        const std::int32_t* cell[pack_lanes];
        for (int lane = 0; lane < pack_lanes; ++lane) cell[lane] = cells + 3 * (first + std::min(lane, size - 1));
        Pack x[3], y[3];
        for (int i = 0; i < 3; ++i) corner_of(X, cell, i, x[i], y[i]);
        const Pack ux = x[1] - x[0], uy = y[1] - y[0], vx = x[2] - x[0], vy = y[2] - y[0];
        const Pack wx = x[2] - x[1], wy = y[2] - y[1];
        const Pack twice_area = ux * vy - vx * uy;
        const Pack u = ux * ux + uy * uy, v = vx * vx + vy * vy, w = wx * wx + wy * wy;
        const Pack longest = larger(larger(u, v), w);
        const double floor = sides * std::max({found.min_quality, quality_floor, 0.0});
        // Negated comparisons, so that a coordinate that is not a number counts as invalid.
        if (all((scale * twice_area >= floor * longest) & (0.5 * twice_area > area_floor))) continue;
        const Pack perimeter = square_root(u) + square_root(v) + square_root(w);
        const Pack quality = scale * twice_area / (perimeter * square_root(longest));
        for (int lane = 0; lane < size; ++lane) {
            found.min_quality = std::min(found.min_quality, quality[lane]);
            found.invalid += !(0.5 * twice_area[lane] > area_floor);
            found.low_quality += !(quality[lane] >= quality_floor);
        }
    }
    return found;
}

// X = X_reference + c0 Psi[0] + c1 Psi[1] (docs/theory/moving-the-mesh.md).
inline void move_nodes(const double* X_reference, const double* Psi, double c0, double c1, double* X,
                       std::ptrdiff_t size) {
    for (std::ptrdiff_t i = 0; i < size; ++i) {
        X[i] = X_reference[i] + c0 * Psi[i] + c1 * Psi[size + i];
    }
}

// The most sides sqrt(2 A) of a triangle that its corners go, from X to Y; infinite where one has no area.
inline double sides_gone(const double* X, const double* Y, const std::int32_t* cells, std::ptrdiff_t count) {
    double most = 0.0;  // squared
    for (std::ptrdiff_t e = 0; e < count; ++e) {
        const std::int32_t* n = cells + 3 * e;
        double gone = 0.0;
        for (int i = 0; i < 3; ++i) {
            const double x = Y[2 * n[i]] - X[2 * n[i]], y = Y[2 * n[i] + 1] - X[2 * n[i] + 1];
            gone = std::max(gone, x * x + y * y);
        }
        if (gone == 0.0) continue;
        const double *a = X + 2 * n[0], *b = X + 2 * n[1], *c = X + 2 * n[2];
        const double twice = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if (!(twice > 0.0)) return std::numeric_limits<double>::infinity();
        most = std::max(most, gone / twice);
    }
    return std::sqrt(most);
}

}  // namespace restshape
