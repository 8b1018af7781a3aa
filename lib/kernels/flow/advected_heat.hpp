// Heat that a fluid advects and conducts, on linear triangles, stabilised by SUPG.
#pragma once

#include "flow/advecting.hpp"

namespace restshape {

// What a fluid is to heat: heat capacity by volume [J/(m^3 K)], conductivity [W/(m K)], factor of the equation, source
// [W/m^3]; in time the factor of the temperature in its rate and 2 over the step, both [1/s].
template <class P>
struct Carrier {
    P capacity, conductivity, factor, source, rate{}, stepping{};

    P spreading() const { return 4.0 * conductivity / capacity; }
};

// Residual of C (dT/dt + a . grad T) = div(k grad T) + source of one cell, times the factor.
template <bool in_time, class SX, class A, class R, class P>
struct AdvectedHeat {
    Advecting<true, in_time, SX, A, P> by;
    Carrier<P> p;
    R slope[2], gained[3], sum, along[2];  // the gain at the nodes, its sum, its integrals with what advects

    // G: gradients of the shapes; third: of the area; a: what advects, at the nodes; temperatures; past: what older
    // temperatures add to the rate, in time.
    template <class ST>
    [[gnu::always_inline]] AdvectedHeat(const SX (&G)[3][2], const SX& third, const A (&a)[3][2],
                                        const ST (&temperature)[3], [[maybe_unused]] const SX (&past)[3],
                                        const Carrier<P>& carrier)
        : by(G, third, carrier.rate, carrier.stepping), p(carrier) {
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 2; ++k) by.speed[i][k] = a[i][k];
        by.set_speed(p.spreading());
        for (int k = 0; k < 2; ++k)
            slope[k] = temperature[0] * G[0][k] + temperature[1] * G[1][k] + temperature[2] * G[2][k];
        for (int i = 0; i < 3; ++i) {
            gained[i] = (slope[0] * by.speed[i][0] + slope[1] * by.speed[i][1]) * p.capacity - p.source;
            if constexpr (in_time) gained[i] += (temperature[i] * p.rate + past[i]) * p.capacity;
        }
        sum = gained[0] + gained[1] + gained[2];
        for (int m = 0; m < 2; ++m) along[m] = by.along(gained[0], gained[1], gained[2], sum, m);
    }

    // Of node i.
    [[gnu::always_inline]] R residual(int i) const {
        const auto& G = by.G[i];
        R out = (slope[0] * G[0] + slope[1] * G[1]) * (by.area * p.conductivity);
        out += (gained[i] + sum) * by.part;
        out += (along[0] * G[0] + along[1] * G[1]) * by.tau;
        return out * p.factor;
    }
};

}  // namespace restshape
