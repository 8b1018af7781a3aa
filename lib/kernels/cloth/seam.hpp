// Springs of seams: a node of one side, and a place on an edge of the other one.
#pragma once

#include <string>
#include <vector>

#include "fem/dual.hpp"

namespace restshape {

// k l |x0 - (1 - t) x1 - t x2|^2/2 with the place t = (s0 - s1)/(s2 - s1) on the edge from node 1 to node 2 that has
// the share s0 of its side's length. Shares and lengths hang on places of many nodes in the material: they are
// coefficients of the nodes, with rates of their own.
struct SeamEdgeElement {
    static constexpr int nodes = 3, dim = 2, fields = 3;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0, coefficient_count = 2;

    // Stiffness by length [N/m^2].
    static std::vector<std::string> parameters() { return {"k"}; }
    // Share of the side's length; length [m] that the spring stands for, which that of node 0 counts for.
    static std::vector<std::string> coefficients() { return {"s", "l"}; }

    template <class SX, class Sx, class R>
    static void residual(const SX*, const Sx* x, const SX* w, const double* p, R* r) {
        SX b[3];
        const SX k = w[1] * p[0];
        shares(w, b);
        for (int a = 0; a < 3; ++a) {
            const R pull = (x[a] - x[3 + a] * b[1] - x[6 + a] * b[2]) * k;
            r[a] = pull;
            r[3 + a] = -(pull * b[1]);
            r[6 + a] = -(pull * b[2]);
        }
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX*, const Sx* x, const SX* w, const double* p) {
        using R = Common<SX, Sx>;
        SX b[3];
        shares(w, b);
        R square(0.0);
        for (int a = 0; a < 3; ++a) {
            const R gap = x[a] - x[3 + a] * b[1] - x[6 + a] * b[2];
            square += gap * gap;
        }
        return square * w[1] * (0.5 * p[0]);
    }

    // By hand: the block of nodes i and j is c_i c_j k l times one, with c = (1, t - 1, -t).
    static void tangent(const double* X, const double* x, const double* w, const double* p, double* r, double* K) {
        constexpr int stride = Dual<9>::lanes;
        double b[3];
        residual(X, x, w, p, r);
        shares(w, b);
        const double c[3] = {1.0, -b[1], -b[2]}, k = p[0] * w[1];
        for (int n = 0; n < 9 * stride; ++n) K[n] = 0.0;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                for (int a = 0; a < 3; ++a) K[(3 * i + a) * stride + 3 * j + a] = k * c[i] * c[j];
    }

 private:
    template <class SX>
    static void shares(const SX* w, SX (&b)[3]) {
        b[2] = (w[0] - w[2]) / (w[4] - w[2]);
        b[1] = 1.0 - b[2];
        b[0] = SX(1.0);
    }
};

}  // namespace restshape
