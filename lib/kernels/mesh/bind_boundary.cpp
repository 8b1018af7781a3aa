// Bindings for the spacing of nodes along an outline.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stdexcept>

#include "mesh/boundary.hpp"
#include "require.hpp"

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

using Reals = py::array_t<double, py::array::c_style>;
using Ints = py::array_t<std::int32_t, py::array::c_style>;
using Flags = py::array_t<std::uint8_t, py::array::c_style>;

Reals as_array(const std::vector<double>& values) {
    return Reals(static_cast<py::ssize_t>(values.size()), values.data());
}

using restshape::require;

Reals narrow_widths(const Reals& points, const Reals& arc, const Ints& first, const Ints& ends, const Flags& straight,
                    const Reals& side, double reach, double fold) {
    const py::ssize_t edges = first.size() - 1;
    require(edges >= 0 && ends.size() == 2 * edges && straight.size() == edges && side.size() == edges,
            "first, ends, straight and side must be of the same edges");
    require(first.data()[0] == 0 && points.size() == 2 * arc.size() && first.data()[edges] == arc.size(),
            "points and arc must have a row a sample");
    for (py::ssize_t e = 0; e < edges; ++e)
        require(first.data()[e + 1] >= first.data()[e] + 2, "each edge needs two samples");
    const restshape::BoundarySamples samples{points.data(),
                                             arc.data(),
                                             first.data(),
                                             ends.data(),
                                             straight.data(),
                                             side.data(),
                                             static_cast<std::int32_t>(edges)};
    return as_array(restshape::NarrowPlaces(samples, reach, fold).widths());
}

void grade_sizes(const Reals& points, Reals& size, double growth, double coarsest) {
    require(points.size() == 2 * size.size(), "points and size must have a row a sample");
    const auto count = static_cast<std::int32_t>(size.size());
    restshape::grade_sizes(points.data(), size.mutable_data(), count, growth, coarsest);
}

Reals edge_parameters(const Reals& s, const Reals& arc, const Reals& size, const Reals& stops, int fewest) {
    require(s.size() >= 2 && arc.size() == s.size() && size.size() == s.size(),
            "s, arc and size must have a row a sample, and two at least");
    return as_array(restshape::edge_parameters(s.data(), arc.data(), size.data(), static_cast<std::int32_t>(s.size()),
                                               stops.data(), static_cast<std::int32_t>(stops.size()), fewest));
}

}  // namespace

void bind_boundary(py::module_& m) {
    m.def("narrow_widths", &narrow_widths, py::arg("points").noconvert(), py::arg("arc").noconvert(),
          py::arg("first").noconvert(), py::arg("ends").noconvert(), py::arg("straight").noconvert(),
          py::arg("side").noconvert(), "reach"_a, "fold"_a,
          "Width of the material at each sample of the edges of an outline, infinite where wider than the reach.");
    m.def("grade_sizes", &grade_sizes, py::arg("points").noconvert(), py::arg("size").noconvert(), "growth"_a,
          "coarsest"_a, "Shortens sizes around all samples where they are below the coarsest, in place.");
    m.def("edge_parameters", &edge_parameters, py::arg("s").noconvert(), py::arg("arc").noconvert(),
          py::arg("size").noconvert(), py::arg("stops").noconvert(), "fewest"_a,
          "Parameters of the nodes inside an edge, at equal steps of length over size between stops.");
}
