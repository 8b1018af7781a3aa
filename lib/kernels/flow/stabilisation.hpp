// Times and lengths of stabilised flow and heat on linear triangles.
//
// Source: Tezduyar, Mittal, Ray and Shih, Comput. Methods Appl. Mech. Engng 95 (1992) 221, tau as their (3.11).
#pragma once

#include "fem/dual.hpp"
#include "fem/pack.hpp"

namespace restshape {

// The square of the largest rate 2 / dt that counts in tau, over that of convection and viscosity: with a tau that goes
// to 0 with the step, nothing would keep the pressure smooth.
constexpr double most_stepping = 1.0;

// The square of the length h of a cell in tau, over its area. Linear triangles have no viscous force inside, so that
// their strong residual lacks it, and a larger h costs accuracy: that of the circle of the same area, 4 / pi, gives the
// lid-driven cavity at Re = 1000 six times the error (docs/theory/flow.md).
constexpr double size_by_area = 0.5;

// tau [s], and its derivative by the square of the speed.
//
// square: of a speed; hh: of a length; spreading: 4 times a diffusivity [m^2/s]; stepping: 2 over the step [1/s]. Where
// nothing advects, the square is not read.
template <bool advects, bool in_time, class SX, class A, class P>
struct StabilisingTime {
    A rates, tau;

    [[gnu::always_inline]] StabilisingTime([[maybe_unused]] const A& square, const SX& hh, const P& spreading,
                                           [[maybe_unused]] const P& stepping) {
        const SX viscous = spreading / hh;
        if constexpr (advects)
            rates = square * (4.0 / hh) + viscous * viscous;
        else
            rates = A(viscous * viscous);
        if constexpr (in_time)
            tau = 1.0 / square_root(counts(stepping) ? A(rates + stepping * stepping) : A(rates * most));
        else
            tau = 1.0 / square_root(rates);
    }

    A slope(const SX& hh, [[maybe_unused]] const P& stepping) const {
        const A steady = tau * tau * tau * (-2.0 / hh);
        if constexpr (in_time) return counts(stepping) ? steady : A(steady * most);
        return steady;
    }

 private:
    static constexpr double most = 1.0 + most_stepping;

    auto counts(const P& stepping) const { return stepping * stepping < most_stepping * value_of(rates); }
};

}  // namespace restshape
