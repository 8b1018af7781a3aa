// Inertia: residual M x with x the acceleration; its energy is x.Mx/2 (the kinetic energy when x is the velocity).
#pragma once

#include <string>
#include <vector>

#include "shapes.hpp"

namespace restshape {

// Lumped mass: rows summed onto the diagonal; the basis functions sum to one.
template <class Shape, int Fields>
struct LumpedMassElement {
    static constexpr int nodes = Shape::nodes, dim = Shape::dim, fields = Fields;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0;

    // Mass per volume in 3D, density times thickness in 2D.
    static std::vector<std::string> parameters() { return {"density"}; }

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        for (int k = 0; k < nodes * fields; ++k) r[k] = R(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][dim];
            const SX mass = Shape::gradients(q, X, G) * p[0];
            const auto& N = Shape::table.value[q];
            for (int i = 0; i < nodes; ++i)
                for (int a = 0; a < fields; ++a) r[i * fields + a] += x[i * fields + a] * (mass * N[i]);
        }
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        R r[nodes * fields];
        residual(X, x, p, r);
        R total(0.0);
        for (int k = 0; k < nodes * fields; ++k) total += 0.5 * (x[k] * r[k]);
        return total;
    }
};

// Consistent mass of first-order simplices: the integral of N_i N_j is V (1 + [i = j]) / ((d + 1)(d + 2)), exactly.
template <class Shape, int Fields>
struct SimplexMassElement {
    static constexpr int nodes = Shape::nodes, dim = Shape::dim, fields = Fields;
    static_assert(nodes == dim + 1 && Shape::points == 1, "for first-order simplices with one quadrature point");
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0;

    // Mass per volume in 3D, density times thickness in 2D.
    static std::vector<std::string> parameters() { return {"density"}; }

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        SX G[nodes][dim];
        const SX share = Shape::gradients(0, X, G) * (p[0] / ((dim + 1) * (dim + 2)));
        for (int a = 0; a < fields; ++a) {
            Sx sum = x[a];
            for (int j = 1; j < nodes; ++j) sum += x[j * fields + a];
            for (int i = 0; i < nodes; ++i) r[i * fields + a] = (sum + x[i * fields + a]) * share;
        }
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        R r[nodes * fields];
        residual(X, x, p, r);
        R total(0.0);
        for (int k = 0; k < nodes * fields; ++k) total += 0.5 * (x[k] * r[k]);
        return total;
    }
};

}  // namespace restshape
