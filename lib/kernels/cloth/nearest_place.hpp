// The nearest place of a triangle: Ericson, Real-time collision detection (2005), 5.1.5.
#pragma once

#include <algorithm>

namespace restshape {

// Where a + u (b - a) + v (c - a) is nearest to y: at a corner, on an edge, or inside.
inline void nearest_place(const double* a, const double* b, const double* c, const double* y, double* at) {
    double ab[3], ac[3];
    // How far y goes along both edges, as seen from each corner.
    double ab_a = 0.0, ac_a = 0.0, ab_b = 0.0, ac_b = 0.0, ab_c = 0.0, ac_c = 0.0;
    for (int k = 0; k < 3; ++k) {
        ab[k] = b[k] - a[k], ac[k] = c[k] - a[k];
        ab_a += ab[k] * (y[k] - a[k]), ac_a += ac[k] * (y[k] - a[k]);
        ab_b += ab[k] * (y[k] - b[k]), ac_b += ac[k] * (y[k] - b[k]);
        ab_c += ab[k] * (y[k] - c[k]), ac_c += ac[k] * (y[k] - c[k]);
    }
    const auto put = [&](double u, double v) {
        for (int k = 0; k < 3; ++k) at[k] = a[k] + (u * ab[k] + v * ac[k]);
    };
    if (ab_a <= 0.0 && ac_a <= 0.0) return put(0.0, 0.0);
    if (ab_b >= 0.0 && ac_b <= ab_b) return void(std::copy(b, b + 3, at));
    if (ac_c >= 0.0 && ab_c <= ac_c) return void(std::copy(c, c + 3, at));
    // Areas of the parts that y makes of the triangle: negative where it is beyond an edge.
    const double above_ab = ab_a * ac_b - ab_b * ac_a, above_ac = ab_c * ac_a - ab_a * ac_c;
    const double above_bc = ab_b * ac_c - ab_c * ac_b;
    if (above_ab <= 0.0 && ab_a >= 0.0 && ab_b <= 0.0) return put(ab_a / (ab_a - ab_b), 0.0);
    if (above_ac <= 0.0 && ac_a >= 0.0 && ac_c <= 0.0) return put(0.0, ac_a / (ac_a - ac_c));
    const double from_b = ac_b - ab_b, from_c = ab_c - ac_c;
    if (above_bc <= 0.0 && from_b >= 0.0 && from_c >= 0.0) {
        const double v = from_b / (from_b + from_c);
        return put(1.0 - v, v);
    }
    const double all = above_bc + above_ac + above_ab;
    put(above_ac / all, above_ab / all);
}

}  // namespace restshape
