// Bindings of second-order nodes: their places in a frame, soundness of curved triangles, fields at points.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stdexcept>
#include <string>

#include "mesh/space.hpp"

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

using Reals = py::array_t<double, py::array::c_style>;
using Ints = py::array_t<std::int32_t, py::array::c_style>;

void require_size(py::ssize_t size, py::ssize_t expected, const char* name) {
    if (size != expected) throw std::invalid_argument(std::string(name) + " has the wrong size");
}

py::ssize_t follow_sides(const Reals& corners, const Ints& corner_number, const Ints& ends, const Ints& side_number,
                         const Ints& curved, const Reals& reference, const Reals& basis, double c0, double c1,
                         Reals offset, Reals X, const Ints& cells, const Ints& curved_cells, double floor) {
    const py::ssize_t width = 2 * curved.size();
    require_size(corners.size(), 2 * corner_number.size(), "corners");
    require_size(ends.size(), 2 * side_number.size(), "ends");
    require_size(reference.size(), width, "reference");
    require_size(basis.size(), 2 * width, "basis");
    require_size(offset.size(), width, "offset");
    require_size(X.size(), 2 * (corner_number.size() + side_number.size()), "X");
    double* bent = offset.mutable_data();
    for (py::ssize_t k = 0; k < width; ++k)
        bent[k] = reference.data()[k] + c0 * basis.data()[k] + c1 * basis.data()[width + k];
    const restshape::Sides sides{ends.data(), side_number.data(), side_number.size(), curved.data(),
                                 bent,        curved.size()};
    restshape::place_second_order(corners.data(), corner_number.data(), corner_number.size(), sides, X.mutable_data());
    py::ssize_t invalid = 0;
    for (py::ssize_t k = 0; k < curved_cells.size(); ++k) {
        // Negated, so that a coordinate that is not a number counts as invalid.
        invalid += !(restshape::jacobian_share(X.data(), cells.data() + 6 * curved_cells.data()[k]) >= floor);
    }
    return invalid;
}

py::tuple locate_quadratic(const Reals& X, const Ints& corners, const Ints& cells, const Reals& points, bool close) {
    if (corners.shape(0) == 0) throw std::invalid_argument("there are no cells");
    require_size(cells.size(), 2 * corners.size(), "cells");
    restshape::QuadraticLocator locator(X.data(), corners.data(), cells.data(), corners.shape(0));
    Ints found(points.shape(0));
    Reals values({points.shape(0), py::ssize_t{6}});
    std::int32_t cell = -1, *to = found.mutable_data();
    for (py::ssize_t i = 0; i < points.shape(0); ++i)
        to[i] = cell = locator.locate(points.data() + 2 * i, values.mutable_data() + 6 * i, close ? cell : -1);
    return py::make_tuple(found, values);
}

}  // namespace

void bind_space(py::module_& m) {
    m.def("follow_sides", &follow_sides, py::arg("corners").noconvert(), py::arg("corner_number").noconvert(),
          py::arg("ends").noconvert(), py::arg("side_number").noconvert(), py::arg("curved").noconvert(),
          py::arg("reference").noconvert(), py::arg("basis").noconvert(), "c0"_a, "c1"_a, py::arg("offset").noconvert(),
          py::arg("X").noconvert(), py::arg("cells").noconvert(), py::arg("curved_cells").noconvert(), "floor"_a,
          "Sets offset = reference + c0 basis[0] + c1 basis[1] of curved sides and the second-order nodes X from the "
          "corners, in place; returns how many of the curved cells have a Jacobian bound below the floor, over twice "
          "the area of their corners.");
    m.def("locate_quadratic", &locate_quadratic, py::arg("X").noconvert(), py::arg("corners").noconvert(),
          py::arg("cells").noconvert(), py::arg("points").noconvert(), "close"_a = false,
          "Quadratic triangle of every point and the values (m, 6) of its basis there; points outside are put on the "
          "nearest boundary point. Of close points the triangle of the one before is tried first.");
}
