// Incompressible viscous flow: Taylor and Hood's element, velocity on six nodes and pressure on the corners.
//
// Source: Taylor and Hood, Computers and Fluids 1 (1973) 73; the linearised convection: Oseen, Arkiv Mat. Astr. Fys. 6
// (1910) no. 29.
#include <string>
#include <vector>

#include "fem/element.hpp"
#include "fem/shapes.hpp"

namespace restshape {

namespace {

// -div(2 mu eps(u) - p I) = b and -div u = 0.
struct StokesElement {
    using Velocity = Tri6;
    using Pressure = Linear<2>;
    static constexpr int nodes = Velocity::nodes, dim = 2, fields = 1, corners = Pressure::nodes;
    static constexpr int first_pressure = 2 * nodes, dof_nodes = first_pressure + corners;
    static constexpr bool symmetric = true, has_tangent = true;
    static constexpr int stress_components = 4;

    static std::vector<Field> layout() { return {{"velocity", nodes, 2}, {"pressure", corners, 1}}; }

    // Viscosity [Pa s], body force [N/m^3].
    static std::vector<std::string> parameters() { return {"viscosity", "bx", "by"}; }

    template <class SX, class Sx, class R>
    [[gnu::flatten]] static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        integrate(X, x, p, r, [](const auto&, const auto&, auto&) {});
    }

    // Stationary, not least, at equilibrium: the pressure is the multiplier of the divergence.
    template <class SX, class Sx>
    static Common<SX, Sx> energy(const SX* X, const Sx* x, const double* p) {
        using R = Common<SX, Sx>;
        R total(0.0);
        for (int q = 0; q < Velocity::points; ++q) {
            SX G[nodes][2];
            const SX volume = Velocity::gradients(q, X, G);
            const auto& N = Velocity::table.value[q];
            double L[corners] = {};
            Pressure::values(Velocity::Rule::at[q], L);
            R H[2][2];
            velocity_gradient(G, x, H);
            const R shear = H[0][1] + H[1][0];
            R density = (H[0][0] * H[0][0] + H[1][1] * H[1][1] + 0.5 * (shear * shear)) * p[0];
            density -= (H[0][0] + H[1][1]) * pressure(L, x);
            for (int i = 0; i < nodes; ++i) density -= x[2 * i] * (p[1] * N[i]) + x[2 * i + 1] * (p[2] * N[i]);
            total += density * volume;
        }
        return total;
    }

    static void stress(const double* X, const double* x, const double* p, const double* xi, double* s) {
        double G[nodes][2], L[corners] = {}, H[2][2], sigma[2][2];
        Velocity::gradients_at(xi, X, G);
        Pressure::values(xi, L);
        velocity_gradient(G, x, H);
        stress_of(H, pressure(L, x), p[0], sigma);
        s[0] = sigma[0][0];
        s[1] = sigma[1][1];
        s[2] = sigma[0][1];
        s[3] = -pressure(L, x);
    }

 protected:
    // Integrals of the residual; add(N, H, force) adds to the force of the fluid on a unit of volume.
    template <class SX, class Sx, class R, class Add>
    static void integrate(const SX* X, const Sx* x, const double* p, R* r, Add add) {
        for (int k = 0; k < dof_nodes; ++k) r[k] = R(0.0);
        for (int q = 0; q < Velocity::points; ++q) {
            SX G[nodes][2];
            const SX volume = Velocity::gradients(q, X, G);
            const auto& N = Velocity::table.value[q];
            double L[corners] = {};
            Pressure::values(Velocity::Rule::at[q], L);
            R H[2][2], s[2][2], force[2] = {R(-p[1]), R(-p[2])};
            velocity_gradient(G, x, H);
            stress_of(H, pressure(L, x), p[0], s);
            add(N, H, force);
            for (int i = 0; i < nodes; ++i)
                for (int a = 0; a < 2; ++a)
                    r[2 * i + a] += (s[a][0] * G[i][0] + s[a][1] * G[i][1] + force[a] * N[i]) * volume;
            const R divergence = (H[0][0] + H[1][1]) * volume;
            for (int j = 0; j < corners; ++j) r[first_pressure + j] -= divergence * L[j];
        }
    }

    template <class SX, class Sx, class R>
    static void velocity_gradient(const SX (&G)[nodes][2], const Sx* x, R (&H)[2][2]) {
        for (int a = 0; a < 2; ++a)
            for (int k = 0; k < 2; ++k) {
                H[a][k] = x[a] * G[0][k];
                for (int i = 1; i < nodes; ++i) H[a][k] += x[2 * i + a] * G[i][k];
            }
    }

    template <class Sx>
    static Sx pressure(const double (&L)[corners], const Sx* x) {
        const Sx* at = x + first_pressure;
        return at[0] * L[0] + at[1] * L[1] + at[2] * L[2];
    }

    template <class R, class P>
    static void stress_of(const R (&H)[2][2], const P& pressure, double viscosity, R (&s)[2][2]) {
        for (int a = 0; a < 2; ++a)
            for (int k = 0; k < 2; ++k) s[a][k] = (H[a][k] + H[k][a]) * viscosity;
        for (int a = 0; a < 2; ++a) s[a][a] -= pressure;
    }
};

// With rho (w . grad) u besides, where w is a given velocity.
struct OseenElement : StokesElement {
    static constexpr bool symmetric = false;
    static constexpr int coefficient_count = 2;

    // Density [kg/m^3] besides.
    static std::vector<std::string> parameters() { return {"viscosity", "bx", "by", "density"}; }
    // Velocity that carries the fluid [m/s].
    static std::vector<std::string> coefficients() { return {"wx", "wy"}; }

    template <class SX, class Sx, class R>
    [[gnu::flatten]] static void residual(const SX* X, const Sx* x, const SX* w, const double* p, R* r) {
        integrate(X, x, p, r, [w, p](const auto& N, const auto& H, auto& force) {
            for (int k = 0; k < 2; ++k) {
                SX speed = w[k] * N[0];
                for (int i = 1; i < nodes; ++i) speed += w[2 * i + k] * N[i];
                for (int a = 0; a < 2; ++a) force[a] += H[a][k] * (speed * p[3]);
            }
        });
    }

    static void stress(const double* X, const double* x, const double*, const double* p, const double* xi, double* s) {
        StokesElement::stress(X, x, p, xi, s);
    }
};

}  // namespace

std::vector<Element> stokes_elements() {
    return {
        element_of<StokesElement>("stokes", "tri6"),
        element_of<OseenElement>("oseen", "tri6"),
    };
}

}  // namespace restshape
