// Bindings of the loads that bring a motion to a new mesh.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stdexcept>

#include "elasticity/motion_loads.hpp"
#include "fem/bounds.hpp"
#include "require.hpp"

namespace py = pybind11;
using Reals = py::array_t<double, py::array::c_style>;
using Ints = py::array_t<int, py::array::c_style>;

namespace {

using restshape::require;

bool fields_of(const Reals& X, const Reals& u) { return X.ndim() == 2 && X.shape(1) == 2 && u.size() == X.size(); }

// Nodes a cell, all of which exist.
int nodes_of(const Ints& cells, py::ssize_t nodes) {
    require(cells.ndim() == 2 && (cells.shape(1) == 3 || cells.shape(1) == 6), "cells must be (ne, 3) or (ne, 6)");
    require(restshape::all_within(cells.data(), cells.size(), nodes), "cells name nodes that do not exist");
    return static_cast<int>(cells.shape(1));
}

restshape::CellPoints points_of(const Reals& at, const Reals& weights, const Ints& found, const Reals& values,
                                py::ssize_t old_cells, py::ssize_t cells, int nodes) {
    const py::ssize_t count = weights.size();
    require(count > 0 && at.size() == 2 * count, "points must be (q, 2), with as many weights");
    require(found.size() == count * cells && values.size() == nodes * found.size(),
            "found must be (ne q,), values (ne q, k)");
    require(restshape::all_within(found.data(), found.size(), old_cells), "points lie in cells that do not exist");
    return {at.data(), weights.data(), count, found.data(), values.data()};
}

// How far apart the rows of parameters are.
int stride_of(const Reals& parameters, py::ssize_t cells, py::ssize_t width) {
    if (parameters.size() == width) return 0;
    require(parameters.size() == width * cells, "parameters must be one row, or one for each cell");
    return static_cast<int>(width);
}

py::array_t<double> lacking_forces(const Reals& old_X, const Ints& old_cells, const Reals& u, const Reals& X,
                                   const Ints& cells, const Reals& start, const Reals& at, const Reals& weights,
                                   const Ints& found, const Reals& values, const Reals& moduli, const Reals& means) {
    require(fields_of(old_X, u) && fields_of(X, start), "nodes and displacements must be (n, 2)");
    const int nodes = nodes_of(old_cells, old_X.shape(0));
    require(nodes_of(cells, X.shape(0)) == nodes, "both meshes must have cells of the same order");
    const auto points = points_of(at, weights, found, values, old_cells.shape(0), cells.shape(0), nodes);
    const int stride = stride_of(moduli, cells.shape(0), 3);
    require(means.size() == 0 || means.size() == old_cells.shape(0), "means must be those of all old cells");
    const restshape::DisplacedCells old{old_X.data(), u.data(), old_cells.data(), old_cells.shape(0)};
    const restshape::DisplacedCells fresh{X.data(), start.data(), cells.data(), cells.shape(0)};
    py::array_t<double> forces({X.shape(0), py::ssize_t(2)});
    std::fill_n(forces.mutable_data(), forces.size(), 0.0);
    const auto add = nodes == 6 ? restshape::add_lacking_forces<6> : restshape::add_lacking_forces<3>;
    add(old, fresh, points, moduli.data(), stride, means.size() ? means.data() : nullptr, forces.mutable_data());
    return forces;
}

py::array_t<double> momenta(const Ints& old_cells, const Reals& v, const Reals& X, const Ints& cells, const Reals& at,
                            const Reals& weights, const Ints& found, const Reals& values, const Reals& density) {
    require(fields_of(v, v) && fields_of(X, X), "nodes and velocities must be (n, 2)");
    require(nodes_of(old_cells, v.shape(0)) == 6 && nodes_of(cells, X.shape(0)) == 6, "cells must be (ne, 6)");
    const auto points = points_of(at, weights, found, values, old_cells.shape(0), cells.shape(0), 6);
    const int stride = stride_of(density, cells.shape(0), 1);
    py::array_t<double> out({X.shape(0), py::ssize_t(2)});
    std::fill_n(out.mutable_data(), out.size(), 0.0);
    restshape::add_momenta(old_cells.data(), v.data(), X.data(), cells.data(), cells.shape(0), points, density.data(),
                           stride, out.mutable_data());
    return out;
}

}  // namespace

void bind_motion(py::module_& m) {
    m.def("lacking_forces", &lacking_forces, py::arg("old_X").noconvert(), py::arg("old_cells").noconvert(),
          py::arg("u").noconvert(), py::arg("X").noconvert(), py::arg("cells").noconvert(),
          py::arg("start").noconvert(), py::arg("at").noconvert(), py::arg("weights").noconvert(),
          py::arg("found").noconvert(), py::arg("values").noconvert(), py::arg("moduli").noconvert(),
          py::arg("means").noconvert(),
          "Nodal forces (n, 2) of the stresses, by moduli (ne or 1, 3), that the displacement `start` (n, 2) on a new "
          "mesh lacks beside u on the mesh before, by points at (q, 2) of its cells with weights that sum to 1; the "
          "points of the first cell, then of the others, were found in cells (ne q,), where the basis has values "
          "(ne q, k). Not empty: means of the dilatation over all old cells, where elements take its mean.");
    m.def("momenta", &momenta, py::arg("old_cells").noconvert(), py::arg("v").noconvert(), py::arg("X").noconvert(),
          py::arg("cells").noconvert(), py::arg("at").noconvert(), py::arg("weights").noconvert(),
          py::arg("found").noconvert(), py::arg("values").noconvert(), py::arg("density").noconvert(),
          "Integrals (n, 2) of the basis of a new mesh of second order times the momentum of velocities v of the mesh "
          "before, by mass an area (ne or 1,); points as of `lacking_forces`.");
}
