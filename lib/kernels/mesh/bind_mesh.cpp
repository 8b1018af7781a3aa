// Bindings of the mesh kernels: relocation, harmonic maps, Delaunay flips, mean value coordinates, point location.
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "mesh/harmonic.hpp"
#include "mesh/location.hpp"
#include "mesh/mean_value.hpp"
#include "mesh/quality.hpp"
#include "mesh/smoothing.hpp"
#include "mesh/triangulation.hpp"

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

// No conversion: what is written must reach the caller's array, and a level-1 frame must not copy.
using Doubles = py::array_t<double, py::array::c_style>;
using Indices = py::array_t<std::int32_t, py::array::c_style>;
using Flags = py::array_t<std::uint8_t, py::array::c_style>;

template <class Array>
void require_rows(const Array& array, py::ssize_t width, const char* name) {
    if (array.ndim() != 2 || array.shape(1) != width) {
        throw std::invalid_argument(std::string(name) + " must be an array (n, " + std::to_string(width) + ")");
    }
}

void require_same_size(py::ssize_t size, py::ssize_t expected, const char* name) {
    if (size != expected) throw std::invalid_argument(std::string(name) + " has the wrong size");
}

py::tuple as_tuple(const restshape::CellQuality& found) {
    return py::make_tuple(found.min_quality, found.invalid, found.low_quality);
}

py::tuple check_cells(const Doubles& X, const Indices& cells, double area_floor, double quality_floor) {
    require_rows(X, 2, "X");
    require_rows(cells, 3, "cells");
    return as_tuple(restshape::check_cells(X.data(), cells.data(), cells.shape(0), area_floor, quality_floor));
}

double sides_gone(const Doubles& X, const Doubles& Y, const Indices& cells) {
    require_rows(X, 2, "X");
    require_rows(cells, 3, "cells");
    require_same_size(Y.size(), X.size(), "Y");
    return restshape::sides_gone(X.data(), Y.data(), cells.data(), cells.shape(0));
}

py::tuple move_and_check(const Doubles& X_reference, const Doubles& Psi, double c0, double c1, Doubles& X,
                         const Indices& cells, double area_floor, double quality_floor) {
    require_rows(X, 2, "X");
    require_rows(cells, 3, "cells");
    require_same_size(X_reference.size(), X.size(), "X_reference");
    require_same_size(Psi.size(), 2 * X.size(), "Psi");
    restshape::move_nodes(X_reference.data(), Psi.data(), c0, c1, X.mutable_data(), X.size());
    return as_tuple(restshape::check_cells(X.data(), cells.data(), cells.shape(0), area_floor, quality_floor));
}

py::tuple relax_and_check(const Doubles& X_reference, const Doubles& Psi, double c0, double c1, Doubles& X,
                          const Indices& cells, const Indices& edge_nodes, const Flags& fixed, int sweeps,
                          double area_floor, double quality_floor) {
    require_rows(X, 2, "X");
    require_rows(cells, 3, "cells");
    require_rows(edge_nodes, 2, "edge_nodes");
    require_same_size(X_reference.size(), X.size(), "X_reference");
    require_same_size(Psi.size(), 2 * X.size(), "Psi");
    require_same_size(fixed.size(), X.shape(0), "fixed");
    restshape::move_fixed_nodes(X_reference.data(), Psi.data(), c0, c1, fixed.data(), X.mutable_data(), X.shape(0));
    restshape::laplacian_sweeps(X.mutable_data(), X.shape(0), edge_nodes.data(), edge_nodes.shape(0), fixed.data(),
                                sweeps);
    return as_tuple(restshape::check_cells(X.data(), cells.data(), cells.shape(0), area_floor, quality_floor));
}

// Checked arguments of mean value coordinates; the array that their values go to.
Doubles room_for_mean_values(const Doubles& points, const Doubles& vertices, const Indices& segments,
                             const Doubles& values) {
    require_rows(points, 2, "points");
    require_rows(vertices, 2, "vertices");
    require_rows(segments, 2, "segments");
    if (values.ndim() != 2) throw std::invalid_argument("values must be an array (vertices, columns)");
    require_same_size(values.shape(0), vertices.shape(0), "values");
    for (py::ssize_t i = 0; i < segments.size(); ++i) {
        const std::int32_t vertex = segments.data()[i];
        if (vertex < 0 || vertex >= vertices.shape(0))
            throw std::invalid_argument("segments name a vertex that is not there");
    }
    return Doubles({points.shape(0), values.shape(1)});
}

template <class Coordinates>
Doubles interpolated(Coordinates coordinates, const Doubles& points, const Doubles& values, Doubles out) {
    const py::ssize_t width = values.shape(1);
    for (py::ssize_t i = 0; i < points.shape(0); ++i) {
        coordinates.interpolate(points.data() + 2 * i, values.data(), width, out.mutable_data() + width * i);
    }
    return out;
}

