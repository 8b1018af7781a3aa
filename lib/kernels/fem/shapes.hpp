// Shapes of elements: basis functions tabulated at quadrature points, gradients in material coordinates.
#pragma once

#include <array>

#include "fem/dual.hpp"

namespace restshape {

// Quadrature: `at` reference coordinates, `weight` (their sum is the measure of the reference element).
// Sources: triangle rules of degree 1, 2, 4 and 6 by Dunavant (1985), tetrahedron rules of degree 2 by Keast (1986), of
// degree 3 by Witherden and Vincent (2015) and of degree 5 by Walkington (2000), Gauss-Legendre on [0, 1].
struct TriRule1 {
    static constexpr int points = 1, dim = 2;
    static constexpr double at[1][2] = {{1.0 / 3, 1.0 / 3}};
    static constexpr double weight[1] = {0.5};
};
struct TriRule3 {
    static constexpr int points = 3, dim = 2;
    static constexpr double at[3][2] = {{1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}};
    static constexpr double weight[3] = {1.0 / 6, 1.0 / 6, 1.0 / 6};
};
struct TriRule6 {
    static constexpr int points = 6, dim = 2;
    static constexpr double a = 0.44594849091596488632, b = 0.091576213509770743460;
    static constexpr double wa = 0.11169079483900573285, wb = 0.054975871827660933819;
    static constexpr double at[6][2] = {{a, a}, {1 - 2 * a, a}, {a, 1 - 2 * a}, {b, b}, {1 - 2 * b, b}, {b, 1 - 2 * b}};
    static constexpr double weight[6] = {wa, wa, wa, wb, wb, wb};
};
struct TriRule12 {
    static constexpr int points = 12, dim = 2;
    static constexpr double a = 0.24928674517091042129, b = 0.063089014491502227340;
    static constexpr double c = 0.053145049844816947353, d = 0.31035245103378440542;
    static constexpr double wa = 0.11678627572637936603 / 2, wb = 0.050844906370206816921 / 2;
    static constexpr double wc = 0.082851075618373575194 / 2;
    static constexpr double at[12][2] = {{a, a},         {1 - 2 * a, a}, {a, 1 - 2 * a}, {b, b},
                                         {1 - 2 * b, b}, {b, 1 - 2 * b}, {c, d},         {d, c},
                                         {c, 1 - c - d}, {1 - c - d, c}, {d, 1 - c - d}, {1 - c - d, d}};
    static constexpr double weight[12] = {wa, wa, wa, wb, wb, wb, wc, wc, wc, wc, wc, wc};
};
struct TetRule1 {
    static constexpr int points = 1, dim = 3;
    static constexpr double at[1][3] = {{0.25, 0.25, 0.25}};
    static constexpr double weight[1] = {1.0 / 6};
};
struct TetRule4 {
    static constexpr int points = 4, dim = 3;
    static constexpr double a = 0.13819660112501051518, b = 0.58541019662496845446;
    static constexpr double at[4][3] = {{a, a, a}, {b, a, a}, {a, b, a}, {a, a, b}};
    static constexpr double weight[4] = {1.0 / 24, 1.0 / 24, 1.0 / 24, 1.0 / 24};
};
struct TetRule8 {
    static constexpr int points = 8, dim = 3;
    static constexpr double a = 0.32816330251638170524, b = 0.10804724989842862115;
    static constexpr double wa = 0.13621784253708734584 / 6, wb = 0.11378215746291265415 / 6;
    static constexpr double at[8][3] = {{a, a, a}, {1 - 3 * a, a, a}, {a, 1 - 3 * a, a}, {a, a, 1 - 3 * a},
                                        {b, b, b}, {1 - 3 * b, b, b}, {b, 1 - 3 * b, b}, {b, b, 1 - 3 * b}};
    static constexpr double weight[8] = {wa, wa, wa, wa, wb, wb, wb, wb};
};
struct TetRule14 {
    static constexpr int points = 14, dim = 3;
    static constexpr double a = 0.31088591926330060980, b = 0.092735250310891226402, c = 0.45449629587435035051;
    static constexpr double d = 0.5 - c;
    static constexpr double wa = 0.11268792571801585080 / 6, wb = 0.073493043116361949544 / 6;
    static constexpr double wc = 0.042546020777081466438 / 6;
    static constexpr double at[14][3] = {{a, a, a}, {1 - 3 * a, a, a}, {a, 1 - 3 * a, a}, {a, a, 1 - 3 * a},
                                         {b, b, b}, {1 - 3 * b, b, b}, {b, 1 - 3 * b, b}, {b, b, 1 - 3 * b},
                                         {c, c, d}, {c, d, c},         {d, c, c},         {c, d, d},
                                         {d, c, d}, {d, d, c}};
    static constexpr double weight[14] = {wa, wa, wa, wa, wb, wb, wb, wb, wc, wc, wc, wc, wc, wc};
};
struct LineRule2 {
    static constexpr int points = 2, dim = 1;
    static constexpr double at[2][1] = {{0.21132486540518711775}, {0.78867513459481288225}};
    static constexpr double weight[2] = {0.5, 0.5};
};
struct LineRule3 {
    static constexpr int points = 3, dim = 1;
    static constexpr double at[3][1] = {{0.11270166537925831148}, {0.5}, {0.88729833462074168852}};
    static constexpr double weight[3] = {5.0 / 18, 4.0 / 9, 5.0 / 18};
};

// Lagrange bases on simplices: corners first, then mid-sides in `sides` order (VTK's; Gmsh swaps the last two of
// tet10).
template <int D>
struct Linear {
    static constexpr int dim = D, nodes = D + 1, order = 1;

