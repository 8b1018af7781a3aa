// The nearest place of a triangle: Ericson, Real-time collision detection (2005), 5.1.5.
#pragma once

namespace restshape {

// Where a + u (b - a) + v (c - a) is nearest to y: at a corner, on an edge, or inside. `Real` is a number, or several
// at once: all cases are computed, and the first of those that hold is chosen.
template <class Real>
[[gnu::always_inline]] inline void nearest_place(const double* a, const double* b, const double* c, const Real* y,
                                                 Real* at) {
    double ab[3], ac[3];
    // How far y goes along both edges, as seen from each corner.
    Real ab_a{}, ac_a{}, ab_b{}, ac_b{}, ab_c{}, ac_c{};
    for (int k = 0; k < 3; ++k) {
        ab[k] = b[k] - a[k], ac[k] = c[k] - a[k];
        const Real from_a = y[k] - a[k], from_b = y[k] - b[k], from_c = y[k] - c[k];
        ab_a += ab[k] * from_a, ac_a += ac[k] * from_a;
        ab_b += ab[k] * from_b, ac_b += ac[k] * from_b;
        ab_c += ab[k] * from_c, ac_c += ac[k] * from_c;
    }
    // Areas of the parts that y makes of the triangle: negative where it is beyond an edge.
    const Real above_ab = ab_a * ac_b - ab_b * ac_a, above_ac = ab_c * ac_a - ab_a * ac_c;
    const Real above_bc = ab_b * ac_c - ab_c * ac_b, all = above_bc + above_ac + above_ab;
    const Real zero{}, one = zero + 1.0, from_b = ac_b - ab_b, from_c = ab_c - ac_c;
    const Real along_bc = from_b / (from_b + from_c);
    Real u = above_ac / all, v = above_ab / all;
    const auto choose = [&](const auto& where, const Real& chosen_u, const Real& chosen_v) {
        u = where ? chosen_u : u, v = where ? chosen_v : v;
    };
    choose((above_bc <= 0.0) & (from_b >= 0.0) & (from_c >= 0.0), one - along_bc, along_bc);
    choose((above_ac <= 0.0) & (ac_a >= 0.0) & (ac_c <= 0.0), zero, ac_a / (ac_a - ac_c));
    choose((above_ab <= 0.0) & (ab_a >= 0.0) & (ab_b <= 0.0), ab_a / (ab_a - ab_b), zero);
    choose((ac_c >= 0.0) & (ab_c <= ac_c), zero, one);
    choose((ab_b >= 0.0) & (ac_b <= ab_b), one, zero);
    choose((ab_a <= 0.0) & (ac_a <= 0.0), zero, zero);
    for (int k = 0; k < 3; ++k) at[k] = a[k] + (u * ab[k] + v * ac[k]);
}

}  // namespace restshape
