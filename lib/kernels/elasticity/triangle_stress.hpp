// Stresses and strain energies of first-order triangles of small strains, of several cells at once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "fem/element.hpp"
#include "fem/pack.hpp"

namespace restshape {

// First and second coordinates of the nodes that a corner has in several cells, from (n, 2).
[[gnu::always_inline]] inline void corner_of(const double* places, const int32_t* const (&cells)[pack_lanes],
                                             int corner, Pack& first, Pack& second) {
    using Pair = double __attribute__((vector_size(2 * sizeof(double))));
    Pair pairs[pack_lanes];
#pragma GCC unroll 8
    for (int lane = 0; lane < pack_lanes; ++lane)
        std::memcpy(&pairs[lane], places + 2 * static_cast<size_t>(cells[lane][corner]), sizeof(Pair));
    const auto join = [&](int k) { return __builtin_shufflevector(pairs[k], pairs[k + 1], 0, 2, 1, 3); };
    const auto low = __builtin_shufflevector(join(0), join(2), 0, 1, 4, 5, 2, 3, 6, 7);
    const auto high = __builtin_shufflevector(join(4), join(6), 0, 1, 4, 5, 2, 3, 6, 7);
    first = __builtin_shufflevector(low, high, 0, 1, 2, 3, 8, 9, 10, 11);
    second = __builtin_shufflevector(low, high, 4, 5, 6, 7, 12, 13, 14, 15);
}

// What `triangle_stress` finds of several cells: their stresses by components, and energies.
struct PackedStress {
    Pack xx, yy, xy, zz, energy;
};

// Corners X of several triangles, first coordinates before second ones, and displacements x of them; p: lambda, mu,
// thickness and the body force.
[[gnu::always_inline]] inline PackedStress stress_of_triangles(const Pack (&X)[2][3], const Pack (&x)[2][3],
                                                               const Pack (&p)[5]) {
    const Pack ux = X[0][1] - X[0][0], uy = X[1][1] - X[1][0], vx = X[0][2] - X[0][0], vy = X[1][2] - X[1][0];
    const Pack ax = x[0][1] - x[0][0], ay = x[1][1] - x[1][0], bx = x[0][2] - x[0][0], by = x[1][2] - x[1][0];
    const Pack twice_area = ux * vy - vx * uy, inverse = 1.0 / twice_area;
    const Pack exx = (ax * vy - bx * uy) * inverse, eyy = (by * ux - ay * vx) * inverse;
    const Pack exy = 0.5 * ((bx * ux - ax * vx) + (ay * vy - by * uy)) * inverse;
    const Pack dilatation = exx + eyy, volumetric = p[0] * dilatation, twice_mu = 2.0 * p[1];
    const Pack density = 0.5 * (volumetric * dilatation) + p[1] * (exx * exx + eyy * eyy + 2.0 * (exy * exy));
    const Pack work = p[3] * (x[0][0] + x[0][1] + x[0][2]) + p[4] * (x[1][0] + x[1][1] + x[1][2]);
    const Pack energy = (density - work / 3.0) * (0.5 * twice_area * p[2]);
    return {twice_mu * exx + volumetric, twice_mu * eyy + volumetric, twice_mu * exy, volumetric, energy};
}

// X, x (n, 2); cells (ne, 3); parameters of the element, one row where `stride` is 0. Writes stress (ne, 4): xx, yy,
// xy, zz, of which zz is 0 in plane stress, and energy (ne,).
inline void triangle_stress(const double* X, const double* x, const int32_t* cells, std::ptrdiff_t ne,
                            const double* parameters, int stride, bool plane_stress, double* stress, double* energy) {
    constexpr int known = 5;
    Pack p[known] = {};
    for (int lane = 0; lane < pack_lanes && ne; ++lane) set_lane(p, lane, parameters, known);
    for (std::ptrdiff_t first = 0; first < ne; first += pack_lanes) {
        const int filled = static_cast<int>(std::min<std::ptrdiff_t>(pack_lanes, ne - first));
        const int32_t* corners[pack_lanes];
        for (int lane = 0; lane < pack_lanes; ++lane) {
            // Lanes beyond the last cell repeat it.
            const std::ptrdiff_t e = first + std::min(lane, filled - 1);
            corners[lane] = cells + 3 * e;
            if (stride) set_lane(p, lane, parameters + e * stride, known);
        }
        Pack Xe[2][3], xe[2][3];
        for (int i = 0; i < 3; ++i) {
            corner_of(X, corners, i, Xe[0][i], Xe[1][i]);
            corner_of(x, corners, i, xe[0][i], xe[1][i]);
        }
        PackedStress found = stress_of_triangles(Xe, xe, p);
        if (plane_stress) found.zz = Pack{};
        for (int lane = 0; lane < filled; ++lane) {
            double* to = stress + 4 * (first + lane);
            to[0] = found.xx[lane], to[1] = found.yy[lane], to[2] = found.xy[lane], to[3] = found.zz[lane];
            energy[first + lane] = found.energy[lane];
        }
    }
}

}  // namespace restshape
