// What holds a fluid that an outflow draws in: without it, the energy that it brings along is without bound.
//
// -rho (a . n)_- u / 2 on the side, with (s)_- = min(s, 0) and a the velocity less that of the mesh. The convection of
// the cells brings in rho |a . n| |u|^2 / 2 of energy there, and this takes just as much.
//
// Source: Y. Bazilevs, J. R. Gohean, T. J. R. Hughes, R. D. Moser and Y. Zhang, Comput. Methods Appl. Mech. Engng 198
// (2009) 3534; M. Esmaily Moghadam, Y. Bazilevs, T.-Y. Hsia, I. E. Vignon-Clementel and A. L. Marsden, Comput. Mech. 48
// (2011) 277.
#include <string>
#include <vector>

#include "fem/element.hpp"
#include "fem/shapes.hpp"

namespace restshape {

namespace {

constexpr double least_part = 0.5;  // of rho (a . n)_- u: with less, energy may come in

template <int Fields, bool moving>
struct BackflowElement {
    static constexpr int nodes = 2, dim = 2, fields = Fields;
    static constexpr bool symmetric = false, has_tangent = true;
    static constexpr int stress_components = 0, coefficient_count = moving ? 2 : 0;

    // Density [kg/m^3]; the fluid is on the left of the side.
    static std::vector<std::string> parameters() { return {"density"}; }
    // Velocity of the mesh [m/s].
    static std::vector<std::string> coefficients() {
        if (moving) return {"wx", "wy"};
        return {};
    }

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        integrate<SX, Sx, R>(X, x, static_cast<const SX*>(nullptr), p, r);
    }
    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const SX* w, const double* p, R* r) {
        integrate<SX, Sx, R>(X, x, w, p, r);
    }

 private:
    template <class SX, class Sx, class R>
    static void integrate(const SX* X, const Sx* x, [[maybe_unused]] const SX* w, const double* p, R* r) {
        const SX along[2] = {X[2] - X[0], X[3] - X[1]};
        for (int k = 0; k < nodes * fields; ++k) r[k] = R(0.0);
        R leaving[nodes];  // what leaves, over the length
        for (int i = 0; i < nodes; ++i) {
            leaving[i] = x[i * fields] * along[1] - x[i * fields + 1] * along[0];
            if constexpr (moving) leaving[i] -= w[2 * i] * along[1] - w[2 * i + 1] * along[0];
        }
        constexpr double apart = 0.5773502691896257;  // the points of Gauss are exact for what is cubic
        for (const double s : {-apart, apart}) {
            const double N[nodes] = {0.5 * (1.0 - s), 0.5 * (1.0 + s)};
            const R out = leaving[0] * N[0] + leaving[1] * N[1];
            if (!(value_of(out) < 0.0)) continue;
            for (int k = 0; k < 2; ++k) {
                const R held = out * (x[k] * N[0] + x[fields + k] * N[1]) * (-0.5 * least_part * p[0]);
                for (int i = 0; i < nodes; ++i) r[i * fields + k] += held * N[i];
            }
        }
    }
};

}  // namespace

std::vector<Element> backflow_elements() {
    return {
        element_of<BackflowElement<3, false>>("backflow", "edge2"),
        element_of<BackflowElement<3, true>>("backflow_on_moving_mesh", "edge2"),
        element_of<BackflowElement<4, false>>("backflow_with_heat", "edge2"),
        element_of<BackflowElement<4, true>>("backflow_on_moving_mesh_with_heat", "edge2"),
    };
}

}  // namespace restshape
