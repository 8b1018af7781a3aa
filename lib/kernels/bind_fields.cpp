// Fields on a triangle mesh: recovery at nodes, areas.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace py = pybind11;
using Reals = py::array_t<double, py::array::c_style>;
using Ints = py::array_t<int, py::array::c_style>;

namespace {

double area(const double* X, const int* cell) {
    const double *a = X + 2 * cell[0], *b = X + 2 * cell[1], *c = X + 2 * cell[2];
    return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
}

void nodal_average(const Reals& X, const Ints& cells, const Reals& values, Reals out) {
    const py::ssize_t n = X.shape(0), ne = cells.shape(0), nn = cells.shape(1), k = values.shape(1);
    if (values.shape(0) != ne || out.shape(0) != n || out.shape(1) != k) throw std::invalid_argument("shapes do not agree");
    double* o = out.mutable_data();
    std::fill(o, o + n * k, 0.0);
    std::vector<double> weight(n, 0.0);
    for (py::ssize_t e = 0; e < ne; ++e) {
        const int* cell = cells.data() + nn * e;
        const double w = std::abs(area(X.data(), cell));
        for (py::ssize_t i = 0; i < nn; ++i) {
            weight[cell[i]] += w;
            for (py::ssize_t j = 0; j < k; ++j) o[k * cell[i] + j] += w * values.data()[k * e + j];
        }
    }
    for (py::ssize_t i = 0; i < n; ++i)
        if (weight[i] > 0.0)
            for (py::ssize_t j = 0; j < k; ++j) o[k * i + j] /= weight[i];
}

double total_area(const Reals& X, const Ints& cells) {
    double sum = 0.0;
    for (py::ssize_t e = 0; e < cells.shape(0); ++e) sum += area(X.data(), cells.data() + cells.shape(1) * e);
    return sum;
}

}  // namespace

void bind_fields(py::module_& m) {
    m.def("nodal_average", &nodal_average, py::arg("X").noconvert(), py::arg("cells").noconvert(),
          py::arg("values").noconvert(), py::arg("out").noconvert(),
          "Means (n, k) of cell values (ne, k) over the cells around each node, weighted with the cells' areas.");
    m.def("total_area", &total_area, py::arg("X").noconvert(), py::arg("cells").noconvert(),
          "Sum of the signed areas of triangles [m^2].");
}
