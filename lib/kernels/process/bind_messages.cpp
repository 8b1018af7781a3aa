// Arrays as they travel in messages, one after the other in one piece of memory.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
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

// A copy in 4 bytes a number; what is not finite becomes `instead`, unless that is none itself.
Floats shortened(const Converted& values, float instead) {
    Floats found(std::vector<py::ssize_t>(values.shape(), values.shape() + values.ndim()));
    float* at = found.mutable_data();
    const double* from = values.data();
    const bool all = std::isnan(instead);
    for (py::ssize_t k = 0; k < values.size(); ++k) {
        const float one = static_cast<float>(from[k]);
        at[k] = all || std::isfinite(one) ? one : instead;
    }
    return found;
}

py::tuple sent_fields(const Converted& points, const Converted& displacement, const Converted& values) {
    constexpr double none = std::numeric_limits<double>::infinity();
    double low = none, high = -none;
    const double* from = values.data();
    for (py::ssize_t k = 0; k < values.size(); ++k)
        if (std::isfinite(from[k])) low = std::min(low, from[k]), high = std::max(high, from[k]);
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    return py::make_tuple(shortened(points, nan), shortened(displacement, 0.0f), shortened(values, nan), low, high);
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
}
