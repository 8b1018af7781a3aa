// Solids whose dilatation tr(E) is taken as its mean over the element in the energy lambda/2 tr(E)^2.
//
// The same as a displacement-pressure element with one constant pressure an element, which is eliminated. With
// second-order triangles the pair meets the inf-sup condition, so nearly incompressible bodies do not lock.
// Source: Nagtegaal, Parks and Rice, Comput. Methods Appl. Mech. Engng 4 (1974) 153; Boffi, Brezzi and Fortin, Mixed
// Finite Element Methods and Applications (2013), section 8.4.3 (the pair P2-P0).
#pragma once

#include "elasticity/solid_parts.hpp"

namespace restshape {

template <class Shape, class Law>
struct DilatationElement : SolidParts<Shape> {
    using Parts = SolidParts<Shape>;
    using Parts::dim;
    using Parts::nodes;

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        SX whole;
        const R volumetric = mean(X, x, whole) * p[0];
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][dim];
            const SX volume = Shape::gradients(q, X, G) * Parts::thickness(p);
            R H[dim][dim], E[dim][dim], S[dim][dim], P[dim][dim];
            Parts::displacement_gradient(G, x, H);
            Law::strain(H, E);
            hooke(E, volumetric, p[1], S);
            Law::first_piola(H, S, P);
            Parts::add_forces(q, G, volume, P, Parts::body(p), r);
        }
    }

    static void tangent(const double* X, const double* x, const double* p, double* r, double* K) {
        double whole;
        const double volumetric = mean(X, x, whole) * p[0];
        Row change = Row::Zero();  // of the integral of the dilatation, by the unknowns
        for (int q = 0; q < Shape::points; ++q) {
            double G[nodes][dim], H[dim][dim];
            const double volume = Shape::gradients(q, X, G);
            Modulus Hd[dim][dim], E[dim][dim], S[dim][dim], P[dim][dim];
            Parts::displacement_gradient(G, x, H);
            Parts::seed(H, Hd);
            Law::strain(Hd, E);
            hooke(E, volumetric, p[1], S);
            Law::first_piola(Hd, S, P);
            Parts::add_forces_and_tangent(q, G, volume * Parts::thickness(p), P, Parts::body(p), r, K);
            Row gradient[dim][dim];
            Parts::spread(G, gradient);
            const Modulus dilatation = trace(E);
            for (int m = 0; m < Parts::moduli; ++m) change += (volume * dilatation.d[m]) * gradient[m / dim][m % dim];
        }
        const double stiffness = p[0] * Parts::thickness(p) / whole;
        for (int i = 0; i < Parts::unknowns; ++i)
            typename Parts::RowMap(K + i * Parts::row_stride) += (stiffness * change[i]) * change;
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        SX whole;
        const R dilatation = mean(X, x, whole);
        R total = (0.5 * p[0] * Parts::thickness(p)) * (dilatation * dilatation) * whole;
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][dim];
            const SX volume = Shape::gradients(q, X, G) * Parts::thickness(p);
            R H[dim][dim], E[dim][dim];
            Parts::displacement_gradient(G, x, H);
            Law::strain(H, E);
            total += distortion_energy(E, p[1]) * volume;
            total -= Parts::work_of_body(q, volume, x, Parts::body(p));
        }
        return total;
    }

    static void stress(const double* X, const double* x, const double* p, const double* xi, double* s) {
        double G[nodes][dim], H[dim][dim], E[dim][dim], whole;
        Shape::gradients_at(xi, X, G);
        Parts::displacement_gradient(G, x, H);
        Law::strain(H, E);
        Parts::template components<Law>(H, E, p[0] * mean(X, x, whole), p[1], s);
    }

 private:
    using typename Parts::Modulus;
    using typename Parts::Row;

    // The mean dilatation, and the volume per thickness that it is the mean over.
    template <class SX, class Sx>
    static Common<SX, Sx> mean(const SX* X, const Sx* x, SX& whole) {
        using R = Common<SX, Sx>;
        R integral(0.0);
        whole = SX(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][dim];
            const SX volume = Shape::gradients(q, X, G);
            R H[dim][dim], E[dim][dim];
            Parts::displacement_gradient(G, x, H);
            Law::strain(H, E);
            integral += trace(E) * volume;
            whole += volume;
        }
        return integral / whole;
    }
};

}  // namespace restshape
