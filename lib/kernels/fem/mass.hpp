// Inertia: residual M x with x the acceleration; its energy is x.Mx/2 (the kinetic energy when x is the velocity).
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "fem/element.hpp"
#include "fem/shapes.hpp"

namespace restshape {

// x.Mx/2 of an element whose residual is M x.
template <class Element, class SX, class Sx>
Common<SX, Sx> inertial_energy(const SX* X, const Sx* x, const double* p) {
    using R = Common<SX, Sx>;
    R r[Element::nodes * Element::fields];
    Element::residual(X, x, p, r);
    R total(0.0);
    for (int k = 0; k < Element::nodes * Element::fields; ++k) total += 0.5 * (x[k] * r[k]);
    return total;
}

// What all elements of inertia have; their tangent is M.
template <class Element>
struct Inertial {
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0;

    // Mass per volume in 3D, density times thickness in 2D.
    static std::vector<std::string> parameters() { return {"density"}; }

    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        return inertial_energy<Element>(X, x, p);
    }
};

// Lumped mass: rows summed onto the diagonal; the basis functions sum to one. Not for second order, where the sums of
// corners are 0.
template <class Shape, int Fields>
struct LumpedMassElement : Inertial<LumpedMassElement<Shape, Fields>> {
    static constexpr int nodes = Shape::nodes, dim = Shape::dim, fields = Fields;

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        for (int k = 0; k < nodes * fields; ++k) r[k] = R(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][dim];
            const SX mass = Shape::gradients(q, X, G) * p[0];
            const auto& N = Shape::table.value[q];
            for (int i = 0; i < nodes; ++i)
                for (int a = 0; a < fields; ++a) r[i * fields + a] += x[i * fields + a] * (mass * N[i]);
        }
    }
};

// Consistent mass by quadrature.
template <class Shape, int Fields>
struct MassElement : Inertial<MassElement<Shape, Fields>> {
    static constexpr int nodes = Shape::nodes, dim = Shape::dim, fields = Fields;

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        for (int k = 0; k < nodes * fields; ++k) r[k] = R(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            const SX mass = Shape::volume(q, X) * p[0];
            const auto& N = Shape::table.value[q];
            for (int a = 0; a < fields; ++a) {
                Sx here = x[a] * N[0];
                for (int j = 1; j < nodes; ++j) here += x[j * fields + a] * N[j];
                const R inertia = here * mass;
                for (int i = 0; i < nodes; ++i) r[i * fields + a] += inertia * N[i];
            }
        }
    }

    // One block of the tangent holds for each component.
    static void tangent(const double* X, const double* x, const double* p, double* r, double* K) {
        constexpr int n = nodes * fields, stride = Dual<n>::lanes;
        double M[nodes][nodes] = {};
        for (int q = 0; q < Shape::points; ++q) {
            const double mass = Shape::volume(q, X) * p[0];
            const auto& N = Shape::table.value[q];
            for (int i = 0; i < nodes; ++i)
                for (int j = 0; j < nodes; ++j) M[i][j] += mass * N[i] * N[j];
        }
        for (int k = 0; k < n * stride; ++k) K[k] = 0.0;
        for (int i = 0; i < nodes; ++i)
            for (int a = 0; a < fields; ++a) {
                r[i * fields + a] = 0.0;
                for (int j = 0; j < nodes; ++j) {
                    K[(i * fields + a) * stride + j * fields + a] = M[i][j];
                    r[i * fields + a] += M[i][j] * x[j * fields + a];
                }
            }
    }

    // Of several elements, one a lane.
    static constexpr bool packed = dim == 2 && nodes * fields <= max_packed;

    [[gnu::flatten]] static void packed_residual(const Pack* X, const Pack* x, const Pack*, const Pack* p, Pack* r) {
        Pack M[nodes][nodes];
        set_matrix(X, p[0], M);
        set_forces(M, x, r);
    }

    [[gnu::flatten]] static void packed_tangent(const Pack* X, const Pack* x, const Pack*, const Pack* p, Pack* r,
                                                Pack* K) {
        Pack M[nodes][nodes];
        set_matrix(X, p[0], M);
        set_forces(M, x, r);
        for (int k = 0; k < nodes * fields; ++k)
            for (int l = 0; l < nodes * fields; ++l)
                K[k * nodes * fields + l] = k % fields == l % fields ? M[k / fields][l / fields] : Pack{};
    }

 private:
    // The integrals of N_i N_j N_k over the reference triangle. The determinant of its map is quadratic, as the basis
    // is: it is the sum of N_k times its values at the nodes, on curved sides too.
    struct Triples {
        double entry[nodes][nodes][nodes] = {};

        constexpr Triples() {
            for (int q = 0; q < Shape::points; ++q)
                for (int i = 0; i < nodes; ++i)
                    for (int j = 0; j < nodes; ++j)
                        for (int k = 0; k < nodes; ++k)
                            entry[i][j][k] += Shape::Rule::weight[q] * Shape::table.value[q][i] *
                                              Shape::table.value[q][j] * Shape::table.value[q][k];
        }
    };

    static void set_matrix(const Pack* X, const Pack& density, Pack (&M)[nodes][nodes]) {
        static constexpr Triples triples{};
        Pack mass[nodes];
        Shape::determinants(X, mass);
        for (int k = 0; k < nodes; ++k) mass[k] *= density;
        for (int i = 0; i < nodes; ++i)
            for (int j = i; j < nodes; ++j) {
                M[i][j] = triples.entry[i][j][0] * mass[0];
                for (int k = 1; k < nodes; ++k) M[i][j] += triples.entry[i][j][k] * mass[k];
                M[j][i] = M[i][j];
            }
    }

    static void set_forces(const Pack (&M)[nodes][nodes], const Pack* x, Pack* r) {
        for (int i = 0; i < nodes; ++i)
            for (int a = 0; a < fields; ++a) {
                r[i * fields + a] = M[i][0] * x[a];
                for (int j = 1; j < nodes; ++j) r[i * fields + a] += M[i][j] * x[j * fields + a];
            }
    }
};

