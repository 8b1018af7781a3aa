// Times and lengths of stabilised flow and heat on linear triangles.
//
// Source: Tezduyar, Mittal, Ray and Shih, Comput. Methods Appl. Mech. Engng 95 (1992) 221, tau as their (3.11).
#pragma once

#include <cmath>

#include "fem/dual.hpp"

namespace restshape {

// The square of the largest rate 2 / dt that counts in tau, over that of convection and viscosity: with a tau that goes
// to 0 with the step, nothing would keep the pressure smooth.
constexpr double most_stepping = 1.0;

// The square of the length h of a cell in tau, over its area. Linear triangles have no viscous force inside, so that
// their strong residual lacks it, and a larger h costs accuracy: that of the circle of the same area, 4 / pi, gives the
// lid-driven cavity at Re = 1000 ten times the error (docs/theory/flow.md).
constexpr double size_by_area = 0.5;

// tau [s] of the square of a speed, that of a length, 4 times a diffusivity [m^2/s], and 2 over the step [1/s].
template <bool in_time, class SX, class A>
inline A stabilising_time(const A& square, const SX& hh, double spreading, double stepping) {
    using std::sqrt;
    const SX viscous = spreading / hh;
    const A steady = square * (4.0 / hh) + viscous * viscous;
    if constexpr (!in_time) return 1.0 / sqrt(steady);
    const double squared = stepping * stepping;
    if (squared < most_stepping * value_of(steady)) return 1.0 / sqrt(steady + squared);
    return 1.0 / sqrt(steady * (1.0 + most_stepping));
}

}  // namespace restshape
