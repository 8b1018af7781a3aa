// Conduction of heat in the plane: cells that conduct, cells that store, sides that heat enters and leaves by.
//
// The unknown is the temperature. Residuals are heat that leaves the nodes [W], over the thickness.
// Source: Lewis, Nithiarasu and Seetharamu, Fundamentals of the Finite Element Method for Heat and Fluid Flow (2004).
#include <string>
#include <vector>

#include "fem/element.hpp"
#include "fem/mass.hpp"
#include "fem/shapes.hpp"

namespace restshape {

namespace {

// -div(k grad T) = source.
template <class Shape>
struct ConductionElement {
    static constexpr int nodes = Shape::nodes, dim = 2, fields = 1;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 2;

    // Conductivity [W/(m K)], thickness [m], source [W/m^3] at each quadrature point.
    static std::vector<std::string> parameters() {
        std::vector<std::string> names{"conductivity", "thickness"};
        for (int q = 0; q < Shape::points; ++q) names.push_back("source" + std::to_string(q));
        return names;
    }

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        for (int i = 0; i < nodes; ++i) r[i] = R(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][2];
            const SX volume = Shape::gradients(q, X, G) * p[1];
            R flow[2];
            for (int a = 0; a < 2; ++a) flow[a] = slope(G, x, a) * volume * p[0];
            for (int i = 0; i < nodes; ++i)
                r[i] += flow[0] * G[i][0] + flow[1] * G[i][1] - volume * (p[2 + q] * Shape::table.value[q][i]);
        }
    }

    // What is stationary: k |grad T|^2 / 2 - source T.
    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        R total(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            SX G[nodes][2];
            const SX volume = Shape::gradients(q, X, G) * p[1];
            const R gx = slope(G, x, 0), gy = slope(G, x, 1);
            R density = 0.5 * p[0] * (gx * gx + gy * gy);
            for (int i = 0; i < nodes; ++i) density -= x[i] * (p[2 + q] * Shape::table.value[q][i]);
            total += density * volume;
        }
        return total;
    }

    // Heat flux -k grad T [W/m^2] at reference coordinates xi.
    static void stress(const double* X, const double* x, const double* p, const double* xi, double* s) {
        double G[nodes][2];
        Shape::gradients_at(xi, X, G);
        for (int a = 0; a < 2; ++a) s[a] = -p[0] * slope(G, x, a);
    }

 private:
    template <class SX, class Sx>
    static Common<SX, Sx> slope(const SX (&G)[nodes][2], const Sx* x, int a) {
        Common<SX, Sx> sum = x[0] * G[0][a];
        for (int i = 1; i < nodes; ++i) sum += x[i] * G[i][a];
        return sum;
    }
};

// k dT/dn = flux - film T on the sides of an outline: what is given, and convection to an ambient at flux / film.
template <class Shape>
struct SurfaceHeatElement {
    static constexpr int nodes = Shape::nodes, dim = 2, fields = 1;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 0;

    // Flux into the body [W/m^2] and film coefficient [W/(m^2 K)] at both ends, linear between them in the side's own
    // parameter; thickness [m].
    static std::vector<std::string> parameters() { return {"flux0", "flux1", "film0", "film1", "thickness"}; }

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        for (int i = 0; i < nodes; ++i) r[i] = R(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            const SX area = side(q, X, p);
            const auto& N = Shape::table.value[q];
            const R leaving = (film(q, p) * here(N, x) - flux(q, p)) * area;
            for (int i = 0; i < nodes; ++i) r[i] += leaving * N[i];
        }
    }

    // film T^2 / 2 - flux T.
    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        Common<SX, Sx> total(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            const Sx T = here(Shape::table.value[q], x);
            total += (0.5 * film(q, p) * (T * T) - flux(q, p) * T) * side(q, X, p);
        }
        return total;
    }

 private:
    static double flux(int q, const double* p) { return at(q, p[0], p[1]); }
    static double film(int q, const double* p) { return at(q, p[2], p[3]); }
    static double at(int q, double first, double last) {
        const double s = Shape::Rule::at[q][0];
        return (1 - s) * first + s * last;
    }
    template <class SX>
    static SX side(int q, const SX* X, const double* p) {
        using std::sqrt;
        SX T[2];
        Shape::tangent(q, X, T);
        return sqrt(T[0] * T[0] + T[1] * T[1]) * (Shape::Rule::weight[q] * p[4]);
    }
    template <class Sx>
    static Sx here(const double (&N)[nodes], const Sx* x) {
        Sx sum = x[0] * N[0];
        for (int i = 1; i < nodes; ++i) sum += x[i] * N[i];
        return sum;
    }
};

}  // namespace

std::vector<Element> heat_elements() {
    return {
        element_of<ConductionElement<Tri3>>("conduction", "tri3"),
        element_of<ConductionElement<Tri6Small>>("conduction", "tri6"),
        element_of<SimplexMassElement<Tri3, 1>>("heat_capacity", "tri3"),
        element_of<MassElement<Tri6Mass, 1>>("heat_capacity", "tri6"),
        element_of<LumpedMassElement<Tri3, 1>>("lumped_heat_capacity", "tri3"),
        element_of<ScaledMassElement<Tri6Mass, 1>>("lumped_heat_capacity", "tri6"),
        element_of<SurfaceHeatElement<Line2>>("surface_heat", "edge2"),
        element_of<SurfaceHeatElement<Line3>>("surface_heat", "edge3"),
    };
}

}  // namespace restshape
