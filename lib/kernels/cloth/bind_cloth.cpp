// Bindings of contact: bodies, and what they do to points.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cloth/contact.hpp"
#include "cloth/point_room.hpp"
#include "cloth/smooth_lowest.hpp"
#include "cloth/triangle_distance.hpp"
#include "cloth/triangle_room.hpp"

namespace py = pybind11;
using namespace pybind11::literals;
using restshape::Body;

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Output = py::array_t<double, py::array::c_style>;
using Vector = std::array<double, 3>;

constexpr int width = 12;  // numbers in the potential of a point
// Of a grid, beyond which from the middle of a part of a triangle something may lie that its quadratic does not show.
constexpr double cells_across = 4.0;

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

Body mesh(std::shared_ptr<restshape::GridDistance> grid, const Doubles& place, const Doubles& rotation, double scale) {
    require(rotation.size() == 9, "rotation must have the shape (3, 3)");
    return Body::mesh(std::move(grid), vector(place, "place").data(), rotation.data(), scale);
}

using Cells = py::array_t<int32_t, py::array::c_style | py::array::forcecast>;
using restshape::Vec3;

// The corners of triangles, whose numbers exist.
struct Triangles {
    const double* x;
    const int32_t* cells;
    py::ssize_t count;

    Triangles(const Doubles& x, const Cells& cells) : x(x.data()), cells(cells.data()), count(cells.shape(0)) {
        const py::ssize_t n = points(x);
        require(cells.ndim() == 2 && cells.shape(1) == 3, "cells must have the shape (ne, 3)");
        const auto inside = [n](int32_t node) { return node >= 0 && node < n; };
        require(std::all_of(this->cells, this->cells + 3 * count, inside), "a cell names a node that does not exist");
    }
    void corners(const double* at, py::ssize_t e, Vec3* p) const {
        for (int i = 0; i < 3; ++i) {
            const double* place = at + 3 * static_cast<py::ssize_t>(cells[3 * e + i]);
            p[i] = {{place[0], place[1], place[2]}};
        }
    }
};

py::array_t<double> distances(const Body& body, const Doubles& x) {
    const py::ssize_t n = points(x);
    py::array_t<double> value(n);
    for (py::ssize_t i = 0; i < n; ++i) value.mutable_data()[i] = body.distance(x.data() + 3 * i, false).value;
    return value;
}

py::tuple lowest(const Body& body, const Doubles& x, const Cells& cells, double tolerance) {
    const Triangles triangles(x, cells);
    Vec3 p[3];
    restshape::Lowest best{std::numeric_limits<double>::infinity(), 0.0, {}};
    py::ssize_t where = -1;
    for (py::ssize_t e = 0; e < triangles.count; ++e) {
        triangles.corners(triangles.x, e, p);
        const restshape::Lowest low = restshape::lowest_on(body, p, tolerance, best.value);
        if (low.value < best.value) {
            best = low;
            where = e;
        }
    }
    return py::make_tuple(best.value, where, Vector{best.b[0], best.b[1], best.b[2]});
}

// The radius of curvature of the surface below a place; infinite where it is flat there.
double radius_below(const Body& body, const double* x, double distance) {
    const restshape::Distance d = body.distance(x);
    double square = 0.0;
    for (int k = 0; k < 6; ++k) square += (k < 3 ? 1 : 2) * d.hessian[k] * d.hessian[k];
    // Deep inside of edges nothing shows how sharp they are.
    if (square == 0.0) return distance < 0.0 ? body.sharpest() : std::numeric_limits<double>::infinity();
    return std::max(body.sharpest(), 1.0 / std::sqrt(square) - distance);
}

