// Bindings of means over facets and triangles.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fem/averages.hpp"
#include "fem/bounds.hpp"

namespace py = pybind11;
using Reals = py::array_t<double, py::array::c_style>;
using Values = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Ints = py::array_t<int32_t, py::array::c_style>;

namespace {

// Calls visit(entity, weights of its nodes) for all facets (m, 2 or 3), or cells (m, 3 or 6).
template <class Visit>
void each_weighted(const Reals& X, const Ints& places, const std::string& of, Visit visit) {
    const bool facets = of == "facets";
    if (!facets && of != "cells") throw std::invalid_argument("of must be \"facets\" or \"cells\"");
    if (X.ndim() != 2 || X.shape(1) != 2) throw std::invalid_argument("X must be (n, 2)");
    const int nodes = places.ndim() == 2 ? static_cast<int>(places.shape(1)) : 0;
    if (nodes != 3 && nodes != (facets ? 2 : 6))
        throw std::invalid_argument(facets ? "facets must be (m, 2) or (m, 3)" : "cells must be (m, 3) or (m, 6)");
    if (!restshape::all_within(places.data(), places.size(), X.shape(0)))
        throw std::invalid_argument("there are nodes that do not exist");
    restshape::Place P[6];
    double w[6];
    const int32_t* node = places.data();
    for (py::ssize_t e = 0; e < places.shape(0); ++e, node += nodes) {
        for (int i = 0; i < nodes; ++i) P[i] = {X.data()[2 * size_t(node[i])], X.data()[2 * size_t(node[i]) + 1]};
        facets ? restshape::facet_weights(P, nodes, w) : restshape::cell_weights(P, nodes, w);
        visit(e, w);
    }
}

py::array_t<double> place_weights(const Reals& X, const Ints& places, const std::string& of) {
    py::array_t<double> out({places.shape(0), places.ndim() == 2 ? places.shape(1) : 0});
    double* found = out.mutable_data();
    const py::ssize_t nodes = out.shape(1);
    each_weighted(X, places, of, [&](py::ssize_t e, const double* w) { std::copy(w, w + nodes, found + e * nodes); });
    return out;
}

// A sum for each of some nodes: where they are few of all, room is taken for them alone.
class NodeSums {
 public:
    NodeSums(std::vector<int32_t> nodes, py::ssize_t all) {
        constexpr py::ssize_t few = 50;
        dense_ = few * static_cast<py::ssize_t>(nodes.size()) > all;
        if (!dense_) {
            std::sort(nodes.begin(), nodes.end());
            nodes_ = std::move(nodes);
        }
        sums_.assign(dense_ ? all : static_cast<py::ssize_t>(nodes_.size()), 0.0);
    }

    // That of a node; null where there is none.
    double* of(int32_t node) {
        if (dense_) return &sums_[node];
        const auto found = std::lower_bound(nodes_.begin(), nodes_.end(), node);
        return found != nodes_.end() && *found == node ? &sums_[found - nodes_.begin()] : nullptr;
    }

 private:
    bool dense_;
    std::vector<int32_t> nodes_;  // ascending
    std::vector<double> sums_;
};

double mean_at(const Reals& X, const Ints& places, const std::string& of, const Ints& at, const Values& values) {
    if (at.size() != values.size()) throw std::invalid_argument("there must be as many values as nodes");
    if (!restshape::all_within(at.data(), at.size(), X.shape(0)))
        throw std::invalid_argument("there are nodes that do not exist");
    NodeSums weight({at.data(), at.data() + at.size()}, X.shape(0));
    const int32_t* node = places.data();
    const py::ssize_t count = places.ndim() == 2 ? places.shape(1) : 0;
    each_weighted(X, places, of, [&](py::ssize_t e, const double* w) {
        for (py::ssize_t i = 0; i < count; ++i)
            if (double* own = weight.of(node[e * count + i])) *own += w[i];
    });
    double sum = 0.0, all = 0.0;
    for (py::ssize_t k = 0; k < at.size(); ++k) {
        const double w = *weight.of(at.data()[k]);
        sum += w * values.data()[k];
        all += w;
    }
    return sum / all;
}

}  // namespace

void bind_averages(py::module_& m) {
    m.def("place_weights", &place_weights, py::arg("X").noconvert(), py::arg("places").noconvert(), py::arg("of"),
          "Lengths [m] that stand for the nodes of \"facets\" (m, 2 or 3: both ends, middle), or areas [m^2] for those "
          "of \"cells\" (m, 3 or 6), of second order without corners; in the shape of places.");
    m.def("mean_at", &mean_at, py::arg("X").noconvert(), py::arg("places").noconvert(), py::arg("of"),
          py::arg("at").noconvert(), py::arg("values"),
          "The mean of values (k,) at nodes (k,), each counting as much as `place_weights` has of it in all places.");
}
