// Bindings of the rates of this machine.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stdexcept>

#include "process/rates.hpp"

namespace py = pybind11;

namespace {

using Numbers = py::array_t<double, py::array::c_style>;

double triad(Numbers a, const Numbers& b, const Numbers& c, int passes, int runs) {
    if (a.size() < 1 || a.size() != b.size() || a.size() != c.size())
        throw std::invalid_argument("a triad needs three arrays of as many numbers");
    if (passes < 1 || runs < 1) throw std::invalid_argument("a triad needs a pass and a run at least");
    return restshape::triad_seconds(a.mutable_data(), b.data(), c.data(), static_cast<size_t>(a.size()), passes, runs);
}

}  // namespace

void bind_rates(py::module_& m) {
    m.def("triad_seconds", &triad, py::arg("a").noconvert(), py::arg("b").noconvert(), py::arg("c").noconvert(),
          py::arg("passes"), py::arg("runs"),
          "Seconds of a pass a = b + s c over arrays (n,), the least of some runs of so many passes each: the triad of "
          "STREAM. s is 1 in the first pass of a run, and one more in each further one.");
    m.def(
        "flop_rate", &restshape::flop_rate, py::arg("steps") = 20000, py::arg("runs") = 20,
        "Multiplications and additions [1/s] of one core, fused and in the widest instructions that this was compiled "
        "for.");
}