    static constexpr void values(const double* xi, double* n) {
        n[0] = 1.0;
        for (int k = 0; k < D; ++k) {
            n[k + 1] = xi[k];
            n[0] -= xi[k];
        }
    }
    static constexpr void slopes(const double*, double (*s)[D]) {
        for (int i = 0; i < nodes; ++i)
            for (int k = 0; k < D; ++k) s[i][k] = i == 0 ? -1.0 : (i == k + 1 ? 1.0 : 0.0);
    }
};

template <int D>
struct Quadratic {
    static constexpr int dim = D, corners = D + 1, nodes = (D + 1) * (D + 2) / 2, order = 2;
    // Of the tetrahedron; the first one or three of them are the sides of the line and of the triangle.
    static constexpr int sides[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};

    static constexpr void values(const double* xi, double* n) {
        double l[corners] = {};
        Linear<D>::values(xi, l);
        for (int i = 0; i < corners; ++i) n[i] = l[i] * (2 * l[i] - 1);
        for (int m = 0; m < nodes - corners; ++m) n[corners + m] = 4 * l[sides[m][0]] * l[sides[m][1]];
    }
    static constexpr void slopes(const double* xi, double (*s)[D]) {
        double l[corners] = {};
        double dl[corners][D] = {};
        Linear<D>::values(xi, l);
        Linear<D>::slopes(xi, dl);
        for (int k = 0; k < D; ++k) {
            for (int i = 0; i < corners; ++i) s[i][k] = (4 * l[i] - 1) * dl[i][k];
            for (int m = 0; m < nodes - corners; ++m) {
                const int a = sides[m][0], b = sides[m][1];
                s[corners + m][k] = 4 * (l[a] * dl[b][k] + l[b] * dl[a][k]);
            }
        }
    }
};

// The nodes of a triangle as points of a rule without weights.
template <class Basis>
struct NodesOf {
    static constexpr int points = Basis::nodes, dim = 2;
    static constexpr double at[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
};

// Values and reference slopes of a basis at the points of a rule.
template <class Basis, class Rule>
struct Table {
    double value[Rule::points][Basis::nodes] = {};
    double slope[Rule::points][Basis::nodes][Basis::dim] = {};

    constexpr Table() {
        for (int q = 0; q < Rule::points; ++q) {
            Basis::values(Rule::at[q], value[q]);
            Basis::slopes(Rule::at[q], slope[q]);
        }
    }
};

// Inverse transposed times determinant (the cofactors) of a small matrix, and its determinant.
template <class S>
S cofactors(const S (&J)[2][2], S (&C)[2][2]) {
    C[0][0] = J[1][1];
    C[0][1] = -J[1][0];
    C[1][0] = -J[0][1];
    C[1][1] = J[0][0];
    return J[0][0] * C[0][0] + J[0][1] * C[0][1];
}
template <class S>
S cofactors(const S (&J)[3][3], S (&C)[3][3]) {
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
            const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
            C[a][b] = J[a1][b1] * J[a2][b2] - J[a1][b2] * J[a2][b1];
        }
    return J[0][0] * C[0][0] + J[0][1] * C[0][1] + J[0][2] * C[0][2];
}

// A triangle or tetrahedron with as many material coordinates as it has dimensions.
template <class Basis_, class Rule_>
struct Solid {
    using Basis = Basis_;
    using Rule = Rule_;
    static constexpr int dim = Basis::dim, nodes = Basis::nodes, points = Rule::points;
    static constexpr Table<Basis, Rule> table{};

