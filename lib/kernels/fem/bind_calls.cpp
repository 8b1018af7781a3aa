// Bindings of the counters: calls of kernels, and the matrices that exist.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "fem/calls.hpp"
#include "fem/operator.hpp"

namespace py = pybind11;

namespace {

py::dict calls() {
    py::dict all;
    for (const auto& [name, tally] : restshape::tallies()) {
        py::dict found;
        for (size_t k = 0; k < tally.counts.size(); ++k)
            if (const auto& count = tally.counts[k]; count.calls)
                found[restshape::purpose_names[k]] = py::make_tuple(count.calls, count.elements);
        if (!found.empty()) all[py::str(name)] = found;
    }
    return all;
}

void reset_calls() {
    for (auto& named : restshape::tallies()) named.second = {};
}

py::list matrices() {
    py::list all;
    for (const restshape::Operator* op : restshape::Operator::living())
        if (op->block_count()) all.append(py::make_tuple(op->nodes() * op->fields(), op->nonzeros()));
    return all;
}

}  // namespace

void bind_calls(py::module_& m) {
    m.def("calls", &calls,
          "By name of an element, or of another kernel on elements, and by purpose (residual, tangent, energy, stress, "
          "design, field): calls and elements since the start or the last `reset_calls`. Kernels without any are left "
          "out.");
    m.def("reset_calls", &reset_calls, "Sets all counts of `calls` to 0.");
    m.def("matrices", &matrices, "Rows and stored entries of this rank of each operator that has a pattern.");
}
