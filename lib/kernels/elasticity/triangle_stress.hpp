// Stresses and strain energies of first-order triangles of small strains, in one loop that knows the element.
#pragma once

#include <cstddef>
#include <cstdint>

#include "elasticity/solid.hpp"

namespace restshape {

// X, x (n, 2); cells (ne, 3); parameters of the element, one row where `stride` is 0. Writes stress (ne, 4): xx, yy,
// xy, zz, of which zz is 0 in plane stress, and energy (ne,).
inline void triangle_stress(const double* X, const double* x, const int32_t* cells, std::ptrdiff_t ne,
                            const double* parameters, int stride, bool plane_stress, double* stress, double* energy) {
    using Solid = SolidElement<Tri3, LinearElastic<2>>;
    constexpr double centre[2] = {1.0 / 3, 1.0 / 3};
    for (std::ptrdiff_t e = 0; e < ne; ++e) {
        double Xe[6], xe[6], s[4];
        for (int i = 0; i < 3; ++i) {
            const size_t node = static_cast<size_t>(cells[3 * e + i]);
            for (int a = 0; a < 2; ++a) Xe[2 * i + a] = X[2 * node + a], xe[2 * i + a] = x[2 * node + a];
        }
        const double* p = parameters + e * stride;
        // Both are inlined, and what they have in common is computed once.
        Solid::stress(Xe, xe, p, centre, s);
        energy[e] = Solid::energy(Xe, xe, p);
        if (plane_stress) s[3] = 0.0;
        for (int k = 0; k < 4; ++k) stress[4 * e + k] = s[k];
    }
}

}  // namespace restshape
