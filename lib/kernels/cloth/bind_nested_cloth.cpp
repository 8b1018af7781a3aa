// Vectors of fine cloth in the directions of the coarse cloth that it is nested in.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "require.hpp"

namespace py = pybind11;

namespace {

using Reals = py::array_t<double, py::array::c_style>;
using Nodes = py::array_t<int32_t, py::array::c_style>;
using Vector = std::array<double, 3>;

constexpr double none = 1e-300;  // length of a direction that is none

Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector unit(const Vector& a) {
    const double length = std::max(std::sqrt(dot(a, a)), none);
    return {a[0] / length, a[1] / length, a[2] / length};
}

Vector between(const double* x, int32_t from, int32_t to) {
    const double *a = x + 3 * static_cast<size_t>(from), *b = x + 3 * static_cast<size_t>(to);
    return {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
}

// Of each coarse node its place, the normal of the cloth there, and a direction along it.
std::vector<double> with_directions(const Reals& x, const Nodes& cells, const Nodes& next, const Reals& sign) {
    const auto n = static_cast<size_t>(x.shape(0));
    std::vector<Vector> normals(n, Vector{0.0, 0.0, 0.0});
    for (py::ssize_t e = 0; e < cells.shape(0); ++e) {
        const int32_t* corner = cells.data() + 3 * e;
        const Vector normal = cross(between(x.data(), corner[0], corner[1]), between(x.data(), corner[0], corner[2]));
        for (int i = 0; i < 3; ++i)
            for (int a = 0; a < 3; ++a) normals[static_cast<size_t>(corner[i])][a] += normal[a];
    }
    std::vector<double> found(9 * n);
    for (size_t i = 0; i < n; ++i) {
        const Vector normal = unit(normals[i]);
        const Vector along = unit(between(x.data(), static_cast<int32_t>(i), next.data()[i]));
        for (int a = 0; a < 3; ++a) {
            found[9 * i + a] = x.data()[3 * i + a];
            found[9 * i + 3 + a] = normal[a];
            found[9 * i + 6 + a] = sign.data()[i] * along[a];
        }
    }
    return found;
}

using restshape::require;

bool within(const Nodes& numbers, py::ssize_t count) {
    const int32_t* first = numbers.data();
    return std::all_of(first, first + numbers.size(), [count](int32_t k) { return k >= 0 && k < count; });
}

void nested_vectors(const Reals& coarse, const Nodes& cells, const Nodes& next, const Reals& sign, const Nodes& starts,
                    const Nodes& columns, const Reals& weights, const py::array_t<uint8_t, py::array::c_style>& placed,
                    const Reals& vectors, bool back, Reals out) {
    const py::ssize_t count = coarse.ndim() == 2 ? coarse.shape(0) : 0, n = starts.size() - 1;
    require(coarse.ndim() == 2 && coarse.shape(1) == 3 && cells.ndim() == 2 && cells.shape(1) == 3,
            "coarse must be (m, 3), cells (ne, 3)");
    require(next.size() == count && sign.size() == count, "next and sign must be (m,)");
    require(n >= 0 && columns.size() == weights.size() && placed.size() == n && vectors.size() == 3 * n &&
                out.size() == 3 * n,
            "placed must be (n,), vectors and out (n, 3), columns and weights as long as each other");
    require(within(cells, count) && within(next, count) && within(columns, count), "a node does not exist");
    const int32_t* start = starts.data();
    require(start[0] == 0 && std::is_sorted(start, start + n + 1) && start[n] == columns.size(), "starts do not fit");
    const std::vector<double> known = with_directions(coarse, cells, next, sign);
    const double* given = vectors.data();
    double* found = out.mutable_data();
    for (py::ssize_t i = 0; i < n; ++i, given += 3, found += 3) {
        double sum[9] = {};
        for (int32_t k = start[i]; k < start[i + 1]; ++k) {
            const double* row = known.data() + 9 * static_cast<size_t>(columns.data()[k]);
            for (int a = 0; a < 9; ++a) sum[a] += weights.data()[k] * row[a];
        }
        const Vector normal = unit({sum[3], sum[4], sum[5]}), both = {sum[6], sum[7], sum[8]};
        const double share = dot(normal, both);
        const Vector along =
            unit({both[0] - share * normal[0], both[1] - share * normal[1], both[2] - share * normal[2]});
        const Vector axes[3] = {along, cross(normal, along), normal};
        const double at = placed.data()[i] ? 1.0 : 0.0;
        for (int a = 0; a < 3; ++a)
            found[a] = back ? dot(axes[a], {given[0] - at * sum[0], given[1] - at * sum[1], given[2] - at * sum[2]})
                            : axes[0][a] * given[0] + axes[1][a] * given[1] + axes[2][a] * given[2] + at * sum[a];
    }
}

}  // namespace

void bind_nested_cloth(py::module_& m) {
    m.def("nested_vectors", &nested_vectors, py::arg("coarse").noconvert(), py::arg("cells").noconvert(),
          py::arg("next").noconvert(), py::arg("sign").noconvert(), py::arg("starts").noconvert(),
          py::arg("columns").noconvert(), py::arg("weights").noconvert(), py::arg("placed").noconvert(),
          py::arg("vectors").noconvert(), py::arg("back"), py::arg("out").noconvert(),
          "Sets out (n, 3) to vectors (n, 3) given along the cloth on cells (ne, 3) of coarse nodes (m, 3), across it "
          "and along its normal, in space, plus the place of the cloth where placed (n,) is not 0; or back. Directions "
          "and places are sums of those of coarse nodes by the rows of starts (n + 1,), columns and weights (k,). "
          "Along is to the node next (m,), times sign (m,).");
}
