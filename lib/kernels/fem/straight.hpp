// Second-order tetrahedra with straight sides, as most of them are: their matrices are exact with fewer points.
#pragma once

#include "fem/mass.hpp"

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

// Consistent mass of straight cells: one matrix for all of them, times the volume.
template <class Shape, int Fields>
struct StraightMassElement {
    static constexpr int nodes = Shape::nodes, fields = Fields;

    static void tangent(const double* X, const double* x, const double* p, double* r, double* K) {
        constexpr int n = nodes * fields, stride = Dual<n>::lanes;
        double J[3][3], C[3][3];
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) J[a][b] = X[3 * (b + 1) + a] - X[a];
        const double mass = cofactors(J, C) * p[0];
        std::fill(K, K + n * stride, 0.0);
        for (int i = 0; i < nodes; ++i)
            for (int a = 0; a < fields; ++a) {
                double force = 0.0;
                for (int j = 0; j < nodes; ++j) {
                    const double entry = unit.entry[i][j] * mass;
                    K[(i * fields + a) * stride + j * fields + a] = entry;
                    force += entry * x[j * fields + a];
                }
                r[i * fields + a] = force;
            }
    }

 private:
    struct Products {
        double entry[nodes][nodes] = {};

        constexpr Products() {
            for (int q = 0; q < Shape::points; ++q)
                for (int i = 0; i < nodes; ++i)
                    for (int j = 0; j < nodes; ++j)
                        entry[i][j] += Shape::Rule::weight[q] * Shape::table.value[q][i] * Shape::table.value[q][j];
        }
    };
    static constexpr Products unit{};
};

}  // namespace restshape
