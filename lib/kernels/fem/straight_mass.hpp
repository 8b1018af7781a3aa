// Inertia of cells with straight sides: one matrix for all of them, times the volume.
#pragma once

#include "fem/shapes.hpp"

namespace restshape {

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
