// Bindings of contact: bodies in closed form, and what they do to points.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <optional>
#include <string>

#include "cloth/contact.hpp"

namespace py = pybind11;
using namespace pybind11::literals;
using restshape::Body;

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Output = py::array_t<double, py::array::c_style>;
using Vector = std::array<double, 3>;

constexpr int width = 12;  // numbers in the potential of a point

void require(bool holds, const std::string& message) {
    if (!holds) throw std::invalid_argument(message);
}

py::ssize_t points(const Doubles& x) {
    require(x.ndim() == 2 && x.shape(1) == 3, "x must have the shape (n, 3)");
    return x.shape(0);
}

void require_shape(const py::array& a, py::ssize_t rows, py::ssize_t columns, const char* name) {
    const bool fits = columns == 1 ? a.size() == rows : a.size() == rows * columns;
    require(fits && a.writeable(), std::string(name) + " has the wrong size or cannot be written");
}

void require_size(const Doubles& a, py::ssize_t size, const char* name) {
    require(a.size() == size, std::string(name) + " has the wrong size");
}

Vector vector(const Doubles& a, const char* name) {
    require(a.size() == 3, std::string(name) + " must have 3 numbers");
    return {a.data()[0], a.data()[1], a.data()[2]};
}

Body box(const Doubles& centre, const Doubles& half, const std::optional<Doubles>& rotation, double radius) {
    const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    require(!rotation || rotation->size() == 9, "rotation must have the shape (3, 3)");
    return Body::box(vector(centre, "centre").data(), vector(half, "half").data(),
                     rotation ? rotation->data() : identity, radius);
}

py::tuple distance(const Body& body, const Doubles& x) {
    const py::ssize_t n = points(x);
    py::array_t<double> value(n), gradient({n, py::ssize_t{3}}), hessian({n, py::ssize_t{3}, py::ssize_t{3}});
    for (py::ssize_t i = 0; i < n; ++i) {
        const restshape::Distance d = body.distance(x.data() + 3 * i);
        value.mutable_data()[i] = d.value;
        for (int a = 0; a < 3; ++a) {
            gradient.mutable_data()[3 * i + a] = d.gradient[a];
            for (int b = 0; b < 3; ++b) hessian.mutable_data()[9 * i + 3 * a + b] = d.hessian[restshape::voigt[a][b]];
        }
    }
    return py::make_tuple(value, gradient, hessian);
}

double add_contact(const Body& body, const Doubles& x, const Doubles& area, double stiffness, double thickness,
                   Output potential, bool curved) {
    const py::ssize_t n = points(x);
    require_size(area, n, "area");
    require_shape(potential, n, width, "potential");
    require(thickness > 0, "thickness must be positive");
    double energy = 0.0;
    for (py::ssize_t i = 0; i < n; ++i)
        energy += restshape::add_contact(body, x.data() + 3 * i, area.data()[i], stiffness, thickness, curved,
                                         potential.mutable_data() + width * i);
    return energy;
}

double update_friction(const Body& body, const Doubles& x, const Doubles& area, double stiffness, double thickness,
                       double coefficient, double slip, Output anchor, Output normal, Output limit) {
    const py::ssize_t n = points(x);
    require_size(area, n, "area");
    require_shape(anchor, n, 3, "anchor");
    require_shape(normal, n, 3, "normal");
    require_shape(limit, n, 1, "limit");
    double moved = 0.0;
    for (py::ssize_t i = 0; i < n; ++i) {
        const double* place = x.data() + 3 * i;
        double *own_anchor = anchor.mutable_data() + 3 * i, *own_normal = normal.mutable_data() + 3 * i;
        double& own_limit = limit.mutable_data()[i];
        const restshape::Distance d = body.distance(place, false);
        std::copy(d.gradient, d.gradient + 3, own_normal);
        // What has touched nothing sticks where it is now.
        if (own_limit == 0.0) std::copy(place, place + 3, own_anchor);
        own_limit = -coefficient * restshape::penalty(d.value, stiffness * area.data()[i], thickness).slope;
        moved = std::max(moved, restshape::update_friction_anchor(place, own_normal, own_limit, slip, own_anchor));
    }
    return moved;
}

