// Co-rotated membranes: Hooke's law of U - I, where F = R U parts the turn from the stretch.
//
// The thesis's predecessor (Etzmuss, Keckeisen and Strasser, Pacific Graphics (2003) 244) turns a linear element by R
// and leaves out what R does as x moves. Here forces are the gradient of the energy area/2 (U - I) : C : (U - I), R
// included.
#pragma once

#include "cloth/membrane.hpp"

namespace restshape {

struct CorotatedMembraneElement : MembraneParts {
    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        SX G[3][2];
        R F[3][2], U[3], S[3], P[3][2];
        const SX area = gradients(X, G);
        deformation(G, x, F);
        const R determinant = stretch(F, U);
        second_piola(U, determinant, p, S);
        first_piola(F, S, P);
        forces(area, G, P, p, r);
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        SX G[3][2];
        R F[3][2], U[3], T[3];
        const SX area = gradients(X, G);
        deformation(G, x, F);
        stretch(F, U);
        U[0] -= 1.0;
        U[1] -= 1.0;
        tension(U, p, T);
        return half_product(T, U) * area + load_energy(area, x, p);
    }

    // Second Piola-Kirchhoff tensions xx, yy, xy [N/m].
    static void stress(const double* X, const double* x, const double* p, const double*, double* s) {
        double G[3][2], F[3][2], U[3], S[3];
        gradients(X, G);
        deformation(G, x, F);
        const double determinant = stretch(F, U);
        second_piola(U, determinant, p, S);
        for (int k = 0; k < 3; ++k) s[k] = S[k];
    }

 protected:
    // U = (F^T F)^(1/2) = (F^T F + det U)/tr U, by Cayley and Hamilton; returns its determinant.
    template <class R>
    static R stretch(const R (&F)[3][2], R (&U)[3]) {
        using std::sqrt;
        metric(F, U);
        const R determinant = sqrt(U[0] * U[1] - U[2] * U[2]);
        const R inverse = 1.0 / sqrt(U[0] + U[1] + 2.0 * determinant);
        U[0] = (U[0] + determinant) * inverse;
        U[1] = (U[1] + determinant) * inverse;
        U[2] = U[2] * inverse;
        return determinant;
    }

    // S with S U + U S = 2 T, T = C : (U - I): what T does along a change of U, S does along that of F^T F / 2.
    template <class R>
    static void second_piola(const R (&U)[3], const R& determinant, const double* p, R (&S)[3]) {
        R strain[3] = {U[0] - 1.0, U[1] - 1.0, U[2]}, T[3];
        tension(strain, p, T);
        // S = (det U T + A T A)/(det U tr U), with A the adjugate of U: seen in the axes of U.
        const R scale = 1.0 / (determinant * (U[0] + U[1]));
        const R a = U[1], b = U[0], c = -U[2];
        S[0] = (determinant * T[0] + a * a * T[0] + c * c * T[1] + 2.0 * (a * c * T[2])) * scale;
        S[1] = (determinant * T[1] + c * c * T[0] + b * b * T[1] + 2.0 * (b * c * T[2])) * scale;
        S[2] = (determinant * T[2] + a * c * T[0] + b * c * T[1] + (a * b + c * c) * T[2]) * scale;
    }
};

// The same forces, with a tangent that is positive semidefinite: that of St. Venant and Kirchhoff, with what is left of
// this element's tension without its negative eigenvalues. Both are one where nothing is strained.
struct CorotatedStabilisedElement : CorotatedMembraneElement {
    static void tangent(const double* X, const double* x, const double* p, double* r, double* K) {
        double G[3][2], F[3][2], U[3], S[3], P[3][2];
        const double area = gradients(X, G);
        deformation(G, x, F);
        const double determinant = stretch(F, U);
        second_piola(U, determinant, p, S);
        first_piola(F, S, P);
        forces(area, G, P, p, r);
        keep_tension(S);
        fill_tangent(area, G, F, p, S, K);
    }
};

}  // namespace restshape