    // Gradients G of the basis functions in material coordinates X, and the volume that point q stands for.
    template <class S>
    static S gradients(int q, const S* X, S (&G)[nodes][dim]) {
        return gradients(table.slope[q], Rule::weight[q], X, G);
    }
    // The volume that point q stands for.
    template <class S>
    static S volume(int q, const S* X) {
        S J[dim][dim], C[dim][dim];
        jacobian(table.slope[q], X, J);
        return cofactors(J, C) * Rule::weight[q];
    }
    // The determinant of the map from the reference triangle at the nodes.
    template <class S>
    static void determinants(const S* X, S* at) {
        static constexpr Table<Basis, NodesOf<Basis>> nodal{};
        for (int i = 0; i < nodes; ++i) {
            S J[dim][dim], C[dim][dim];
            jacobian(nodal.slope[i], X, J);
            at[i] = cofactors(J, C);
        }
    }
    // The gradients anywhere: xi are reference coordinates. Returns the determinant of the map.
    template <class S>
    static S gradients_at(const double* xi, const S* X, S (&G)[nodes][dim]) {
        double slope[nodes][dim] = {};
        Basis::slopes(xi, slope);
        return gradients(slope, 1.0, X, G);
    }

 private:
    template <class S>
    static void jacobian(const double (&slope)[nodes][dim], const S* X, S (&J)[dim][dim]) {
        for (int a = 0; a < dim; ++a)
            for (int b = 0; b < dim; ++b) {
                if constexpr (Basis::order == 1) {
                    J[a][b] = X[(b + 1) * dim + a] - X[a];
                } else {
                    J[a][b] = X[a] * slope[0][b];
                    for (int i = 1; i < nodes; ++i) J[a][b] += X[i * dim + a] * slope[i][b];
                }
            }
    }
    template <class S>
    static S gradients(const double (&slope)[nodes][dim], double weight, const S* X, S (&G)[nodes][dim]) {
        S J[dim][dim], C[dim][dim];
        jacobian(slope, X, J);
        const S determinant = cofactors(J, C), inverse = 1.0 / determinant;
        for (int a = 0; a < dim; ++a) {
            S F[dim];
            for (int b = 0; b < dim; ++b) F[b] = C[a][b] * inverse;
            if constexpr (Basis::order == 1) {
                G[0][a] = -F[0];
                for (int b = 1; b < dim; ++b) G[0][a] -= F[b];
                for (int b = 0; b < dim; ++b) G[b + 1][a] = F[b];
            } else {
                for (int i = 0; i < nodes; ++i) {
                    G[i][a] = F[0] * slope[i][0];
                    for (int b = 1; b < dim; ++b) G[i][a] += F[b] * slope[i][b];
                }
            }
        }
        return determinant * weight;
    }
};

// A line in the plane: a side of an outline.
template <class Basis_, class Rule_>
struct Side {
    using Basis = Basis_;
    using Rule = Rule_;
    static constexpr int dim = 2, nodes = Basis::nodes, points = Rule::points;
    static constexpr Table<Basis, Rule> table{};

    // dX/dxi at point q.
    template <class S>
    static void tangent(int q, const S* X, S (&t)[2]) {
        for (int a = 0; a < 2; ++a) {
            t[a] = X[a] * table.slope[q][0][0];
            for (int i = 1; i < nodes; ++i) t[a] += X[i * 2 + a] * table.slope[q][i][0];
        }
    }
};

// Second order: enough points that a linear field on curved sides is in exact equilibrium (degree 2 in 2D, 3 in 3D),
// and that the energy of small strains is exact on straight ones (degree 2); that of large strains is a quartic.
using Tri3 = Solid<Linear<2>, TriRule1>;
using Tri6Small = Solid<Quadratic<2>, TriRule3>;
using Tri6 = Solid<Quadratic<2>, TriRule6>;
using Tri6Mass = Solid<Quadratic<2>, TriRule12>;  // exact for products of two displacements, on curved sides too
using Tet4 = Solid<Linear<3>, TetRule1>;
using Tet10 = Solid<Quadratic<3>, TetRule8>;
using Tet10Straight = Solid<Quadratic<3>, TetRule4>;  // exact for small strains on straight sides
using Tet10Mass = Solid<Quadratic<3>, TetRule14>;     // exact for products of two displacements, on straight sides
using Line2 = Side<Linear<1>, LineRule2>;
using Line3 = Side<Quadratic<1>, LineRule3>;

}  // namespace restshape
