// What the element loop knows of an element: its sizes and five functions, made from one template by `element_of`.
#pragma once

#include <string>
#include <vector>

#include "fem/calls.hpp"
#include "fem/corners.hpp"
#include "fem/dual.hpp"
#include "fem/pack.hpp"

namespace restshape {

// Unknowns of one kind of an element with several: on the first of its nodes, so many components on each.
struct Field {
    std::string name;
    int nodes, components;
};

// Arrays of one element: X (nodes, dim), w (nodes, coefficients), x and r (dof_nodes, fields), p (parameters).
//
// Unknowns lie on the element's own nodes, `fields` on each. Of an element with a layout they are single numbers
// (fields is 1), field after field, in a field node after node.
struct Element {
    std::string name, family, shape;  // the name is the other two, joined, unless another is given
    int nodes, dim, dof_nodes, fields;
    int tangent_stride;  // doubles between rows of K
    bool symmetric;      // of the tangent
    int stress_components;
    std::vector<std::string> parameters, coefficients;
    std::vector<Field> layout;  // empty where every node has the same unknowns

    // Those of the element type, which take w where there are coefficients: none is called through another.
    template <class... W>
    struct Functions {
        void (*residual)(const double* X, const double* x, W... w, const double* p, double* r) = nullptr;
        void (*tangent)(const double* X, const double* x, W... w, const double* p, double* r, double* K) = nullptr;
        double (*energy)(const double* X, const double* x, W... w, const double* p) = nullptr;
        void (*stress)(const double* X, const double* x, W... w, const double* p, const double* xi,
                       double* s) = nullptr;
    };
    using Design = void (*)(const double* X, const double* dX, const double* x, const double* dx, const double* w,
                            const double* dw, const double* p, double* r);

    // Those of several elements, one a lane, K without padding; null where the element has none.
    struct Packed {
        void (*residual)(const Pack* X, const Pack* x, const Pack* w, const Pack* p, Pack* r) = nullptr;
        void (*tangent)(const Pack* X, const Pack* x, const Pack* w, const Pack* p, Pack* r, Pack* K) = nullptr;
    };

    Functions<> plain;
    Functions<const double*> with_coefficients;
    Design design;  // dr/dX . dX + dr/dw . dw + dr/dx . dx; without those whose direction is null

    bool has_coefficients() const { return with_coefficients.residual != nullptr; }
    bool has_tangent() const { return plain.tangent || with_coefficients.tangent; }  // whether r depends on x
    bool has_energy() const { return plain.energy || with_coefficients.energy; }

    void residual(const double* X, const double* x, const double* w, const double* p, double* r) const {
        has_coefficients() ? with_coefficients.residual(X, x, w, p, r) : plain.residual(X, x, p, r);
    }
    // Residual and dr/dx in one pass.
    void residual_tangent(const double* X, const double* x, const double* w, const double* p, double* r,
                          double* K) const {
        has_coefficients() ? with_coefficients.tangent(X, x, w, p, r, K) : plain.tangent(X, x, p, r, K);
    }
    double energy(const double* X, const double* x, const double* w, const double* p) const {
        return has_coefficients() ? with_coefficients.energy(X, x, w, p) : plain.energy(X, x, p);
    }
    // At reference coordinates xi.
    void stress(const double* X, const double* x, const double* w, const double* p, const double* xi, double* s) const {
        has_coefficients() ? with_coefficients.stress(X, x, w, p, xi, s) : plain.stress(X, x, p, xi, s);
    }

    Packed packed;
    Tally* tally = nullptr;  // of the registered element of this name