Doubles mean_value(const Doubles& points, const Doubles& vertices, const Indices& segments, const Doubles& values) {
    Doubles out = room_for_mean_values(points, vertices, segments, values);
    const auto count = static_cast<std::int32_t>(segments.shape(0));
    return interpolated(restshape::MeanValue(vertices.data(), segments.data(), count), points, values, out);
}

Doubles positive_mean_value(const Doubles& points, const Doubles& vertices, const Indices& segments,
                            const Doubles& values) {
    Doubles out = room_for_mean_values(points, vertices, segments, values);
    restshape::PositiveMeanValue coordinates(vertices.data(), static_cast<std::int32_t>(vertices.shape(0)),
                                             segments.data(), static_cast<std::int32_t>(segments.shape(0)));
    return interpolated(std::move(coordinates), points, values, out);
}

py::tuple locate(const Doubles& X, const Indices& cells, const Doubles& points, bool close) {
    require_rows(X, 2, "X");
    require_rows(cells, 3, "cells");
    require_rows(points, 2, "points");
    if (cells.shape(0) == 0) throw std::invalid_argument("there are no cells");
    restshape::Locator locator(X.data(), cells.data(), cells.shape(0));
    Indices found(points.shape(0));
    Doubles weights({points.shape(0), py::ssize_t{3}});
    std::int32_t cell = -1, *to = found.mutable_data();
    for (py::ssize_t i = 0; i < points.shape(0); ++i)
        to[i] = cell = locator.locate(points.data() + 2 * i, weights.mutable_data() + 3 * i, close ? cell : -1);
    return py::make_tuple(found, weights);
}

void interpolate_rows(const Indices& nodes, const Doubles& weights, const Doubles& rows, Doubles out) {
    if (nodes.ndim() != 2 || weights.ndim() != 2 || rows.ndim() != 3)
        throw std::invalid_argument("nodes and weights must be arrays (points, corners), rows (count, n, columns)");
    require_same_size(weights.size(), nodes.size(), "weights");
    for (py::ssize_t i = 0; i < nodes.size(); ++i) {
        if (nodes.data()[i] < 0 || nodes.data()[i] >= rows.shape(1))
            throw std::invalid_argument("nodes name a row that is not there");
    }
    require_same_size(out.size(), rows.shape(0) * nodes.shape(0) * rows.shape(2), "out");
    const py::ssize_t width = rows.shape(2);
    const auto interpolate = width == 2   ? &restshape::interpolate_rows<2>
                             : width == 3 ? &restshape::interpolate_rows<3>
                                          : &restshape::interpolate_rows<0>;
    interpolate(nodes.data(), weights.data(), nodes.shape(0), nodes.shape(1), rows.data(), rows.shape(0), rows.shape(1),
                width, out.mutable_data());
}

std::unique_ptr<restshape::HarmonicExtension> harmonic_extension(const Doubles& X, const Indices& cells,
                                                                 const Indices& boundary,
                                                                 const std::optional<Indices>& border) {
    require_rows(X, 2, "X");
    require_rows(cells, 3, "cells");
    const auto count = [](const auto& array) { return static_cast<std::int32_t>(array.shape(0)); };
    return std::make_unique<restshape::HarmonicExtension>(
        X.data(), count(X), cells.data(), count(cells), boundary.data(), count(boundary),
        border ? border->data() : nullptr, border ? count(*border) : 0);
}

// Keeps the mesh's arrays alive beside the triangulation that works on them.
class BoundTriangulation {
 public:
    BoundTriangulation(Indices cells, Indices cell_edges, Indices edge_nodes, const Flags& fixed)
        : cells_(std::move(cells)),
          cell_edges_(std::move(cell_edges)),
          edge_nodes_(std::move(edge_nodes)),
          triangulation_(checked(fixed), cell_edges_.mutable_data(), cells_.shape(0), edge_nodes_.mutable_data(),
                         edge_nodes_.shape(0), fixed.data()) {}

    py::tuple flip_delaunay(const Doubles& X, int max_passes, double quality_floor) {
        require_rows(X, 2, "X");
        const auto flips = triangulation_.flip_delaunay(X.data(), max_passes, quality_floor);
        const auto& changed = triangulation_.changed_cells();
        return py::make_tuple(flips, Indices(static_cast<py::ssize_t>(changed.size()), changed.data()));
    }

    static Indices edge_cells(const py::object& self) {
        const auto& sides = self.cast<const BoundTriangulation&>().triangulation_.edge_cells();
        return Indices({static_cast<py::ssize_t>(sides.size()), py::ssize_t{2}},
                       reinterpret_cast<const std::int32_t*>(sides.data()), self);
    }

 private:
    std::int32_t* checked(const Flags& fixed) {
        require_rows(cells_, 3, "cells");
        require_rows(cell_edges_, 3, "cell_edges");
        require_rows(edge_nodes_, 2, "edge_nodes");
        require_same_size(cell_edges_.size(), cells_.size(), "cell_edges");
        require_same_size(fixed.size(), edge_nodes_.shape(0), "fixed");
        return cells_.mutable_data();
    }

