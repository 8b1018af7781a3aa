// Shape quality of triangles, and the whole relocation step of a level-1 frame in one pass.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace restshape {

struct CellQuality {
    double min_quality = 1.0;
    int invalid = 0;
    int low_quality = 0;
};

// Checks triangles against the two thresholds of a criterion (docs/theory/levels-of-reuse.md). The quality is inscribed
// radius over longest edge, scaled to 1 for the equilateral triangle and signed like the area; the author's ratio
// longest edge x half perimeter / area is 2 sqrt(3) over it, so that one number serves both criteria.
inline CellQuality check_cells(const double* X, const std::int32_t* cells, std::ptrdiff_t count, double area_floor,
                               double quality_floor) {
    constexpr int lanes = 64;  // blocks that stay in the first-level cache and fill the vector registers
    using Lane = Eigen::Array<double, lanes, 1>;
    const double scale = 2.0 * std::sqrt(3.0);
    Lane ax, ay, bx, by, cx, cy;
    CellQuality found;
    double worst = 1.0;
    for (std::ptrdiff_t first = 0; first < count; first += lanes) {
        const auto size = std::min<std::ptrdiff_t>(lanes, count - first);
        for (std::ptrdiff_t j = 0; j < lanes; ++j) {
            const std::int32_t* cell = cells + 3 * (first + std::min(j, size - 1));
            ax[j] = X[2 * cell[0]], ay[j] = X[2 * cell[0] + 1];
            bx[j] = X[2 * cell[1]], by[j] = X[2 * cell[1] + 1];
            cx[j] = X[2 * cell[2]], cy[j] = X[2 * cell[2] + 1];
        }
        const Lane twice_area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
        const Lane a = ((cx - bx).square() + (cy - by).square()).sqrt();
        const Lane b = ((ax - cx).square() + (ay - cy).square()).sqrt();
        const Lane c = ((bx - ax).square() + (by - ay).square()).sqrt();
        const Lane quality = scale * twice_area / ((a + b + c) * a.max(b).max(c));
        worst = std::min(worst, quality.minCoeff());
        // Negated comparisons, so that a coordinate that is not a number counts as invalid.
        int invalid = 0, low_quality = 0;
        for (std::ptrdiff_t j = 0; j < size; ++j) {
            invalid += !(0.5 * twice_area[j] > area_floor);
            low_quality += !(quality[j] >= quality_floor);
        }
        found.invalid += invalid;
        found.low_quality += low_quality;
    }
    found.min_quality = worst;
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
