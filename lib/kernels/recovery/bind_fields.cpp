// Fields on a triangle mesh: recovery at nodes, areas.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "elasticity/triangle_stress.hpp"
#include "fem/calls.hpp"
#include "fem/element.hpp"
#include "mesh/curved.hpp"
#include "recovery/patch.hpp"

namespace py = pybind11;
using Reals = py::array_t<double, py::array::c_style>;
using Ints = py::array_t<int, py::array::c_style>;

namespace {

double area(const double* X, const int* cell) {
    const double *a = X + 2 * cell[0], *b = X + 2 * cell[1], *c = X + 2 * cell[2];
    return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
}

void require_corners(const Ints& cells, const Ints& rows) {
    if (cells.ndim() != 2 || cells.shape(1) != 3 || rows.ndim() != 2 || rows.shape(1) != 3 ||
        rows.shape(0) != cells.shape(0))
        throw std::invalid_argument("cells and rows must be (ne, 3)");
}

restshape::PatchRecovery patch_recovery(const Ints& cells, const Ints& rows, int count) {
    require_corners(cells, rows);
    return {cells.data(), rows.data(), static_cast<int>(cells.shape(0)), count};
}

void follow(restshape::PatchRecovery& patches, const Ints& cells, const Ints& rows) {
    require_corners(cells, rows);
    if (cells.shape(0) != patches.cells()) throw std::invalid_argument("there must be as many cells as before");
    patches.follow(cells.data(), rows.data());
}

void require_nodes_of(const restshape::PatchRecovery& patches, const Reals& X) {
    if (X.ndim() != 2 || X.shape(1) != 2 || X.shape(0) < patches.least_nodes())
        throw std::invalid_argument("X must be (n, 2), with all nodes of the cells");
}

template <int components>
using Values = restshape::PatchRecovery::Values<components>;
using Nodes = const int32_t * [restshape::pack_lanes];
using Corners = restshape::Pack[2][3];

// A lane of packs to each of these rows of (n, 4): what is not there is 0.
template <int components>
void put(const int* rows, int count, const Values<components>& from, double* to) {
    for (int lane = 0; lane < count; ++lane)
        for (int i = 0; i < 4; ++i) to[4 * static_cast<size_t>(rows[lane]) + i] = i < components ? from[i][lane] : 0.0;
}

void count_recovery(const restshape::PatchRecovery& patches) {
    static restshape::Tally& tally = restshape::tallies()["recover"];
    tally.add(restshape::Purpose::field, patches.cells());
}

void recover(restshape::PatchRecovery& patches, const Reals& X, const Reals& stress, Reals out) {
    require_nodes_of(patches, X);
    if (stress.ndim() != 2 || stress.shape(0) != patches.cells() || stress.shape(1) != 4 || out.ndim() != 2 ||
        out.shape(0) != patches.rows() || out.shape(1) != 4)
        throw std::invalid_argument("stress must be (ne, 4) and out (rows, 4)");
    count_recovery(patches);
    const double* of = stress.data();
    double* to = out.mutable_data();
    patches.run<4>(
        X.data(), nullptr,
        [of](const int* cells, int, const Nodes&, const Corners&, Values<4>& found) {
            for (int lane = 0; lane < restshape::pack_lanes; ++lane)
                for (int i = 0; i < 4; ++i) found[i][lane] = of[4 * static_cast<size_t>(cells[lane]) + i];
        },
        [to](const int* rows, int count, const Values<4>& found) { put<4>(rows, count, found, to); });
}

// Where results go: none where an array is empty, else it has `count` numbers.
double* room(std::optional<Reals>& array, py::ssize_t count) {
    if (!array) return nullptr;
    if (array->size() != count) throw std::invalid_argument("an array has not as many numbers as there are results");
    return array->mutable_data();
}

// Where results of `recover_stresses` go; null: nowhere.
struct Recovered {
    double *energies, *of_cells, *of_rows, *equivalent;
};

// Without the last component, which is 0 in plane stress, a fit takes three quarters of the numbers.
template <int components>
void recover_stresses(restshape::PatchRecovery& patches, const restshape::Triangles& on, const Recovered& to) {
    const restshape::TriangleLoop loop(on);
    patches.run<components>(
        on.X, on.x,
        [&](const int* cells, int count, const Nodes& nodes, const Corners& corners, Values<components>& found) {
            const restshape::PackedStress own = loop.stress(nodes, corners, [cells](int lane) { return cells[lane]; });
            found[0] = own.xx, found[1] = own.yy, found[2] = own.xy;
            if constexpr (components == 4) found[3] = own.zz;
            for (int lane = 0; lane < count; ++lane) to.energies[cells[lane]] = own.energy[lane];
            if (to.of_cells) put<components>(cells, count, found, to.of_cells);
        },
        [&](const int* rows, int count, const Values<components>& found) {
            if (to.of_rows) put<components>(rows, count, found, to.of_rows);
            if (!to.equivalent) return;
            restshape::Pack all[4] = {};
            for (int i = 0; i < components; ++i) all[i] = found[i];
            const restshape::Pack own = restshape::equivalent_stress(all);
            for (int lane = 0; lane < count; ++lane) to.equivalent[rows[lane]] = own[lane];
        });
}

void recover_triangles(restshape::PatchRecovery& patches, const Reals& X, const Reals& x, const Reals& params,
                       bool plane_stress, Reals energy, std::optional<Reals> stress, std::optional<Reals> nodal,
                       std::optional<Reals> equivalent) {
    require_nodes_of(patches, X);
    const py::ssize_t ne = patches.cells(), rows = patches.rows();
    const bool each = params.ndim() == 2 && params.shape(0) == ne && params.shape(1) == 5;
    if (!each && (params.ndim() != 1 || params.size() != 5))
        throw std::invalid_argument("params must be (5,) or (ne, 5)");
    if (x.size() != X.size() || energy.size() != ne) throw std::invalid_argument("x must be (n, 2), energy (ne,)");
    const Recovered to{energy.mutable_data(), room(stress, 4 * ne), room(nodal, 4 * rows), room(equivalent, rows)};
    restshape::element("linear_elastic_tri3").tally->add(restshape::Purpose::stress, ne);
    count_recovery(patches);
    const restshape::Triangles on{X.data(), x.data(), patches.nodes(), params.data(), each ? 5 : 0, plane_stress};
    if (plane_stress)
        recover_stresses<3>(patches, on, to);
    else
        recover_stresses<4>(patches, on, to);
}

py::array_t<int> cells_around(const Ints& cells, const Ints& nodes, int node_count) {
    std::vector<uint8_t> marked(node_count, 0);
    for (py::ssize_t i = 0; i < nodes.size(); ++i) marked.at(nodes.data()[i]) = 1;
    std::vector<int> found;
    for (py::ssize_t e = 0; e < cells.shape(0); ++e) {
        bool touches = false;
        for (py::ssize_t i = 0; i < cells.shape(1); ++i)
            touches |= marked.at(cells.data()[cells.shape(1) * e + i]) != 0;
        if (touches) found.push_back(static_cast<int>(e));
    }
    return py::array_t<int>(static_cast<py::ssize_t>(found.size()), found.data());
}

// Between the chord of a side and the parabola through its middle, to the right of the way from a to b.
double area_beyond(const double* X, int a, int b, int middle) {
    const double *p = X + 2 * a, *q = X + 2 * b, *m = X + 2 * middle;
    return ((m[0] - 0.5 * (p[0] + q[0])) * (q[1] - p[1]) - (m[1] - 0.5 * (p[1] + q[1])) * (q[0] - p[0])) * 2.0 / 3.0;
}

double total_area(const Reals& X, const Ints& cells) {
    double sum = 0.0;
    if (cells.shape(1) == 3) {
        // Sums that do not wait for each other.
        constexpr int sums = 4;
        double part[sums] = {};
        const py::ssize_t whole = cells.shape(0) / sums * sums;
        for (py::ssize_t e = 0; e < whole; e += sums)
            for (int k = 0; k < sums; ++k) part[k] += area(X.data(), cells.data() + 3 * (e + k));
        for (py::ssize_t e = whole; e < cells.shape(0); ++e) part[0] += area(X.data(), cells.data() + 3 * e);
        return (part[0] + part[1]) + (part[2] + part[3]);
    }
    for (py::ssize_t e = 0; e < cells.shape(0); ++e) {
        const int* cell = cells.data() + cells.shape(1) * e;
        sum += area(X.data(), cell);
        for (int i = 0; i < 3 && cells.shape(1) == 6; ++i)
            sum += area_beyond(X.data(), cell[i], cell[(i + 1) % 3], cell[3 + i]);
    }
    return sum;
}

// Whether det F <= 0 somewhere in a straight or second-order triangle with these nodes' places.
bool inverted(const double (*P)[2], int nodes) {
    if (nodes == 3) {
        const double Q[6] = {P[0][0], P[0][1], P[1][0], P[1][1], P[2][0], P[2][1]};
        const int cell[3] = {0, 1, 2};
        return !(area(Q, cell) > 0.0);
    }
    double b[6];
    restshape::jacobian_coefficients(P, b);
    // All coefficients positive: so is the Jacobian.
    if (std::all_of(b, b + 6, [](double value) { return value > 0.0; })) return false;
    const bool numbers = std::all_of(b, b + 6, [](double value) { return std::isfinite(value); });
    return !numbers || restshape::least_jacobian(b) <= 0.0;
}

py::array_t<int> inverted_cells(const Reals& X, const Reals& u, const Ints& cells) {
    const int nodes = static_cast<int>(cells.shape(1));
    if ((nodes != 3 && nodes != 6) || X.size() != u.size() || X.shape(1) != 2)
        throw std::invalid_argument("X and u must be (n, 2), cells (ne, 3) or (ne, 6)");
    static restshape::Tally& tally = restshape::tallies()["inverted_cells"];
    tally.add(restshape::Purpose::field, cells.shape(0));
    std::vector<int> found;
    for (py::ssize_t e = 0; e < cells.shape(0); ++e) {
        double P[6][2];
        for (int i = 0; i < nodes; ++i) {
            const py::ssize_t node = cells.data()[nodes * e + i];
            for (int a = 0; a < 2; ++a) P[i][a] = X.data()[2 * node + a] + u.data()[2 * node + a];
        }
        if (inverted(P, nodes)) found.push_back(static_cast<int>(e));
    }
    return py::array_t<int>(static_cast<py::ssize_t>(found.size()), found.data());
}

bool same_bits(const Reals& a, const Reals& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), sizeof(double) * a.size()) == 0;
}

