// Incompressible flow on linear triangles: velocity and pressure on the same nodes, stabilised by SUPG, PSPG and LSIC.
//
// rho (du/dt + a . grad u) = -grad p + mu laplace u + b and div u = 0, where a is the velocity less that of the mesh.
// Without a condition on an edge mu du/dn - p n = 0 there. The residual of what is strongly required has all of its
// terms, so that stabilisation takes nothing from an exact solution. Steady flow has no step in tau.
//
// Source: Tezduyar, Mittal, Ray and Shih, Comput. Methods Appl. Mech. Engng 95 (1992) 221, tau as their (3.11);
// Tezduyar and Osawa, Comput. Methods Appl. Mech. Engng 190 (2000) 411, tau of LSIC; backward differences: Hairer,
// Norsett and Wanner, Solving Ordinary Differential Equations I (1993), section III.1.
#include <algorithm>
#include <string>
#include <vector>

#include "fem/element.hpp"
#include "fem/shapes.hpp"
#include "flow/advected_heat.hpp"

namespace restshape {

namespace {

// What advects the velocity: nothing, its own velocity, that less the mesh's, a velocity that is given, or nothing but
// the mesh's motion, while heat is advected by both.
enum class Advection { none, own, relative, given, mesh };

// The temperature that lifts the fluid: there is none, it is given at the nodes, or it is an unknown.
enum class Warmth { none, given, own };

template <Advection advection, bool in_time, Warmth warmth = Warmth::none>
struct FlowElement {
    using Shape = Solid<Linear<2>, TriRule3>;
    static constexpr bool heated = warmth == Warmth::own, lifted = warmth != Warmth::none;
    static constexpr int nodes = 3, dim = 2, fields = heated ? 4 : 3;
    static constexpr bool symmetric = false, has_tangent = true;
    static constexpr int stress_components = 0;
    static constexpr bool given = advection != Advection::none && advection != Advection::own;
    static constexpr int given_columns = given ? 2 : 0;  // columns of coefficients before the past ones
    static constexpr int coefficient_count =
        given_columns + (in_time ? 2 : 0) + (warmth == Warmth::given || (heated && in_time) ? 1 : 0);
    static constexpr int warm_parameters = in_time ? 7 : 5;  // the first of what warmth needs

    // Density [kg/m^3], viscosity [Pa s], body force [N/m^3], factor of continuity [kg/(m^2 s)]; in time the factor of
    // the velocity in its rate and 2 over the step, both [1/s]; force by temperature [N/(m^3 K)] and the temperature
    // [K] without any; what a `Carrier` has.
    static std::vector<std::string> parameters() {
        std::vector<std::string> names{"density", "viscosity", "bx", "by", "continuity"};
        if (in_time) names.insert(names.end(), {"rate", "stepping"});
        if (lifted) names.insert(names.end(), {"lift_x", "lift_y", "reference"});
        if (heated) names.insert(names.end(), {"capacity", "conductivity", "heat", "source"});
        return names;
    }
    // Velocity of the mesh, or the one that advects [m/s]; what older velocities add to the rate [m/s^2]; the
    // temperature [K] that is given, or what older ones add to its rate [K/s].
    static std::vector<std::string> coefficients() {
        std::vector<std::string> names;
        if (given) names = {"wx", "wy"};
        if (in_time) names.insert(names.end(), {"past_x", "past_y"});
        if (warmth == Warmth::given) names.push_back("temperature");
        if (heated && in_time) names.push_back("past_temperature");
        return names;
    }

    template <class SX, class Sx, class R>
    [[gnu::flatten]] static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        integrate<SX, Sx, R>(X, x, static_cast<const SX*>(nullptr), p, r);
    }
    template <class SX, class Sx, class R>
    [[gnu::flatten]] static void residual(const SX* X, const Sx* x, const SX* w, const double* p, R* r) {
        integrate<SX, Sx, R>(X, x, w, p, r);
    }

 private:
    // What advects is of the unknowns' type where it is their own, else of the coefficients'.
    template <class SX, class Sx>
    using Advecting =
        std::conditional_t<advection == Advection::own || advection == Advection::relative, Common<SX, Sx>, SX>;
    // The unknown k of node i.
    static constexpr int at(int i, int k) { return fields * i + k; }

