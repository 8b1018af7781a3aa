// Fields on a triangle mesh: recovery at nodes, areas.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stdexcept>
#include <vector>

#include "field_recovery.hpp"

namespace py = pybind11;
using Reals = py::array_t<double, py::array::c_style>;
using Ints = py::array_t<int, py::array::c_style>;

namespace {

double area(const double* X, const int* cell) {
    const double *a = X + 2 * cell[0], *b = X + 2 * cell[1], *c = X + 2 * cell[2];
    return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
}

void recover(const Reals& X, const Ints& cells, const Reals& stress, Reals out) {
    const py::ssize_t n = X.shape(0), ne = cells.shape(0);
    if (stress.shape(0) != ne || stress.shape(1) != 4 || out.shape(0) != n || out.shape(1) != 4)
        throw std::invalid_argument("stress must be (ne, 4) and out (n, 4)");
    const int stride = static_cast<int>(cells.shape(1));
    restshape::PatchRecovery(X.data(), cells.data(), stride, stress.data(), static_cast<int>(n), static_cast<int>(ne))
        .run(out.mutable_data());
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

double total_area(const Reals& X, const Ints& cells) {
    double sum = 0.0;
    for (py::ssize_t e = 0; e < cells.shape(0); ++e) sum += area(X.data(), cells.data() + cells.shape(1) * e);
    return sum;
}

}  // namespace

void bind_fields(py::module_& m) {
    m.def(
        "recover", &recover, py::arg("X").noconvert(), py::arg("cells").noconvert(), py::arg("stress").noconvert(),
        py::arg("out").noconvert(),
        "Nodal stresses (n, 4) recovered from cell stresses (ne, 4) by fits over patches (Zienkiewicz and Zhu 1992).");
    m.def("cells_around", &cells_around, py::arg("cells").noconvert(), py::arg("nodes").noconvert(),
          py::arg("node_count"), "Cells (k,), ascending, of which a corner is one of the nodes.");
    m.def("total_area", &total_area, py::arg("X").noconvert(), py::arg("cells").noconvert(),
          "Sum of the signed areas of triangles [m^2].");
}
