// Springs of seams: a node of one side, and a place on an edge of the other one.
#pragma once

#include <string>
#include <vector>

#include "fem/shapes.hpp"

namespace restshape {

// k l max(0, |d| - g)^2/2 with the gap d = x0 - (1 - t) x1 - t x2 to the place t = (s0 - s1)/(s2 - s1) on the edge from
// node 1 to node 2 that has the share s0 of its side's length. Shares and lengths hang on places of many nodes in the
// material: they are coefficients of the nodes, with rates of their own.
struct SeamEdgeElement {
    static constexpr int nodes = 3, dim = 2, fields = 3;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0, coefficient_count = 2;

    // Stiffness by length [N/m^2]; distance [m] up to which it does not pull.
    static std::vector<std::string> parameters() { return {"k", "g"}; }
    // Share of the side's length; length [m] that the spring stands for, which that of node 0 counts for.
    static std::vector<std::string> coefficients() { return {"s", "l"}; }

    template <class SX, class Sx, class R>
    static void residual(const SX*, const Sx* x, const SX* w, const double* p, R* r) {
        using G = Common<SX, Sx>;
        SX b[3];
        G d[3];
        const SX k = w[1] * p[0];
        shares(w, b);
        gap(x, b, d);
        const G part = pulling(d, p[1]);
        for (int a = 0; a < 3; ++a) {
            const G pull = d[a] * part * k;
            r[a] = pull;
            r[3 + a] = -(pull * b[1]);
            r[6 + a] = -(pull * b[2]);
        }
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX*, const Sx* x, const SX* w, const double* p) {
        using R = Common<SX, Sx>;
        SX b[3];
        R d[3];
        shares(w, b);
        gap(x, b, d);
        const R part = pulling(d, p[1]);
        return square(d) * part * part * w[1] * (0.5 * p[0]);
    }

    // By hand: the block of nodes i and j is c_i c_j times k l (q 1 + (1 - q) n n'), with c = (1, t - 1, -t), the part
    // q of the gap that pulls, and its direction n.
    static void tangent(const double* X, const double* x, const double* w, const double* p, double* r, double* K) {
        constexpr int stride = Dual<9>::lanes;
        double b[3], d[3];
        residual(X, x, w, p, r);
        shares(w, b);
        gap(x, b, d);
        const double c[3] = {1.0, -b[1], -b[2]}, part = pulling(d, p[1]), k = p[0] * w[1] * part;
        // Without slack it is k l times one, at no distance too.
        const double along = p[1] > 0.0 && part > 0.0 ? p[0] * w[1] * (1.0 - part) / square(d) : 0.0;
        for (int n = 0; n < 9 * stride; ++n) K[n] = 0.0;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                for (int a = 0; a < 3; ++a) {
                    for (int e = 0; e < 3; ++e) K[(3 * i + a) * stride + 3 * j + e] = along * d[a] * d[e] * c[i] * c[j];
                    K[(3 * i + a) * stride + 3 * j + a] += k * c[i] * c[j];
                }
    }

 private:
    template <class SX>
    static void shares(const SX* w, SX (&b)[3]) {
        b[2] = (w[0] - w[2]) / (w[4] - w[2]);
        b[1] = 1.0 - b[2];
        b[0] = SX(1.0);
    }
    template <class SX, class Sx, class R>
    static void gap(const Sx* x, const SX* b, R* d) {
        for (int a = 0; a < 3; ++a) d[a] = x[a] - x[3 + a] * b[1] - x[6 + a] * b[2];
    }
    template <class R>
    static R square(const R* d) {
        return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    }
    // Part of the gap that pulls: 1 - g/|d|, or 0.
    template <class R>
    static R pulling(const R* d, double slack) {
        using std::sqrt;
        if (slack == 0.0) return R(1.0);
        const R all = square(d);
        if (value_of(all) <= slack * slack) return R(0.0);
        return 1.0 - slack / sqrt(all);
    }
};

// Bending across a seam that is sewn flat: k l/2 6/(h + h') |d + d'|^2 of a piece of it, with the slopes d out of the
// triangles on both sides, whose heights are h. Between triangles of one edge it is the quadratic hinge of the same k.
struct SeamFlatElement {
    static constexpr int nodes = 6, dim = 2, fields = 3;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0, coefficient_count = 1;

