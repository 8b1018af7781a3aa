// Bindings of the outline kernels.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "shape/outline_check.hpp"

namespace py = pybind11;
using namespace restshape::outline;

namespace {

using Coordinates = py::array_t<double, py::array::c_style>;
using Indices = py::array_t<std::int32_t, py::array::c_style>;
using Loops = std::vector<std::tuple<int, std::vector<int>, std::vector<bool>, int>>;

std::vector<Point> points_of(const Coordinates& array) {
    if (array.ndim() != 2 || array.shape(1) != 2) throw py::value_error("coordinates must be (n, 2)");
    std::vector<Point> points(array.shape(0));
    std::copy_n(array.data(), array.size(), reinterpret_cast<double*>(points.data()));
    return points;
}

OutlineCheck make_check(const Indices& first, const Indices& ends, const Loops& loops, double gap, double sharpest,
                        const std::vector<bool>& round, const std::vector<int>& spot_pieces) {
    if (ends.ndim() != 2 || ends.shape(1) != 2) throw py::value_error("ends must be (n_edges, 2)");
    if (first.size() != ends.shape(0) + 1) throw py::value_error("first must have one entry more than edges");
    std::vector<std::array<int, 2>> pairs(ends.shape(0));
    for (py::ssize_t e = 0; e < ends.shape(0); ++e) pairs[e] = {ends.at(e, 0), ends.at(e, 1)};
    std::vector<SampledLoop> sampled;
    for (const auto& [kind, edges, forward, piece] : loops) sampled.push_back({kind, edges, forward, piece});
    std::vector<bool> rounds(round);
    rounds.resize(pairs.size(), false);
    return {std::vector<int>(first.data(), first.data() + first.size()),
            pairs,
            sampled,
            gap,
            sharpest,
            rounds,
            spot_pieces};
}

const char* name_of(Fault fault) {
    static const char* names[] = {"none",       "resample",      "cross",        "touch",  "fold",
                                  "short",      "turned",        "outside",      "nested", "overlap",
                                  "point_near", "point_outside", "point_in_hole"};
    return names[static_cast<int>(fault)];
}

}  // namespace

void bind_outline(py::module_& m) {
    py::class_<OutlineCheck>(m, "OutlineCheck",
                             "Validity of a sampled outline along a motion that is linear in two numbers.")
        .def(py::init(&make_check), py::arg("first"), py::arg("ends"), py::arg("loops"), py::arg("gap"),
             py::arg("sharpest"), py::arg("round"), py::arg("spot_pieces"))
        .def(
            "set_motion",
            [](OutlineCheck& self, const Coordinates& p0, const Coordinates& p1, const Coordinates& p2,
               const Coordinates& e0, const Coordinates& e1, const Coordinates& e2,
               const py::array_t<std::uint8_t, py::array::c_style>& state, bool rigid) {
                if (p1.size() != p0.size() || p2.size() != p0.size() || e1.size() != e0.size() ||
                    e2.size() != e0.size())
                    throw py::value_error("positions and displacements must have the same shape");
                self.set_motion({points_of(p0), points_of(p1), points_of(p2)},
                                {points_of(e0), points_of(e1), points_of(e2)},
                                std::vector<std::uint8_t>(state.data(), state.data() + state.size()), rigid);
            },
            py::arg("p0"), py::arg("p1"), py::arg("p2"), py::arg("e0"), py::arg("e1"), py::arg("e2"), py::arg("state"),
            py::arg("rigid"))
        .def("settle", &OutlineCheck::settle, py::arg("c0"), py::arg("c1"), "The pieces suit the shape at (c0, c1).")
        .def(
            "check",
            [](OutlineCheck& self, double c0, double c1) -> py::object {
                const Finding found = self.check(c0, c1);
                if (found.fault == Fault::none) return py::none();
                return py::make_tuple(name_of(found.fault), found.i, found.j, found.at.x, found.at.y);
            },
            py::arg("c0"), py::arg("c1"), "None when valid, else (what, i, j, x, y).");
}
