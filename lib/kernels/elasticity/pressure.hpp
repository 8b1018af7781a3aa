// Pressure that follows the deformed sides of an outline: residual -int N (-p n) over the deformed side.
//
// n da is linear in the places X + u of the nodes, so quadrature is exact and a closed chain of uniform pressure has no
// resultant. The tangent is symmetric but for the ends of a loaded chain and where the pressure varies.
#pragma once

#include <string>
#include <vector>

#include "fem/shapes.hpp"

namespace restshape {

template <class Shape>
struct PressureElement {
    static constexpr int nodes = Shape::nodes, dim = 2, fields = 2;
    static constexpr bool symmetric = false, has_tangent = true;
    static constexpr int stress_components = 0;

    // Pressure [Pa] at both ends, positive towards the body (material on the left of a side).
    static std::vector<std::string> parameters() { return {"p0", "p1", "thickness"}; }

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        R place[nodes * 2];
        for (int k = 0; k < nodes * 2; ++k) place[k] = x[k] + X[k];
        for (int k = 0; k < nodes * fields; ++k) r[k] = R(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            R T[2];
            Shape::tangent(q, place, T);
            const double s = Shape::Rule::at[q][0];
            const double pressure = ((1 - s) * p[0] + s * p[1]) * Shape::Rule::weight[q] * p[2];
            for (int i = 0; i < nodes; ++i) {
                const double share = pressure * Shape::table.value[q][i];
                r[i * 2] += T[1] * share;
                r[i * 2 + 1] -= T[0] * share;
            }
        }
    }
};

}  // namespace restshape
