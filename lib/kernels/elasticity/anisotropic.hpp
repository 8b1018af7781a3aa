// Solids of small strains whose stiffness is any symmetric matrix: wood, and what else has a grain. x is the
// displacement u.
#pragma once

#include "elasticity/solid_parts.hpp"

namespace restshape {

template <class Shape>
struct AnisotropicElement : SolidParts<Shape> {
    using Parts = SolidParts<Shape>;
    using Parts::dim;
    using Parts::flat;
    using Parts::nodes;
    static constexpr int strains = flat ? 3 : 6, constants = strains * (strains + 1) / 2;

    // The upper triangle of the stiffness, row by row, in Voigt's order xx yy zz yz xz xy; of xx yy xy in the plane,
    // where the caller chooses between plane stress and plane strain.
    static std::vector<std::string> parameters() {
        std::vector<std::string> names;
        for (int a = 1; a <= strains; ++a)
            for (int b = a; b <= strains; ++b) names.push_back("C" + number(a) + number(b));
        if (flat) names.push_back("thickness");
        for (const char* axis : {"bx", "by", "bz"})
            if (axis[1] != 'z' || !flat) names.push_back(axis);
        return names;
    }

    template <class SX, class Sx, class R>
    [[gnu::flatten]] static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][dim];
            const SX volume = Shape::gradients(q, X, G) * thickness(p);
            R H[dim][dim], s[strains], P[dim][dim];
            Parts::displacement_gradient(G, x, H);
            stress_of(H, p, s);
            for (int a = 0; a < dim; ++a)
                for (int k = 0; k < dim; ++k) P[a][k] = s[place(a, k)];
            Parts::add_forces(q, G, volume, P, body(p), r);
        }
    }

    [[gnu::flatten]] static void tangent(const double* X, const double* x, const double* p, double* r, double* K) {
        for (int q = 0; q < Shape::points; ++q) {
            double G[nodes][dim], H[dim][dim], s[strains];
            const double volume = Shape::gradients(q, X, G) * thickness(p);
            Parts::displacement_gradient(G, x, H);
            stress_of(H, p, s);
            typename Parts::Modulus P[dim][dim];
            for (int a = 0; a < dim; ++a)
                for (int k = 0; k < dim; ++k) {
                    P[a][k] = s[place(a, k)];
                    for (int m = 0; m < Parts::moduli; ++m)
                        P[a][k].d[m] = constant(p, place(a, k), place(m / dim, m % dim));
                }
            Parts::add_forces_and_tangent(q, G, volume, P, body(p), r, K);
        }
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        R total(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][dim];
            const SX volume = Shape::gradients(q, X, G) * thickness(p);
            R H[dim][dim], s[strains], density(0.0);
            Parts::displacement_gradient(G, x, H);
            stress_of(H, p, s);
            for (int a = 0; a < dim; ++a)
                for (int k = 0; k < dim; ++k) density += s[place(a, k)] * H[a][k];
            total += density * volume * 0.5;
            total -= Parts::work_of_body(q, volume, x, body(p));
        }
        return total;
    }

    // At reference coordinates xi; normal to the plane of a flat one it is 0.
    static void stress(const double* X, const double* x, const double* p, const double* xi, double* out) {
        double G[nodes][dim], H[dim][dim], s[strains];
        Shape::gradients_at(xi, X, G);
        Parts::displacement_gradient(G, x, H);
        stress_of(H, p, s);
        out[0] = s[0];
        out[1] = s[1];
        out[2] = s[strains - 1];
        out[3] = flat ? 0.0 : s[2];
        for (int m = 4; m < Parts::stress_components; ++m) out[m] = s[m - 1];
    }

 private:
    static std::string number(int a) { return std::to_string(a == strains && flat ? 6 : a); }
    static double thickness(const double* p) { return flat ? p[constants] : 1.0; }
    static const double* body(const double* p) { return p + constants + (flat ? 1 : 0); }

    // Voigt's number of a component.
    static constexpr int place(int a, int k) { return a == k ? a : (flat ? 2 : 6 - a - k); }

    static double constant(const double* p, int a, int b) {
        const int row = a < b ? a : b, column = a < b ? b : a;
        return p[row * strains - row * (row - 1) / 2 + column - row];
    }

    template <class R>
    static void stress_of(const R (&H)[dim][dim], const double* p, R (&s)[strains]) {
        R e[strains];
        for (int a = 0; a < dim; ++a) {
            e[a] = H[a][a];
            for (int b = 0; b < a; ++b) e[place(a, b)] = H[a][b] + H[b][a];
        }
        for (int a = 0; a < strains; ++a) {
            s[a] = e[0] * constant(p, a, 0);
            for (int b = 1; b < strains; ++b) s[a] += e[b] * constant(p, a, b);
        }
    }
};

}  // namespace restshape
