// Heat in a fluid whose velocity is given, on linear triangles.
//
// Source: Brooks and Hughes, Comput. Methods Appl. Mech. Engng 32 (1982) 199; docs/theory/flow.md.
#include "flow/advected_heat.hpp"

#include <string>
#include <vector>

#include "fem/element.hpp"

namespace restshape {

namespace {

template <bool in_time>
struct AdvectedHeatElement {
    using Shape = Solid<Linear<2>, TriRule3>;
    static constexpr int nodes = 3, dim = 2, fields = 1;
    static constexpr bool symmetric = false, has_tangent = true;
    static constexpr int stress_components = 0;
    static constexpr int coefficient_count = in_time ? 3 : 2;

    // Of a `Carrier`.
    static std::vector<std::string> parameters() {
        std::vector<std::string> names{"capacity", "conductivity", "factor", "source"};
        if (in_time) names.insert(names.end(), {"rate", "stepping"});
        return names;
    }
    // Velocity relative to the mesh [m/s]; what older temperatures add to the rate [K/s].
    static std::vector<std::string> coefficients() {
        if (in_time) return {"wx", "wy", "past"};
        return {"wx", "wy"};
    }

    template <class SX, class Sx, class R>
    [[gnu::flatten]] static void residual(const SX* X, const Sx* x, const SX* w, const double* p, R* r) {
        SX G[nodes][2], a[nodes][2], past[nodes];
        Sx T[nodes];
        const SX third = Shape::gradients(0, X, G);
        Carrier<double> carrier{p[0], p[1], p[2], p[3]};
        if constexpr (in_time) {
            carrier.rate = p[4];
            carrier.stepping = p[5];
        }
        for (int i = 0; i < nodes; ++i) {
            for (int k = 0; k < 2; ++k) a[i][k] = w[coefficient_count * i + k];
            T[i] = x[i];
            past[i] = in_time ? w[coefficient_count * i + coefficient_count - 1] : SX(0.0);
        }
        const AdvectedHeat<in_time, SX, SX, R, double> heat(G, third, a, T, past, carrier);
        for (int i = 0; i < nodes; ++i) r[i] = heat.residual(i);
    }
};

}  // namespace

std::vector<Element> advected_heat_elements() {
    return {
        element_of<AdvectedHeatElement<false>>("advected_heat", "tri3"),
        element_of<AdvectedHeatElement<true>>("unsteady_advected_heat", "tri3"),
    };
}

}  // namespace restshape
