// Stresses and strain energies of first-order triangles of small strains, of several cells at once.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "fem/corners.hpp"
#include "fem/element.hpp"
#include "fem/pack.hpp"

namespace restshape {

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

// Triangles with corners X (n, 2) at displacements x (n, 2): cells (ne, 3), parameters of the element, one row where
// `stride` is 0, and whether they are in plane stress, where zz is 0.
struct Triangles {
    const double *X, *x;
    const int32_t* cells;
    const double* parameters;
    int stride;
    bool plane_stress;
};

// Finds stresses and energies of several of them at once.
class TriangleLoop {
 public:
    explicit TriangleLoop(const Triangles& on) : on_(on) {
        for (int lane = 0; lane < pack_lanes; ++lane) set_lane(same_, lane, on.parameters, known);
    }

    // Of cells with these nodes, a lane each, and their places; cell(lane) has the lane's row of parameters.
    template <class Cell>
    [[gnu::always_inline]] PackedStress stress(const int32_t* const (&nodes)[pack_lanes], const Pack (&corners)[2][3],
                                               const Cell& cell) const {
        Pack x[2][3];
        for (int i = 0; i < 3; ++i) corner_of(on_.x, nodes, i, x[0][i], x[1][i]);
        PackedStress found;
        if (on_.stride) {
            Pack own[known];
            for (int lane = 0; lane < pack_lanes; ++lane)
                set_lane(own, lane, on_.parameters + static_cast<size_t>(cell(lane)) * on_.stride, known);
            found = stress_of_triangles(corners, x, own);
        } else {
            found = stress_of_triangles(corners, x, same_);
        }
        if (on_.plane_stress) found.zz = Pack{};
        return found;
    }

 private:
    static constexpr int known = 5;
    Triangles on_;
    Pack same_[known] = {};
};

// Of all ne cells: writes energy (ne,), and stress (ne, 4), xx, yy, xy, zz, unless it is null.
inline void triangle_stress(const Triangles& on, int32_t ne, double* stress, double* energy) {
    if (ne == 0) return;
    const TriangleLoop loop(on);
    for (int32_t first = 0; first < ne; first += pack_lanes) {
        const int filled = std::min(pack_lanes, ne - first);
        // Lanes beyond the last cell repeat it.
        const auto cell = [&](int lane) { return first + std::min(lane, filled - 1); };
        const int32_t* nodes[pack_lanes];
        for (int lane = 0; lane < pack_lanes; ++lane) nodes[lane] = on.cells + 3 * static_cast<size_t>(cell(lane));
        Pack X[2][3];
        for (int i = 0; i < 3; ++i) corner_of(on.X, nodes, i, X[0][i], X[1][i]);
        const PackedStress found = loop.stress(nodes, X, cell);
        for (int lane = 0; lane < filled; ++lane) {
            energy[first + lane] = found.energy[lane];
            if (!stress) continue;
            double* to = stress + 4 * static_cast<size_t>(first + lane);
            to[0] = found.xx[lane], to[1] = found.yy[lane], to[2] = found.xy[lane], to[3] = found.zz[lane];
        }
    }
}

inline double root_of(double a) { return std::sqrt(a); }
[[gnu::always_inline]] inline Pack root_of(const Pack& a) { return square_root(a); }

// Von Mises' stress of plane states: xx, yy, xy, zz.
template <class Number>
[[gnu::always_inline]] inline Number equivalent_stress(const Number (&s)[4]) {
    const Number a = s[0] - s[1], b = s[1] - s[3], c = s[3] - s[0];
    return root_of(0.5 * (a * a + b * b + c * c) + 3.0 * s[2] * s[2]);
}

}  // namespace restshape
