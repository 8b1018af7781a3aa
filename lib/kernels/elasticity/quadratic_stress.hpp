// Stresses of second-order triangles of small strains at given points, of several cells at once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "elasticity/solid.hpp"
#include "fem/element.hpp"

namespace restshape {

// X, x (n, 2); cells (ne, 6); parameters of the element, one row where `stride` is 0; reference coordinates at (m, 2).
// Writes stress (ne, m, 4): xx, yy, xy, zz of plane strain.
inline void quadratic_stress(const double* X, const double* x, const int32_t* cells, std::ptrdiff_t ne,
                             const double* parameters, int stride, const double* at, std::ptrdiff_t m, double* stress) {
    using Solid = SolidElement<Tri6Small, LinearElastic<2>>;
    constexpr int nodes = 6, moduli = 2, components = 4;
    Pack Xe[2 * nodes], xe[2 * nodes], p[moduli], s[components];
    for (std::ptrdiff_t first = 0; first < ne; first += pack_lanes) {
        const int filled = static_cast<int>(std::min<std::ptrdiff_t>(pack_lanes, ne - first));
        const int32_t* node[pack_lanes];
        for (int lane = 0; lane < pack_lanes; ++lane) {
            // Lanes beyond the last cell repeat it.
            const std::ptrdiff_t e = first + std::min(lane, filled - 1);
            node[lane] = cells + nodes * e;
            set_lane(p, lane, parameters + e * stride, moduli);
        }
        gather(node, nodes, 2, X, Xe);
        gather(node, nodes, 2, x, xe);
        for (std::ptrdiff_t q = 0; q < m; ++q) {
            Solid::packed_stress(Xe, xe, p, at + 2 * q, s);
            for (int lane = 0; lane < filled; ++lane)
                for (int k = 0; k < components; ++k) stress[((first + lane) * m + q) * components + k] = s[k][lane];
        }
    }
}

}  // namespace restshape
