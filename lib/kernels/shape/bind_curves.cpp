// Bindings of kernels on curves of straight pieces, and of control points that follow a hand.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stdexcept>

#include "shape/curve_distance.hpp"

namespace py = pybind11;
using Reals = py::array_t<double, py::array::c_style>;

namespace {

Reals distances(const Reals& points, const Reals& starts, const Reals& ends) {
    for (const Reals* array : {&points, &starts, &ends})
        if (array->ndim() != 2 || array->shape(1) != 2) throw std::invalid_argument("points must be arrays (n, 2)");
    if (starts.shape(0) != ends.shape(0) || starts.shape(0) == 0)
        throw std::invalid_argument("starts and ends must be of the same number, one piece at least");
    const restshape::Pieces pieces(starts.data(), ends.data(), starts.shape(0));
    Reals out(points.shape(0));
    for (py::ssize_t i = 0; i < points.shape(0); ++i)
        out.mutable_data()[i] = pieces.distance(points.data()[2 * i], points.data()[2 * i + 1]);
    return out;
}

// Each sum is rounded, as those of whole arrays are.
[[gnu::optimize("fp-contract=off")]] Reals moved_points(const Reals& reference, const Reals& basis, double along,
                                                        double across) {
    const py::ssize_t size = reference.size();
    if (reference.ndim() != 2 || basis.size() != 2 * size)
        throw std::invalid_argument("reference must be (k, d), basis (2, k, d)");
    Reals out({reference.shape(0), reference.shape(1)});
    const double *from = reference.data(), *first = basis.data(), *second = first + size;
    double* to = out.mutable_data();
    for (py::ssize_t i = 0; i < size; ++i) to[i] = from[i] + (along * first[i] + across * second[i]);
    return out;
}

}  // namespace

void bind_curves(py::module_& m) {
    m.def("distances", &distances, py::arg("points").noconvert(), py::arg("starts").noconvert(),
          py::arg("ends").noconvert(),
          "Distances (n,) of points (n, 2) from straight pieces between starts (m, 2) and ends (m, 2).");
    m.def("moved_points", &moved_points, py::arg("reference"), py::arg("basis"), py::arg("along"), py::arg("across"),
          "Points (k, d): reference + along basis[0] + across basis[1], of a basis (2, k, d).");
}
