// Bindings of error estimates: distances of recovered stresses from those of cells, recovery in tetrahedra.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "fem/bounds.hpp"
#include "recovery/estimate.hpp"
#include "recovery/space_recovery.hpp"
#include "require.hpp"

namespace py = pybind11;
using Reals = py::array_t<double, py::array::c_style>;
using Ints = py::array_t<int32_t, py::array::c_style>;
using Bytes = py::array_t<uint8_t, py::array::c_style>;

namespace {

using restshape::require;

void require_nodes(const Ints& cells, py::ssize_t count) {
    require(restshape::all_within(cells.data(), cells.size(), count), "cells name nodes that do not exist");
}

template <class Visit>
auto with_shape(py::ssize_t nodes, Visit visit) {
    switch (nodes) {
        case 3:
            return visit(restshape::EstimateTri3{});
        case 6:
            return visit(restshape::EstimateTri6{});
        case 4:
            return visit(restshape::EstimateTet4{});
        case 10:
            return visit(restshape::EstimateTet10{});
        default:
            throw std::invalid_argument("cells must have 3, 6, 4 or 10 nodes");
    }
}

py::array_t<double> points(int nodes) {
    return with_shape(nodes, [](auto shape) {
        using Rule = typename decltype(shape)::Rule;
        py::array_t<double> out({Rule::points, Rule::dim});
        for (int q = 0; q < Rule::points; ++q)
            for (int a = 0; a < Rule::dim; ++a) out.mutable_at(q, a) = Rule::at[q][a];
        return out;
    });
}

std::pair<double, double> recovery_energies(const Reals& X, const Ints& cells, const Ints& rows, const Reals& nodal,
                                            const Reals& samples, const Reals& compliance, const Ints& kinds) {
    require(cells.ndim() == 2 && rows.ndim() == 2, "cells and rows must be (ne, nodes)");
    return with_shape(cells.shape(1), [&](auto shape) {
        using Shape = decltype(shape);
        const py::ssize_t ne = cells.shape(0), c = Shape::components, table = c * c;
        require(X.ndim() == 2 && X.shape(1) == Shape::dim, "X must be (n, dimension of the cells)");
        require(rows.size() == cells.size() && nodal.size() % c == 0,
                "rows must be (ne, nodes), nodal (k, components)");
        require(compliance.size() % table == 0, "compliance must be (kinds, components, components)");
        require(kinds.size() == ne || (kinds.size() == 0 && compliance.size() == table), "kinds must be (ne,)");
        const py::ssize_t sampled = ne ? samples.size() / (ne * c) : 1;
        require(samples.size() == ne * sampled * c, "samples must be (ne, m, components)");
        require(sampled == 1 || sampled == Shape::dim + 1 || sampled == Shape::points,
                "samples must be one a cell, those near its corners, or those at the points of the rule");
        require_nodes(cells, X.shape(0));
        require_nodes(rows, nodal.size() / c);
        for (py::ssize_t e = 0; e < kinds.size(); ++e)
            require(kinds.data()[e] >= 0 && kinds.data()[e] < compliance.size() / table, "a kind does not exist");
        const int32_t* kind = kinds.size() ? kinds.data() : nullptr;
        const restshape::StressOnCells on{X.data(),          cells.data(),   rows.data(),
                                          nodal.data(),      samples.data(), static_cast<int>(sampled),
                                          compliance.data(), kind,           ne};
        const restshape::Energies found = restshape::recovery_energies<Shape>(on);
        return std::make_pair(found.distance, found.size);
    });
}

void pull_back(const Reals& X, const Reals& x, const Ints& cells, const Reals& at, Reals stress) {
    require(X.ndim() == 2 && X.shape(1) == 2 && x.size() == X.size(), "X and x must be (n, 2)");
    require(cells.ndim() == 2 && at.ndim() == 2 && at.shape(1) == 2, "cells must be (ne, nodes), points (m, 2)");
    const py::ssize_t nodes = cells.shape(1), m = at.shape(0);
    require(nodes == 3 || nodes == 6, "cells must have 3 or 6 nodes");
    require(stress.size() == cells.shape(0) * m * 4, "stress must be (ne, m, 4)");
    require_nodes(cells, X.shape(0));
    double* s = stress.mutable_data();
    double Xe[12], xe[12];
    for (py::ssize_t e = 0; e < cells.shape(0); ++e) {
        for (py::ssize_t i = 0; i < nodes; ++i)
            for (int a = 0; a < 2; ++a) {
                const size_t from = 2 * static_cast<size_t>(cells.data()[e * nodes + i]) + a;
                Xe[2 * i + a] = X.data()[from];
                xe[2 * i + a] = x.data()[from];
            }
        for (py::ssize_t q = 0; q < m; ++q, s += 4) {
            if (nodes == 3)
                restshape::pull_back<restshape::EstimateTri3>(Xe, xe, at.data() + 2 * q, s);
            else
                restshape::pull_back<restshape::EstimateTri6>(Xe, xe, at.data() + 2 * q, s);
        }
    }
}

template <class Basis, class Samples>
void recover_each(const Reals& X, const Ints& cells, const Reals& stress, Reals& out) {
    using Recovery = restshape::SpaceRecovery<Basis, Samples>;
    const py::ssize_t n = X.shape(0), ne = cells.shape(0), count = out.shape(0);
    require(stress.size() == count * ne * Recovery::points * Recovery::values,
            "stress must be (k, ne, 6), or (k, ne, 4, 6) of second order");
    const Recovery recovery(X.data(), cells.data(), n, ne, stress.data(), count);
    for (py::ssize_t k = 0; k < count; ++k) recovery.write(k, out.mutable_data() + k * n * Recovery::values);
}

void recover_space(const Reals& X, const Ints& cells, const Reals& stress, Reals out) {
    require(X.ndim() == 2 && X.shape(1) == 3 && cells.ndim() == 2, "X must be (n, 3), cells (ne, 4) or (ne, 10)");
    require(cells.shape(1) == 4 || cells.shape(1) == 10, "cells must have 4 or 10 nodes");
    require(out.ndim() == 3 && out.shape(1) == X.shape(0) && out.shape(2) == 6, "out must be (k, n, 6)");
    require_nodes(cells, X.shape(0));
    if (cells.shape(1) == 4)
        recover_each<restshape::Linear<3>, restshape::TetRule1>(X, cells, stress, out);
    else
        recover_each<restshape::Quadratic<3>, restshape::TetRule4>(X, cells, stress, out);
}

// The projector onto what is normal to none of the normals at a node; false where there are none.
bool projector(const double* normals, py::ssize_t n, py::ssize_t node, Eigen::Matrix3d& P) {
    P.setIdentity();
    bool any = false;
    for (int k = 0; k < 3; ++k) {
        const Eigen::Map<const Eigen::Vector3d> normal(normals + 3 * (k * n + node));
        if (normal.isZero(0.0)) continue;
        any = true;
        const Eigen::Vector3d rest = P * normal;
        const double size = rest.norm();
        if (size >= 1e-6) P -= (rest / size) * (rest / size).transpose();
    }
    return any;
}

void remove_tractions(const Reals& normals, const Bytes& constrained, Reals nodal) {
    require(nodal.ndim() == 3 && nodal.shape(2) == 6, "nodal must be (k, n, 6)");
    const py::ssize_t n = nodal.shape(1), fields = constrained.ndim() == 2 ? constrained.shape(1) : 0;
    require(normals.ndim() == 3 && normals.shape(0) == 3 && normals.shape(1) == n && normals.shape(2) == 3,
            "normals must be (3, n, 3)");
    require(constrained.ndim() == 2 && constrained.shape(0) == n, "constrained must be (n, fields)");
    for (py::ssize_t i = 0; i < n; ++i) {
        const uint8_t* own = constrained.data() + i * fields;
        Eigen::Matrix3d P, S;
        if (std::any_of(own, own + fields, [](uint8_t one) { return one != 0; }) || !projector(normals.data(), n, i, P))
            continue;
        for (py::ssize_t k = 0; k < nodal.shape(0); ++k) {
            double* s = nodal.mutable_data() + 6 * (k * n + i);
            S << s[0], s[2], s[5], s[2], s[1], s[4], s[5], s[4], s[3];
            const Eigen::Matrix3d kept = P * S * P;
            s[0] = kept(0, 0), s[1] = kept(1, 1), s[2] = kept(0, 1);
            s[3] = kept(2, 2), s[4] = kept(2, 1), s[5] = kept(0, 2);
        }
    }
}

py::array_t<double> space_points() {
    using Rule = restshape::TetRule4;
    py::array_t<double> out({Rule::points, 3});
    std::copy(&Rule::at[0][0], &Rule::at[0][0] + 3 * Rule::points, out.mutable_data());
    return out;
}

}  // namespace

