// Arrays as they travel in messages, one after the other in one piece of memory.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace py = pybind11;
using namespace py::literals;

namespace {

constexpr py::ssize_t aligned = 8;  // bytes

// Writes an array as numbers of a type; where it ends. Arrays of that type, or of doubles, are read as they are.
template <class T>
char* put(const py::handle& values, char* at, const char* end) {
    if (py::isinstance<py::array_t<double>>(values)) {
        const auto wide = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(values);
        const py::ssize_t size = wide.size() * static_cast<py::ssize_t>(sizeof(T));
        if (size > end - at) throw std::invalid_argument("the arrays are larger than the message");
        const double* from = wide.data();
        for (py::ssize_t k = 0; k < wide.size(); ++k) {
            const T one = static_cast<T>(from[k]);
            std::memcpy(at + k * sizeof(T), &one, sizeof(T));
        }
        return at + size;
    }
    const auto own = py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(values);
    if (!own) throw py::error_already_set();
    if (own.nbytes() > end - at) throw std::invalid_argument("the arrays are larger than the message");
    std::memcpy(at, own.data(), own.nbytes());
    return at + own.nbytes();
}

py::bytes packed(const py::list& arrays, py::ssize_t size) {
    py::bytes whole(nullptr, size);
    char* at = PyBytes_AS_STRING(whole.ptr());
    const char *begin = at, *end = at + size;
    for (const py::handle& one : arrays) {
        const py::array values = py::reinterpret_borrow<py::array>(one);
        if (values.dtype().kind() == 'f')
            at = put<float>(one, at, end);
        else if (py::isinstance<py::array_t<std::uint16_t>>(one))
            at = put<std::uint16_t>(one, at, end);
        else
            at = put<std::uint32_t>(one, at, end);
        const py::ssize_t room = -(at - begin) & (aligned - 1);
        if (room > end - at) throw std::invalid_argument("the arrays are larger than the message");
        std::memset(at, 0, room);
        at += room;
    }
    if (at != end) throw std::invalid_argument("the arrays are smaller than the message");
    return whole;
}

using Converted = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Floats = py::array_t<float, py::array::c_style>;

// A copy in 4 bytes a number; of one that is drawn, 0 for what is not finite.
template <bool drawn>
Floats shortened(const Converted& values) {
    Floats found(std::vector<py::ssize_t>(values.shape(), values.shape() + values.ndim()));
    float* at = found.mutable_data();
    const double* from = values.data();
    const py::ssize_t count = values.size();
    for (py::ssize_t k = 0; k < count; ++k) {
        const float one = static_cast<float>(from[k]);
        at[k] = !drawn || std::abs(one) <= std::numeric_limits<float>::max() ? one : 0.0f;
    }
    return found;
}

constexpr double infinite = std::numeric_limits<double>::infinity();

// The least and the largest of numbers; comparisons with those that are none do not hold.
std::pair<double, double> extremes(const double* values, py::ssize_t count) {
    constexpr py::ssize_t beside = 8;  // that compilers put into registers
    double low[beside], high[beside];
    std::fill_n(low, beside, infinite), std::fill_n(high, beside, -infinite);
    const auto take = [&](py::ssize_t k, py::ssize_t lane) {
        low[lane] = values[k] < low[lane] ? values[k] : low[lane];
        high[lane] = values[k] > high[lane] ? values[k] : high[lane];
    };
    py::ssize_t k = 0;
    for (; k + beside <= count; k += beside)
        for (py::ssize_t lane = 0; lane < beside; ++lane) take(k + lane, lane);
    for (; k < count; ++k) take(k, 0);
    return {*std::min_element(low, low + beside), *std::max_element(high, high + beside)};
}

// The same of those that are finite.
std::pair<double, double> finite_extremes(const Converted& values) {
    const double* from = values.data();
    auto found = extremes(from, values.size());
    if (found.first > -infinite && found.second < infinite) return found;
    found = {infinite, -infinite};
    for (py::ssize_t k = 0; k < values.size(); ++k)
        if (std::isfinite(from[k])) found = {std::min(found.first, from[k]), std::max(found.second, from[k])};
    return found;
}

py::tuple sent_fields(const Converted& points, const Converted& displacement, const Converted& values) {
    const auto [low, high] = finite_extremes(values);
    return py::make_tuple(shortened<false>(points), shortened<true>(displacement), shortened<false>(values), low, high);
}

using EdgeEnds = py::array_t<std::int32_t, py::array::c_style | py::array::forcecast>;
using EdgeShares = py::array_t<std::complex<double>, py::array::c_style | py::array::forcecast>;

py::tuple sent_outline(const Converted& controls, const EdgeEnds& ends, const EdgeShares& shares,
                       py::ssize_t vertices) {
    const py::ssize_t count = controls.shape(0), m = shares.size();
    if (controls.ndim() != 2 || controls.shape(1) != 2 || ends.size() != 2 * m || vertices < 0 || vertices > count)
        throw std::invalid_argument("control points, ends and shares do not belong together");
    Floats lines(std::vector<py::ssize_t>{m, 2}), dots(std::vector<py::ssize_t>{vertices, 2});
    const double* at = controls.data();
    const std::int32_t *first = ends.data(), *last = first + m;
    float* to = lines.mutable_data();
    for (py::ssize_t k = 0; k < m; ++k) {
        if (first[k] < 0 || last[k] < 0 || first[k] >= count || last[k] >= count)
            throw std::invalid_argument("an edge ends at no control point");
        const double *a = at + 2 * first[k], *b = at + 2 * last[k], x = b[0] - a[0], y = b[1] - a[1];
        const double along = shares.data()[k].real(), aside = shares.data()[k].imag();
        to[2 * k] = static_cast<float>(a[0] + (along * x - aside * y));
        to[2 * k + 1] = static_cast<float>(a[1] + (along * y + aside * x));
    }
    std::transform(at, at + 2 * vertices, dots.mutable_data(), [](double one) { return static_cast<float>(one); });
    return py::make_tuple(lines, dots);
}

}  // namespace

void bind_messages(py::module_& m) {
    m.def(
        "packed", &packed, "arrays"_a, "size"_a,
        "Arrays one after the other in a text of `size` bytes, each from a multiple of 8 bytes on: floating numbers in "
        "4 bytes, integers of 2 bytes as they are, others without sign in 4.");
    m.def(
        "sent_fields", &sent_fields, "points"_a, "displacement"_a, "values"_a,
        "Copies in 4 bytes a number, with 0 for displacements that are not finite; and the least and the largest value "
        "that is, infinite without any.");
    m.def("sent_outline", &sent_outline, "controls"_a, "ends"_a, "shares"_a, "vertices"_a,
          "Points (m, 2) on the edges of control points (k, 2), in 4 bytes a number: of the way between two `ends` (2, "
          "m) "
          "the complex `shares` (m,), turned about the first; and so many first control points, which are vertices.");
}
