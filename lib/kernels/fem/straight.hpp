// Second-order tetrahedra with straight sides, as most of them are: their matrices are exact with fewer points.
#pragma once

#include "fem/shapes.hpp"

namespace restshape {

// Whether all mid-sides of a tetrahedron lie in the middle of their sides, up to rounding.
inline bool has_straight_sides(const double* X) {
    double size = 0.0, bend = 0.0;
    for (int m = 0; m < 6; ++m) {
        const double *a = X + 3 * Quadratic<3>::sides[m][0], *b = X + 3 * Quadratic<3>::sides[m][1];
        const double* middle = X + 3 * (4 + m);
        for (int k = 0; k < 3; ++k) {
            size += std::abs(b[k] - a[k]);
            bend += std::abs(2 * middle[k] - a[k] - b[k]);
        }
    }
    return bend <= 1e-12 * size;
}

// An element of curved cells whose tangent is that of another one where the cell is straight.
template <class Curved, class Straight>
struct EitherElement : Curved {
    static void tangent(const double* X, const double* x, const double* p, double* r, double* K) {
        has_straight_sides(X) ? Straight::tangent(X, x, p, r, K) : Curved::tangent(X, x, p, r, K);
    }
};

}  // namespace restshape
