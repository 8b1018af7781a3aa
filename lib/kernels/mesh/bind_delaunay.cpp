// Binding of the Delaunay mesher; without CGAL's headers only the news that there is none.

// CGAL's intervals change the rounding mode; before all headers, so that their functions can still be inlined.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("rounding-math")
#endif

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>

#if RESTSHAPE_CGAL
#include "mesh/delaunay.hpp"
#endif

namespace py = pybind11;
using namespace pybind11::literals;

#if RESTSHAPE_CGAL
namespace {

using Doubles = py::array_t<double, py::array::c_style>;
using Indices = py::array_t<std::int32_t, py::array::c_style>;
using Flags = py::array_t<std::uint8_t, py::array::c_style>;

template <class T>
py::array_t<T> rows(const std::vector<T>& values, py::ssize_t width) {
    return py::array_t<T>({static_cast<py::ssize_t>(values.size()) / width, width}, values.data());
}

void check(const Doubles& points, const Indices& segments, const Flags& border, const Doubles& sources) {
    if (points.ndim() != 2 || points.shape(1) != 2) throw std::invalid_argument("points must be an array (n, 2)");
    if (segments.ndim() != 2 || segments.shape(1) != 2) throw std::invalid_argument("segments must be an array (m, 2)");
    if (border.size() != segments.shape(0)) throw std::invalid_argument("border must have one flag a segment");
    if (sources.ndim() != 2 || sources.shape(1) != 4) throw std::invalid_argument("sources must be an array (k, 4)");
    for (py::ssize_t i = 0; i < segments.size(); ++i)
        if (segments.data()[i] < 0 || segments.data()[i] >= points.shape(0))
            throw std::invalid_argument("segments name a point that is not there");
    for (py::ssize_t i = 0; i < points.size(); ++i)
        if (!std::isfinite(points.data()[i])) throw restshape::MesherFailure("a point is not finite");
}

py::tuple refine_delaunay(const Doubles& points, const Indices& segments, const Flags& border, double size,
                          double growth, const Doubles& sources, double stretch, double sine_bound,
                          std::size_t patience) {
    check(points, segments, border, sources);
    std::vector<restshape::SizeSource> around(sources.shape(0));
    for (py::ssize_t i = 0; i < sources.shape(0); ++i) {
        const double* row = sources.data() + 4 * i;
        around[i] = {row[0], row[1], row[2], row[3]};
    }
    const restshape::SizeField field(size, growth, std::move(around), points.data(), points.shape(0));
    const restshape::MeshInput input{points.data(), points.shape(0), segments.data(), border.data(), segments.shape(0)};
    const auto mesh = restshape::refine_delaunay(input, field, stretch, sine_bound, patience);
    return py::make_tuple(
        rows(mesh.X, 2), rows(mesh.cells, 3),
        py::array_t<std::int32_t>(static_cast<py::ssize_t>(mesh.split_segment.size()), mesh.split_segment.data()),
        py::array_t<double>(static_cast<py::ssize_t>(mesh.split_fraction.size()), mesh.split_fraction.data()));
}

}  // namespace

void bind_mesher(py::module_& m) {
    py::register_exception<restshape::MesherFailure>(m, "MesherFailure");
    m.attr("has_cgal") = true;
    m.def("refine_delaunay", &refine_delaunay, py::arg("points").noconvert(), py::arg("segments").noconvert(),
          py::arg("border").noconvert(), "size"_a, "growth"_a, py::arg("sources").noconvert(), "stretch"_a,
          "sine_bound"_a, "patience"_a,
          "Nodes and triangles of the region left of the border segments, and the segment and the fraction along it of "
          "each node that splits one; these follow the given points. sources: x, y, size, reach.");
    m.def("mesher_items", &restshape::cgal::items_made,
          "How many items of lists the mesher has allocated, for its next meshes too; 0 where the library of C++ does "
          "not "
          "tell what they are.");
}
#else
void bind_mesher(py::module_& m) { m.attr("has_cgal") = false; }
#endif