    Indices cells_, cell_edges_, edge_nodes_;
    restshape::Triangulation triangulation_;
};

}  // namespace

void bind_mesh(py::module_& m) {
    m.def("check_cells", &check_cells, py::arg("X").noconvert(), py::arg("cells").noconvert(), "area_floor"_a,
          "quality_floor"_a,
          "Smallest quality, number of triangles with area <= area_floor, number with quality < quality_floor.");
    m.def("move_and_check", &move_and_check, py::arg("X_reference").noconvert(), py::arg("Psi").noconvert(), "c0"_a,
          "c1"_a, py::arg("X").noconvert(), py::arg("cells").noconvert(), "area_floor"_a, "quality_floor"_a,
          "check_cells after X = X_reference + c0 Psi[0] + c1 Psi[1], written in place.");
    m.def("relax_and_check", &relax_and_check, py::arg("X_reference").noconvert(), py::arg("Psi").noconvert(), "c0"_a,
          "c1"_a, py::arg("X").noconvert(), py::arg("cells").noconvert(), py::arg("edge_nodes").noconvert(),
          py::arg("fixed").noconvert(), "sweeps"_a, "area_floor"_a, "quality_floor"_a,
          "check_cells after fixed nodes went to X_reference + c0 Psi[0] + c1 Psi[1], and the others `sweeps` times to "
          "the mean of their neighbours, in place.");
    m.def("mean_value", &mean_value, py::arg("points").noconvert(), py::arg("vertices").noconvert(),
          py::arg("segments").noconvert(), py::arg("values").noconvert(),
          "Values (n, columns) at points on the left of all segments, by mean value coordinates.");
    m.def("positive_mean_value", &positive_mean_value, py::arg("points").noconvert(), py::arg("vertices").noconvert(),
          py::arg("segments").noconvert(), py::arg("values").noconvert(),
          "Values (n, columns) at points inside the segments, by positive mean value coordinates.");
    m.def("sides_gone", &sides_gone, py::arg("X").noconvert(), py::arg("Y").noconvert(), py::arg("cells").noconvert(),
          "The most sides sqrt(2 A) of a triangle that its corners go from X to Y; infinite where one has no area.");
    m.def(
        "locate", &locate, py::arg("X").noconvert(), py::arg("cells").noconvert(), py::arg("points").noconvert(),
        py::arg("close") = false,
        "Triangle and barycentric coordinates of every point; points outside are put on the nearest boundary point. Of "
        "close points the triangle of the one before is tried first.");
    m.def("interpolate_rows", &interpolate_rows, py::arg("nodes").noconvert(), py::arg("weights").noconvert(),
          py::arg("rows").noconvert(), py::arg("out").noconvert(),
          "Writes to out rows (count, points, columns) of fields from rows (count, n, columns), each point from its "
          "nodes "
          "(points, k) by its weights.");
    py::class_<restshape::HarmonicExtension>(m, "HarmonicExtension",
                                             "Carries boundary values into a mesh by Laplace's equation.")
        .def(py::init(&harmonic_extension), py::arg("X").noconvert(), py::arg("cells").noconvert(),
             py::arg("boundary").noconvert(), py::arg("border").noconvert() = py::none())
        .def("solve", &restshape::HarmonicExtension::solve, "values"_a,
             "Values (n, k) at all nodes from values (nb, k) at the boundary nodes.")
        .def("weigh", &restshape::HarmonicExtension::weigh, "field"_a,
             "Weights each triangle by the size of the gradient of a field (n, k), whose largest one it returns.")
        .def("stiffen", &restshape::HarmonicExtension::stiffen, "largest"_a,
             "Factorises again, with these weights over the largest one; equal ones where that is 0.")
        .def("complement", &restshape::HarmonicExtension::complement,
             "The Schur complement (m, m) of the border, nodes that other parts of a mesh have too.")
        .def("reduce", &restshape::HarmonicExtension::reduce, "values"_a,
             "The loads (m, k) that values (nb, k) at the boundary nodes leave for the border.")
        .def("complete", &restshape::HarmonicExtension::complete, "values"_a, "border"_a,
             "Values (n, k) at all nodes from those of the last `reduce`, and those (m, k) at the border.");
    py::class_<BoundTriangulation>(m, "Triangulation",
                                   "Delaunay flips in the arrays of a mesh; a flipped edge keeps its number.")
        .def(py::init<Indices, Indices, Indices, const Flags&>(), py::arg("cells").noconvert(),
             py::arg("cell_edges").noconvert(), py::arg("edge_nodes").noconvert(), py::arg("fixed").noconvert())
        .def("flip_delaunay", &BoundTriangulation::flip_delaunay, py::arg("X").noconvert(), "max_passes"_a,
             "quality_floor"_a = 1.0, "Number of flips and the triangles they changed, ascending.")
        .def_property_readonly("edge_cells", &BoundTriangulation::edge_cells,
                               "The two triangles (n_edges, 2) of every edge, -1 where there is none; a live view.");
}
