// Heat that a fluid carries and conducts, on linear triangles, stabilised by SUPG.
#pragma once

#include "fem/shapes.hpp"
#include "flow/stabilisation.hpp"

namespace restshape {

// What a fluid is to heat: heat capacity by volume [J/(m^3 K)], conductivity [W/(m K)], factor of the equation, source
// [W/m^3]; in time the factor of the temperature in its rate and 2 over the step, both [1/s].
struct Carrier {
    double capacity, conductivity, factor, source;
    double rate = 0.0, stepping = 0.0;
};

// Residual of C (dT/dt + a . grad T) = div(k grad T) + source of one cell, times the factor.
//
// G: gradients of the shapes; third: of the area; a: what carries, at the nodes; T: temperatures; past: what older
// temperatures add to the rate, in time.
template <bool in_time, class SX, class A, class ST, class R>
[[gnu::always_inline]] inline void advected_heat(const SX (&G)[3][2], const SX& third, const A (&a)[3][2],
                                                 const ST (&T)[3], [[maybe_unused]] const SX (&past)[3],
                                                 const Carrier& p, R (&out)[3]) {
    using Shape = Solid<Linear<2>, TriRule3>;
    const SX hh = third * (3.0 * size_by_area);
    A mean[2];
    R slope[2];
    for (int k = 0; k < 2; ++k) {
        mean[k] = (a[0][k] + a[1][k] + a[2][k]) * (1.0 / 3.0);
        slope[k] = T[0] * G[0][k] + T[1] * G[1][k] + T[2] * G[2][k];
    }
    const A tau = stabilising_time<in_time, SX, A>(mean[0] * mean[0] + mean[1] * mean[1], hh,
                                                   4.0 * p.conductivity / p.capacity, p.stepping);
    R along[2] = {R(0.0), R(0.0)};
    for (int i = 0; i < 3; ++i) out[i] = R(0.0);
    for (int q = 0; q < Shape::points; ++q) {
        const auto& N = Shape::table.value[q];
        A here[2];
        for (int k = 0; k < 2; ++k) here[k] = a[0][k] * N[0] + a[1][k] * N[1] + a[2][k] * N[2];
        R gained = (slope[0] * here[0] + slope[1] * here[1]) * p.capacity - p.source;
        if constexpr (in_time)
            for (int i = 0; i < 3; ++i) gained += (T[i] * p.rate + past[i]) * (p.capacity * N[i]);
        for (int i = 0; i < 3; ++i) out[i] += gained * N[i] * third;
        for (int k = 0; k < 2; ++k) along[k] += gained * here[k];
    }
    const SX area = third * 3.0;
    for (int i = 0; i < 3; ++i) {
        out[i] += (slope[0] * G[i][0] + slope[1] * G[i][1]) * (area * p.conductivity);
        out[i] += (along[0] * G[i][0] + along[1] * G[i][1]) * tau * third;
        out[i] = out[i] * p.factor;
    }
}

}  // namespace restshape
