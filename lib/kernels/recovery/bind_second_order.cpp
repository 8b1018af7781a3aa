// Bindings for second-order triangles: validity of curved cells, recovery of stresses at nodes.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include "fem/calls.hpp"
#include "mesh/curved.hpp"
#include "recovery/quadratic.hpp"

namespace py = pybind11;
using Reals = py::array_t<double, py::array::c_style>;
using Ints = py::array_t<int32_t, py::array::c_style>;
using Chosen = py::array_t<int32_t, py::array::c_style | py::array::forcecast>;

namespace {

void require_cells(const Reals& X, const Ints& cells) {
    if (X.ndim() != 2 || X.shape(1) != 2 || cells.ndim() != 2 || cells.shape(1) != 6)
        throw std::invalid_argument("second-order triangles need X of shape (n, 2) and cells of shape (ne, 6)");
}

py::array_t<double> jacobian_bound(const Reals& X, const Ints& cells, const std::optional<Chosen>& subset) {
    require_cells(X, cells);
    const py::ssize_t count = subset ? subset->size() : cells.shape(0);
    py::array_t<double> out(count);
    for (py::ssize_t k = 0; k < count; ++k) {
        const py::ssize_t e = subset ? subset->data()[k] : k;
        if (e < 0 || e >= cells.shape(0))
            throw std::invalid_argument("subset names cell " + std::to_string(e) + ", which does not exist");
        out.mutable_data()[k] = restshape::curved_jacobian_bound(X.data(), cells.data() + 6 * e);
    }
    return out;
}

void recover_quadratic(const Reals& X, const Ints& cells, const Reals& stress, Reals out) {
    require_cells(X, cells);
    const py::ssize_t n = X.shape(0), ne = cells.shape(0);
    if (stress.size() != ne * restshape::TriRule3::points * 4 || out.ndim() != 2 || out.shape(0) != n ||
        out.shape(1) != 4)
        throw std::invalid_argument("stress must be (ne, 3, 4) and out (n, 4)");
    static restshape::Tally& tally = restshape::tallies()["recover_quadratic"];
    tally.add(restshape::Purpose::field, ne);
    restshape::QuadraticPatchRecovery(X.data(), cells.data(), stress.data(), static_cast<int>(n), static_cast<int>(ne))
        .run(out.mutable_data());
}

py::array_t<double> sample_points() {
    using Rule = restshape::TriRule3;
    py::array_t<double> out({Rule::points, 2});
    std::copy(&Rule::at[0][0], &Rule::at[0][0] + 2 * Rule::points, out.mutable_data());
    return out;
}

}  // namespace

void bind_second_order(py::module_& m) {
    m.def("curved_jacobian_bound", &jacobian_bound, py::arg("X").noconvert(), py::arg("cells").noconvert(),
          py::arg("subset") = py::none(),
          "Lower bounds (k,) of the Jacobian [m^2] of second-order triangles (ne, 6), of all or of those in subset: "
          "twice the area where sides are straight; a cell whose bound is positive is valid (Johnen et al. 2013).");
    m.def("recover_quadratic", &recover_quadratic, py::arg("X").noconvert(), py::arg("cells").noconvert(),
          py::arg("stress").noconvert(), py::arg("out").noconvert(),
          "Nodal stresses out (n, 4) of second-order triangles, recovered from stresses (ne, 3, 4) at "
          "`recovery_points` by quadratic fits over patches (Zienkiewicz and Zhu 1992).");
    m.def("recovery_points", &sample_points,
          "Reference coordinates (3, 2) at which `recover_quadratic` takes stresses.");
}
