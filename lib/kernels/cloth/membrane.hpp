// Membranes of cloth: triangles of constant strain between material coordinates X in the plane and positions x in
// space.
//
// With G_i the gradients of the barycentric coordinates in X, F = sum of x_i G_i^T and S = C : (F^T F - I)/2 is the
// tension a unit of material length. Material coordinates are Cartesian, so that S is referred to an orthonormal frame.
#pragma once

#include <string>
#include <vector>

#include "fem/pack.hpp"
#include "fem/shapes.hpp"

namespace restshape {

// What all laws of membranes share.
struct MembraneParts {
    static constexpr int nodes = 3, dim = 2, fields = 3;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 3;
    static constexpr int load = 6;  // the first of three parameters

    // Moduli [N/m]: tensions xx, yy, xy by strains xx, yy and twice xy; dead load [N/m^2] of material.
    static std::vector<std::string> parameters() {
        return {"C11", "C12", "C22", "C16", "C26", "C66", "bx", "by", "bz"};
    }

 protected:
    // Gradients of the barycentric coordinates; returns the area.
    template <class S>
    static S gradients(const S* X, S (&G)[3][2]) {
        return Tri3::gradients(0, X, G);
    }

    // From sides of the triangle, so that far from the origin nothing is lost to rounding.
    template <class SX, class Sx, class R>
    static void deformation(const SX (&G)[3][2], const Sx* x, R (&F)[3][2]) {
        for (int a = 0; a < 3; ++a) {
            const Sx first = x[3 + a] - x[a], second = x[6 + a] - x[a];
            for (int k = 0; k < 2; ++k) F[a][k] = first * G[1][k] + second * G[2][k];
        }
    }

    // P = F S, of S as xx, yy, xy.
    template <class R>
    static void first_piola(const R (&F)[3][2], const R (&S)[3], R (&P)[3][2]) {
        for (int a = 0; a < 3; ++a)
            for (int k = 0; k < 2; ++k) P[a][k] = F[a][0] * S[k ? 2 : 0] + F[a][1] * S[k ? 1 : 2];
    }

    // F^T F as xx, yy, xy.
    template <class R>
    static void metric(const R (&F)[3][2], R (&C)[3]) {
        for (int k = 0; k < 3; ++k) {
            const int a = k == 1 ? 1 : 0, b = k == 0 ? 0 : 1;
            C[k] = F[0][a] * F[0][b] + F[1][a] * F[1][b] + F[2][a] * F[2][b];
        }
    }

    // Tensions xx, yy, xy of strains xx, yy, xy.
    template <class R, class P>
    static void tension(const R (&E)[3], const P* p, R (&S)[3]) {
        const R twice = 2.0 * E[2];
        S[0] = E[0] * p[0] + E[1] * p[1] + twice * p[3];
        S[1] = E[0] * p[1] + E[1] * p[2] + twice * p[4];
        S[2] = E[0] * p[3] + E[1] * p[4] + twice * p[5];
    }

    template <class R>
    static R half_product(const R (&S)[3], const R (&E)[3]) {
        return 0.5 * (S[0] * E[0] + S[1] * E[1]) + S[2] * E[2];
    }

    // Forces of P, the tension times the sides that it acts on, and of the load.
    template <class SX, class R, class Numbers>
    static void forces(const SX& area, const SX (&G)[3][2], const R (&P)[3][2], const Numbers* p, R* r) {
        for (int i = 0; i < 3; ++i)
            for (int a = 0; a < 3; ++a)
                r[3 * i + a] = (P[a][0] * G[i][0] + P[a][1] * G[i][1]) * area - area * (p[load + a] / 3.0);
    }

    // Potential of the load.
    template <class SX, class Sx>
    static Common<SX, Sx> load_energy(const SX& area, const Sx* x, const double* p) {
        Common<SX, Sx> sum(0.0);
        for (int a = 0; a < 3; ++a) sum -= (x[a] + x[3 + a] + x[6 + a]) * (area * (p[load + a] / 3));
        return sum;
    }

