// What elements of solids share: parameters, kinematics, and forces and tangents of stresses. x is the displacement u.
#pragma once

#include <string>
#include <vector>

#include "elasticity/law.hpp"
#include "fem/pack.hpp"

namespace restshape {

// What elements of solids share: parameters, and the integrals of a stress over the volume of one quadrature point.
template <class Shape>
struct SolidParts {
    static constexpr int nodes = Shape::nodes, dim = Shape::dim, fields = dim;
    static constexpr int unknowns = nodes * fields, moduli = dim * dim;
    static constexpr bool symmetric = true, has_tangent = true, flat = dim == 2;
    static constexpr int stress_components = flat ? 4 : 6;

    static std::vector<std::string> parameters() {
        if (flat) return {"lambda", "mu", "thickness", "bx", "by"};
        return {"lambda", "mu", "bx", "by", "bz"};
    }

 protected:
    using Modulus = Dual<moduli>;                // of a stress, by the components of H
    using Row = typename Dual<unknowns>::Lanes;  // of the tangent
    using RowMap = Eigen::Map<Row, Eigen::Aligned64>;
    static constexpr int row_stride = Dual<unknowns>::lanes;

    static double thickness(const double* p) { return flat ? p[2] : 1.0; }
    static Pack times_thickness(const Pack& volume, const Pack* p) { return flat ? volume * p[2] : volume; }
    template <class P>
    static const P* body(const P* p) {
        return p + (flat ? 3 : 2);
    }

    template <class SX, class Sx, class R>
    static void displacement_gradient(const SX (&G)[nodes][dim], const Sx* x, R (&H)[dim][dim]) {
        for (int a = 0; a < dim; ++a)
            for (int k = 0; k < dim; ++k) {
                H[a][k] = x[a] * G[0][k];
                for (int i = 1; i < nodes; ++i) H[a][k] += x[i * dim + a] * G[i][k];
            }
    }

    // H with a derivative in each of its components.
    static void seed(const double (&H)[dim][dim], Modulus (&Hd)[dim][dim]) {
        for (int a = 0; a < dim; ++a)
            for (int k = 0; k < dim; ++k) Hd[a][k] = Modulus::seed(H[a][k], a * dim + k);
    }

