// Solids: a law (energy density and stress of the displacement gradient H = du/dX) on a shape. x is the displacement u.
#pragma once

#include <string>
#include <vector>

#include "shapes.hpp"

namespace restshape {

// Small strains: psi = lambda/2 tr(eps)^2 + mu eps:eps (docs/theory.md, section 2).
template <int D>
struct LinearElastic {
    template <class R>
    static void stress(const R (&H)[D][D], const double* p, R (&P)[D][D]) {
        const double lambda = p[0], mu = p[1];
        R trace = H[0][0];
        for (int a = 1; a < D; ++a) trace += H[a][a];
        trace *= lambda;
        for (int a = 0; a < D; ++a) {
            P[a][a] = trace + H[a][a] * (2 * mu);
            for (int b = 0; b < a; ++b) P[a][b] = P[b][a] = (H[a][b] + H[b][a]) * mu;
        }
    }

    template <class R>
    static R energy(const R (&H)[D][D], const double* p) {
        R trace = H[0][0], square = H[0][0] * H[0][0];
        for (int a = 1; a < D; ++a) {
            trace += H[a][a];
            square += H[a][a] * H[a][a];
            for (int b = 0; b < a; ++b) square += 0.5 * ((H[a][b] + H[b][a]) * (H[a][b] + H[b][a]));
        }
        return 0.5 * p[0] * (trace * trace) + p[1] * square;
    }

    // Cauchy stress, and the normal stress out of the plane under plane strain.
    static double cauchy(const double (&H)[D][D], const double* p, double (&s)[D][D]) {
        stress(H, p, s);
        double trace = 0;
        for (int a = 0; a < D; ++a) trace += H[a][a];
        return p[0] * trace;
    }
};

// St. Venant-Kirchhoff: S = lambda tr(E) I + 2 mu E, E = (F^T F - I)/2, P = F S (docs/theory.md, section 2).
template <int D>
struct StVenantKirchhoff {
    template <class R>
    static void strain(const R (&H)[D][D], R (&E)[D][D]) {
        for (int a = 0; a < D; ++a)
            for (int b = 0; b <= a; ++b) {
                R e = H[a][b] + H[b][a];
                for (int k = 0; k < D; ++k) e += H[k][a] * H[k][b];
                E[a][b] = E[b][a] = 0.5 * e;
            }
    }

    template <class R>
    static void stress(const R (&H)[D][D], const double* p, R (&P)[D][D]) {
        R E[D][D], S[D][D];
        strain(H, E);
        LinearElastic<D>::stress(E, p, S);
        for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b) {
                P[a][b] = S[a][b];
                for (int k = 0; k < D; ++k) P[a][b] += H[a][k] * S[k][b];
            }
    }

    template <class R>
    static R energy(const R (&H)[D][D], const double* p) {
        R E[D][D];
        strain(H, E);
        return LinearElastic<D>::energy(E, p);
    }

    static double cauchy(const double (&H)[D][D], const double* p, double (&s)[D][D]) {
        double E[D][D], P[D][D], F[D][D], C[D][D];
        stress(H, p, P);
        for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b) F[a][b] = H[a][b] + (a == b);
        const double J = cofactors(F, C);
        for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b) {
                s[a][b] = 0;
                for (int k = 0; k < D; ++k) s[a][b] += P[a][k] * F[b][k] / J;
            }
        strain(H, E);
        double trace = 0;
        for (int a = 0; a < D; ++a) trace += E[a][a];
        return p[0] * trace / J;
    }
};

// Volumes [per metre of thickness], stresses and body forces integrated on a shape.
template <class Shape, class Law>
struct SolidElement {
    static constexpr int nodes = Shape::nodes, dim = Shape::dim, fields = dim;
    static constexpr bool symmetric = true, has_tangent = true, flat = dim == 2;
    static constexpr int stress_components = flat ? 4 : 6;

    static std::vector<std::string> parameters() {
        if (flat) return {"lambda", "mu", "thickness", "bx", "by"};
        return {"lambda", "mu", "bx", "by", "bz"};
    }

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        const double thickness = flat ? p[2] : 1.0, *b = p + (flat ? 3 : 2);
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][dim];
            const SX volume = Shape::gradients(q, X, G) * thickness;
            R H[dim][dim], P[dim][dim];
            displacement_gradient(G, x, H);
            Law::stress(H, p, P);
            for (int a = 0; a < dim; ++a)
                for (int k = 0; k < dim; ++k) P[a][k] *= volume;
            for (int i = 0; i < nodes; ++i)
                for (int a = 0; a < dim; ++a) {
                    R force = P[a][0] * G[i][0];
                    for (int k = 1; k < dim; ++k) force += P[a][k] * G[i][k];
                    force -= volume * (b[a] * Shape::table.value[q][i]);
                    if (q == 0)
                        r[i * dim + a] = force;
                    else
                        r[i * dim + a] += force;
                }
        }
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        const double thickness = flat ? p[2] : 1.0, *b = p + (flat ? 3 : 2);
        R total(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][dim];
            const SX volume = Shape::gradients(q, X, G) * thickness;
            R H[dim][dim];
            displacement_gradient(G, x, H);
            R density = Law::energy(H, p);
            for (int i = 0; i < nodes; ++i)
                for (int a = 0; a < dim; ++a) density -= x[i * dim + a] * (b[a] * Shape::table.value[q][i]);
            total += density * volume;
        }
        return total;
    }

    // xx yy xy zz (yz xz) at the centroid.
    static void stress(const double* X, const double* x, const double* p, double* s) {
        const double centre[3] = {1.0 / (dim + 1), 1.0 / (dim + 1), 1.0 / (dim + 1)};
        double G[nodes][dim], H[dim][dim], c[dim][dim];
        Shape::gradients_at(centre, X, G);
        displacement_gradient(G, x, H);
        const double out_of_plane = Law::cauchy(H, p, c);
        s[0] = c[0][0];
        s[1] = c[1][1];
        s[2] = c[0][1];
        s[3] = out_of_plane;
        if constexpr (!flat) {
            s[3] = c[2][2];
            s[4] = c[1][2];
            s[5] = c[0][2];
        }
    }

 private:
    template <class SX, class Sx, class R>
    static void displacement_gradient(const SX (&G)[nodes][dim], const Sx* x, R (&H)[dim][dim]) {
        for (int a = 0; a < dim; ++a)
            for (int k = 0; k < dim; ++k) {
                H[a][k] = x[a] * G[0][k];
                for (int i = 1; i < nodes; ++i) H[a][k] += x[i * dim + a] * G[i][k];
            }
    }
};

}  // namespace restshape