double add_friction(const Doubles& x, const Doubles& anchor, const Doubles& normal, const Doubles& limit, double slip,
                    Output potential) {
    const py::ssize_t n = points(x);
    require_size(anchor, 3 * n, "anchor");
    require_size(normal, 3 * n, "normal");
    require_size(limit, n, "limit");
    require_shape(potential, n, width, "potential");
    require(slip > 0, "slip must be positive");
    double energy = 0.0;
    for (py::ssize_t i = 0; i < n; ++i)
        energy += restshape::add_friction(x.data() + 3 * i, anchor.data() + 3 * i, normal.data() + 3 * i,
                                          limit.data()[i], slip, potential.mutable_data() + width * i);
    return energy;
}

}  // namespace

void bind_contact(py::module_& m) {
    py::class_<Body>(m, "Body", "A body in closed form that points do not enter.")
        .def_static(
            "sphere",
            [](const Doubles& centre, double radius) { return Body::sphere(vector(centre, "centre").data(), radius); },
            "centre"_a, "radius"_a, "A ball.")
        .def_static(
            "plane",
            [](const Doubles& point, const Doubles& normal) {
                return Body::plane(vector(point, "point").data(), vector(normal, "normal").data());
            },
            "point"_a, "normal"_a, "All on the side that the normal points away from.")
        .def_static("box", &box, "centre"_a, "half"_a, "rotation"_a = py::none(), "radius"_a = 0.0,
                    "A box of these half sizes, its axes the rows of rotation, its edges rounded within them.")
        .def_static(
            "capsule",
            [](const Doubles& from, const Doubles& to, double radius) {
                return Body::capsule(vector(from, "start").data(), vector(to, "end").data(), radius);
            },
            "start"_a, "end"_a, "radius"_a, "All within the radius of a line.")
        .def_static(
            "cylinder",
            [](const Doubles& from, const Doubles& to, double radius, double rounded) {
                return Body::cylinder(vector(from, "start").data(), vector(to, "end").data(), radius, rounded);
            },
            "start"_a, "end"_a, "radius"_a, "rounded"_a = 0.0,
            "All within the radius of a line and between its ends, the edges there rounded within both.")
        .def("distance", &distance, "x"_a,
             "Signed distances (n,) [m] of points x (n, 3), negative inside, with gradients (n, 3) and Hessians (n, 3, "
             "3).")
        .def("update_friction", &update_friction, "x"_a, "area"_a, "stiffness"_a, "thickness"_a, "coefficient"_a,
             "slip"_a, "anchor"_a.noconvert(), "normal"_a.noconvert(), "limit"_a.noconvert(),
             "Takes the normals (n, 3) at x (n, 3), and as limits (n,) [N] the coefficient times the normal forces of "
             "`add_contact`. Takes anchors (n, 3) into the surface at x and after it where they are more than a slip "
             "away; those without a limit, before or now, go to x. Returns the farthest way that one was dragged [m].")
        .def("add_contact", &add_contact, "x"_a, "area"_a, "stiffness"_a, "thickness"_a, "potential"_a.noconvert(),
             "curved"_a = true,
             "Energy [J] of a penalty of stiffness [N/m^3] within a thickness [m] of the surface, on points x (n, 3) "
             "that stand for areas (n,) [m^2]. Adds gradient and Hessian to the columns 3: of potential (n, 12), the "
             "parameters of the element potential_point1; without the curvature of the surface if not curved, which "
             "makes the Hessian positive semidefinite.");
    m.def("add_friction", &add_friction, "x"_a, "anchor"_a, "normal"_a, "limit"_a, "slip"_a, "potential"_a.noconvert(),
          "Energy [J] of friction that pulls x (n, 3) to anchors along the surface with the forces limit (n,) [N] at "
          "most, which it reaches where they are a slip [m] away. Adds gradient and Hessian to potential (n, 12).");
}