void bind_estimate(py::module_& m) {
    m.def("estimate_points", &points, py::arg("nodes"),
          "Reference coordinates (m, dim) at which `recovery_energies` takes stresses of cells with that many nodes.");
    m.def(
        "recovery_energies", &recovery_energies, py::arg("X").noconvert(), py::arg("cells").noconvert(),
        py::arg("rows").noconvert(), py::arg("nodal").noconvert(), py::arg("samples").noconvert(),
        py::arg("compliance").noconvert(), py::arg("kinds").noconvert(),
        "Integrals of d . C d and of s . C s over all cells: s are stresses of the cells, samples (ne, components), or "
        "(ne, m, components) at `estimate_points`, or at the points of recovery where they are linear; d is by how "
        "much the nodal ones, interpolated, differ. Nodes have their stresses in the rows (ne, nodes) of nodal (k, "
        "components), cells their C in compliance (kinds, "
        "components, components); 4 components in the plane, 6 in space.");
    m.def("pull_back", &pull_back, py::arg("X").noconvert(), py::arg("x").noconvert(), py::arg("cells").noconvert(),
          py::arg("points").noconvert(), py::arg("stress").noconvert(),
          "Changes Cauchy's stresses (ne, m, 4) at reference coordinates points (m, 2) to the second ones of Piola and "
          "Kirchhoff, by the displacement x (n, 2).");
    m.def("recover_space", &recover_space, py::arg("X").noconvert(), py::arg("cells").noconvert(),
          py::arg("stress").noconvert(), py::arg("out").noconvert(),
          "Nodal stresses out (k, n, 6) of tetrahedra, recovered from stresses (k, ne, 6) at their centres, or (k, ne, "
          "4, "
          "6) at `space_recovery_points` where they are of second order, by fits over the cells around each corner.");
    m.def("remove_tractions", &remove_tractions, py::arg("normals").noconvert(), py::arg("constrained").noconvert(),
          py::arg("nodal").noconvert(),
          "Replaces stresses s, nodal (k, n, 6) as xx, yy, xy, zz, yz, xz, by P s P, where P projects onto what is "
          "orthogonal to the normals (3, n, 3) of a node, of which some are 0. Nodes with a mark among constrained (n, "
          "fields) "
          "stay.");
    m.def("space_recovery_points", &space_points,
          "Reference coordinates (4, 3) at which `recover_space` takes stresses of second order.");
}