    // r (+)= volume (P . grad N_i - b N_i), set at the first point.
    template <class SX, class B, class R>
    static void add_forces(int q, const SX (&G)[nodes][dim], const SX& volume, R (&P)[dim][dim], const B* b, R* r) {
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

    // The same for P with its derivatives in H, and K (+)= volume grad N_i . dP/dH . grad N_j.
    static void add_forces_and_tangent(int q, const double (&G)[nodes][dim], double volume,
                                       const Modulus (&P)[dim][dim], const double* b, double* r, double* K) {
        double value[dim][dim];
        for (int a = 0; a < dim; ++a)
            for (int k = 0; k < dim; ++k) value[a][k] = P[a][k].v;
        add_forces(q, G, volume, value, b, r);
        Row gradient[dim][dim];  // dH[c][l] by the unknowns
        spread(G, gradient);
        for (int a = 0; a < dim; ++a) {
            Row stress[dim];  // dP[a][k] by the unknowns, times the volume
            for (int k = 0; k < dim; ++k) {
                stress[k] = (volume * P[a][k].d[0]) * gradient[0][0];
                for (int m = 1; m < moduli; ++m) stress[k] += (volume * P[a][k].d[m]) * gradient[m / dim][m % dim];
            }
            for (int i = 0; i < nodes; ++i) {
                RowMap row(K + (i * dim + a) * row_stride);
                Row sum = G[i][0] * stress[0];
                for (int k = 1; k < dim; ++k) sum += G[i][k] * stress[k];
                if (q == 0)
                    row = sum;
                else
                    row += sum;
            }
        }
    }

    // The same of several elements, of one point each.
    static void set_forces_and_tangent(const Pack (&G)[nodes][dim], const Pack& volume,
                                       const PackDual<moduli> (&P)[dim][dim], const Pack* b, Pack* r, Pack* K) {
        Pack value[dim][dim];
        for (int a = 0; a < dim; ++a)
            for (int k = 0; k < dim; ++k) value[a][k] = P[a][k].v;
        add_forces(0, G, volume, value, b, r);
        for (int a = 0; a < dim; ++a)
            for (int c = 0; c < dim; ++c)
                for (int j = 0; j < nodes; ++j) {
                    Pack stress[dim];  // dP[a][k] by unknown c of node j, times the volume
                    for (int k = 0; k < dim; ++k) {
                        stress[k] = P[a][k].d[c * dim] * G[j][0];
                        for (int l = 1; l < dim; ++l) stress[k] += P[a][k].d[c * dim + l] * G[j][l];
                        stress[k] *= volume;
                    }
                    for (int i = 0; i < nodes; ++i) {
                        Pack sum = G[i][0] * stress[0];
                        for (int k = 1; k < dim; ++k) sum += G[i][k] * stress[k];
                        K[(i * dim + a) * unknowns + j * dim + c] = sum;
                    }
                }
    }

    // The tangent of Hooke's law of several elements of one point each. Its sums have the order of
    // `add_forces_and_tangent`, so that rounding is the same: the bending modes of thin bodies hang on it.
    static void set_hooke_tangent(const Pack (&G)[nodes][dim], const Pack& volume, const Pack& lambda, const Pack& mu,
                                  Pack* K) {
        const Pack stretch = volume * (lambda + 2.0 * mu), side = volume * lambda, shear = volume * mu;
        for (int j = 0; j < nodes; ++j)
            for (int c = 0; c < dim; ++c) {
                const Pack first = side * G[j][c], second = stretch * G[j][c];
                Pack sheared[dim];
                for (int k = 0; k < dim; ++k) sheared[k] = shear * G[j][k];
                for (int i = 0; i < nodes; ++i)
                    for (int a = 0; a < dim; ++a) {
                        Pack& entry = K[(i * dim + a) * unknowns + j * dim + c];
                        if (a == c) {
                            entry = G[i][0] * (a == 0 ? second : sheared[0]);
                            for (int k = 1; k < dim; ++k) entry += G[i][k] * (k == a ? second : sheared[k]);
                        } else if (a < c) {
                            entry = G[i][a] * first + G[i][c] * sheared[a];
                        } else {
                            entry = G[i][c] * sheared[a] + G[i][a] * first;
                        }
                    }
            }
    }

    // Sums over the points of volume dN_i/dX_k dN_j/dX_l of several elements in the plane: all that Hooke's law needs.
    struct GradientProducts {
        Pack xx[nodes][nodes], yy[nodes][nodes], xy[nodes][nodes];  // of xx and yy the upper halves

        void add(int q, const Pack (&G)[nodes][dim], const Pack& volume) {
            for (int i = 0; i < nodes; ++i) {
                const Pack x = volume * G[i][0], y = volume * G[i][1];
                for (int j = i; j < nodes; ++j) {
                    xx[i][j] = q ? xx[i][j] + x * G[j][0] : x * G[j][0];
                    yy[i][j] = q ? yy[i][j] + y * G[j][1] : y * G[j][1];
                }
                for (int j = 0; j < nodes; ++j) xy[i][j] = q ? xy[i][j] + x * G[j][1] : x * G[j][1];
            }
        }
    };

    // The tangent of Hooke's law of them: the sum of volume (lambda dN_i/dX_a dN_j/dX_c + mu (dN_i/dX_c dN_j/dX_a +
    // [a = c] grad N_i . grad N_j)).
    static void set_hooke_tangent(const GradientProducts& g, const Pack& lambda, const Pack& mu, Pack* K) {
        const Pack stretch = lambda + 2.0 * mu;
        for (int i = 0; i < nodes; ++i)
            for (int j = i; j < nodes; ++j) {
                Pack *upper = K + i * dim * unknowns + j * dim, *lower = K + j * dim * unknowns + i * dim;
                upper[0] = lower[0] = stretch * g.xx[i][j] + mu * g.yy[i][j];
                upper[unknowns + 1] = lower[unknowns + 1] = stretch * g.yy[i][j] + mu * g.xx[i][j];
                upper[1] = lower[unknowns] = lambda * g.xy[i][j] + mu * g.xy[j][i];
                upper[unknowns] = lower[1] = lambda * g.xy[j][i] + mu * g.xy[i][j];
            }
    }

    static void spread(const double (&G)[nodes][dim], Row (&gradient)[dim][dim]) {
        for (int c = 0; c < dim; ++c)
            for (int l = 0; l < dim; ++l) {
                gradient[c][l].setZero();
                for (int j = 0; j < nodes; ++j) gradient[c][l][j * dim + c] = G[j][l];
            }
    }

    // Potential of the body force of one point.
    template <class SX, class Sx>
    static Common<SX, Sx> work_of_body(int q, const SX& volume, const Sx* x, const double* b) {
        Common<SX, Sx> work(0.0);
        for (int i = 0; i < nodes; ++i)
            for (int a = 0; a < dim; ++a) work += x[i * dim + a] * (b[a] * Shape::table.value[q][i]);
        return work * volume;
    }

    // xx yy xy zz (yz xz) of S = volumetric I + 2 mu E.
    template <class Law>
    static void components(const double (&H)[dim][dim], const double (&E)[dim][dim], double volumetric, double mu,
                           double* s) {
        double S[dim][dim], c[dim][dim];
        hooke(E, volumetric, mu, S);
        const double J = Law::cauchy(H, S, c);
        s[0] = c[0][0];
        s[1] = c[1][1];
        s[2] = c[0][1];
        if constexpr (flat) {
            s[3] = volumetric / J;  // of plane strain
        } else {
            s[3] = c[2][2];
            s[4] = c[1][2];
            s[5] = c[0][2];
        }
    }
};

}  // namespace restshape
