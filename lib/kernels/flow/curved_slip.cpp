// A curved edge along which a fluid slips: the part of its friction that the Laplace form of viscosity leaves there.
//
// Without friction t . mu (grad u + grad u^T) n = 0, while without a condition t . mu (grad u) n = 0. The difference is
// mu (v . t) n . du/dt, integrated exactly: on a circle mu u_t / r, and 0 on a straight edge.
#include <string>
#include <vector>

#include "fem/element.hpp"
#include "fem/shapes.hpp"

namespace restshape {

namespace {

template <int Fields>
struct CurvedSlipElement {
    static constexpr int nodes = 2, dim = 2, fields = Fields;
    static constexpr bool symmetric = false, has_tangent = true;
    static constexpr int stress_components = 0;

    // Viscosity [Pa s]; the fluid is on the left of the side.
    static std::vector<std::string> parameters() { return {"viscosity"}; }

    template <class SX, class Sx, class R>
    static void residual(const SX* X, const Sx* x, const double* p, R* r) {
        const SX along[2] = {X[2] - X[0], X[3] - X[1]};
        const R across = (x[fields] - x[0]) * along[1] - (x[fields + 1] - x[1]) * along[0];
        const R friction = across * (0.5 * p[0]) / (along[0] * along[0] + along[1] * along[1]);
        for (int i = 0; i < nodes; ++i) {
            for (int a = 0; a < 2; ++a) r[i * fields + a] = friction * along[a];
            for (int k = 2; k < fields; ++k) r[i * fields + k] = R(0.0);
        }
    }
};

}  // namespace

std::vector<Element> curved_slip_elements() {
    return {
        element_of<CurvedSlipElement<3>>("curved_slip", "edge2"),
        element_of<CurvedSlipElement<4>>("curved_slip_with_heat", "edge2"),
    };
}

}  // namespace restshape