    // With f_k the columns of F, the block of two nodes is the sum of m_kl f_k f_l^T and of what the tension resists: m
    // depends on X and the moduli alone.
    static void fill_tangent(double area, const double (&G)[3][2], const double (&F)[3][2], const double* p,
                             const double (&S)[3], double* K) {
        constexpr int stride = Dual<9>::lanes;
        using Four = Eigen::Array<double, 4, 1>;
        const Four unit[3] = {{1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}};
        const Four f0(F[0][0], F[1][0], F[2][0], 0.0), f1(F[0][1], F[1][1], F[2][1], 0.0);
        for (int i = 0; i < 3; ++i) {
            const double g = area * G[i][0], h = area * G[i][1];
            const double c[6] = {g * p[0] + h * p[3], g * p[3] + h * p[5], g * p[3] + h * p[1],
                                 g * p[5] + h * p[4], g * p[1] + h * p[4], g * p[4] + h * p[2]};
            const double t[2] = {g * S[0] + h * S[2], g * S[2] + h * S[1]};
            for (int j = 0; j < 3; ++j) {
                const double u = G[j][0], v = G[j][1];
                const double m00 = c[0] * u + c[1] * v, m01 = c[1] * u + c[4] * v, m10 = c[2] * u + c[3] * v,
                             m11 = c[3] * u + c[5] * v, pull = t[0] * u + t[1] * v;
                // The fourth number is overwritten by the next block, or lies in the padding.
                for (int a = 0; a < 3; ++a)
                    Eigen::Map<Four>(K + (3 * i + a) * stride + 3 * j) =
                        (F[a][0] * m00 + F[a][1] * m10) * f0 + (F[a][0] * m01 + F[a][1] * m11) * f1 + pull * unit[a];
            }
        }
    }

    // The same of several triangles, one a lane, without padding.
    static void fill_tangent(const Pack& area, const Pack (&G)[3][2], const Pack (&F)[3][2], const Pack* p,
                             const Pack (&S)[3], Pack* K) {
        for (int i = 0; i < 3; ++i) {
            const Pack g = area * G[i][0], h = area * G[i][1];
            const Pack c[6] = {g * p[0] + h * p[3], g * p[3] + h * p[5], g * p[3] + h * p[1],
                               g * p[5] + h * p[4], g * p[1] + h * p[4], g * p[4] + h * p[2]};
            const Pack t[2] = {g * S[0] + h * S[2], g * S[2] + h * S[1]};
            for (int j = i; j < 3; ++j) {
                const Pack u = G[j][0], v = G[j][1];
                const Pack m00 = c[0] * u + c[1] * v, m01 = c[1] * u + c[4] * v, m10 = c[2] * u + c[3] * v,
                           m11 = c[3] * u + c[5] * v, pull = t[0] * u + t[1] * v;
                for (int a = 0; a < 3; ++a) {
                    const Pack first = F[a][0] * m00 + F[a][1] * m10, second = F[a][0] * m01 + F[a][1] * m11;
                    for (int b = 0; b < 3; ++b) {
                        Pack entry = first * F[b][0] + second * F[b][1];
                        if (a == b) entry += pull;
                        K[(3 * i + a) * 9 + 3 * j + b] = K[(3 * j + b) * 9 + 3 * i + a] = entry;
                    }
                }
            }
        }
    }

    // Eigenvalues below zero become zero.
    static void keep_tension(Pack (&S)[3]) {
        const Pack mean = 0.5 * (S[0] + S[1]), half = 0.5 * (S[0] - S[1]), none{};
        const Pack radius = square_root(half * half + S[2] * S[2]), above = mean + radius;
        const Pack top = above > none ? above : none, share = top / (radius > none ? 2.0 * radius : none + 1.0);
        const auto pulled = mean >= radius;
        S[0] = pulled ? S[0] : share * (radius + half);
        S[1] = pulled ? S[1] : share * (radius - half);
        S[2] = pulled ? S[2] : share * S[2];
    }
    static void keep_tension(double (&S)[3]) {
        const double mean = 0.5 * (S[0] + S[1]), half = 0.5 * (S[0] - S[1]),
                     radius = std::sqrt(half * half + S[2] * S[2]);
        if (mean >= radius) return;
        const double top = mean + radius;
        if (top <= 0.0) {
            S[0] = S[1] = S[2] = 0.0;
            return;
        }
        const double share = top / (2 * radius);
        S[0] = share * (radius + half);
        S[1] = share * (radius - half);
        S[2] = share * S[2];
    }
};

// St. Venant-Kirchhoff. The stabilised tangent takes for the tension what is left of it without its negative
// eigenvalues, which makes it positive semidefinite; the residual, and so the equilibria, are the same.
// Source: docs/theory/cloth.md; Teran, Sifakis, Irving and Fedkiw, Symp. Computer Animation (2005) 181.
template <bool Stabilised>
struct MembraneElement : MembraneParts {
    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        SX G[3][2];
        R F[3][2], E[3], S[3], P[3][2];
        const SX area = gradients(X, G);
        deformation(G, x, F);
        strain(F, E);
        tension(E, p, S);
        first_piola(F, S, P);
        forces(area, G, P, p, r);
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        SX G[3][2];
        R F[3][2], E[3], S[3];
        const SX area = gradients(X, G);
        deformation(G, x, F);
        strain(F, E);
        tension(E, p, S);
        return half_product(S, E) * area + load_energy(area, x, p);
    }

