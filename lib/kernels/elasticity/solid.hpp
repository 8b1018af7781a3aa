// Solids: a law on a shape. x is the displacement u.
#pragma once

#include "elasticity/solid_parts.hpp"

namespace restshape {

template <class Shape, class Law>
struct SolidElement : SolidParts<Shape> {
    using Parts = SolidParts<Shape>;
    using Parts::dim;
    using Parts::nodes;

    // Flat, like the tangent: with many elements in one file the compiler would stop inlining, at half the speed.
    template <class SX, class Sx, class R>
    [[gnu::flatten]] static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][dim];
            const SX volume = Shape::gradients(q, X, G) * Parts::thickness(p);
            R H[dim][dim], P[dim][dim];
            Parts::displacement_gradient(G, x, H);
            stress_of(H, p, P);
            Parts::add_forces(q, G, volume, P, Parts::body(p), r);
        }
    }

    // Dual numbers carry the law's derivatives in H only: as many lanes as H has components, not as there are unknowns.
    [[gnu::flatten]] static void tangent(const double* X, const double* x, const double* p, double* r, double* K) {
        for (int q = 0; q < Shape::points; ++q) {
            double G[nodes][dim], H[dim][dim];
            const double volume = Shape::gradients(q, X, G) * Parts::thickness(p);
            typename Parts::Modulus Hd[dim][dim], P[dim][dim];
            Parts::displacement_gradient(G, x, H);
            Parts::seed(H, Hd);
            stress_of(Hd, p, P);
            Parts::add_forces_and_tangent(q, G, volume, P, Parts::body(p), r, K);
        }
    }

    // Of several elements, one a lane, where they have few unknowns; of several points or in space Hooke's law alone.
    static constexpr bool packed = dim == 2 ? Shape::points == 1 || Law::linear : Shape::points == 1 && Law::linear;

    [[gnu::flatten]] static void packed_residual(const Pack* X, const Pack* x, const Pack*, const Pack* p, Pack* r) {
        for (int q = 0; q < Shape::points; ++q) {
            Pack G[nodes][dim];
            add_packed_forces(q, X, x, p, G, r);
        }
    }

    [[gnu::flatten]] static void packed_tangent(const Pack* X, const Pack* x, const Pack*, const Pack* p, Pack* r,
                                                Pack* K) {
        if constexpr (Shape::points > 1) {
            typename Parts::GradientProducts products;
            for (int q = 0; q < Shape::points; ++q) {
                Pack G[nodes][dim];
                const Pack volume = add_packed_forces(q, X, x, p, G, r);
                products.add(q, G, volume);
            }
            Parts::set_hooke_tangent(products, p[0], p[1], K);
            return;
        }
        Pack G[nodes][dim], H[dim][dim];
        const Pack volume = Parts::times_thickness(Shape::gradients(0, X, G), p);
        Parts::displacement_gradient(G, x, H);
        if constexpr (dim == 3) {
            Pack stress[dim][dim];
            stress_of(H, p, stress);
            Parts::add_forces(0, G, volume, stress, Parts::body(p), r);
            Parts::set_hooke_tangent(G, volume, p[0], p[1], K);
            return;
        }
        PackDual<dim * dim> Hd[dim][dim], P[dim][dim];
        for (int a = 0; a < dim; ++a)
            for (int k = 0; k < dim; ++k) Hd[a][k] = PackDual<dim * dim>::seed(H[a][k], a * dim + k);
        stress_of(Hd, p, P);
        Parts::set_forces_and_tangent(G, volume, P, Parts::body(p), r, K);
    }

    // Stresses of small strains as of `stress`, likewise.
    [[gnu::flatten]] static void packed_stress(const Pack* X, const Pack* x, const Pack* p, const double* xi, Pack* s) {
        static_assert(dim == 2 && Law::linear, "for small strains in the plane");
        Pack G[nodes][dim], H[dim][dim], S[dim][dim];
        Shape::gradients_at(xi, X, G);
        Parts::displacement_gradient(G, x, H);
        stress_of(H, p, S);
        s[0] = S[0][0];
        s[1] = S[1][1];
        s[2] = S[0][1];
        s[3] = (H[0][0] + H[1][1]) * p[0];
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        R total(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][dim];
            const SX volume = Shape::gradients(q, X, G) * Parts::thickness(p);
            R H[dim][dim], E[dim][dim];
            Parts::displacement_gradient(G, x, H);
            Law::strain(H, E);
            const R dilatation = trace(E);
            total += (0.5 * p[0] * (dilatation * dilatation) + distortion_energy(E, p[1])) * volume;
            total -= Parts::work_of_body(q, volume, x, Parts::body(p));
        }
        return total;
    }

    // Cauchy stress at reference coordinates xi.
    static void stress(const double* X, const double* x, const double* p, const double* xi, double* s) {
        double G[nodes][dim], H[dim][dim], E[dim][dim];
        Shape::gradients_at(xi, X, G);
        Parts::displacement_gradient(G, x, H);
        Law::strain(H, E);
        Parts::template components<Law>(H, E, p[0] * trace(E), p[1], s);
    }

 private:
    // Forces of one point, and its gradients; returns the volume that it stands for.
    static Pack add_packed_forces(int q, const Pack* X, const Pack* x, const Pack* p, Pack (&G)[nodes][dim], Pack* r) {
        Pack H[dim][dim], P[dim][dim];
        const Pack volume = Parts::times_thickness(Shape::gradients(q, X, G), p);
        Parts::displacement_gradient(G, x, H);
        stress_of(H, p, P);
        Parts::add_forces(q, G, volume, P, Parts::body(p), r);
        return volume;
    }

    template <class R, class M>
    static void stress_of(const R (&H)[dim][dim], const M* p, R (&P)[dim][dim]) {
        R E[dim][dim], S[dim][dim];
        Law::strain(H, E);
        hooke(E, trace(E) * p[0], p[1], S);
        Law::first_piola(H, S, P);
    }
};

}  // namespace restshape
