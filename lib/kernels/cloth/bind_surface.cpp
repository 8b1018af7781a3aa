// Bindings of closed surfaces: distances from their triangles, and the grids that stand for these in contact.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cloth/grid_distance.hpp"

#if RESTSHAPE_CGAL
#include "cloth/lattice_distance.hpp"
#include "cloth/surface_search.hpp"
#endif

namespace py = pybind11;
using namespace pybind11::literals;
using restshape::GridDistance;

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Numbers = py::array_t<int32_t, py::array::c_style | py::array::forcecast>;
using Vector = std::array<double, 3>;

py::ssize_t points(const Doubles& x) {
    if (x.ndim() != 2 || x.shape(1) != 3) throw std::invalid_argument("x must have the shape (n, 3)");
    return x.shape(0);
}

template <class T, class A>
std::vector<T> copied(const A& values) {
    return std::vector<T>(values.data(), values.data() + values.size());
}

std::shared_ptr<GridDistance> grid(const Vector& origin, double spacing, const std::array<int, 3>& bricks,
                                   const Vector& low, const Vector& high, double band, const Numbers& table,
                                   const Floats& fine, const Doubles& coarse, const Doubles& bent, double slope,
                                   double thin, double sharpest, double slack) {
    GridDistance::Layout layout{};
    for (int a = 0; a < 3; ++a) {
        layout.origin[a] = origin[a], layout.bricks[a] = bricks[a];
        layout.low[a] = low[a], layout.high[a] = high[a];
    }
    layout.spacing = spacing, layout.band = band, layout.slope = slope, layout.thin = thin, layout.sharpest = sharpest;
    layout.slack = slack;
    return std::make_shared<GridDistance>(layout, copied<int32_t>(table), copied<float>(fine), copied<double>(coarse),
                                          copied<double>(bent));
}

py::tuple at(const GridDistance& body, const Doubles& x) {
    const py::ssize_t n = points(x);
    py::array_t<double> value(n), gradient({n, py::ssize_t{3}}), hessian({n, py::ssize_t{6}});
    for (py::ssize_t i = 0; i < n; ++i) {
        const restshape::GridValue found = body.at(x.data() + 3 * i, true);
        value.mutable_data()[i] = found.value;
        std::copy(found.gradient, found.gradient + 3, gradient.mutable_data() + 3 * i);
        std::copy(found.hessian, found.hessian + 6, hessian.mutable_data() + 6 * i);
    }
    return py::make_tuple(value, gradient, hessian);
}

py::array_t<double> values(const GridDistance& body, const Doubles& x) {
    const py::ssize_t n = points(x);
    py::array_t<double> value(n);
    for (py::ssize_t i = 0; i < n; ++i) value.mutable_data()[i] = body.at(x.data() + 3 * i, false).value;
    return value;
}

// Of places x: value, length of the gradient, least and largest second derivative in any direction.
py::array_t<double> shapes(const GridDistance& body, const Doubles& x) {
    const py::ssize_t n = points(x);
    py::array_t<double> out({n, py::ssize_t{4}});
    for (py::ssize_t i = 0; i < n; ++i) {
        const restshape::GridValue found = body.at(x.data() + 3 * i, true);
        const double *h = found.hessian, *g = found.gradient;
        Eigen::Matrix3d H;
        H << h[0], h[5], h[4], h[5], h[1], h[3], h[4], h[3], h[2];
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> own;
        own.computeDirect(H, Eigen::EigenvaluesOnly);
        double* row = out.mutable_data() + 4 * i;
        row[0] = found.value, row[1] = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
        row[2] = own.eigenvalues()[0], row[3] = own.eigenvalues()[2];
    }
    return out;
}

#if RESTSHAPE_CGAL
using restshape::SurfaceSearch;

std::unique_ptr<SurfaceSearch> search(const Doubles& x, const Numbers& cells) {
    const py::ssize_t n = points(x);
    if (cells.ndim() != 2 || cells.shape(1) != 3) throw std::invalid_argument("cells must have the shape (m, 3)");
    for (py::ssize_t k = 0; k < cells.size(); ++k)
        if (cells.data()[k] < 0 || cells.data()[k] >= n)
            throw std::invalid_argument("a triangle names a corner that does not exist");
    if (!cells.shape(0)) throw std::invalid_argument("a surface has at least one triangle");
    return std::make_unique<SurfaceSearch>(x.data(), cells.data(), cells.shape(0));
}

py::tuple nearest(const SurfaceSearch& surface, const Doubles& x, double far) {
    const py::ssize_t n = points(x);
    py::array_t<double> value(n), place({n, py::ssize_t{3}});
    double hint[3], last[3] = {0, 0, 0}, before = 0.0;
    bool inside = false;
    surface.any_place(hint);
    for (py::ssize_t i = 0; i < n; ++i) {
        const double* y = x.data() + 3 * i;
        surface.nearest(y, hint);
        double own = 0.0, gone = 0.0;
        for (int a = 0; a < 3; ++a) {
            own += (y[a] - hint[a]) * (y[a] - hint[a]);
            gone += (y[a] - last[a]) * (y[a] - last[a]);
        }
        own = std::sqrt(own);
        // Two balls that touch and hold no surface are on one side of it.
        if (i == 0 || std::sqrt(gone) > 0.999 * (own + before)) inside = surface.winding(y, far) > 0.5;
        before = own;
        std::copy(y, y + 3, last);
        std::copy(hint, hint + 3, place.mutable_data() + 3 * i);
        value.mutable_data()[i] = inside ? -own : own;
    }
    return py::make_tuple(value, place);
}

