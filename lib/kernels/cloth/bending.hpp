// Bending that is quadratic in the positions, as isometric deformations allow: their Hessians depend on X alone.
//
// Source: docs/theory/cloth.md; Bergou, Wardetzky, Harmon, Zorin and Grinspun, Symp. Geometry Processing
// (2006) 227; Morley, Aeronautical Quarterly 19 (1968) 149.
#pragma once

#include <string>
#include <vector>

#include "fem/shapes.hpp"

namespace restshape {

// Energy sum over components of kappa . W kappa/2, kappa = B^T x. The first E::corners nodes hold positions, whose
// forms vanish on what is constant: they are taken from node 0, so that far from the origin nothing is lost to
// rounding.
template <class E, int Nodes, int Forms>
struct QuadraticElement {
    static constexpr int nodes = Nodes, dim = 2, fields = 3, forms = Forms;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0;

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        SX B[nodes][forms], W[forms][forms];
        E::prepare(X, p, B, W);
        for (int a = 0; a < 3; ++a) {
            R kappa[forms], moment[forms];
            apply(B, x + a, kappa);
            for (int m = 0; m < forms; ++m) {
                moment[m] = kappa[0] * W[m][0];
                for (int l = 1; l < forms; ++l) moment[m] += kappa[l] * W[m][l];
            }
            for (int i = 0; i < nodes; ++i) {
                r[3 * i + a] = moment[0] * B[i][0];
                for (int m = 1; m < forms; ++m) r[3 * i + a] += moment[m] * B[i][m];
            }
        }
    }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        SX B[nodes][forms], W[forms][forms];
        E::prepare(X, p, B, W);
        R total(0.0);
        for (int a = 0; a < 3; ++a) {
            R kappa[forms];
            apply(B, x + a, kappa);
            for (int m = 0; m < forms; ++m)
                for (int l = 0; l < forms; ++l) total += 0.5 * (kappa[m] * kappa[l] * W[m][l]);
        }
        return total;
    }

    static void tangent(const double* X, const double* x, const double* p, double* r, double* K) {
        constexpr int n = 3 * nodes, stride = Dual<n>::lanes;
        double B[nodes][forms], W[forms][forms];
        residual(X, x, p, r);
        E::prepare(X, p, B, W);
        for (int k = 0; k < n * stride; ++k) K[k] = 0.0;
        for (int i = 0; i < nodes; ++i) {
            double WB[forms];
            for (int m = 0; m < forms; ++m) {
                WB[m] = 0.0;
                for (int l = 0; l < forms; ++l) WB[m] += W[m][l] * B[i][l];
            }
            for (int j = 0; j < nodes; ++j) {
                double entry = 0.0;
                for (int m = 0; m < forms; ++m) entry += WB[m] * B[j][m];
                for (int a = 0; a < 3; ++a) K[(3 * i + a) * stride + 3 * j + a] = entry;
            }
        }
    }

 private:
    // One component of x, three apart.
    template <class SX, class Sx, class R>
    static void apply(const SX (&B)[nodes][forms], const Sx* x, R (&kappa)[forms]) {
        for (int m = 0; m < forms; ++m) {
            kappa[m] = (x[3] - x[0]) * B[1][m];
            for (int j = 2; j < E::corners; ++j) kappa[m] += (x[3 * j] - x[0]) * B[j][m];
            for (int j = E::corners; j < nodes; ++j) kappa[m] += x[3 * j] * B[j][m];
        }
    }
};

// Two triangles about an inner edge from node 0 to node 1, node 2 on its left and node 3 on its right:
// E = k/2 3/(A0 + A1) |c . x|^2, with c from the cotangents of the angles that the edge makes.
struct HingeElement : QuadraticElement<HingeElement, 4, 1> {
    static constexpr int corners = 4;

    // Stiffness [N m]: on equilateral triangles a plate of D = 3k with nu = -1/3, and a strip of 8k/3 a width.
    static std::vector<std::string> parameters() { return {"k"}; }

    template <class S>
    static void prepare(const S* X, const double* p, S (&B)[4][1], S (&W)[1][1]) {
        S e[2], left[2], right[2], l, r;
        for (int a = 0; a < 2; ++a) {
            e[a] = X[2 + a] - X[a];
            left[a] = X[4 + a] - X[a];
            right[a] = X[6 + a] - X[a];
        }
        l = e[0] * left[1] - e[1] * left[0];
        r = e[1] * right[0] - e[0] * right[1];
        const S square = e[0] * e[0] + e[1] * e[1];
        const S along_left = e[0] * left[0] + e[1] * left[1], along_right = e[0] * right[0] + e[1] * right[1];
        // Cotangents at node 0, then at node 1, of both triangles.
        const S l0 = along_left / l, l1 = (square - along_left) / l;
        const S r0 = along_right / r, r1 = (square - along_right) / r;
        B[0][0] = l1 + r1;
        B[1][0] = l0 + r0;
        B[2][0] = -(l0 + l1);
        B[3][0] = -(r0 + r1);
        W[0][0] = (6 * p[0]) / (l + r);
    }
};

// Morley's triangle: quadratic polynomials by their values at the corners and the slopes in the middle of the sides
// (0, 1), (1, 2), (2, 0). The unknown y of a side is its length times the slope along its normal, on the right of the
// edge's fixed direction, so that it is a length as the positions are. With d = X_j - X_i and N = (d_y, -d_x)
//   area times the second derivatives = sum over sides of (s y N N^T + (x_j - x_i) sym(d N^T)) / |d|^2.
struct MorleyElement : QuadraticElement<MorleyElement, 6, 3> {
    static constexpr int corners = 3;

    // Bending stiffness [N m]: moments xx, yy, xy by curvatures xx, yy and twice xy. Sign of each side: 1 where it runs
    // as its edge does, -1 where against it.
    static std::vector<std::string> parameters() {
        return {"D11", "D12", "D22", "D16", "D26", "D66", "s01", "s12", "s20"};
    }

    template <class S>
    static void prepare(const S* X, const double* p, S (&B)[6][3], S (&W)[3][3]) {
        const S inverse = 1.0 / curvatures(X, p, B);
        constexpr int entry[3][3] = {{0, 1, 3}, {1, 2, 4}, {3, 4, 5}};
        for (int m = 0; m < 3; ++m)
            for (int l = 0; l < 3; ++l) W[m][l] = p[entry[m][l]] * inverse;
    }

 private:
    // Area times the second derivatives xx, yy and twice xy of each basis function; returns the area.
    template <class S>
    static S curvatures(const S* X, const double* p, S (&B)[6][3]) {
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k) B[i][k] = S(0.0);
        S d[3][2];
        for (int m = 0; m < 3; ++m) {
            const int i = m, j = (m + 1) % 3;
            for (int a = 0; a < 2; ++a) d[m][a] = X[2 * j + a] - X[2 * i + a];
            const S xx = d[m][0] * d[m][0], yy = d[m][1] * d[m][1], xy = d[m][0] * d[m][1];
            const S inverse = 1.0 / (xx + yy);
            const S normal[3] = {yy * inverse, xx * inverse, xy * inverse * -2.0};
            const S mixed[3] = {xy * inverse, -xy * inverse, (yy - xx) * inverse};
            for (int k = 0; k < 3; ++k) {
                B[3 + m][k] = normal[k] * p[6 + m];
                B[j][k] += mixed[k];
                B[i][k] -= mixed[k];
            }
        }
        return 0.5 * (d[0][0] * d[1][1] - d[0][1] * d[1][0]);
    }
};

}  // namespace restshape
