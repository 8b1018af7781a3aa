// A quadratic potential at one node: what contact, friction or a spring does there, as a block of an operator.
#pragma once

#include <string>
#include <vector>

#include "fem/dual.hpp"

namespace restshape {

// g . (x - x0) + (x - x0) . H (x - x0)/2. Where x is x0, residual and tangent are g and H.
struct PointPotentialElement {
    static constexpr int nodes = 1, dim = 2, fields = 3;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0;

    // Place x0 [m], gradient there [N], second derivatives [N/m].
    static std::vector<std::string> parameters() {
        return {"x0", "y0", "z0", "gx", "gy", "gz", "Hxx", "Hyy", "Hzz", "Hyz", "Hxz", "Hxy"};
    }

    template <class SX, class Sx, class R>
    static void residual(const SX*, const Sx* x, const double* p, R* r) {
        const Sx u[3] = {x[0] - p[0], x[1] - p[1], x[2] - p[2]};
        r[0] = R(u[0] * p[6] + u[1] * p[11] + u[2] * p[10] + p[3]);
        r[1] = R(u[0] * p[11] + u[1] * p[7] + u[2] * p[9] + p[4]);
        r[2] = R(u[0] * p[10] + u[1] * p[9] + u[2] * p[8] + p[5]);
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        Sx r[3], total(0.0);
        residual(X, x, p, r);
        for (int a = 0; a < 3; ++a) total += (x[a] - p[a]) * (0.5 * (r[a] + p[3 + a]));
        return Common<SX, Sx>(1.0) * total;
    }
};

}  // namespace restshape
