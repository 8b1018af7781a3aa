// Stresses of plane bodies: of many triangles at once, and how the thickness changes where they stretch.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "elasticity/quadratic_stress.hpp"
#include "elasticity/triangle_stress.hpp"
#include "fem/bounds.hpp"
#include "fem/calls.hpp"
#include "fem/element.hpp"

namespace py = pybind11;
using Reals = py::array_t<double, py::array::c_style>;
using Ints = py::array_t<int, py::array::c_style>;

namespace {

// Derivatives of a triangle's basis functions by its two coordinates.
struct Slopes {
    double b[6] = {-1, 1, 0}, c[6] = {-1, 0, 1};
};

Slopes slopes(int nodes, double b, double c) {
    if (nodes == 3) return {};
    const double a = 1 - b - c;
    return {{1 - 4 * a, 4 * b - 1, 0, 4 * (a - b), 4 * c, -4 * c},
            {1 - 4 * a, 0, 4 * c - 1, -4 * b, 4 * b, 4 * (a - c)}};
}

// The products u.u, v.v and u.v of the tangents u, v along both coordinates.
std::array<double, 3> metric(const double (*P)[2], int nodes, const Slopes& d) {
    double u[2] = {}, v[2] = {};
    for (int i = 0; i < nodes; ++i)
        for (int a = 0; a < 2; ++a) u[a] += d.b[i] * P[i][a], v[a] += d.c[i] * P[i][a];
    return {u[0] * u[0] + u[1] * u[1], v[0] * v[0] + v[1] * v[1], u[0] * v[0] + u[1] * v[1]};
}

// The trace of F^T F follows from the metrics of the tangents before and after.
double stretch(const double (*P)[2], const double (*now)[2], int nodes, const Slopes& d, double ratio) {
    const auto [a, b, c] = metric(P, nodes, d);
    const auto [now_a, now_b, now_c] = metric(now, nodes, d);
    const double trace = (now_a * b + now_b * a - 2 * now_c * c) / (a * b - c * c);
    const double square = 1 - ratio * (trace - 2);
    return square > 0 ? std::sqrt(square) : std::numeric_limits<double>::quiet_NaN();
}

py::array_t<double> thickness_stretch(const Reals& X, const Reals& u, const Ints& cells, const Reals& ratio,
                                      const Reals& points) {
    const int nodes = static_cast<int>(cells.shape(1));
    const py::ssize_t ne = cells.shape(0), m = points.shape(0);
    if ((nodes != 3 && nodes != 6) || X.size() != u.size() || X.shape(1) != 2 || ratio.size() != ne)
        throw std::invalid_argument("X and u must be (n, 2), cells (ne, 3) or (ne, 6), ratio (ne,)");
    std::vector<Slopes> at;
    for (py::ssize_t k = 0; k < m; ++k) at.push_back(slopes(nodes, points.at(k, 0), points.at(k, 1)));
    py::array_t<double> out({ne, m});
    double* found = out.mutable_data();
    for (py::ssize_t e = 0; e < ne; ++e) {
        double P[6][2], now[6][2];
        for (int i = 0; i < nodes; ++i)
            for (int a = 0; a < 2; ++a) {
                const py::ssize_t k = 2 * py::ssize_t(cells.data()[nodes * e + i]) + a;
                P[i][a] = X.data()[k];
                now[i][a] = P[i][a] + u.data()[k];
            }
        for (const Slopes& d : at) *found++ = stretch(P, now, nodes, d, ratio.data()[e]);
    }
    return out;
}

// Checks arguments of triangles with so many nodes, counts their stresses under the element's name, and returns how far
// apart rows of parameters are.
int checked_triangles(const Reals& X, const Reals& x, const Ints& cells, const Reals& params, int nodes) {
    const py::ssize_t n = X.ndim() == 2 && X.shape(1) == 2 ? X.shape(0) : 0, ne = cells.shape(0);
    if (x.size() != 2 * n || cells.ndim() != 2 || cells.shape(1) != nodes)
        throw std::invalid_argument("X and x must be (n, 2), cells (ne, " + std::to_string(nodes) + ")");
    const bool each = params.ndim() == 2 && params.shape(0) == ne && params.shape(1) == 5;
    if (!each && (params.ndim() != 1 || params.size() != 5))
        throw std::invalid_argument("params must be (5,) or (ne, 5)");
    if (!restshape::all_within(cells.data(), cells.size(), n))
        throw std::invalid_argument("cells name nodes that do not exist");
    restshape::element("linear_elastic_tri" + std::to_string(nodes)).tally->add(restshape::Purpose::stress, ne);
    return each ? 5 : 0;
}

std::pair<py::array_t<double>, py::array_t<double>> triangle_stress(const Reals& X, const Reals& x, const Ints& cells,
                                                                    const Reals& params, bool plane_stress) {
    const int stride = checked_triangles(X, x, cells, params, 3);
    const py::ssize_t ne = cells.shape(0);
    py::array_t<double> stress({ne, py::ssize_t(4)}), energy(ne);
    const restshape::Triangles on{X.data(), x.data(), cells.data(), params.data(), stride, plane_stress};
    restshape::triangle_stress(on, static_cast<int32_t>(ne), stress.mutable_data(), energy.mutable_data());
    return {stress, energy};
}

py::array_t<double> triangle_energies(const Reals& X, const Reals& x, const Ints& cells, const Reals& params) {
    const int stride = checked_triangles(X, x, cells, params, 3);
    const py::ssize_t ne = cells.shape(0);
    py::array_t<double> energy(ne);
    const restshape::Triangles on{X.data(), x.data(), cells.data(), params.data(), stride, false};
    restshape::triangle_stress(on, static_cast<int32_t>(ne), nullptr, energy.mutable_data());
    return energy;
}

py::array_t<double> quadratic_stress(const Reals& X, const Reals& x, const Ints& cells, const Reals& params,
                                     const Reals& points) {
    const int stride = checked_triangles(X, x, cells, params, 6);
    if (points.ndim() != 2 || points.shape(1) != 2) throw std::invalid_argument("points must be (m, 2)");
    const py::ssize_t ne = cells.shape(0), m = points.shape(0);
    py::array_t<double> stress({ne, m, py::ssize_t(4)});
    restshape::quadratic_stress(X.data(), x.data(), cells.data(), ne, params.data(), stride, points.data(), m,
                                stress.mutable_data());
    return stress;
}

py::array_t<double> von_mises(const Reals& stress) {
    if (stress.ndim() != 2 || stress.shape(1) != 4) throw std::invalid_argument("stress must be (n, 4)");
    const py::ssize_t n = stress.shape(0);
    py::array_t<double> out(n);
    const double* s = stress.data();
    double* found = out.mutable_data();
    for (py::ssize_t k = 0; k < n; ++k, s += 4) {
        const double state[] = {s[0], s[1], s[2], s[3]};
        found[k] = restshape::equivalent_stress(state);
    }
    return out;
}

}  // namespace

