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
        Flow<SX, Sx, R, double>(X, x, static_cast<const SX*>(nullptr), p).residual(r);
    }
    template <class SX, class Sx, class R>
    [[gnu::flatten]] static void residual(const SX* X, const Sx* x, const SX* w, const double* p, R* r) {
        Flow<SX, Sx, R, double>(X, x, w, p).residual(r);
    }

    // By the rules of products and of chains: dual numbers of as many directions as there are unknowns take ten times
    // as long, and are what tests compare with.
    [[gnu::flatten]] static void tangent(const double* X, const double* x, const double* p, double* r, double* K) {
        both<Dual<unknowns>::lanes>(X, x, static_cast<const double*>(nullptr), p, r, K);
    }
    [[gnu::flatten]] static void tangent(const double* X, const double* x, const double* w, const double* p, double* r,
                                         double* K) {
        both<Dual<unknowns>::lanes>(X, x, w, p, r, K);
    }

    static constexpr bool packed = true;

    [[gnu::flatten]] static void packed_residual(const Pack* X, const Pack* x, const Pack* w, const Pack* p, Pack* r) {
        Flow<Pack, Pack, Pack, Pack>(X, x, w, p).residual(r);
    }
    [[gnu::flatten]] static void packed_tangent(const Pack* X, const Pack* x, const Pack* w, const Pack* p, Pack* r,
                                                Pack* K) {
        both<unknowns>(X, x, w, p, r, K);
    }

 private:
    static constexpr int unknowns = nodes * fields;
    static constexpr bool advects = advection != Advection::none;
    static constexpr bool by_itself = advection == Advection::own || advection == Advection::relative;

    // The unknown k of node i, and a coefficient of it.
    static constexpr int at(int i, int k) { return fields * i + k; }
    static constexpr int column(int i, int k) { return coefficient_count * i + k; }
    static constexpr int last_column(int i) { return column(i, coefficient_count - 1); }

    // What the unknowns x make of the flow in a cell.
    template <class SX, class Sx, class R, class P>
    struct Flow {
        // What advects is of the unknowns' type where it is their own, else of the coefficients'.
        using A = std::conditional_t<by_itself, Common<SX, Sx>, SX>;

        const Sx* x;
        const SX* w;
        const P* p;
        SX G[nodes][2], third;
        Advecting<advects, in_time, SX, A, P> by;
        R H[2][2], slope[2], divergence;  // gradients of velocity and of pressure
        R inertia[nodes][2], sum[2];      // rho times the acceleration less the body force, and its sum
        R strong[nodes][2], all[2];       // with the gradient of the pressure
        R along[2][2];                    // the integral of its products with what advects
        A squeezing;                      // tau of LSIC [m^2/s]

        [[gnu::always_inline]] Flow(const SX* X, const Sx* unknown, const SX* coefficient, const P* parameter)
            : x(unknown),
              w(coefficient),
              p(parameter),
              third(Shape::gradients(0, X, G)),
              by(G, third, p[in_time ? 5 : 0], p[in_time ? 6 : 0]) {
            for (int k = 0; k < 2; ++k) {
                for (int a = 0; a < 2; ++a)
                    H[a][k] = x[at(0, a)] * G[0][k] + x[at(1, a)] * G[1][k] + x[at(2, a)] * G[2][k];
                slope[k] = x[at(0, 2)] * G[0][k] + x[at(1, 2)] * G[1][k] + x[at(2, 2)] * G[2][k];
            }
            divergence = H[0][0] + H[1][1];
            for (int i = 0; i < nodes; ++i)
                for (int k = 0; k < 2; ++k) set_speed(i, k);
            by.set_speed(4.0 * viscosity());
            if constexpr (advects) squeezing = squeezing_time();
            for (int k = 0; k < 2; ++k) set_gains(k);
        }

        // The residual, node after node.
        [[gnu::always_inline]] void residual(R* r) const {
            R pressure = (x[at(0, 2)] + x[at(1, 2)] + x[at(2, 2)]) * (1.0 / 3.0);
            if constexpr (advects) pressure -= divergence * squeezing * p[0];
            for (int i = 0; i < nodes; ++i) {
                for (int k = 0; k < 2; ++k) {
                    R force = ((H[k][0] * G[i][0] + H[k][1] * G[i][1]) * p[1] - pressure * G[i][k]) * by.area;
                    force += (inertia[i][k] + sum[k]) * by.part;
                    if constexpr (advects) force += (along[k][0] * G[i][0] + along[k][1] * G[i][1]) * by.tau;
                    r[at(i, k)] = force;
                }
                const R smoothing = (all[0] * G[i][0] + all[1] * G[i][1]) * by.tau * (1.0 / p[0]);
                r[at(i, 2)] = (divergence + smoothing) * third * p[4];
            }
            if constexpr (heated) {
                const auto warm = heat();
                for (int i = 0; i < nodes; ++i) r[at(i, 3)] = warm.residual(i);
            }
        }

        P viscosity() const { return p[1] / p[0]; }

        // The residual of heat, which velocities advect though the fluid have no inertia.
        [[gnu::always_inline]] auto heat() const {
            using Speed = std::conditional_t<advection == Advection::given, SX, Common<SX, Sx>>;
            const P* own = p + warm_parameters + 3;
            Carrier<P> carrier{own[0], own[1], own[2], own[3]};
            if constexpr (in_time) {
                carrier.rate = p[5];
                carrier.stepping = p[6];
            }
            Speed velocity[nodes][2];
            Sx temperature[nodes];
            SX past[nodes];
            for (int i = 0; i < nodes; ++i) {
                temperature[i] = x[at(i, 3)];
                if constexpr (in_time) past[i] = w[last_column(i)];
                for (int k = 0; k < 2; ++k) {
                    if constexpr (advection == Advection::given)
                        velocity[i][k] = w[column(i, k)];
                    else if constexpr (given)
                        velocity[i][k] = x[at(i, k)] - w[column(i, k)];
                    else
                        velocity[i][k] = Speed(x[at(i, k)]);
                }
            }
            return AdvectedHeat<in_time, SX, Speed, R, P>(G, third, velocity, temperature, past, carrier);
        }

        // tau of LSIC is |a| h / 2, times Re_h / 3 where that is below 1, which makes it smooth at a = 0.
        auto slow() const { return value_of(by.square) * value_of(by.hh) < 36.0 * viscosity() * viscosity(); }
        A squeezing_time() const {
            const A product = by.square * by.hh;
            return slow() ? A(product * (1.0 / (12.0 * viscosity()))) : A(square_root(product) * 0.5);
        }
        // Its derivative by the square of the mean of what advects.
        A squeezing_slope() const {
            return slow() ? A(by.hh * (1.0 / (12.0 * viscosity()))) : A(squeezing * 0.5 / by.square);
        }

     private:
        void set_speed([[maybe_unused]] int i, [[maybe_unused]] int k) {
            if constexpr (advection == Advection::own) by.speed[i][k] = A(x[at(i, k)]);
            if constexpr (advection == Advection::relative) by.speed[i][k] = x[at(i, k)] - w[column(i, k)];
            if constexpr (advection == Advection::given) by.speed[i][k] = w[column(i, k)];
            if constexpr (advection == Advection::mesh) by.speed[i][k] = -w[column(i, k)];
        }

        [[gnu::always_inline]] void set_gains(int k) {
            for (int i = 0; i < nodes; ++i) {
                R& gained = inertia[i][k];
                gained = R(-p[2 + k]);
                if constexpr (heated)
                    gained -= (x[at(i, 3)] - p[warm_parameters + 2]) * p[warm_parameters + k];
                else if constexpr (lifted)
                    gained -= (w[last_column(i)] - p[warm_parameters + 2]) * p[warm_parameters + k];
                if constexpr (advects) gained += (H[k][0] * by.speed[i][0] + H[k][1] * by.speed[i][1]) * p[0];
                if constexpr (in_time) gained += (x[at(i, k)] * p[5] + w[column(i, given_columns + k)]) * p[0];
                strong[i][k] = gained + slope[k];
            }
            sum[k] = inertia[0][k] + inertia[1][k] + inertia[2][k];
            all[k] = strong[0][k] + strong[1][k] + strong[2][k];
            if constexpr (advects)
                for (int m = 0; m < 2; ++m) along[k][m] = by.along(strong[0][k], strong[1][k], strong[2][k], all[k], m);
        }
    };

    // The residual, and its derivatives by the unknowns: K, whose rows are `stride` apart.
    template <int stride, class T>
    [[gnu::always_inline]] static void both(const T* X, const T* x, const T* w, const T* p, T* r, T* K) {
        const Flow<T, T, T, T> flow(X, x, w, p);
        flow.residual(r);
        const Changes<T> changes(flow);
        for (int i = 0; i < nodes; ++i)
            for (int j = 0; j < nodes; ++j) {
                differentiate_momentum<stride>(flow, changes, i, j, K + at(i, 0) * stride + at(j, 0));
                differentiate_continuity(flow, changes, i, j, K + at(i, 2) * stride + at(j, 0));
            }
        if constexpr (heated) differentiate_heat<stride>(flow.heat(), K);
    }

    // How the flow in a cell changes with the unknowns: with a velocity, its own transport apart, at that node alone by
    // rho H, of what advects itself.
    template <class T>
    struct Changes {
        Transport<advects, by_itself, in_time, T> by;
        T by_squeezing[2];  // of tau of LSIC by a component of any velocity

        [[gnu::always_inline]] explicit Changes(const Flow<T, T, T, T>& flow)
            : by(flow.by, flow.p[0], 4.0 * flow.viscosity()) {
            if constexpr (by_itself)
                for (int c = 0; c < 2; ++c) by_squeezing[c] = flow.squeezing_slope() * flow.by.mean[c] * (2.0 / 3.0);
        }
    };

    // Of the forces on node i by the unknowns of node j.
    template <int stride, class T>
    [[gnu::always_inline]] static void differentiate_momentum(const Flow<T, T, T, T>& flow, const Changes<T>& changes,
                                                              int i, int j, T* K) {
        const auto& by = flow.by;
        const T *p = flow.p, *G = flow.G[i], *other = flow.G[j];
        const T alike = changes.by.gain(by, p[1], i, j), share = changes.by.share(by, i, j);
        for (int k = 0; k < 2; ++k) {
            for (int c = 0; c < 2; ++c) {
                T entry = k == c ? alike : T{};
                if constexpr (advects) entry += p[0] * by.area * flow.squeezing * G[k] * other[c];
                if constexpr (by_itself) {
                    entry += flow.H[k][c] * p[0] * share;
                    entry += by.tau * by.part * (flow.strong[j][k] + flow.all[k]) * G[c];
                    entry += p[0] * by.area * flow.divergence * changes.by_squeezing[c] * G[k];
                    entry += (flow.along[k][0] * G[0] + flow.along[k][1] * G[1]) * changes.by.by_tau[c];
                }
                K[k * stride + c] = entry;
            }
            T entry = G[k] * by.area * (-1.0 / 3.0);
            if constexpr (advects) entry += by.tau * by.area * (by.mean[0] * G[0] + by.mean[1] * G[1]) * other[k];
            K[k * stride + 2] = entry;
            if constexpr (heated) K[k * stride + 3] = -p[warm_parameters + k] * share;
        }
    }

    // Of what flows out about node i.
    template <class T>
    [[gnu::always_inline]] static void differentiate_continuity(const Flow<T, T, T, T>& flow, const Changes<T>& changes,
                                                                int i, int j, T* K) {
        const T *p = flow.p, *G = flow.G[i], *other = flow.G[j];
        const T factor = flow.third * p[4], smoothing = flow.by.tau / p[0];
        for (int c = 0; c < 2; ++c) {
            T entry = other[c] + smoothing * changes.by.total[j] * G[c];
            if constexpr (by_itself) {
                entry += flow.by.tau * (flow.H[0][c] * G[0] + flow.H[1][c] * G[1]);
                entry += changes.by.by_tau[c] / p[0] * (flow.all[0] * G[0] + flow.all[1] * G[1]);
            }
            K[c] = factor * entry;
        }
        K[2] = factor * 3.0 * smoothing * (G[0] * other[0] + G[1] * other[1]);
        if constexpr (heated) K[3] = -factor * smoothing * (p[warm_parameters] * G[0] + p[warm_parameters + 1] * G[1]);
    }

    // Of the heat of the nodes.
    template <int stride, class Warm, class T>
    [[gnu::always_inline]] static void differentiate_heat(const Warm& warm, T* K) {
        constexpr bool by_velocity = advection != Advection::given;
        const auto& by = warm.by;
        const Transport<true, by_velocity, in_time, T> changes(by, warm.p.capacity, warm.p.spreading());
        for (int i = 0; i < nodes; ++i)
            for (int j = 0; j < nodes; ++j) {
                const T* G = by.G[i];
                T* row = K + at(i, 3) * stride + at(j, 0);
                for (int c = 0; c < 2; ++c) {
                    T entry = T{};
                    if constexpr (by_velocity) {
                        entry += warm.p.capacity * warm.slope[c] * changes.share(by, i, j);
                        entry += by.tau * by.part * (warm.gained[j] + warm.sum) * G[c];
                        entry += (warm.along[0] * G[0] + warm.along[1] * G[1]) * changes.by_tau[c];
                    }
                    row[c] = warm.p.factor * entry;
                }
                row[2] = T{};
                row[3] = warm.p.factor * changes.gain(by, warm.p.conductivity, i, j);
            }
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
