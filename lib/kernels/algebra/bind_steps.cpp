// What a time step makes of the state before it, each in one pass, rounded as the sums of whole arrays would be.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <vector>

#include "algebra/ridge.hpp"

#pragma GCC optimize("fp-contract=off")

namespace py = pybind11;
using Reals = py::array_t<double, py::array::c_style>;

void restshape::solve_with_ridge(const double* gram, const double* products, std::ptrdiff_t k, double ridge,
                                 double* weights) {
    const std::ptrdiff_t wide = k + 1;
    std::vector<double> rows(k * wide);
    double trace = 0.0;
    for (std::ptrdiff_t i = 0; i < k; ++i) {
        for (std::ptrdiff_t j = 0; j < k; ++j) rows[i * wide + j] = gram[i * k + j];
        rows[i * wide + k] = products[i];
        trace += rows[i * wide + i];
    }
    const double shift = ridge * trace;
    std::fill(weights, weights + k, 0.0);
    if (shift == 0.0) return;
    for (std::ptrdiff_t i = 0; i < k; ++i) rows[i * wide + i] += shift;
    for (std::ptrdiff_t i = 0; i < k; ++i)
        for (std::ptrdiff_t below = i + 1; below < k; ++below) {
            const double factor = rows[below * wide + i] / rows[i * wide + i];
            for (std::ptrdiff_t j = i + 1; j < wide; ++j) rows[below * wide + j] -= factor * rows[i * wide + j];
        }
    for (std::ptrdiff_t i = k; i-- > 0;) {
        double rest = 0.0;
        for (std::ptrdiff_t j = i + 1; j < k; ++j) rest += rows[i * wide + j] * weights[j];
        weights[i] = (rows[i * wide + k] - rest) / rows[i * wide + i];
    }
}

namespace {

void ridge_weights(const Reals& gram, const Reals& products, double ridge, Reals out) {
    const py::ssize_t k = gram.ndim() == 2 ? gram.shape(0) : -1;
    if (k < 0 || gram.shape(1) != k || products.size() < k || out.size() != k)
        throw std::invalid_argument("gram must be (k, k), products (k,) or longer, out (k,)");
    restshape::solve_with_ridge(gram.data(), products.data(), k, ridge, out.mutable_data());
}

// Weights of unknowns, rates and rates of rates in what a matrix is applied to.
struct Weights {
    double y, v, a;
};

void weigh(const Weights& weights, const Reals& y, const Reals& v, const std::optional<Reals>& a, double* out) {
    const py::ssize_t count = y.size();
    const double *of_y = y.data(), *of_v = v.data();
    if (weights.v == 0.0)
        for (py::ssize_t i = 0; i < count; ++i) out[i] = of_y[i] * weights.y;
    else
        for (py::ssize_t i = 0; i < count; ++i) out[i] = of_y[i] * weights.y + weights.v * of_v[i];
    if (!a) return;
    const double* of_a = a->data();
    for (py::ssize_t i = 0; i < count; ++i) out[i] += weights.a * of_a[i];
}

void weigh_state(const Reals& y, const Reals& v, const std::optional<Reals>& a, const std::vector<double>& weights,
                 const Reals& base, Reals stiff, Reals inert) {
    const py::ssize_t count = y.size(), fields = y.ndim() == 2 ? y.shape(1) : 0;
    if (fields == 0 || v.size() != count || (a && a->size() != count) || stiff.size() != count ||
        inert.size() != count || base.size() != fields || weights.size() != 6)
        throw std::invalid_argument("y, v, a, stiff and inert must be (n, f), base (f,), weights six numbers");
    weigh({weights[0], weights[1], weights[2]}, y, v, a, stiff.mutable_data());
    double* to = inert.mutable_data();
    weigh({weights[3], weights[4], weights[5]}, y, v, a, to);
    for (py::ssize_t i = 0; i < count; i += fields)
        for (py::ssize_t c = 0; c < fields; ++c) to[i + c] -= base.data()[c];
}

Reals rates_after(const Reals& y, const Reals& before, const Reals& v, double of_change, double of_rate) {
    const py::ssize_t count = y.size();
    if (y.ndim() != 2 || before.size() != count || v.size() != count)
        throw std::invalid_argument("y, before and v must be (n, f)");
    Reals out({y.shape(0), y.shape(1)});
    double* to = out.mutable_data();
    const double *now = y.data(), *then = before.data(), *rate = v.data();
    for (py::ssize_t i = 0; i < count; ++i) to[i] = of_change * (now[i] - then[i]) - of_rate * rate[i];
    return out;
}

}  // namespace

void bind_steps(py::module_& m) {
    m.def("ridge_weights", &ridge_weights, py::arg("gram").noconvert(), py::arg("products").noconvert(),
          py::arg("ridge"), py::arg("out").noconvert(),
          "Writes weights w (k,) of (gram + ridge trace(gram)) w = products, 0 where gram (k, k) has no trace.");
    m.def("weigh_state", &weigh_state, py::arg("y"), py::arg("v"), py::arg("a"), py::arg("weights"), py::arg("base"),
          py::arg("stiff").noconvert(), py::arg("inert").noconvert(),
          "Writes the sums stiff and inert (n, f) of y, v and a (n, f; None: none), with three of the six weights "
          "each, less the base's (f,) in every row of inert.");
    m.def("rates_after", &rates_after, py::arg("y"), py::arg("before"), py::arg("v"), py::arg("of_change"),
          py::arg("of_rate"), "The rates (n, f) of_change (y - before) - of_rate v.");
}
