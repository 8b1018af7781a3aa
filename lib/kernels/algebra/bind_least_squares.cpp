// Values at the hand from those of samples around it.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <stdexcept>

#include "algebra/moving_least_squares.hpp"

namespace py = pybind11;
using Reals = py::array_t<double, py::array::c_style>;

namespace {

Reals gmls(const Reals& hand, const Reals& last, const Reals& places, double size, double epsilon2, const Reals& rows,
           Reals out) {
    const size_t count = places.ndim() == 2 ? static_cast<size_t>(places.shape(0)) : 0;
    if (hand.size() != 2 || (last.size() && last.size() != 2) || places.ndim() != 2 || places.shape(1) != 2 ||
        rows.ndim() != 2 || static_cast<size_t>(rows.shape(0)) < 1 + 3 * count || rows.shape(1) != out.size())
        throw std::invalid_argument("hand must be (2,), last (2,) or (0,), places (m, 2), rows (1 + 3 m, n), out (n,)");
    if (count < 1 || !(size > 0.0) || !(epsilon2 > 0.0))
        throw std::invalid_argument("there must be a sample, and size and epsilon2 must be above 0");
    const auto factors =
        restshape::gmls_factors(hand.data(), last.size() ? last.data() : nullptr, places.data(), count, size, epsilon2);
    restshape::combine_rows(factors, rows.data(), static_cast<size_t>(out.size()), out.mutable_data());
    Reals found(static_cast<py::ssize_t>(factors.size()));
    std::copy(factors.begin(), factors.end(), found.mutable_data());
    return found;
}

}  // namespace

void bind_least_squares(py::module_& m) {
    m.def("gmls", &gmls, py::arg("hand").noconvert(), py::arg("last").noconvert(), py::arg("places").noconvert(),
          py::arg("size"), py::arg("epsilon2"), py::arg("rows").noconvert(), py::arg("out").noconvert(),
          "Writes to out (n,) the value at a hand (2,) of the linear polynomial that fits samples best: generalised "
          "moving least squares. The rows (1 + 3 m, n) are the values at last (2,), unless that is empty, and for each "
          "of the places (m, 2) values and both derivatives; weights are 1 / (square of the distance in sizes + "
          "epsilon2). Returns the factors (1 + 3 m,) of the rows.");
}