void bind_thickness(py::module_& m) {
    m.def("thickness_stretch", &thickness_stretch, py::arg("X").noconvert(), py::arg("u").noconvert(),
          py::arg("cells").noconvert(), py::arg("ratio"), py::arg("points"),
          "Thickness (ne, m) over that at rest at reference coordinates (m, 2) of triangles of either order, for the "
          "displacement u (n, 2), in plane stress under the law of St. Venant and Kirchhoff: sqrt(1 - 2 ratio tr E), "
          "ratio nu/(1 - nu) a cell; not a number where nothing is left.");
    m.def("triangle_stress", &triangle_stress, py::arg("X").noconvert(), py::arg("x").noconvert(),
          py::arg("cells").noconvert(), py::arg("params").noconvert(), py::arg("plane_stress"),
          "Stresses (ne, 4), xx yy xy zz [Pa], and strain energies (ne,) [J] of triangles of first order at the "
          "displacement x (n, 2), as `linear_elastic_tri3` has them with params (5,) or (ne, 5); in plane stress zz is "
          "0.");
    m.def("triangle_energies", &triangle_energies, py::arg("X").noconvert(), py::arg("x").noconvert(),
          py::arg("cells").noconvert(), py::arg("params").noconvert(), "The same strain energies (ne,) alone.");
    m.def("quadratic_stress", &quadratic_stress, py::arg("X").noconvert(), py::arg("x").noconvert(),
          py::arg("cells").noconvert(), py::arg("params").noconvert(), py::arg("points").noconvert(),
          "Stresses (ne, m, 4), xx yy xy zz [Pa], of triangles of second order at reference coordinates points (m, 2) "
          "and the displacement x (n, 2), as `linear_elastic_tri6` has them with params (5,) or (ne, 5).");
    m.def("von_mises", &von_mises, py::arg("stress").noconvert(),
          "Equivalent stresses (n,) of plane states (n, 4): xx yy xy zz.");
}
