// Binding of the search for parts of a sheet that may come near each other.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stdexcept>

#include "cloth/near_pairs.hpp"

namespace py = pybind11;
using namespace pybind11::literals;
using restshape::NearPairs;

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Numbers = py::array_t<int32_t, py::array::c_style | py::array::forcecast>;

void require_numbers(const Numbers& part, py::ssize_t width, py::ssize_t nodes, const char* what) {
    if (part.ndim() != 2 || part.shape(1) != width) throw std::invalid_argument(what);
    for (py::ssize_t i = 0; i < part.size(); ++i)
        if (part.data()[i] < 0 || part.data()[i] >= nodes) throw std::invalid_argument("a node is out of range");
}

// The search with the number of nodes, against which positions are checked.
struct Search {
    Search(const Doubles& X, const Numbers& edges, const Numbers& cells)
        : nodes(X.shape(0)), found(made(X, edges, cells)) {}

    static NearPairs made(const Doubles& X, const Numbers& edges, const Numbers& cells) {
        if (X.ndim() != 2 || X.shape(1) != 2) throw std::invalid_argument("X must have the shape (n, 2)");
        require_numbers(edges, 2, X.shape(0), "edges must have the shape (m, 2)");
        require_numbers(cells, 3, X.shape(0), "cells must have the shape (ne, 3)");
        std::vector<int32_t> all(X.shape(0));
        for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int32_t>(i);
        return NearPairs(edges.data(), static_cast<int>(edges.shape(0)), cells.data(), static_cast<int>(cells.shape(0)),
                         all.data(), static_cast<int>(all.size()), X.data());
    }

    const restshape::Point3* points(const Doubles& x) const {
        if (x.ndim() != 2 || x.shape(0) != nodes || x.shape(1) != 3)
            throw std::invalid_argument("positions and ways must have the shape (n, 3)");
        return reinterpret_cast<const restshape::Point3*>(x.data());
    }

    py::ssize_t nodes;
    NearPairs found;
};

Numbers array_of(const NearPairs::Pairs& pairs) {
    Numbers out({static_cast<py::ssize_t>(pairs.size()), py::ssize_t{2}});
    std::copy_n(reinterpret_cast<const int32_t*>(pairs.data()), 2 * pairs.size(), out.mutable_data());
    return out;
}

py::tuple search(Search& own, const Doubles& x, double reach) {
    if (!(reach >= 0)) throw std::invalid_argument("the reach must not be negative");
    NearPairs::Pairs edge_edge, cell_node;
    own.found.search(own.points(x), reach, edge_edge, cell_node);
    return py::make_tuple(array_of(edge_edge), array_of(cell_node));
}

void sew(Search& own, const Numbers& of, const Numbers& sewn) {
    if (of.ndim() != 1 || of.shape(0) != own.nodes) throw std::invalid_argument("numbers must have the shape (n,)");
    require_numbers(sewn, 2, own.nodes, "sewn numbers must have the shape (k, 2)");
    for (py::ssize_t i = 0; i < of.size(); ++i)
        if (of.data()[i] < 0 || of.data()[i] >= own.nodes) throw std::invalid_argument("a number is out of range");
    own.found.sew(of.data(), sewn.data(), static_cast<int>(sewn.shape(0)));
}

Numbers crossed(Search& own, const Doubles& x) {
    const std::vector<int32_t> found = own.found.crossed(own.points(x));
    return Numbers(static_cast<py::ssize_t>(found.size()), found.data());
}

double share_of_step(Search& own, const Doubles& x, const Doubles& d, double reach) {
    return own.found.share_of(own.points(x), own.points(d), reach);
}

}  // namespace

void bind_near_pairs(py::module_& m) {
    py::class_<Search>(m, "NearPairs", "Finds parts of a sheet that may come near each other on a straight way.")
        .def(py::init<const Doubles&, const Numbers&, const Numbers&>(), "X"_a, "edges"_a, "cells"_a,
             "Of edges (m, 2) and triangles (ne, 3) between nodes X (n, 2) of the flat sheet.")
        .def("sew", &sew, "numbers"_a, "sewn"_a,
             "Nodes of one of the numbers (n,) are as one, and so are those of pairs (k, 2) of numbers.")
        .def(
            "search", &search, "x"_a, "reach"_a,
            "Pairs without a common node, of edges (k, 2) and of a triangle and a node (l, 2), that are within a reach "
            "[m] of each other at x (n, 3) [m]; ordered.")
        .def("crossed", &crossed, "x"_a,
             "Numbers (k,) of the triangles that edges without a common node, or sewn ones, pass through at x (n, 3) "
             "[m].")
        .def("step_share", &share_of_step, "x"_a, "d"_a, "reach"_a = 0.0,
             "The share, at most 1, of the way from x (n, 3) along d (n, 3) [m] on which no such pair meets: each that "
             "comes "
             "within the reach [m] comes nearer by nine tenths at most. Searches on that way are by what was found "
             "there.");
}
