// Bindings of what steps of cloth ask of the places of its nodes, each in one pass.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "cloth/part_distance.hpp"

namespace py = pybind11;
using namespace pybind11::literals;
using restshape::Point3;

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using LongIndices = py::array_t<int64_t, py::array::c_style | py::array::forcecast>;

const Point3* points(const Doubles& x, py::ssize_t count, const char* what) {
    if (x.ndim() != 2 || x.shape(0) != count || x.shape(1) != 3) throw std::invalid_argument(what);
    return reinterpret_cast<const Point3*>(x.data());
}

bool same_values(const Doubles& a, const Doubles& b) {
    return a.ndim() == b.ndim() && std::equal(a.shape(), a.shape() + a.ndim(), b.shape()) &&
           std::equal(a.data(), a.data() + a.size(), b.data());
}

double farthest_apart(const Doubles& before, const Doubles& after) {
    const py::ssize_t n = before.ndim() ? before.shape(0) : 0;
    const Point3* from = points(before, n, "before must have the shape (n, 3)");
    const Point3* to = points(after, n, "after must have the shape of before");
    Point3 mean{0, 0, 0};
    for (py::ssize_t i = 0; i < n; ++i) mean = mean + (to[i] - from[i]);
    mean = mean * (1.0 / static_cast<double>(std::max<py::ssize_t>(n, 1)));
    double most = 0.0;
    for (py::ssize_t i = 0; i < n; ++i) {
        const Point3 off = to[i] - from[i] - mean;
        const double square = off.dot(off);
        if (std::isnan(square)) return square;
        most = std::max(most, square);
    }
    return std::sqrt(most);
}

double least_slide(const Doubles& x, const LongIndices& nodes, const Doubles& start, const Doubles& normals) {
    const py::ssize_t n = x.ndim() ? x.shape(0) : 0, count = nodes.size();
    const Point3* at = points(x, n, "x must have the shape (n, 3)");
    const Point3* from = points(start, count, "start must have the shape (m, 3)");
    const Point3* normal = points(normals, count, "normals must have the shape (m, 3)");
    double least = std::numeric_limits<double>::infinity();
    for (py::ssize_t k = 0; k < count; ++k) {
        const int64_t node = nodes.data()[k];
        if (node < 0 || node >= n) throw std::invalid_argument("a node is out of range");
        const Point3 way = at[node] - from[k], along = way - normal[k] * way.dot(normal[k]);
        const double square = along.dot(along);
        if (std::isnan(square)) return square;
        least = std::min(least, square);
    }
    return std::sqrt(least);
}

}  // namespace

void bind_places(py::module_& m) {
    m.def("same_values", &same_values, "a"_a, "b"_a,
          "Whether arrays of numbers have the same shape and the same values; none is the same as one that is no "
          "number.");
    m.def("farthest_apart", &farthest_apart, "before"_a, "after"_a,
          "The farthest way [m] of a node from before (n, 3) to after (n, 3) [m], less the mean of all ways.");
    m.def("least_slide", &least_slide, "x"_a, "nodes"_a, "start"_a, "normals"_a,
          "The least way [m] of nodes (m,) from start (m, 3) to x (n, 3) [m] across their normals (m, 3); infinite of "
          "none.");
}