using Wanted = py::array_t<std::uint8_t, py::array::c_style>;
using Values = py::array_t<double, py::array::c_style>;

void fill_lattice(const SurfaceSearch& outer, const Vector& origin, double spacing, const Wanted& wanted,
                  Values& values, std::optional<const SurfaceSearch*> whole, double far) {
    if (wanted.ndim() != 3 || values.ndim() != 3) throw std::invalid_argument("a lattice has the shape (i, j, k)");
    restshape::Lattice lattice{{origin[0], origin[1], origin[2]}, spacing, {}, wanted.data()};
    for (int a = 0; a < 3; ++a) {
        lattice.counts[a] = wanted.shape(a);
        if (values.shape(a) != wanted.shape(a)) throw std::invalid_argument("values must have the shape of wanted");
    }
    restshape::LatticeDistance(outer, whole ? **whole : outer, far).fill(lattice, values.mutable_data());
}

py::array_t<double> winding(const SurfaceSearch& surface, const Doubles& x, double far) {
    const py::ssize_t n = points(x);
    py::array_t<double> found(n);
    for (py::ssize_t i = 0; i < n; ++i) found.mutable_data()[i] = surface.winding(x.data() + 3 * i, far);
    return found;
}

py::array_t<double> first_hits(const SurfaceSearch& surface, const Doubles& x, const Doubles& ways) {
    const py::ssize_t n = points(x);
    if (points(ways) != n) throw std::invalid_argument("ways must have the shape of x");
    py::array_t<double> found(n);
    for (py::ssize_t i = 0; i < n; ++i)
        found.mutable_data()[i] = surface.first_hit(x.data() + 3 * i, ways.data() + 3 * i);
    return found;
}

void bind_search(py::module_& m) {
    py::class_<SurfaceSearch>(m, "SurfaceSearch", "Triangles of a closed surface, and what is near to a place.")
        .def(py::init(&search), "x"_a, "cells"_a, "Triangles (m, 3) of corners x (n, 3) [m], none without area.")
        .def("nearest", &nearest, "x"_a, "far"_a = 2.5,
             "Signed distances (n,) [m] of places x (n, 3), negative inside, and the nearest places (n, 3) of the "
             "surface. Which side a place is on follows from its winding number, see `winding`.")
        .def(
            "fill_lattice", &fill_lattice, "origin"_a, "spacing"_a, "wanted"_a, py::arg("values").noconvert(),
            "whole"_a = py::none(), "far"_a = 2.5,
            "Puts into values (i, j, k) the signed distances [m] of places origin + spacing (i, j, k) that are wanted "
            "(i, j, k), as `nearest` gives them; negative where the triangles of `whole`, these or others, wind around "
            "a place.")
        .def("winding", &winding, "x"_a, "far"_a = 2.5,
             "Generalised winding numbers (n,) of the surface about places x (n, 3). Triangles that are farther away "
             "than `far` times their radius count together as a dipole; infinite: exact.")
        .def("first_hits", &first_hits, "x"_a, "ways"_a,
             "How far (n,) [m] rays from places x (n, 3) along ways (n, 3) go to the surface; infinite: never there.");
}
#else
void bind_search(py::module_&) {}
#endif

}  // namespace

void bind_surface(py::module_& m) {
    py::class_<GridDistance, std::shared_ptr<GridDistance>>(
        m, "GridDistance", "Signed distance of a closed surface on grids, by cubic B-splines.")
        .def(py::init(&grid), "origin"_a, "spacing"_a, "bricks"_a, "low"_a, "high"_a, "band"_a, "table"_a, "fine"_a,
             "coarse"_a, "bent"_a, "slope"_a, "thin"_a, "sharpest"_a, "slack"_a,
             "Bricks of 8^3 cells of a spacing [m], their number along each axis, from an origin on. table: numbers of "
             "those that are stored, -1 outside, -2 inside. fine: their coefficients (k, 11, 11, 11), x last. coarse: "
             "coefficients of the grid of the bricks' corners, with a layer around. bent (k,): how much the distance "
             "curves downwards in bricks, at most. low, high: box of the surface; band [m]: within which there are "
             "bricks; slope: bound on gradients; thin, sharpest [m]: see Body.inner_radius and sharpest; slack [m]: "
             "by which the coarse grid is too large "
             "outside.")
        .def("at", &at, "x"_a,
             "Signed distances (n,) [m] of places x (n, 3), gradients (n, 3), and second derivatives (n, 6), xx yy zz "
             "yz xz xy.")
        .def("values", &values, "x"_a, "Signed distances (n,) [m] of places x (n, 3) alone.")
        .def("shapes", &shapes, "x"_a,
             "Of places x (n, 3): distance, length of the gradient, least and largest second derivative (n, 4).");
    bind_search(m);
}
