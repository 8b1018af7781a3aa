// Laws of solids: a strain E of the displacement gradient H = du/dX, Hooke's stress S of it, and what S means.
#pragma once

#include "fem/shapes.hpp"

namespace restshape {

template <int D, class R>
R trace(const R (&E)[D][D]) {
    R t = E[0][0];
    for (int a = 1; a < D; ++a) t += E[a][a];
    return t;
}

// S = volumetric I + 2 mu E, where `volumetric` is lambda tr(E) or what stands for it.
template <int D, class R, class V, class M>
void hooke(const R (&E)[D][D], const V& volumetric, const M& mu, R (&S)[D][D]) {
    for (int a = 0; a < D; ++a) {
        S[a][a] = E[a][a] * (2 * mu) + volumetric;
        for (int b = 0; b < a; ++b) S[a][b] = S[b][a] = E[a][b] * (2 * mu);
    }
}

// mu E:E, the energy that shear and stretch store besides that of the dilatation.
template <int D, class R>
R distortion_energy(const R (&E)[D][D], double mu) {
    R square = E[0][0] * E[0][0];
    for (int a = 1; a < D; ++a) {
        square += E[a][a] * E[a][a];
        for (int b = 0; b < a; ++b) square += 2.0 * (E[a][b] * E[a][b]);
    }
    return square * mu;
}

// Small strains: sigma = lambda tr(eps) I + 2 mu eps (docs/theory/solids.md).
template <int D>
struct LinearElastic {
    static constexpr bool linear = true;

    template <class R>
    static void strain(const R (&H)[D][D], R (&E)[D][D]) {
        for (int a = 0; a < D; ++a) {
            E[a][a] = H[a][a];
            for (int b = 0; b < a; ++b) E[a][b] = E[b][a] = 0.5 * (H[a][b] + H[b][a]);
        }
    }

    template <class R>
    static void first_piola(const R (&)[D][D], const R (&S)[D][D], R (&P)[D][D]) {
        for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b) P[a][b] = S[a][b];
    }

    // Cauchy stress of S; returns the change of volume that normal stresses out of the plane are divided by.
    static double cauchy(const double (&H)[D][D], const double (&S)[D][D], double (&s)[D][D]) {
        first_piola(H, S, s);
        return 1.0;
    }
};

// St. Venant-Kirchhoff: S = lambda tr(E) I + 2 mu E, E = (F^T F - I)/2, P = F S (docs/theory/solids.md).
template <int D>
struct StVenantKirchhoff {
    static constexpr bool linear = false;

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
    static void first_piola(const R (&H)[D][D], const R (&S)[D][D], R (&P)[D][D]) {
        for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b) {
                P[a][b] = S[a][b];
                for (int k = 0; k < D; ++k) P[a][b] += H[a][k] * S[k][b];
            }
    }

    static double cauchy(const double (&H)[D][D], const double (&S)[D][D], double (&s)[D][D]) {
        double P[D][D], F[D][D], C[D][D];
        first_piola(H, S, P);
        for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b) F[a][b] = H[a][b] + (a == b);
        const double J = cofactors(F, C);
        for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b) {
                s[a][b] = 0;
                for (int k = 0; k < D; ++k) s[a][b] += P[a][k] * F[b][k] / J;
            }
        return J;
    }
};

}  // namespace restshape