    // By hand: duals of nine directions would take sixteen lanes.
    static void tangent(const double* X, const double* x, const double* p, double* r, double* K) {
        double G[3][2], F[3][2], E[3], S[3], P[3][2];
        const double area = gradients(X, G);
        deformation(G, x, F);
        strain(F, E);
        tension(E, p, S);
        first_piola(F, S, P);
        forces(area, G, P, p, r);
        if (Stabilised) keep_tension(S);
        fill_tangent(area, G, F, p, S, K);
    }

    // Of several triangles, one a lane.
    static constexpr bool packed = true;

    [[gnu::flatten]] static void packed_residual(const Pack* X, const Pack* x, const Pack*, const Pack* p, Pack* r) {
        Pack G[3][2], F[3][2], S[3];
        set_packed_forces(X, x, p, G, F, S, r);
    }

    [[gnu::flatten]] static void packed_tangent(const Pack* X, const Pack* x, const Pack*, const Pack* p, Pack* r,
                                                Pack* K) {
        Pack G[3][2], F[3][2], S[3];
        const Pack area = set_packed_forces(X, x, p, G, F, S, r);
        if (Stabilised) keep_tension(S);
        fill_tangent(area, G, F, p, S, K);
    }

    // Second Piola-Kirchhoff tensions xx, yy, xy [N/m].
    static void stress(const double* X, const double* x, const double* p, const double*, double* s) {
        double G[3][2], F[3][2], E[3], S[3];
        gradients(X, G);
        deformation(G, x, F);
        strain(F, E);
        tension(E, p, S);
        for (int k = 0; k < 3; ++k) s[k] = S[k];
    }

 private:
    // Sets forces, and what they are made of; returns the areas.
    static Pack set_packed_forces(const Pack* X, const Pack* x, const Pack* p, Pack (&G)[3][2], Pack (&F)[3][2],
                                  Pack (&S)[3], Pack* r) {
        Pack E[3], P[3][2];
        const Pack area = gradients(X, G);
        deformation(G, x, F);
        strain(F, E);
        tension(E, p, S);
        first_piola(F, S, P);
        forces(area, G, P, p, r);
        return area;
    }

    template <class R>
    static void strain(const R (&F)[3][2], R (&E)[3]) {
        metric(F, E);
        E[0] = 0.5 * (E[0] - 1.0);
        E[1] = 0.5 * (E[1] - 1.0);
        E[2] = 0.5 * E[2];
    }
};

// A tension S that strains do not change, with the energy S : E: what it adds to a tangent is linear in S and the same
// at all positions.
struct MembraneTensionElement : MembraneParts {
    // Second Piola-Kirchhoff tensions [N/m].
    static std::vector<std::string> parameters() { return {"Sxx", "Syy", "Sxy"}; }

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        SX G[3][2];
        R F[3][2], P[3][2];
        const SX area = gradients(X, G);
        deformation(G, x, F);
        const R S[3] = {R(p[0]), R(p[1]), R(p[2])};
        first_piola(F, S, P);
        for (int i = 0; i < 3; ++i)
            for (int a = 0; a < 3; ++a) r[3 * i + a] = (P[a][0] * G[i][0] + P[a][1] * G[i][1]) * area;
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        SX G[3][2];
        R F[3][2], C[3];
        const SX area = gradients(X, G);
        deformation(G, x, F);
        metric(F, C);
        return (0.5 * ((C[0] - 1.0) * p[0] + (C[1] - 1.0) * p[1]) + C[2] * p[2]) * area;
    }

    static void stress(const double*, const double*, const double* p, const double*, double* s) {
        for (int k = 0; k < 3; ++k) s[k] = p[k];
    }
};

}  // namespace restshape
