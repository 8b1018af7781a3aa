// Dead loads on the sides of an outline: residual -int N (t - p n), n outward (material on the left of a side).
#pragma once

#include <string>
#include <vector>

#include "fem/shapes.hpp"

namespace restshape {

template <class Shape>
struct TractionElement {
    static constexpr int nodes = Shape::nodes, dim = 2, fields = 2;
    static constexpr bool symmetric = true, has_tangent = false;
    static constexpr int stress_components = 0;

    // Traction [Pa] and pressure [Pa] at both ends, linear between them in the side's own parameter.
    static std::vector<std::string> parameters() { return {"tx0", "ty0", "tx1", "ty1", "p0", "p1", "thickness"}; }

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx*, const double* p, R* r) {
        for (int k = 0; k < nodes * fields; ++k) r[k] = R(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            SX T[2], force[2];
            Shape::tangent(q, X, T);
            const double s = Shape::Rule::at[q][0], weight = Shape::Rule::weight[q] * p[6];
            const double pressure = (1 - s) * p[4] + s * p[5];
            const SX length = sqrt_of(T[0] * T[0] + T[1] * T[1]);
            force[0] = length * ((1 - s) * p[0] + s * p[2]) - T[1] * pressure;
            force[1] = length * ((1 - s) * p[1] + s * p[3]) + T[0] * pressure;
            for (int i = 0; i < nodes; ++i)
                for (int a = 0; a < 2; ++a) r[i * 2 + a] -= force[a] * (weight * Shape::table.value[q][i]);
        }
    }

    // The potential of the load.
    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        R r[nodes * fields];
        residual(X, x, p, r);
        R total(0.0);
        for (int k = 0; k < nodes * fields; ++k) total += x[k] * r[k];
        return total;
    }

 private:
    template <class S>
    static S sqrt_of(const S& s) {
        using std::sqrt;
        return sqrt(s);
    }
};

}  // namespace restshape
