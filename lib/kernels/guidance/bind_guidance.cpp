// Bindings of the search for combinations of design modes.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "guidance/force_space.hpp"

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::tuple combinations(const Doubles& K, const Doubles& h, const Doubles& e, const Doubles& low, const Doubles& high,
                       int most, int least, double least_gain, double longest,
                       const std::vector<std::vector<int>>& barred, int keep) {
    if (K.ndim() != 2) throw std::invalid_argument("K must have the shape (modes, rows)");
    const int m = static_cast<int>(K.shape(0)), rows = static_cast<int>(K.shape(1));
    for (const Doubles* a : {&h, &e, &low, &high})
        if (a->size() != rows) throw std::invalid_argument("h, e, low and high must have a number for each row");
    restshape::ForceSpace space(K.data(), h.data(), e.data(), low.data(), high.data(), m, rows, {least_gain, longest});
    for (const auto& modes : barred) space.bar(modes);
    {
        py::gil_scoped_release release;
        space.search(most, least, keep);
    }
    const auto& rays = space.rays();
    const py::ssize_t n = static_cast<py::ssize_t>(rays.size());
    py::array_t<int> modes({n, py::ssize_t{most}});
    py::array_t<double> directions({n, py::ssize_t{most}}), spans({n, py::ssize_t{2}});
    for (py::ssize_t r = 0; r < n; ++r) {
        for (int k = 0; k < most; ++k) {
            modes.mutable_at(r, k) = k < rays[r].count ? rays[r].modes[k] : -1;
            directions.mutable_at(r, k) = k < rays[r].count ? rays[r].direction[k] : 0.0;
        }
        spans.mutable_at(r, 0) = rays[r].enters, spans.mutable_at(r, 1) = rays[r].leaves;
    }
    return py::make_tuple(modes, directions, spans, space.tried());
}

}  // namespace

void bind_force_space(py::module_& m) {
    m.def("combinations", &combinations, "K"_a, "h"_a, "e"_a, "low"_a, "high"_a, "most"_a, "least"_a, "least_gain"_a,
          "longest"_a, "barred"_a, "keep"_a,
          "Modes (r, most; -1 is none), unit directions (r, most) and spans (r, 2) of the combinations that lead into "
          "the box, and how many of each size were tried. K (modes, rows) changes the forces h (rows); y minimises "
          "|K y + e|. What holds a barred combination of modes, in rising order, is left out. `keep` > 0 keeps that "
          "many of each size and leading mode, the widest.");
}