py::tuple lowest_each(const Body& body, const Doubles& x, const Cells& cells, double tolerance,
                      const std::optional<Doubles>& enough) {
    const Triangles triangles(x, cells);
    constexpr double infinite = std::numeric_limits<double>::infinity();
    if (enough) require_size(*enough, triangles.count, "enough");
    Vec3 p[3];
    py::array_t<double> found(triangles.count), radius(triangles.count);
    // Triangles share corners: each one's distance is taken once.
    std::vector<double> known(points(x), infinite);
    for (py::ssize_t e = 0; e < triangles.count; ++e) {
        triangles.corners(triangles.x, e, p);
        double at_corners[3];
        for (int i = 0; i < 3; ++i) {
            double& own = known[triangles.cells[3 * e + i]];
            if (own == infinite) own = body.distance(p[i].c, false).value;
            at_corners[i] = own;
        }
        const double least = enough ? enough->data()[e] : infinite;
        const restshape::Lowest low =
            body.convex()
                ? restshape::lowest_on(body, p, tolerance, least, at_corners)
                : restshape::smooth_lowest(body, p, tolerance, cells_across * body.detail(), least, at_corners);
        const Vec3 at = low.b[0] * p[0] + low.b[1] * p[1] + low.b[2] * p[2];
        found.mutable_data()[e] = low.value;
        radius.mutable_data()[e] = low.value < least ? radius_below(body, at.c, low.value) : infinite;
    }
    return py::make_tuple(found, radius);
}

py::array_t<double> longest_sides(const Doubles& x, const Cells& cells) {
    const Triangles triangles(x, cells);
    Vec3 p[3];
    py::array_t<double> found(triangles.count);
    for (py::ssize_t e = 0; e < triangles.count; ++e) {
        triangles.corners(triangles.x, e, p);
        double most = 0.0;
        for (int i = 0; i < 3; ++i) {
            const Vec3 side = p[(i + 1) % 3] - p[i];
            most = std::max(most, inner(side.c, side));
        }
        found.mutable_data()[e] = std::sqrt(most);
    }
    return found;
}

// Triangles with a corner farther than a slack from where it was; those take where it is.
py::array_t<int64_t> moved_cells(const Doubles& x, const Cells& cells, double slack, Output before) {
    const Triangles triangles(x, cells);
    require_shape(before, triangles.count, 9, "before");
    Vec3 p[3];
    std::vector<int64_t> found;
    for (py::ssize_t e = 0; e < triangles.count; ++e) {
        triangles.corners(triangles.x, e, p);
        double* known = before.mutable_data() + 9 * e;
        bool stays = true;
        for (int i = 0; i < 3; ++i) {
            const Vec3 way = p[i] - Vec3{{known[3 * i], known[3 * i + 1], known[3 * i + 2]}};
            stays = stays && inner(way.c, way) <= slack * slack;
        }
        if (stays) continue;
        found.push_back(e);
        for (int i = 0; i < 3; ++i) std::copy(p[i].c, p[i].c + 3, known + 3 * i);
    }
    return py::array_t<int64_t>(static_cast<py::ssize_t>(found.size()), found.data());
}

// Corners, followed by places between those of triangles.
py::array_t<double> with_points(const Doubles& values, const Cells& nodes, const Doubles& weights) {
    const py::ssize_t n = points(values), m = nodes.shape(0);
    require_size(weights, 3 * m, "weights");
    require(nodes.ndim() == 2 && nodes.shape(1) == 3, "nodes must have the shape (m, 3)");
    const auto inside = [n](int32_t node) { return node >= 0 && node < n; };
    require(std::all_of(nodes.data(), nodes.data() + 3 * m, inside), "a point names a node that does not exist");
    py::array_t<double> all({n + m, py::ssize_t{3}});
    double* to = std::copy(values.data(), values.data() + 3 * n, all.mutable_data());
    for (py::ssize_t k = 0; k < m; ++k, to += 3) {
        const double *share = weights.data() + 3 * k, *from[3];
        for (int i = 0; i < 3; ++i) from[i] = values.data() + 3 * static_cast<py::ssize_t>(nodes.data()[3 * k + i]);
        for (int a = 0; a < 3; ++a) to[a] = share[0] * from[0][a] + share[1] * from[1][a] + share[2] * from[2][a];
    }
    return all;
}

