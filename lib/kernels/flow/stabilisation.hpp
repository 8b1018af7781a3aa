// Times and lengths of stabilised flow and heat on linear triangles.
//
// Source: Tezduyar, Mittal, Ray and Shih, Comput. Methods Appl. Mech. Engng 95 (1992) 221, tau as their (3.11).
#pragma once

#include "fem/dual.hpp"
#include "fem/pack.hpp"

namespace restshape {

// The square of the length h of a cell in tau, over its area. Linear triangles have no viscous force inside, so that
// their strong residual lacks it, and a larger h costs accuracy: that of the circle of the same area, 4 / pi, gives the
// lid-driven cavity at Re = 1000 six times the error (docs/theory/flow.md).
constexpr double size_by_area = 0.5;

// tau [s], and its derivative by the square of the speed.
//
// square: of a speed; hh: of a length; spreading: 4 times a diffusivity [m^2/s]; stepping: 2 over the step [1/s], as
// far as it counts. Where nothing advects, the square is not read.
template <bool advects, bool in_time, class SX, class A, class P>
struct StabilisingTime {
    A tau;

    [[gnu::always_inline]] StabilisingTime([[maybe_unused]] const A& square, const SX& hh, const P& spreading,
                                           [[maybe_unused]] const P& stepping) {
        const SX viscous = spreading / hh;
        A rates = A(viscous * viscous);
        if constexpr (advects) rates += square * (4.0 / hh);
        if constexpr (in_time) rates += stepping * stepping;
        tau = 1.0 / square_root(rates);
    }

    A slope(const SX& hh) const { return tau * tau * tau * (-2.0 / hh); }
};

}  // namespace restshape