// Consistent mass of first-order simplices: the integral of N_i N_j is V (1 + [i = j]) / ((d + 1)(d + 2)), exactly.
template <class Shape, int Fields>
struct SimplexMassElement : Inertial<SimplexMassElement<Shape, Fields>> {
    static constexpr int nodes = Shape::nodes, dim = Shape::dim, fields = Fields;
    static_assert(nodes == dim + 1 && Shape::points == 1, "for first-order simplices with one quadrature point");

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        SX G[nodes][dim];
        const SX share = Shape::gradients(0, X, G) * (p[0] / ((dim + 1) * (dim + 2)));
        for (int a = 0; a < fields; ++a) {
            Sx sum = x[a];
            for (int j = 1; j < nodes; ++j) sum += x[j * fields + a];
            for (int i = 0; i < nodes; ++i) r[i * fields + a] = (sum + x[i * fields + a]) * share;
        }
    }

    // Of several elements, one a lane.
    static constexpr bool packed = true;

    [[gnu::flatten]] static void packed_residual(const Pack* X, const Pack* x, const Pack*, const Pack* p, Pack* r) {
        set_forces(packed_share(X, p), x, r);
    }

    [[gnu::flatten]] static void packed_tangent(const Pack* X, const Pack* x, const Pack*, const Pack* p, Pack* r,
                                                Pack* K) {
        const Pack share = packed_share(X, p);
        set_forces(share, x, r);
        for (int k = 0; k < nodes * fields; ++k)
            for (int l = 0; l < nodes * fields; ++l)
                K[k * nodes * fields + l] = k == l ? 2.0 * share : k % fields == l % fields ? share : 0.0 * share;
    }

    static void tangent(const double* X, const double* x, const double* p, double* r, double* K) {
        constexpr int n = nodes * fields, stride = Dual<n>::lanes;
        double G[nodes][dim];
        const double share = Shape::gradients(0, X, G) * (p[0] / ((dim + 1) * (dim + 2)));
        std::fill(K, K + n * stride, 0.0);
        for (int i = 0; i < nodes; ++i)
            for (int a = 0; a < fields; ++a) {
                double sum = x[i * fields + a], *row = K + (i * fields + a) * stride;
                for (int j = 0; j < nodes; ++j) {
                    sum += x[j * fields + a];
                    row[j * fields + a] = i == j ? 2.0 * share : share;
                }
                r[i * fields + a] = sum * share;
            }
    }

 private:
    static Pack packed_share(const Pack* X, const Pack* p) {
        return Shape::volume(0, X) * (p[0] * (1.0 / ((dim + 1) * (dim + 2))));
    }

    static void set_forces(const Pack& share, const Pack* x, Pack* r) {
        for (int a = 0; a < fields; ++a) {
            Pack sum = x[a];
            for (int j = 1; j < nodes; ++j) sum += x[j * fields + a];
            for (int i = 0; i < nodes; ++i) r[i * fields + a] = (sum + x[i * fields + a]) * share;
        }
    }
};

// Lumped mass of second order: the diagonal of the consistent one, scaled to the whole mass. All masses are positive.
// Source: Hinton, Rock and Zienkiewicz, Earthquake Engng Struct. Dyn. 4 (1976) 245.
template <class Shape, int Fields>
struct ScaledMassElement : Inertial<ScaledMassElement<Shape, Fields>> {
    static constexpr int nodes = Shape::nodes, dim = Shape::dim, fields = Fields;

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        SX diagonal[nodes];
        masses(X, p[0], diagonal);
        for (int i = 0; i < nodes; ++i)
            for (int a = 0; a < fields; ++a) r[i * fields + a] = x[i * fields + a] * diagonal[i];
    }

 private:
    template <class S>
    static void masses(const S* X, double density, S (&diagonal)[nodes]) {
        S whole(0.0), sum(0.0);
        for (int i = 0; i < nodes; ++i) diagonal[i] = S(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            const S volume = Shape::volume(q, X);
            const auto& N = Shape::table.value[q];
            whole += volume;
            for (int i = 0; i < nodes; ++i) diagonal[i] += volume * (N[i] * N[i]);
        }
        for (int i = 0; i < nodes; ++i) sum += diagonal[i];
        const S scale = whole * density / sum;
        for (int i = 0; i < nodes; ++i) diagonal[i] *= scale;
    }
};

}  // namespace restshape
