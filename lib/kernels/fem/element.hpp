// What the element loop knows of an element: its sizes and five functions, made from one template by `element_of`.
#pragma once

#include <string>
#include <vector>

#include "calls.hpp"
#include "dual.hpp"

namespace restshape {

// Arrays of one element: X (nodes, dim), x and r (nodes, fields), p (parameters).
struct Element {
    std::string name;
    int nodes, dim, fields;
    int tangent_stride;  // doubles between rows of K
    bool symmetric;      // of the tangent
    int stress_components;
    std::vector<std::string> parameters;

    using Residual = void (*)(const double* X, const double* x, const double* p, double* r);
    using Tangent = void (*)(const double* X, const double* x, const double* p, double* r, double* K);
    using Design = void (*)(const double* X, const double* dX, const double* x, const double* dx, const double* p,
                            double* r);
    using Energy = double (*)(const double* X, const double* x, const double* p);
    using Stress = void (*)(const double* X, const double* x, const double* p, const double* xi, double* s);

    Residual residual;
    Tangent residual_tangent;  // residual and dr/dx in one pass; null where the residual does not depend on x
    Design design;             // dr/dX . dX + dr/dx . dx; without the second where dx is null
    Energy energy;             // null where there is none
    Stress stress;             // at reference coordinates xi; null where there is none

    Tally* tally = nullptr;  // of the registered element of this name

    int unknowns() const { return nodes * fields; }
};

constexpr int max_unknowns = 64, max_coordinates = 64, max_tangent = max_unknowns * max_unknowns;

const std::vector<Element>& elements();           // all that are registered
const Element& element(const std::string& name);  // throws std::invalid_argument with the names that exist

namespace detail {

// Flat: with many elements in one file the compiler would stop inlining the arithmetic of duals.
template <class E>
[[gnu::flatten]] void tangent(const double* X, const double* x, const double* p, double* r, double* K) {
    constexpr int n = E::nodes * E::fields;
    using D = Dual<n>;
    D xd[n], rd[n];
    for (int k = 0; k < n; ++k) xd[k] = D::seed(x[k], k);
    E::residual(X, xd, p, rd);
    for (int k = 0; k < n; ++k) {
        r[k] = rd[k].v;
        Eigen::Map<typename D::Lanes>(K + k * D::lanes) = rd[k].d;
    }
}

template <class E>
void design(const double* X, const double* dX, const double* x, const double* dx, const double* p, double* r) {
    constexpr int n = E::nodes * E::fields, m = E::nodes * E::dim;
    using D = Dual<1>;
    D Xd[m], rd[n];
    for (int k = 0; k < m; ++k) Xd[k] = D(X[k], D::Lanes::Constant(dX[k]));
    if (dx) {
        D xd[n];
        for (int k = 0; k < n; ++k) xd[k] = D(x[k], D::Lanes::Constant(dx[k]));
        E::residual(Xd, xd, p, rd);
    } else {
        E::residual(Xd, x, p, rd);
    }
    for (int k = 0; k < n; ++k) r[k] = rd[k].d[0];
}

template <class E, class = void>
struct TangentOf {
    static constexpr Element::Tangent value = tangent<E>;
};
template <class E>
struct TangentOf<E, std::void_t<decltype(&E::tangent)>> {
    // Six unknowns fill one register of duals: the plain way is the faster one then.
    static constexpr Element::Tangent value = E::nodes * E::fields <= 6 ? tangent<E> : E::tangent;
};

}  // namespace detail

// An element type E has nodes, dim, fields, symmetric, has_tangent, stress_components, parameters() and
//   template <class SX, class Sx, class R> static void residual(const SX* X, const Sx* x, const double* p, R* r)
//   template <class SX, class Sx> static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p)
//   static void stress(const double* X, const double* x, const double* p, const double* xi, double* s)
// the energy if it is symmetric, the stress if it has components of it; and may have a tangent of its own where that is
// faster than dual numbers of all unknowns.
template <class E>
Element element_of(const char* name) {
    constexpr int n = E::nodes * E::fields;
    static_assert(n <= max_unknowns && E::nodes * E::dim <= max_coordinates, "raise the limits of the element loop");
    Element e{name,
              E::nodes,
              E::dim,
              E::fields,
              Dual<n>::lanes,
              E::symmetric,
              E::stress_components,
              E::parameters(),
              E::template residual<double, double, double>,
              nullptr,
              detail::design<E>,
              nullptr,
              nullptr};
    if constexpr (E::has_tangent) e.residual_tangent = detail::TangentOf<E>::value;
    if constexpr (E::symmetric) e.energy = E::template energy<double, double>;
    if constexpr (E::stress_components > 0) e.stress = E::stress;
    return e;
}

}  // namespace restshape