py::array_t<int64_t> nonzero_rows(const Doubles& values) {
    require(values.ndim() == 2, "values must have rows");
    const py::ssize_t n = values.shape(0), wide = values.shape(1);
    std::vector<int64_t> found;
    for (py::ssize_t i = 0; i < n; ++i) {
        const double* row = values.data() + wide * i;
        if (std::any_of(row, row + wide, [](double value) { return value != 0.0; })) found.push_back(i);
    }
    return py::array_t<int64_t>(static_cast<py::ssize_t>(found.size()), found.data());
}

double step_share(const Body& body, const Doubles& x, const Doubles& d, const Cells& cells, double floor, double deeper,
                  double tolerance, double bottom) {
    const Triangles triangles(x, cells);
    require(d.size() == x.size(), "d must have the shape of x");
    require(deeper > tolerance && tolerance > 0, "deeper must be more than the tolerance, which must be positive");
    Vec3 p[3], way[3];
    double share = 1.0;
    for (py::ssize_t e = 0; e < triangles.count && share > 0.0; ++e) {
        triangles.corners(triangles.x, e, p);
        triangles.corners(d.data(), e, way);
        for (Vec3& w : way) w = share * w;
        share *= restshape::triangle_share(body, p, way, floor, deeper, bottom, tolerance);
    }
    return share;
}

using restshape::TriangleRoom;

double room_share(TriangleRoom& room, const Doubles& x, const Doubles& d, const Cells& cells) {
    const Triangles triangles(x, cells);
    require(d.size() == x.size(), "d must have the shape of x");
    require(static_cast<std::size_t>(triangles.count) == room.count(), "cells are not as many as the room is of");
    Vec3 p[3], way[3];
    double share = 1.0;
    for (py::ssize_t e = 0; e < triangles.count && share > 0.0; ++e) {
        triangles.corners(triangles.x, e, p);
        triangles.corners(d.data(), e, way);
        for (Vec3& w : way) w = share * w;
        share *= room.share(e, p, way);
    }
    return share;
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

using restshape::PointRoom;

double room_contact(PointRoom& room, const Doubles& x, const Doubles& area, double stiffness, double thickness,
                    Output potential, bool curved) {
    const py::ssize_t n = points(x);
    require_size(area, n, "area");
    require_shape(potential, n, width, "potential");
    require(thickness > 0, "thickness must be positive");
    require(static_cast<std::size_t>(n) == room.count(), "points are not as many as the room is of");
    double energy = 0.0;
    for (py::ssize_t i = 0; i < n; ++i)
        energy += room.add(i, x.data() + 3 * i, area.data()[i], stiffness, thickness, curved,
                           potential.mutable_data() + width * i);
    return energy;
}

double update_friction(const Doubles& x, const Doubles& pushed, double coefficient, double slip, Output anchor,
                       Output normal, Output limit) {
    const py::ssize_t n = points(x);
    require_size(pushed, width * n, "pushed");
    require_shape(anchor, n, 3, "anchor");
    require_shape(normal, n, 3, "normal");
    require_shape(limit, n, 1, "limit");
    double moved = 0.0;
    for (py::ssize_t i = 0; i < n; ++i) {
        const double *place = x.data() + 3 * i, *force = pushed.data() + width * i + 3;
        double *own_anchor = anchor.mutable_data() + 3 * i, *own_normal = normal.mutable_data() + 3 * i;
        double& own_limit = limit.mutable_data()[i];
        const double size = std::sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]);
        // What has touched nothing sticks where it is now.
        if (own_limit == 0.0) std::copy(place, place + 3, own_anchor);
        own_limit = coefficient * size;
        if (size > 0.0)
            for (int a = 0; a < 3; ++a) own_normal[a] = -force[a] / size;
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

using Rate = restshape::Dual<1>;
using BodyRates = restshape::BodyOf<Rate>;

Rate rate(double value, double slope) { return {value, Rate::Lanes::Constant(slope)}; }

template <py::ssize_t count>
std::array<Rate, count> rates(const Doubles& value, const Doubles& slope, const char* name) {
    require(value.size() == count && slope.size() == count, std::string(name) + " or its rates have the wrong size");
    std::array<Rate, count> found;
    for (py::ssize_t k = 0; k < count; ++k) found[k] = rate(value.data()[k], slope.data()[k]);
    return found;
}

Rate rate(const std::array<double, 2>& pair) { return rate(pair[0], pair[1]); }
using Pair = std::array<double, 2>;

void add_force_rates(const BodyRates& body, const Doubles& x, const Doubles& dx, const Doubles& area,
                     const Doubles& darea, const Pair& stiffness, const Pair& thickness, const Pair& coefficient,
                     const Pair& slip, const Doubles& anchor, const Doubles& danchor, const Doubles& limit,
                     Output out) {
    const py::ssize_t n = points(x);
    for (const auto* a : {&dx, &anchor, &danchor}) require_size(*a, 3 * n, "dx, anchor or danchor");
    for (const auto* a : {&area, &darea, &limit}) require_size(*a, n, "area, darea or limit");
    require_shape(out, n, 3, "out");
    for (py::ssize_t i = 0; i < n; ++i) {
        Rate place[3], held[3], force[3] = {0.0, 0.0, 0.0};
        for (int a = 0; a < 3; ++a) {
            place[a] = rate(x.data()[3 * i + a], dx.data()[3 * i + a]);
            held[a] = rate(anchor.data()[3 * i + a], danchor.data()[3 * i + a]);
        }
        const bool sticks = coefficient[0] > 0 && limit.data()[i] > 0;
        restshape::add_force(body, place, rate(area.data()[i], darea.data()[i]), rate(stiffness), rate(thickness),
                             rate(coefficient), rate(slip), held, sticks, force);
        for (int a = 0; a < 3; ++a) out.mutable_data()[3 * i + a] += force[a].d[0];
    }
}

}  // namespace

