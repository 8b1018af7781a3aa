// Bindings for fresh meshes: smoothing, orders of nodes and triangles, edges.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stdexcept>
#include <string>

#include "fem/bounds.hpp"
#include "mesh/order.hpp"
#include "mesh/relaxation.hpp"

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

using Doubles = py::array_t<double, py::array::c_style>;
using Indices = py::array_t<std::int32_t, py::array::c_style>;

std::int32_t rows_of(const py::array& array, py::ssize_t width, const char* name) {
    if (array.ndim() != 2 || array.shape(1) != width)
        throw std::invalid_argument(std::string(name) + " must be an array (n, " + std::to_string(width) + ")");
    return static_cast<std::int32_t>(array.shape(0));
}

void require_nodes(const Indices& nodes, std::int32_t count, const char* name) {
    if (!restshape::all_within(nodes.data(), nodes.size(), count))
        throw std::invalid_argument(std::string(name) + " names a node that is not there");
}

double smooth_fresh(Doubles& X, const Indices& cells, std::int32_t fixed, int sweeps) {
    const auto nodes = rows_of(X, 2, "X"), count = rows_of(cells, 3, "cells");
    require_nodes(cells, nodes, "cells");
    return restshape::smooth_fresh(X.mutable_data(), nodes, cells.data(), count, fixed, sweeps);
}

py::array_t<std::int64_t> hilbert_keys(const Doubles& points) {
    const auto keys = restshape::hilbert_keys(points.data(), rows_of(points, 2, "points"));
    return py::array_t<std::int64_t>(static_cast<py::ssize_t>(keys.size()), keys.data());
}

Indices node_order(const Doubles& X) {
    const auto nodes = rows_of(X, 2, "X");
    Indices order(static_cast<py::ssize_t>(nodes));
    restshape::node_order(X.data(), nodes, order.mutable_data());
    return order;
}

Indices cell_order(const Indices& cells, std::int32_t nodes) {
    const auto count = rows_of(cells, 3, "cells");
    require_nodes(cells, nodes, "cells");
    Indices order(static_cast<py::ssize_t>(count));
    restshape::cell_order(cells.data(), count, nodes, order.mutable_data());
    return order;
}

py::tuple edges_of_cells(const Indices& cells, std::int32_t nodes) {
    const auto count = rows_of(cells, 3, "cells");
    require_nodes(cells, nodes, "cells");
    Indices cell_edges({static_cast<py::ssize_t>(count), py::ssize_t{3}});
    const auto edges = restshape::edges_of_cells(cells.data(), count, nodes, cell_edges.mutable_data());
    const auto edge_count = static_cast<py::ssize_t>(edges.size() / 2);
    return py::make_tuple(Indices({edge_count, py::ssize_t{2}}, edges.data()), cell_edges);
}

Indices cells_left_of(const Indices& facets, const Indices& cells, std::int32_t nodes) {
    const auto facet_count = rows_of(facets, 2, "facets"), count = rows_of(cells, 3, "cells");
    require_nodes(facets, nodes, "facets");
    require_nodes(cells, nodes, "cells");
    Indices left(static_cast<py::ssize_t>(facet_count));
    restshape::cells_left_of(facets.data(), facet_count, cells.data(), count, nodes, left.mutable_data());
    return left;
}

}  // namespace

void bind_order(py::module_& m) {
    m.def("smooth_fresh", &smooth_fresh, py::arg("X").noconvert(), py::arg("cells").noconvert(), "fixed"_a, "sweeps"_a,
          "Moves nodes from `fixed` on to the mean of their neighbours, in place, such that the worst triangle gets no "
          "worse; returns its area over the sum of its squared sides before.");
    m.def("hilbert_keys", &hilbert_keys, "points"_a, "Place of each point along a Hilbert curve around all of them.");
    m.def("node_order", &node_order, "X"_a, "Nodes along a Hilbert curve.");
    m.def("cell_order", &cell_order, "cells"_a, "nodes"_a, "Triangles by their smallest node, then by the others.");
    m.def("edges_of_cells", &edges_of_cells, "cells"_a, "nodes"_a,
          "Edges of triangles, sorted, and the edge opposite to each corner.");
    m.def("cells_left_of", &cells_left_of, "facets"_a, "cells"_a, "nodes"_a,
          "The triangle to the left of each directed pair of nodes, or -1.");
}
