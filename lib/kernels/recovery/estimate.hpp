// How far stresses of cells are from nodal ones that are interpolated, as energies: the estimate of Zienkiewicz and
// Zhu, Int. J. Numer. Meth. Engng 24 (1987) 337.
#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "fem/pack.hpp"
#include "fem/shapes.hpp"

namespace restshape {

// Shapes with rules that are exact for the square of what is interpolated, on straight sides.
struct EstimateTri3 : Solid<Linear<2>, TriRule3> {
    static constexpr int components = 4;
};
struct EstimateTri6 : Solid<Quadratic<2>, TriRule6> {
    static constexpr int components = 4;
};
struct EstimateTet4 : Solid<Linear<3>, TetRule4> {
    static constexpr int components = 6;
};
struct EstimateTet10 : Solid<Quadratic<3>, TetRule14> {
    static constexpr int components = 6;
};

struct StressOnCells {
    const double* X;              // (n, dim)
    const int32_t *cells, *rows;  // (ne, nodes) nodes, and their rows in `nodal`
    const double* nodal;          // (rows, components)
    const double* samples;        // (ne, sampled, components)
    int sampled;                  // points; 1 where stresses are constant in a cell, dim + 1 where they are linear
    const double* compliance;     // (kinds, components, components)
    const int32_t* kinds;         // (ne,), or null where all are 0
    std::ptrdiff_t count;
};

struct Energies {
    double distance = 0.0, size = 0.0;
};

// Values of one place in one register: six with zeros behind them.
using Four = double __attribute__((vector_size(4 * sizeof(double))));
template <int Components>
using Register = std::conditional_t<Components == 4, Four, EightLanes>;

// Six in two readings, for what is put together in memory is waited for.
template <int Components>
Register<Components> loaded(const double* from) {
    Four first;
    std::memcpy(&first, from, sizeof(Four));
    if constexpr (Components == 4) {
        return first;
    } else {
        using Two = double __attribute__((vector_size(2 * sizeof(double))));
        Two last;
        std::memcpy(&last, from + 4, sizeof(Two));
        const Four rest = __builtin_shufflevector(last, Two{}, 0, 1, 2, 3);
        return __builtin_shufflevector(first, rest, 0, 1, 2, 3, 4, 5, 6, 7);
    }
}

// The stress at point q of what is constant in the cell, or linear between samples near its corners.
template <class Shape>
Register<Shape::components> stress_between(int q, const double* sample, int sampled) {
    constexpr int components = Shape::components, corners = Shape::dim + 1;
    const auto first = loaded<components>(sample);
    if (sampled == 1) return first;
    // A sample's own barycentric coordinate is 1 - dim a, the others are a.
    constexpr double a = Shape::dim == 3 ? TetRule4::a : 1.0 / 6, range = 1.0 - corners * a;
    double l[corners];
    Linear<Shape::dim>::values(Shape::Rule::at[q], l);
    auto s = (l[0] - a) / range * first;
    for (int i = 1; i < corners; ++i) s += (l[i] - a) / range * loaded<components>(sample + i * components);
    return s;
}

// The terms of d . C d, one a component: their sum needs no order, and is taken once for all cells.
template <int Components>
Register<Components> energy_terms(const Register<Components> (&C)[Components], const Register<Components>& d) {
    Register<Components> image = d[0] * C[0];
    for (int k = 1; k < Components; ++k) image += d[k] * C[k];
    return d * image;
}

template <int Components>
Energies summed(const Register<Components>& distance, const Register<Components>& size) {
    Energies total;
    for (int k = 0; k < Components; ++k) total.distance += distance[k], total.size += size[k];
    return total;
}

// The integrals of `recovery_energies` in closed form: of first order d is linear where the samples are constant, and
// the mean of d . C d is that of the corners and of their sum, over the number of corners and one more.
template <class Shape>
Energies constant_stress_energies(const StressOnCells& on) {
    constexpr int nodes = Shape::nodes, dim = Shape::dim, components = Shape::components;
    using Value = Register<components>;
    Value distance{}, size{}, C[components] = {};
    int kind = -1;
    for (std::ptrdiff_t e = 0; e < on.count; ++e) {
        const Value s = loaded<components>(on.samples + e * components);
        if (const int own = on.kinds ? on.kinds[e] : 0; own != kind) {
            kind = own;
            for (int k = 0; k < components; ++k)
                C[k] = loaded<components>(on.compliance + (kind * components + k) * components);
        }
        double X[nodes * dim];
        Value sum{}, squares{};
        for (int i = 0; i < nodes; ++i) {
            const double* place = on.X + static_cast<size_t>(on.cells[e * nodes + i]) * dim;
            for (int a = 0; a < dim; ++a) X[i * dim + a] = place[a];
            const size_t row = static_cast<size_t>(on.rows[e * nodes + i]);
            const Value d = loaded<components>(on.nodal + row * components) - s;
            sum += d;
            squares += energy_terms<components>(C, d);
        }
        const double volume = Shape::points * Shape::volume(0, X);
        distance += volume / (nodes * (nodes + 1)) * (squares + energy_terms<components>(C, sum));
        size += volume * energy_terms<components>(C, s);
    }
    return summed<components>(distance, size);
}

// Integrals of d . C d, of d = nodal - sampled, and of s . C s, of the samples s.
template <class Shape>
Energies recovery_energies(const StressOnCells& on) {
    constexpr int nodes = Shape::nodes, dim = Shape::dim, components = Shape::components;
    if constexpr (Shape::Basis::order == 1)
        if (on.sampled == 1) return constant_stress_energies<Shape>(on);
    using Value = Register<components>;
    Value distance{}, size{};
    for (std::ptrdiff_t e = 0; e < on.count; ++e) {
        double X[nodes * dim];
        Value recovered[nodes], C[components];
        for (int i = 0; i < nodes; ++i) {
            const double* place = on.X + static_cast<size_t>(on.cells[e * nodes + i]) * dim;
            for (int a = 0; a < dim; ++a) X[i * dim + a] = place[a];
            recovered[i] = loaded<components>(on.nodal + static_cast<size_t>(on.rows[e * nodes + i]) * components);
        }
        for (int k = 0; k < components; ++k)
            C[k] = loaded<components>(on.compliance + ((on.kinds ? on.kinds[e] : 0) * components + k) * components);
        double volume = 0.0;
        for (int q = 0; q < Shape::points; ++q) {
            // Of first order all points stand for the same volume.
            if (q == 0 || Shape::Basis::order > 1) volume = Shape::volume(q, X);
            const double* sample = on.samples + e * on.sampled * components;
            const Value s = on.sampled == Shape::points ? loaded<components>(sample + q * components)
                                                        : stress_between<Shape>(q, sample, on.sampled);
            Value d = -s;
            for (int i = 0; i < nodes; ++i) d += Shape::table.value[q][i] * recovered[i];
            distance += volume * energy_terms<components>(C, d);
            size += volume * energy_terms<components>(C, s);
        }
    }
    return summed<components>(distance, size);
}

// Second stress of Piola and Kirchhoff of Cauchy's one in the plane: J F^-1 s F^-T of its components xx yy xy zz.
template <class Shape>
void pull_back(const double* X, const double* x, const double* xi, double* s) {
    constexpr int nodes = Shape::nodes, dim = Shape::dim;
    double G[nodes][dim], F[2][2] = {{1.0, 0.0}, {0.0, 1.0}}, C[2][2];
    Shape::gradients_at(xi, X, G);
    for (int i = 0; i < nodes; ++i)
        for (int a = 0; a < 2; ++a)
            for (int k = 0; k < 2; ++k) F[a][k] += x[2 * i + a] * G[i][k];
    const double J = cofactors(F, C);
    // The cofactors are J times the inverse transposed.
    const double c[2][2] = {{s[0], s[2]}, {s[2], s[1]}};
    double S[2][2] = {};
    for (int k = 0; k < 2; ++k)
        for (int l = 0; l < 2; ++l)
            for (int a = 0; a < 2; ++a)
                for (int b = 0; b < 2; ++b) S[k][l] += C[a][k] * c[a][b] * C[b][l] / J;
    s[0] = S[0][0], s[1] = S[1][1], s[2] = S[0][1], s[3] = s[3] * J;
}

}  // namespace restshape