    template <class SX, class Sx, class R>
    [[gnu::always_inline]] static void integrate(const SX* X, const Sx* x, [[maybe_unused]] const SX* w,
                                                 const double* p, R* r) {
        using A = Advecting<SX, Sx>;
        const double density = p[0];
        SX G[nodes][2];
        const SX third = Shape::gradients(0, X, G);  // of the area
        R H[2][2], slope[2];                         // gradients of velocity and of pressure
        for (int k = 0; k < 2; ++k) {
            for (int a = 0; a < 2; ++a) H[a][k] = x[at(0, a)] * G[0][k] + x[at(1, a)] * G[1][k] + x[at(2, a)] * G[2][k];
            slope[k] = x[at(0, 2)] * G[0][k] + x[at(1, 2)] * G[1][k] + x[at(2, 2)] * G[2][k];
        }
        const R divergence = H[0][0] + H[1][1];
        A speed[nodes][2], mean[2];
        advect(x, w, speed);
        for (int a = 0; a < 2; ++a) mean[a] = (speed[0][a] + speed[1][a] + speed[2][a]) * (1.0 / 3.0);
        const A square = mean[0] * mean[0] + mean[1] * mean[1];
        const SX hh = third * (3.0 * size_by_area);
        const A tau = stabilising_time<in_time, SX, A>(square, hh, 4.0 * p[1] / p[0], p[in_time ? 6 : 0]);
        const A incompressible = squeezing<SX, A>(square, hh, p);

        // Sums over the points of what is the same for all test functions, and of what their values weigh.
        R strong[2] = {R(0.0), R(0.0)}, along[2][2] = {{R(0.0), R(0.0)}, {R(0.0), R(0.0)}};
        for (int k = 0; k < dim + 1; ++k)
            for (int i = 0; i < nodes; ++i) r[at(i, k)] = R(0.0);
        for (int q = 0; q < Shape::points; ++q) {
            const auto& N = Shape::table.value[q];
            A a[2];
            for (int k = 0; k < 2; ++k) a[k] = speed[0][k] * N[0] + speed[1][k] * N[1] + speed[2][k] * N[2];
            for (int k = 0; k < 2; ++k) {
                R inertia = R(-p[2 + k]);
                if constexpr (lifted) inertia -= warmer(N, x, w, p) * p[warm_parameters + k];
                if constexpr (advection != Advection::none) inertia += (H[k][0] * a[0] + H[k][1] * a[1]) * density;
                if constexpr (in_time) inertia += rate(N, x, w, p, k) * density;
                for (int i = 0; i < nodes; ++i) r[at(i, k)] += inertia * N[i] * third;
                const R whole = inertia + slope[k];
                strong[k] += whole;
                if constexpr (advection != Advection::none)
                    for (int m = 0; m < 2; ++m) along[k][m] += whole * a[m];
            }
        }
        const SX area = third * 3.0;
        const R pressure =
            (x[at(0, 2)] + x[at(1, 2)] + x[at(2, 2)]) * (1.0 / 3.0) - divergence * incompressible * density;
        for (int i = 0; i < nodes; ++i) {
            for (int k = 0; k < 2; ++k) {
                r[at(i, k)] += ((H[k][0] * G[i][0] + H[k][1] * G[i][1]) * p[1] - pressure * G[i][k]) * area;
                if constexpr (advection != Advection::none)
                    r[at(i, k)] += (along[k][0] * G[i][0] + along[k][1] * G[i][1]) * tau * third;
            }
            const R smoothing = (strong[0] * G[i][0] + strong[1] * G[i][1]) * tau * (1.0 / density);
            r[at(i, 2)] = (divergence + smoothing) * third * p[4];
        }
        if constexpr (heated) heat<SX, Sx, R>(G, third, x, w, p, r);
    }

    // The residual of heat, which velocities carry though the fluid have no inertia.
    template <class SX, class Sx, class R>
    [[gnu::always_inline]] static void heat(const SX (&G)[nodes][2], const SX& third, const Sx* x,
                                            [[maybe_unused]] const SX* w, const double* p, R* r) {
        using A = std::conditional_t<advection == Advection::given, SX, Common<SX, Sx>>;
        const double* own = p + warm_parameters + 3;
        Carrier carrier{own[0], own[1], own[2], own[3]};
        if constexpr (in_time) {
            carrier.rate = p[5];
            carrier.stepping = p[6];
        }
        A carries[nodes][2];
        Sx T[nodes];
        SX past[nodes];
        R out[nodes];
        for (int i = 0; i < nodes; ++i) {
            T[i] = x[at(i, 3)];
            past[i] = in_time ? w[coefficient_count * i + coefficient_count - 1] : SX(0.0);
            for (int k = 0; k < 2; ++k) {
                if constexpr (advection == Advection::given)
                    carries[i][k] = w[coefficient_count * i + k];
                else if constexpr (given)
                    carries[i][k] = x[at(i, k)] - w[coefficient_count * i + k];
                else
                    carries[i][k] = A(x[at(i, k)]);
            }
        }
        advected_heat<in_time, SX, A, Sx, R>(G, third, carries, T, past, carrier, out);
        for (int i = 0; i < nodes; ++i) r[at(i, 3)] = out[i];
    }