void bind_contact(py::module_& m) {
    py::class_<Body>(m, "Body", "A body that points do not enter.")
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
        .def_static("mesh", &mesh, "grid"_a, "place"_a, "rotation"_a, "scale"_a = 1.0,
                    "What a grid of distances stands for, made larger, its axes the rows of rotation, its origin at a "
                    "place [m].")
        .def_property_readonly("hull", &Body::hull, "A convex body that holds it: itself, or a box.")
        .def("distance", &distance, "x"_a,
             "Signed distances (n,) [m] of points x (n, 3), negative inside, with gradients (n, 3) and Hessians (n, 3, "
             "3).")
        .def("distances", &distances, "x"_a, "Signed distances (n,) [m] of points x (n, 3) alone.")
        .def_property_readonly("sharpest", &Body::sharpest,
                               "The smallest radius of curvature of its surface [m]; infinite where it is flat.")
        .def_property_readonly("inner_radius", &Body::inner_radius,
                               "How deep the place farthest within it is [m]; infinite in a half-space.")
        .def(
            "lowest", &lowest, "x"_a, "cells"_a, "tolerance"_a,
            "The least signed distance [m], within a tolerance [m], over triangles: cells (ne, 3) of corners x (n, 3). "
            "Returns it, the triangle and the barycentric coordinates of the place.")
        .def("lowest_each", &lowest_each, "x"_a, "cells"_a, "tolerance"_a, "enough"_a = py::none(),
             "The least signed distance (ne,) [m] over each triangle, within a tolerance [m], and the radius of "
             "curvature (ne,) [m] of the surface there; where the distance is not below what is `enough` (ne,) [m], "
             "some on it, and no radius.")
        .def("step_share", &step_share, "x"_a, "d"_a, "cells"_a, "floor"_a, "deeper"_a, "tolerance"_a,
             "bottom"_a = -std::numeric_limits<double>::infinity(),
             "The largest share of a way d (n, 3) from x (n, 3) [m] on which no triangle of cells (ne, 3) has a signed "
             "distance below a floor [m], or, where it is below that plus `deeper` [m], one that is lower by more than "
             "`deeper`; and none below a bottom, unless it is there already.")
        .def("add_contact", &add_contact, "x"_a, "area"_a, "stiffness"_a, "thickness"_a, "potential"_a.noconvert(),
             "curved"_a = true,
             "Energy [J] of a penalty of stiffness [N/m^3] within a thickness [m] of the surface, on points x (n, 3) "
             "that stand for areas (n,) [m^2]. Adds gradient and Hessian to the columns 3: of potential (n, 12), the "
             "parameters of the element potential_point1; without the curvature of the surface if not curved, which "
             "makes the Hessian positive semidefinite.");
    py::class_<PointRoom>(m, "PointRoom", "How far points are from a body, kept from one place to the next.")
        .def(py::init([](const Body& body, py::ssize_t count) {
                 return PointRoom(body, static_cast<std::size_t>(std::max<py::ssize_t>(count, 0)));
             }),
             "body"_a, "count"_a, "Of so many points, nothing of which is known.")
        .def("add_contact", &room_contact, "x"_a, "area"_a, "stiffness"_a, "thickness"_a, "potential"_a.noconvert(),
             "curved"_a = true,
             "What `Body.add_contact` does. Points that are known to be farther than the thickness are not looked at.")
        .def_property_readonly("count", &PointRoom::count, "Points that it is of.")
        .def_property_readonly("looks", &PointRoom::looks, "How often the distance of a point was taken.");
    py::class_<TriangleRoom>(m, "TriangleRoom",
                             "How far triangles may go beside a body, kept from one step to the next.")
        .def(py::init(
                 [](const Body& body, py::ssize_t count, double floor, double deeper, double tolerance, double bottom) {
                     require(deeper > tolerance && tolerance > 0,
                             "deeper must be more than the tolerance, which must be positive");
                     return TriangleRoom(body, static_cast<std::size_t>(std::max<py::ssize_t>(count, 0)), floor, deeper,
                                         bottom, tolerance);
                 }),
             "body"_a, "count"_a, "floor"_a, "deeper"_a, "tolerance"_a,
             "bottom"_a = -std::numeric_limits<double>::infinity(),
             "Of so many triangles, nothing of which is known; numbers as of `Body.step_share`.")
        .def("step_share", &room_share, "x"_a, "d"_a, "cells"_a,
             "What `Body.step_share` gives. Triangles that stay within what is known of them are not looked at.")
        .def_property_readonly("looks", &TriangleRoom::looks, "How often triangles were looked at.");
    py::class_<BodyRates>(m, "BodyRates", "A body whose numbers change, with their rates.")
        .def(py::init<const Body&>(), "body"_a, "One that stays as it is.")
        .def_static(
            "sphere",
            [](const Doubles& centre, double radius, const Doubles& dcentre, double dradius) {
                return BodyRates::sphere(rates<3>(centre, dcentre, "centre").data(), rate(radius, dradius));
            },
            "centre"_a, "radius"_a, "dcentre"_a, "dradius"_a, "A ball.")
        .def_static(
            "plane",
            [](const Doubles& point, const Doubles& normal, const Doubles& dpoint, const Doubles& dnormal) {
                return BodyRates::plane(rates<3>(point, dpoint, "point").data(),
                                        rates<3>(normal, dnormal, "normal").data());
            },
            "point"_a, "normal"_a, "dpoint"_a, "dnormal"_a, "A half-space.")
        .def_static(
            "box",
            [](const Doubles& centre, const Doubles& half, const Doubles& rotation, double radius,
               const Doubles& dcentre, const Doubles& dhalf, const Doubles& drotation, double dradius) {
                return BodyRates::box(rates<3>(centre, dcentre, "centre").data(), rates<3>(half, dhalf, "half").data(),
                                      rates<9>(rotation, drotation, "rotation").data(), rate(radius, dradius));
            },
            "centre"_a, "half"_a, "rotation"_a, "radius"_a, "dcentre"_a, "dhalf"_a, "drotation"_a, "dradius"_a,
            "A box.")
        .def_static(
            "capsule",
            [](const Doubles& from, const Doubles& to, double radius, const Doubles& dfrom, const Doubles& dto,
               double dradius) {
                return BodyRates::capsule(rates<3>(from, dfrom, "start").data(), rates<3>(to, dto, "end").data(),
                                          rate(radius, dradius));
            },
            "start"_a, "end"_a, "radius"_a, "dstart"_a, "dend"_a, "dradius"_a, "All within the radius of a line.")
        .def_static(
            "cylinder",
            [](const Doubles& from, const Doubles& to, double radius, double rounded, const Doubles& dfrom,
               const Doubles& dto, double dradius, double drounded) {
                return BodyRates::cylinder(rates<3>(from, dfrom, "start").data(), rates<3>(to, dto, "end").data(),
                                           rate(radius, dradius), rate(rounded, drounded));
            },
            "start"_a, "end"_a, "radius"_a, "rounded"_a, "dstart"_a, "dend"_a, "dradius"_a, "drounded"_a, "A cylinder.")
        .def_static(
            "mesh",
            [](std::shared_ptr<restshape::GridDistance> grid, const Doubles& place, const Doubles& rotation,
               double scale, const Doubles& dplace, const Doubles& drotation, double dscale) {
                return BodyRates::mesh(std::move(grid), rates<3>(place, dplace, "place").data(),
                                       rates<9>(rotation, drotation, "rotation").data(), rate(scale, dscale));
            },
            "grid"_a, "place"_a, "rotation"_a, "scale"_a, "dplace"_a, "drotation"_a, "dscale"_a,
            "What a grid of distances stands for.")
        .def("add_force_rates", &add_force_rates, "x"_a, "dx"_a, "area"_a, "darea"_a, "stiffness"_a, "thickness"_a,
             "coefficient"_a, "slip"_a, "anchor"_a, "danchor"_a, "limit"_a, "out"_a.noconvert(),
             "Adds to out (n, 3) [N] the rates of the gradient of `add_contact` on points x (n, 3), and of friction "
             "where its limit (n,) is not 0, with the normal and the normal force of x itself. Numbers are pairs of "
             "value and rate.");
    m.def("with_points", &with_points, "values"_a, "nodes"_a, "weights"_a,
          "Values (n, 3) of nodes, followed by those (m, 3) of points: sums of their nodes' (m, 3) by weights (m, 3).");
    m.def("nonzero_rows", &nonzero_rows, "values"_a,
          "Numbers (k,) of the rows of values (n, f) that are not all zero.");
    m.def("moved_cells", &moved_cells, "x"_a, "cells"_a, "slack"_a, "before"_a.noconvert(),
          "Numbers (k,) of triangles with a corner, at x (n, 3), farther than a slack [m] from where it was `before` "
          "(ne, "
          "3, 3). Those take where it is.");
    m.def("longest_sides", &longest_sides, "x"_a, "cells"_a,
          "The longest side (ne,) [m] of triangles: cells (ne, 3) of corners x (n, 3).");
    m.def(
        "update_friction", &update_friction, "x"_a, "pushed"_a, "coefficient"_a, "slip"_a, "anchor"_a.noconvert(),
        "normal"_a.noconvert(), "limit"_a.noconvert(),
        "Takes from what `Body.add_contact` adds for a body at x (n, 3), `pushed` (n, 12), the normals (n, 3) of what "
        "is "
        "pressed, and as limits (n,) [N] a coefficient times the forces. Takes anchors (n, 3) into the surface at x "
        "and after it where they are more than a slip away; those without a limit, before or now, go to x. Returns the "
        "farthest way that one was dragged [m].");
    m.def("add_friction", &add_friction, "x"_a, "anchor"_a, "normal"_a, "limit"_a, "slip"_a, "potential"_a.noconvert(),
          "Energy [J] of friction that pulls x (n, 3) to anchors along the surface with the forces limit (n,) [N] at "
          "most, which it reaches where they are a slip [m] away. Adds gradient and Hessian to potential (n, 12).");
}