double largest_size(const Reals& a) {
    const double* value = a.data();
    const py::ssize_t count = a.size();
    double most = 0.0;
    bool numbers = true;
    for (py::ssize_t i = 0; i < count; ++i) {
        const double size = std::abs(value[i]);
        numbers &= size == size;
        most = std::max(most, size);
    }
    return numbers ? most : std::numeric_limits<double>::quiet_NaN();
}

double largest_norm(const Reals& a) {
    const double* value = a.data();
    const py::ssize_t fields = a.ndim() == 2 ? a.shape(1) : 1;
    double most = 0.0;
    bool numbers = true;
    for (const double* end = value + a.size(); value != end; value += fields) {
        double square = 0.0;
        for (py::ssize_t k = 0; k < fields; ++k) square += value[k] * value[k];
        numbers &= square == square;
        most = std::max(most, square);
    }
    return numbers ? std::sqrt(most) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

void bind_fields(py::module_& m) {
    py::class_<restshape::PatchRecovery>(
        m, "PatchRecovery",
        "Recovers nodal stresses from those of triangles by fits over patches (Zienkiewicz and Zhu 1992). Cells (ne, "
        "3) "
        "name the nodes of corners, rows (ne, 3) the rows, `count` of them, in which these have their stresses: the "
        "nodes themselves, or one a side of a border.")
        .def(py::init(&patch_recovery), py::arg("cells").noconvert(), py::arg("rows").noconvert(), py::arg("count"))
        .def("follow", &follow, py::arg("cells").noconvert(), py::arg("rows").noconvert(),
             "Takes as many cells and rows (ne, 3) that are others after flips.")
        .def("__call__", &recover, py::arg("X").noconvert(), py::arg("stress").noconvert(), py::arg("out").noconvert(),
             "Writes stresses out (count, 4) recovered from those of the cells (ne, 4), on nodes X (n, 2).")
        .def(
            "triangles", &recover_triangles, py::arg("X").noconvert(), py::arg("x").noconvert(),
            py::arg("params").noconvert(), py::arg("plane_stress"), py::arg("energy").noconvert(),
            py::arg("stress").noconvert(), py::arg("nodal").noconvert(), py::arg("equivalent").noconvert(),
            "Writes what `triangle_stress` has of the cells, energy (ne,) and stress (ne, 4), and what is recovered of "
            "the stress: nodal (count, 4), and von Mises' stress of it, equivalent (count,). Only energy cannot be "
            "None. Cells and nodes are gone through once, whatever is asked for.");
    m.def("same_bits", &same_bits, py::arg("a"), py::arg("b"),
          "Whether two arrays hold the same numbers, bit for bit.");
    m.def("largest_size", &largest_size, py::arg("a"),
          "The largest size among numbers, 0 of none; not a number where one of them is not.");
    m.def("largest_norm", &largest_norm, py::arg("a"),
          "The largest size of a row of numbers (n, f), 0 of none; not a number where one of them is not.");
    m.def("cells_around", &cells_around, py::arg("cells").noconvert(), py::arg("nodes").noconvert(),
          py::arg("node_count"), "Cells (k,), ascending, of which a corner is one of the nodes.");
    m.def("total_area", &total_area, py::arg("X").noconvert(), py::arg("cells").noconvert(),
          "Sum of the signed areas of triangles of first or second order [m^2].");
    m.def("inverted_cells", &inverted_cells, py::arg("X").noconvert(), py::arg("u").noconvert(),
          py::arg("cells").noconvert(),
          "Cells (k,) that the displacement u (n, 2) turns inside out: det F <= 0 somewhere in them.");
}