    // Stiffness [N m].
    static std::vector<std::string> parameters() { return {"k"}; }
    // Length [m] of the piece, which that of node 0 counts for. Nodes 0 to 2 are the ends of the edge and the third
    // corner on one side, 3 to 5 those on the other one.
    static std::vector<std::string> coefficients() { return {"l"}; }

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const SX* w, const double* p, R* r) {
        SX c[6];
        const SX k = slopes(X, c) * w[0] * p[0];
        for (int a = 0; a < 3; ++a) {
            const R moment = sum(c, x + a) * k;
            for (int i = 0; i < 6; ++i) r[3 * i + a] = moment * c[i];
        }
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const SX* w, const double* p) {
        using R = Common<SX, Sx>;
        SX c[6];
        const SX k = slopes(X, c) * w[0] * (0.5 * p[0]);
        R square(0.0);
        for (int a = 0; a < 3; ++a) {
            const R both = sum(c, x + a);
            square += both * both;
        }
        return square * k;
    }

    // By hand: the block of nodes i and j is c_i c_j times one number.
    static void tangent(const double* X, const double* x, const double* w, const double* p, double* r, double* K) {
        constexpr int stride = Dual<18>::lanes;
        double c[6];
        residual(X, x, w, p, r);
        const double k = slopes(X, c) * w[0] * p[0];
        for (int n = 0; n < 18 * stride; ++n) K[n] = 0.0;
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 6; ++j)
                for (int a = 0; a < 3; ++a) K[(3 * i + a) * stride + 3 * j + a] = k * c[i] * c[j];
    }

 private:
    // Shares of the nodes in both slopes, each of them out of its triangle; returns 6/(h + h').
    template <class SX>
    static SX slopes(const SX* X, SX (&c)[6]) {
        using std::sqrt;
        SX heights(0.0);
        for (int side = 0; side < 2; ++side) {
            const SX* P = X + 6 * side;
            SX* own = c + 3 * side;
            const SX e[2] = {P[2] - P[0], P[3] - P[1]}, q[2] = {P[4] - P[0], P[5] - P[1]};
            const SX square = e[0] * e[0] + e[1] * e[1], area = e[0] * q[1] - e[1] * q[0];
            const SX height = (value_of(area) < 0.0 ? -area : area) / sqrt(square);
            const SX foot = (e[0] * q[0] + e[1] * q[1]) / square;
            own[0] = (1.0 - foot) / height;
            own[1] = foot / height;
            own[2] = -(1.0 / height);
            heights += height;
        }
        return 6.0 / heights;
    }
    template <class SX, class Sx>
    static Common<SX, Sx> sum(const SX (&c)[6], const Sx* x) {
        Common<SX, Sx> found = x[0] * c[0];
        for (int i = 1; i < 6; ++i) found += x[3 * i] * c[i];
        return found;
    }
};

// k l |c0 x0 + c1 x1|^2/2 of the slopes of two edges, which are the unknowns x times c.
struct SeamSlopeElement {
    static constexpr int nodes = 2, dim = 2, fields = 3;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0, coefficient_count = 2;

    // Moment by slope and length [N].
    static std::vector<std::string> parameters() { return {"k"}; }
    // Slope out of the cloth over the unknown [1/m]; length [m] of the piece, which that of node 0 counts for.
    static std::vector<std::string> coefficients() { return {"c", "l"}; }

    template <class SX, class Sx, class R>
    static void residual(const SX*, const Sx* x, const SX* w, const double* p, R* r) {
        const SX k = w[1] * p[0];
        for (int a = 0; a < 3; ++a) {
            const R moment = (x[a] * w[0] + x[3 + a] * w[2]) * k;
            r[a] = moment * w[0];
            r[3 + a] = moment * w[2];
        }
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX*, const Sx* x, const SX* w, const double* p) {
        using R = Common<SX, Sx>;
        R square(0.0);
        for (int a = 0; a < 3; ++a) {
            const R both = x[a] * w[0] + x[3 + a] * w[2];
            square += both * both;
        }
        return square * w[1] * (0.5 * p[0]);
    }
};

}  // namespace restshape
