// What a flow takes along through a linear triangle, such as momentum and heat: what advects, and how that gain
// changes.
#pragma once

#include "fem/shapes.hpp"
#include "flow/stabilisation.hpp"

namespace restshape {

// The cell, and what advects there. What is linear in it is integrated with the values at the nodes: the integral of
// N_i N_j is a twelfth of the area, that of N_i N_i a sixth.
template <bool advects, bool in_time, class SX, class A, class P>
struct Advecting {
    const SX (&G)[3][2];      // gradients of the shapes
    SX area, part, hh;        // part: a twelfth of the area; hh: the square of the length of the cell
    A speed[3][2], whole[2];  // at the nodes, and their sum
    A mean[2], square, tau;   // square: of the mean
    P rate, stepping;         // factor of the unknown in its rate, and 2 over the step [1/s]

    Advecting(const SX (&gradients)[3][2], const SX& third, const P& factor, const P& twice_by_step)
        : G(gradients),
          area(third * 3.0),
          part(third * 0.25),
          hh(third * (3.0 * size_by_area)),
          rate(factor),
          stepping(twice_by_step) {}

    // Take up the speeds; spreading: 4 times the diffusivity [m^2/s].
    [[gnu::always_inline]] void set_speed(const P& spreading) {
        if constexpr (advects) {
            for (int k = 0; k < 2; ++k) {
                whole[k] = speed[0][k] + speed[1][k] + speed[2][k];
                mean[k] = whole[k] * (1.0 / 3.0);
            }
            square = mean[0] * mean[0] + mean[1] * mean[1];
        }
        tau = StabilisingTime<advects, in_time, SX, A, P>(square, hh, spreading, stepping).tau;
    }

    // The integral of a sum over the nodes of values times what advects.
    template <class R>
    [[gnu::always_inline]] R along(const R& a, const R& b, const R& c, const R& sum, int m) const {
        return (a * speed[0][m] + b * speed[1][m] + c * speed[2][m] + sum * whole[m]) * part;
    }
};

// How the gain at the nodes changes with what is advected there, and that gain's integrals with what advects.
template <bool advects, bool by_itself, bool in_time, class T>
struct Transport {
    T nodal[3][3], total[3];  // of i by j, and its sum over i
    T advected[3][2];         // the integral of its products with what advects, times tau
    T by_tau[2];              // of tau by a component of any velocity

    // capacity: what times rate and convection is the gain.
    [[gnu::always_inline]] Transport(const Advecting<advects, in_time, T, T, T>& at, const T& capacity,
                                     const T& spreading) {
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 3; ++i) {
                nodal[i][j] = T{};
                if constexpr (advects)
                    nodal[i][j] = (at.G[j][0] * at.speed[i][0] + at.G[j][1] * at.speed[i][1]) * capacity;
                if constexpr (in_time)
                    if (i == j) nodal[i][j] += capacity * at.rate;
            }
            total[j] = nodal[0][j] + nodal[1][j] + nodal[2][j];
            if constexpr (advects)
                for (int m = 0; m < 2; ++m)
                    advected[j][m] = at.along(nodal[0][j], nodal[1][j], nodal[2][j], total[j], m) * at.tau;
        }
        if constexpr (by_itself) {
            const StabilisingTime<advects, in_time, T, T, T> time(at.square, at.hh, spreading, at.stepping);
            for (int c = 0; c < 2; ++c) by_tau[c] = time.slope(at.hh) * at.mean[c] * (2.0 / 3.0);
        }
    }

    // Of what node i gains by what is advected at node j, with a conductivity.
    [[gnu::always_inline]] T gain(const Advecting<advects, in_time, T, T, T>& at, const T& conductivity, int i,
                                  int j) const {
        const T *G = at.G[i], *other = at.G[j];
        T sum = (G[0] * other[0] + G[1] * other[1]) * (conductivity * at.area) + (nodal[i][j] + total[j]) * at.part;
        if constexpr (advects) sum += advected[j][0] * G[0] + advected[j][1] * G[1];
        return sum;
    }

    // Of what node i gains by a gain at node j alone.
    [[gnu::always_inline]] static T share(const Advecting<advects, in_time, T, T, T>& at, int i, int j) {
        T sum = T{} + (i == j ? 2.0 : 1.0);
        if constexpr (advects) {
            const T *G = at.G[i], *speed = at.speed[j];
            sum += at.tau * ((speed[0] + at.whole[0]) * G[0] + (speed[1] + at.whole[1]) * G[1]);
        }
        return sum * at.part;
    }
};

}  // namespace restshape