    // The temperature less the one without any force, where shapes have the values N.
    template <class SX, class Sx>
    static auto warmer(const double (&N)[nodes], const Sx* x, [[maybe_unused]] const SX* w, const double* p) {
        if constexpr (heated) {
            Sx sum = x[at(0, 3)] * N[0] + x[at(1, 3)] * N[1] + x[at(2, 3)] * N[2];
            return Sx(sum - p[warm_parameters + 2]);
        } else {
            SX sum(-p[warm_parameters + 2]);
            for (int i = 0; i < nodes; ++i) sum += w[coefficient_count * i + coefficient_count - 1] * N[i];
            return sum;
        }
    }

    // Values at the nodes of what advects.
    template <class SX, class Sx, class A>
    static void advect([[maybe_unused]] const Sx* x, [[maybe_unused]] const SX* w, A (&speed)[nodes][2]) {
        for (int i = 0; i < nodes; ++i)
            for (int a = 0; a < 2; ++a) {
                if constexpr (advection == Advection::own) speed[i][a] = A(x[at(i, a)]);
                if constexpr (advection == Advection::relative)
                    speed[i][a] = x[at(i, a)] - w[coefficient_count * i + a];
                if constexpr (advection == Advection::given) speed[i][a] = w[coefficient_count * i + a];
                if constexpr (advection == Advection::mesh) speed[i][a] = -w[coefficient_count * i + a];
                if constexpr (advection == Advection::none) speed[i][a] = A(0.0);
            }
    }

    // Rate of a component of the velocity where shapes have the values N.
    template <class SX, class Sx>
    static Common<SX, Sx> rate(const double (&N)[nodes], const Sx* x, const SX* w, const double* p, int k) {
        Common<SX, Sx> sum(0.0);
        for (int i = 0; i < nodes; ++i)
            sum += (x[at(i, k)] * p[5] + w[coefficient_count * i + given_columns + k]) * N[i];
        return sum;
    }

    // tau of LSIC [m^2/s]: |a| h / 2, times Re_h / 3 where that is below 1, which makes it smooth at a = 0.
    template <class SX, class A>
    static A squeezing(const A& square, const SX& hh, const double* p) {
        using std::sqrt;
        const A product = square * hh;
        const double viscosity = p[1] / p[0];
        if (value_of(product) < 36.0 * viscosity * viscosity) return product * (1.0 / (12.0 * viscosity));
        return sqrt(product) * 0.5;
    }
};

}  // namespace

std::vector<Element> stabilised_flow_elements() {
    return {
        element_of<FlowElement<Advection::none, false>>("slow_flow", "tri3"),
        element_of<FlowElement<Advection::own, false>>("flow", "tri3"),
        element_of<FlowElement<Advection::given, false>>("oseen_flow", "tri3"),
        element_of<FlowElement<Advection::none, true>>("unsteady_slow_flow", "tri3"),
        element_of<FlowElement<Advection::own, true>>("unsteady_flow", "tri3"),
        element_of<FlowElement<Advection::relative, true>>("unsteady_flow_on_moving_mesh", "tri3"),
        element_of<FlowElement<Advection::given, true>>("unsteady_oseen_flow", "tri3"),
        element_of<FlowElement<Advection::none, false, Warmth::own>>("heated_slow_flow", "tri3"),
        element_of<FlowElement<Advection::own, false, Warmth::own>>("heated_flow", "tri3"),
        element_of<FlowElement<Advection::given, false, Warmth::own>>("heated_oseen_flow", "tri3"),
        element_of<FlowElement<Advection::none, true, Warmth::own>>("unsteady_heated_slow_flow", "tri3"),
        element_of<FlowElement<Advection::own, true, Warmth::own>>("unsteady_heated_flow", "tri3"),
        element_of<FlowElement<Advection::relative, true, Warmth::own>>("unsteady_heated_flow_on_moving_mesh", "tri3"),
        element_of<FlowElement<Advection::mesh, true, Warmth::own>>("unsteady_heated_slow_flow_on_moving_mesh", "tri3"),
        element_of<FlowElement<Advection::given, true, Warmth::own>>("unsteady_heated_oseen_flow", "tri3"),
        element_of<FlowElement<Advection::none, false, Warmth::given>>("lifted_slow_flow", "tri3"),
        element_of<FlowElement<Advection::own, false, Warmth::given>>("lifted_flow", "tri3"),
        element_of<FlowElement<Advection::given, false, Warmth::given>>("lifted_oseen_flow", "tri3"),
        element_of<FlowElement<Advection::none, true, Warmth::given>>("unsteady_lifted_slow_flow", "tri3"),
        element_of<FlowElement<Advection::own, true, Warmth::given>>("unsteady_lifted_flow", "tri3"),
        element_of<FlowElement<Advection::relative, true, Warmth::given>>("unsteady_lifted_flow_on_moving_mesh",
                                                                          "tri3"),
        element_of<FlowElement<Advection::given, true, Warmth::given>>("unsteady_lifted_oseen_flow", "tri3"),
    };
}

}  // namespace restshape
