// Bindings of bodies over a plane mesh.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include "mesh/extrude.hpp"

namespace py = pybind11;

namespace {

using Reals = py::array_t<double, py::array::c_style>;
using Ints = py::array_t<std::int32_t, py::array::c_style>;
using Chosen = py::array_t<std::int32_t, py::array::c_style | py::array::forcecast>;

void extrude_nodes(const Reals& plane, const Reals& thickness, int levels, double datum, Reals X) {
    const py::ssize_t n = thickness.size();
    if (levels < 2 || plane.size() != 2 * n || X.size() != 3 * levels * n)
        throw std::invalid_argument("plane must be (n, 2), thickness (n,), X (n * levels, 3), with two levels or more");
    restshape::extrude_nodes(plane.data(), thickness.data(), n, levels, datum, X.mutable_data());
}

void split_prisms(const Ints& plane_cells, const Ints& places, int layers, Ints cells,
                  const std::optional<Chosen>& changed) {
    const int width = plane_cells.ndim() == 2 ? static_cast<int>(plane_cells.shape(1)) : 0;
    if ((width != 3 && width != 6) || layers < 1)
        throw std::invalid_argument("plane_cells must be (ne, 3) or (ne, 6), with one layer or more");
    const restshape::PrismSplit prism(width, layers);
    const py::ssize_t all = plane_cells.size();
    const std::int32_t* nodes = plane_cells.data();
    if (std::any_of(nodes, nodes + all, [n = places.size()](std::int32_t i) { return i < 0 || i >= n; }))
        throw std::invalid_argument("places must be (n,), one a node of plane_cells");
    const py::ssize_t count = plane_cells.shape(0), block = 3 * layers * prism.nodes();
    if (cells.size() != count * block)
        throw std::invalid_argument("cells must be (3 * layers * ne, " + std::to_string(prism.nodes()) + ")");
    std::int32_t* out = cells.mutable_data();
    const py::ssize_t chosen = changed ? changed->size() : count;
    for (py::ssize_t k = 0; k < chosen; ++k) {
        const py::ssize_t e = changed ? changed->data()[k] : k;
        if (e < 0 || e >= count)
            throw std::invalid_argument("changed names cell " + std::to_string(e) + ", which does not exist");
        prism.split(nodes + width * e, places.data(), out + block * e);
    }
}

}  // namespace

void bind_extrude(py::module_& m) {
    m.def("extrude_nodes", &extrude_nodes, py::arg("plane").noconvert(), py::arg("thickness").noconvert(),
          py::arg("levels"), py::arg("datum"), py::arg("X").noconvert(),
          "Writes columns of nodes to X (n * levels, 3): z from -datum h to (1 - datum) h, h the thickness (n,) [m].");
    m.def(
        "split_prisms", &split_prisms, py::arg("plane_cells").noconvert(), py::arg("places").noconvert(),
        py::arg("layers"), py::arg("cells").noconvert(), py::arg("changed") = py::none(),
        "Writes the tetrahedra over plane cells (ne, 3 or 6), or over the changed ones alone, to cells "
        "(3 * layers * ne, 4 or 10); those of cell e begin at row 3 * layers * e. Diagonals go up from the node whose "
        "place (n,) is smaller.");
}