    int unknowns() const { return dof_nodes * fields; }
    int coefficient_count() const { return static_cast<int>(coefficients.size()); }
};

// Rows of an array (n, columns) at the nodes of a cell.
inline void gather(const int32_t* cell, int nodes, int columns, const double* from, double* to) {
    for (int i = 0; i < nodes; ++i)
        for (int a = 0; a < columns; ++a) to[i * columns + a] = from[static_cast<size_t>(cell[i]) * columns + a];
}

// Numbers of one element after the other, into its lane of packs.
inline void set_lane(Pack* to, int lane, const double* from, int count) {
    for (int k = 0; k < count; ++k) to[k][lane] = from[k];
}

// Rows of an array (n, columns) at the nodes of several cells, a lane each.
inline void gather(const int32_t* const (&cells)[pack_lanes], int nodes, int columns, const double* from, Pack* to) {
    for (int i = 0; i < nodes; ++i) {
        // Put together in registers: a pack whose lanes are written one by one is waited for when it is read.
        if (columns == 2) {
            corner_of(from, cells, i, to[2 * i], to[2 * i + 1]);
            continue;
        }
        for (int lane = 0; lane < pack_lanes; ++lane)
            set_lane(to + i * columns, lane, from + static_cast<size_t>(cells[lane][i]) * columns, columns);
    }
}

constexpr int max_packed = 12,
              max_parameters = 16;   // unknowns or coordinates, and parameters, of elements with `packed`
constexpr int max_packed_terms = 4;  // of a sum of such elements
constexpr int max_unknowns = 64, max_coordinates = 64, max_coefficients = 64, max_tangent = max_unknowns * max_unknowns;

const std::vector<Element>& elements();           // all that are registered
const Element& element(const std::string& name);  // throws std::invalid_argument with the names that exist

namespace detail {

// What an element type says only where it is not the plain case.
template <class E, class = void>
struct Unknowns {
    static constexpr int nodes = E::nodes;
    static std::vector<Field> layout() { return {}; }
};
template <class E>
struct Unknowns<E, std::void_t<decltype(E::dof_nodes)>> {
    static constexpr int nodes = E::dof_nodes;
    static std::vector<Field> layout() { return E::layout(); }
};
template <class E, class = void>
struct Coefficients {
    static constexpr int count = 0;
    static std::vector<std::string> names() { return {}; }
};
template <class E>
struct Coefficients<E, std::void_t<decltype(E::coefficient_count)>> {
    static constexpr int count = E::coefficient_count;
    static std::vector<std::string> names() { return E::coefficients(); }
};

// Flat: with many elements in one file the compiler would stop inlining the arithmetic of duals.
template <class E, class... W>
[[gnu::flatten]] void tangent(const double* X, const double* x, W... w, const double* p, double* r, double* K) {
    constexpr int n = Unknowns<E>::nodes * E::fields;
    using D = Dual<n>;
    D xd[n], rd[n];
    for (int k = 0; k < n; ++k) xd[k] = D::seed(x[k], k);
    E::residual(X, xd, w..., p, rd);
    for (int k = 0; k < n; ++k) {
        r[k] = rd[k].v;
        Eigen::Map<typename D::Lanes>(K + k * D::lanes) = rd[k].d;
    }
}

// Coefficients with their derivatives along one direction; none where the element has none.
template <int Count>
struct DualCoefficients {
    Dual<1> at[Count];
    DualCoefficients(const double* w, const double* dw) {
        for (int k = 0; k < Count; ++k) at[k] = Dual<1>(w[k], Dual<1>::Lanes::Constant(dw ? dw[k] : 0.0));
    }
    const Dual<1>* data() const { return at; }
};
template <>
struct DualCoefficients<0> {
    DualCoefficients(const double*, const double*) {}
    const Dual<1>* data() const { return nullptr; }
};

// Elements without coefficients are not asked to take any.
template <class E, class Sx, class R>
[[gnu::always_inline]] inline void dual_residual(const Dual<1>* X, const Sx* x, [[maybe_unused]] const Dual<1>* w,
                                                 const double* p, R* r) {
    if constexpr (Coefficients<E>::count > 0)
        E::residual(X, x, w, p, r);
    else
        E::residual(X, x, p, r);
}

template <class E>
void design(const double* X, const double* dX, const double* x, const double* dx, const double* w, const double* dw,
            const double* p, double* r) {
    constexpr int n = Unknowns<E>::nodes * E::fields, m = E::nodes * E::dim;
    using D = Dual<1>;
    const DualCoefficients<E::nodes * Coefficients<E>::count> wd(w, dw);
    D Xd[m], rd[n];
    for (int k = 0; k < m; ++k) Xd[k] = D(X[k], D::Lanes::Constant(dX[k]));
    if (dx) {
        D xd[n];
        for (int k = 0; k < n; ++k) xd[k] = D(x[k], D::Lanes::Constant(dx[k]));
        dual_residual<E>(Xd, xd, wd.data(), p, rd);
    } else {
        dual_residual<E>(Xd, x, wd.data(), p, rd);
    }
    for (int k = 0; k < n; ++k) r[k] = rd[k].d[0];
}

template <class E, class F, class = void>
struct HasOwnTangent : std::false_type {};
template <class E, class F>
struct HasOwnTangent<E, F, std::void_t<decltype(static_cast<F>(&E::tangent))>> : std::true_type {};

template <class E, class = void>
struct HasPacked : std::false_type {};
template <class E>
struct HasPacked<E, std::void_t<decltype(E::packed)>> : std::bool_constant<E::packed> {};

template <class E, class... W>
void set_functions(Element::Functions<W...>& f) {
    f.residual = E::template residual<double, double, double>;
    if constexpr (E::has_tangent) {
        // Six unknowns fill one register of duals: the plain way is the faster one then.
        if constexpr (HasOwnTangent<E, decltype(f.tangent)>::value && Unknowns<E>::nodes * E::fields > 6)
            f.tangent = E::tangent;
        else
            f.tangent = tangent<E, W...>;
    }
    if constexpr (E::symmetric) f.energy = E::template energy<double, double>;
    if constexpr (E::stress_components > 0) f.stress = E::stress;
}

}  // namespace detail

// An element type E has nodes, dim, fields, symmetric, has_tangent, stress_components, parameters() and
//   template <class SX, class Sx, class R> static void residual(const SX* X, const Sx* x, const double* p, R* r)
//   template <class SX, class Sx> static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p)
//   static void stress(const double* X, const double* x, const double* p, const double* xi, double* s)
// the energy if it is symmetric, the stress if it has components of it; and may have a tangent of its own where that is
// faster than dual numbers of all unknowns. With nodal coefficients it has coefficient_count, above 0, and
// coefficients(), their names, and all of these take them after x: const SX* w (const double* w where X is). With
// fields on different nodes it has dof_nodes and layout().
template <class E>
Element element_of(const std::string& family, const std::string& shape) {
    constexpr int n = detail::Unknowns<E>::nodes * E::fields, coefficients = detail::Coefficients<E>::count;
    static_assert(
        n <= max_unknowns && E::nodes * E::dim <= max_coordinates && E::nodes * coefficients <= max_coefficients,
        "raise the limits of the element loop");
    Element e{family + "_" + shape,
              family,
              shape,
              E::nodes,
              E::dim,
              detail::Unknowns<E>::nodes,
              E::fields,
              Dual<n>::lanes,
              E::symmetric,
              E::stress_components,
              E::parameters(),
              detail::Coefficients<E>::names(),
              detail::Unknowns<E>::layout(),
              {},
              {},
              detail::design<E>};
    if constexpr (coefficients > 0)
        detail::set_functions<E>(e.with_coefficients);
    else
        detail::set_functions<E>(e.plain);
    if constexpr (detail::HasPacked<E>::value) {
        static_assert(n <= max_packed && E::nodes * E::dim <= max_packed, "raise the limits of packed elements");
        static_assert(E::nodes == detail::Unknowns<E>::nodes, "packed elements have their unknowns at their nodes");
        e.packed = {E::packed_residual, E::packed_tangent};
    }
    return e;
}

}  // namespace restshape
