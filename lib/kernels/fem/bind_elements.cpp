// Bindings of the elements: their residuals, energies, stresses and derivatives on the cells of a mesh.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "fem/element.hpp"
#include "fem/operator.hpp"
#include "require.hpp"

namespace py = pybind11;
using restshape::Element;
using restshape::Pack;
using restshape::pack_lanes;
using restshape::Purpose;
using restshape::require;

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Output = py::array_t<double, py::array::c_style>;
using Cells = py::array_t<int32_t, py::array::c_style | py::array::forcecast>;

// What only some elements need: nodal coefficients (n, c), and unknowns that do not lie on the nodes of X.
struct Optional {
    const std::optional<Doubles>& coefficients;
    const std::optional<Cells>& dofs;
};

std::string shape_text(py::ssize_t rows, py::ssize_t columns) {
    return "(" + std::to_string(rows) + ", " + std::to_string(columns) + ")";
}

// The arguments that all loops share, checked once.
struct Loop {
    Loop(const Element& e, const Doubles& X, const Doubles& x, const Cells& cells, const Doubles& params,
         const Optional& optional)
        : element(e), X(X.data()), x(x.data()), cells(cells.data()), parameters(params.data()) {
        require(cells.ndim() == 2 && cells.shape(1) == e.nodes,
                e.name + " needs cells of shape (ne, " + std::to_string(e.nodes) + ")");
        require(X.ndim() == 2 && X.shape(1) == e.dim, e.name + " needs X of shape (n, " + std::to_string(e.dim) + ")");
        nodes = X.shape(0);
        count = cells.shape(0);
        set_dofs(x, optional.dofs);
        require(x.size() == dof_nodes * e.fields, e.name + " needs x of shape (n, " + std::to_string(e.fields) + ")");
        const auto np = static_cast<py::ssize_t>(e.parameters.size());
        const bool each = params.ndim() == 2 && params.shape(0) == count && params.shape(1) == np;
        require(each || (params.ndim() == 1 && params.size() == np),
                e.name + " needs params of shape (" + std::to_string(np) + ",) or (ne, " + std::to_string(np) + ")");
        stride = each ? np : 0;
        require((optional.coefficients ? optional.coefficients->size() : 0) == nodes * e.coefficient_count(),
                e.name + " needs coefficients of shape " + shape_text(nodes, e.coefficient_count()));
        if (!e.coefficients.empty()) coefficients = optional.coefficients->data();
    }

    void set_dofs(const Doubles& x, const std::optional<Cells>& given) {
        require(given || element.dof_nodes == element.nodes,
                element.name + " needs dofs of shape (ne, " + std::to_string(element.dof_nodes) + ")");
        require(!given || (given->ndim() == 2 && given->shape(0) == count && given->shape(1) == element.dof_nodes),
                element.name + " needs dofs of shape " + shape_text(count, element.dof_nodes));
        dofs = given ? given->data() : cells;
        dof_nodes = given ? x.size() / element.fields : nodes;
    }

    void require_output(const Output& out, py::ssize_t rows, py::ssize_t columns) const {
        require(out.size() == rows * columns && out.writeable(),
                "out must be a writeable array of shape " + shape_text(rows, columns));
    }

    [[noreturn]] void refuse(py::ssize_t cell, int32_t node) const {
        throw std::invalid_argument("cell " + std::to_string(cell) + " names node " + std::to_string(node) +
                                    ", which does not exist");
    }

    // One cell of a subset, and its nodes. No text is made unless it is needed: it would cost more than the element.
    void check(py::ssize_t e) const {
        if (e < 0 || e >= count)
            throw std::invalid_argument("subset names cell " + std::to_string(e) + ", which does not exist");
        for (int i = 0; i < element.nodes; ++i)
            if (const int32_t node = cells[e * element.nodes + i]; node < 0 || node >= nodes) refuse(e, node);
        if (dofs != cells) check_dofs(e);
    }

    // Dofs of an element that are not its nodes.
    void check_dofs(py::ssize_t e) const {
        const int32_t* dof = dofs + e * element.dof_nodes;
        for (int i = 0; i < element.dof_nodes; ++i)
            if (dof[i] < 0 || dof[i] >= dof_nodes) refuse(e, dof[i]);
    }

    // With inner counts that the compiler knows for the commonest elements.
    template <class Sizes>
    const int32_t* gather(Sizes sizes, py::ssize_t e) {
        const int n = sizes.nodes(), dim = sizes.dim(), m = sizes.dof_nodes(), fields = sizes.fields();
        const int32_t *cell = cells + e * n, *dof = dofs + e * m;
        for (int i = 0; i < n; ++i)
            if (cell[i] < 0 || cell[i] >= nodes) refuse(e, cell[i]);
        if (dofs != cells) check_dofs(e);
        restshape::gather(cell, n, dim, X, Xe);
        restshape::gather(dof, m, fields, x, xe);
        if (coefficients) restshape::gather(cell, n, element.coefficient_count(), coefficients, we);
        p = parameters + e * stride;
        return cell;
    }

    void scatter(py::ssize_t e, const double* r, double* out) const {
        const int32_t* dof = dofs + e * element.dof_nodes;
        for (int i = 0; i < element.dof_nodes; ++i)
            for (int a = 0; a < element.fields; ++a)
                out[static_cast<size_t>(dof[i]) * element.fields + a] += r[i * element.fields + a];
    }

    const Element& element;
    const double *X, *x, *coefficients = nullptr;
    const int32_t *cells, *dofs;
    const double *parameters, *p = nullptr;
    py::ssize_t nodes, dof_nodes, count, stride;
    alignas(64) double Xe[restshape::max_coordinates];
    alignas(64) double xe[restshape::max_unknowns];
    alignas(64) double we[restshape::max_coefficients];
};

// The commonest loop, with its inner counts known to the compiler for the commonest elements.
template <class Sizes>
void add_residuals(Sizes sizes, const Loop& loop, const int32_t* subset, py::ssize_t count, double* out) {
    const Element& e = loop.element;
    const int nodes = sizes.nodes(), dim = sizes.dim(), dof_nodes = sizes.dof_nodes(), fields = sizes.fields();
    alignas(64) double X[restshape::max_coordinates], x[restshape::max_unknowns], r[restshape::max_unknowns];
    alignas(64) double w[restshape::max_coefficients];
    for (py::ssize_t k = 0; k < count; ++k) {
        const py::ssize_t index = subset ? subset[k] : k;
        loop.check(index);
        const int32_t *cell = loop.cells + index * nodes, *dof = loop.dofs + index * dof_nodes;
        for (int i = 0; i < nodes; ++i)
            for (int a = 0; a < dim; ++a) X[i * dim + a] = loop.X[static_cast<size_t>(cell[i]) * dim + a];
        for (int i = 0; i < dof_nodes; ++i)
            for (int a = 0; a < fields; ++a) x[i * fields + a] = loop.x[static_cast<size_t>(dof[i]) * fields + a];
        if (loop.coefficients) restshape::gather(cell, nodes, e.coefficient_count(), loop.coefficients, w);
        e.residual(X, x, w, loop.parameters + index * loop.stride, r);
        for (int i = 0; i < dof_nodes; ++i)
            for (int a = 0; a < fields; ++a) out[static_cast<size_t>(dof[i]) * fields + a] += r[i * fields + a];
    }
}

// The same, several elements at once: all checks are made before.
template <class Sizes>
void add_packed_residuals(Sizes sizes, const Loop& loop, const int32_t* subset, py::ssize_t count, double* out) {
    const Element& e = loop.element;
    const int nodes = sizes.nodes(), dim = sizes.dim(), fields = sizes.fields();
    const int parameters = static_cast<int>(e.parameters.size());
    const int coefficients = e.coefficient_count();
    Pack X[restshape::max_packed], x[restshape::max_packed], w[restshape::max_coefficients];
    Pack p[restshape::max_parameters], r[restshape::max_packed];
    const int32_t *cell[pack_lanes], *dof[pack_lanes];
    double own[restshape::max_coefficients];
    for (py::ssize_t first = 0; first < count; first += pack_lanes) {
        const int filled = static_cast<int>(std::min<py::ssize_t>(pack_lanes, count - first));
        for (int lane = 0; lane < pack_lanes; ++lane) {
            // Lanes beyond the last element repeat it.
            const py::ssize_t k = first + std::min(lane, filled - 1), index = subset ? subset[k] : k;
            loop.check(index);
            cell[lane] = loop.cells + index * nodes;
            dof[lane] = loop.dofs + index * nodes;
            if (loop.stride || !first) restshape::set_lane(p, lane, loop.parameters + index * loop.stride, parameters);
        }
        restshape::gather(cell, nodes, dim, loop.X, X);
        restshape::gather(dof, nodes, fields, loop.x, x);
        if (loop.coefficients)
            for (int lane = 0; lane < pack_lanes; ++lane) {
                restshape::gather(cell[lane], nodes, coefficients, loop.coefficients, own);
                restshape::set_lane(w, lane, own, nodes * coefficients);
            }
        e.packed.residual(X, x, w, p, r);
        for (int lane = 0; lane < filled; ++lane)
            for (int i = 0; i < nodes; ++i)
                for (int a = 0; a < fields; ++a)
                    out[static_cast<size_t>(dof[lane][i]) * fields + a] += r[i * fields + a][lane];
    }
}

void residual(const Element& e, const Doubles& X, const Doubles& x, const Cells& cells, const Doubles& params,
              Output out, const std::optional<Cells>& subset, const std::optional<Doubles>& coefficients,
              const std::optional<Cells>& dofs) {
    const Loop loop(e, X, x, cells, params, {coefficients, dofs});
    loop.require_output(out, loop.dof_nodes, e.fields);
    double* target = out.mutable_data();
    const py::ssize_t count = subset ? subset->size() : loop.count;
    e.tally->add(Purpose::residual, count);
    const int32_t* list = subset ? subset->data() : nullptr;
    restshape::with_sizes(e, [&](auto sizes) {
        if constexpr (decltype(sizes)::packs)
            if (e.packed.residual) return add_packed_residuals(sizes, loop, list, count, target);
        add_residuals(sizes, loop, list, count, target);
    });
}

void design(const Element& e, const Doubles& X, const Doubles& dX, const Doubles& x, const Cells& cells,
            const Doubles& params, Output out, const std::optional<Doubles>& dx,
            const std::optional<Doubles>& coefficients, const std::optional<Doubles>& dw,
            const std::optional<Cells>& dofs) {
    Loop loop(e, X, x, cells, params, {coefficients, dofs});
    require(dX.size() == X.size(), "dX must have the shape of X");
    require(!dx || dx->size() == x.size(), "dx must have the shape of x");
    require(!dw || (coefficients && dw->size() == coefficients->size()), "dw must have the shape of coefficients");
    e.tally->add(Purpose::design, loop.count);
    loop.require_output(out, loop.dof_nodes, e.fields);
    double* target = out.mutable_data();
    double dXe[restshape::max_coordinates], dxe[restshape::max_unknowns], r[restshape::max_unknowns];
    double dwe[restshape::max_coefficients];
    for (py::ssize_t k = 0; k < loop.count; ++k) {
        const int32_t *cell = loop.gather(restshape::Sizes<0, 0, 0>(e), k), *dof = loop.dofs + k * e.dof_nodes;
        restshape::gather(cell, e.nodes, e.dim, dX.data(), dXe);
        if (dx) restshape::gather(dof, e.dof_nodes, e.fields, dx->data(), dxe);
        if (dw) restshape::gather(cell, e.nodes, e.coefficient_count(), dw->data(), dwe);
        e.design(loop.Xe, dXe, loop.xe, dx ? dxe : nullptr, loop.we, dw ? dwe : nullptr, loop.p, r);
        loop.scatter(k, r, target);
    }
}

py::array_t<double> energy(const Element& e, const Doubles& X, const Doubles& x, const Cells& cells,
                           const Doubles& params, const std::optional<Doubles>& coefficients,
                           const std::optional<Cells>& dofs) {
    Loop loop(e, X, x, cells, params, {coefficients, dofs});
    require(e.has_energy(), e.name + " has no energy");
    e.tally->add(Purpose::energy, loop.count);
    py::array_t<double> out(loop.count);
    double* target = out.mutable_data();
    restshape::with_sizes(e, [&](auto sizes) {
        for (py::ssize_t k = 0; k < loop.count; ++k) {
            loop.gather(sizes, k);
            target[k] = e.energy(loop.Xe, loop.xe, loop.we, loop.p);
        }
    });
    return out;
}

void stress(const Element& e, const Doubles& X, const Doubles& x, const Cells& cells, const Doubles& params, Output out,
            const std::optional<Doubles>& points, const std::optional<Doubles>& coefficients,
            const std::optional<Cells>& dofs) {
    Loop loop(e, X, x, cells, params, {coefficients, dofs});
    require(e.stress_components > 0, e.name + " has no stress");
    const double centre[3] = {1.0 / (e.dim + 1), 1.0 / (e.dim + 1), 1.0 / (e.dim + 1)};
    require(!points || (points->ndim() == 2 && points->shape(1) == e.dim),
            e.name + " needs points of shape (m, " + std::to_string(e.dim) + ")");
    const double* at = points ? points->data() : centre;
    const py::ssize_t count = points ? points->shape(0) : 1;
    loop.require_output(out, loop.count, count * e.stress_components);
    e.tally->add(Purpose::stress, loop.count);
    double* target = out.mutable_data();
    restshape::with_sizes(e, [&](auto sizes) {
        for (py::ssize_t k = 0; k < loop.count; ++k) {
            loop.gather(sizes, k);
            for (py::ssize_t m = 0; m < count; ++m, target += e.stress_components)
                e.stress(loop.Xe, loop.xe, loop.we, loop.p, at + m * e.dim, target);
        }
    });
}

py::array_t<double> tangent_block(const Element& e, const Doubles& X, const Doubles& x, const Doubles& params,
                                  const std::optional<Doubles>& coefficients) {
    const int n = e.unknowns(), c = e.coefficient_count();
    require(
        X.size() == e.nodes * e.dim && x.size() == n && params.size() == static_cast<py::ssize_t>(e.parameters.size()),
        e.name + " needs X " + shape_text(e.nodes, e.dim) + ", x " + shape_text(e.dof_nodes, e.fields) + " and " +
            std::to_string(e.parameters.size()) + " params");
    require((coefficients ? coefficients->size() : 0) == e.nodes * c,
            e.name + " needs coefficients of shape " + shape_text(e.nodes, c));
    py::array_t<double> out({n, n});
    std::fill(out.mutable_data(), out.mutable_data() + n * n, 0.0);
    if (!e.has_tangent()) return out;
    alignas(64) double r[restshape::max_unknowns], K[restshape::max_tangent];
    e.residual_tangent(X.data(), x.data(), coefficients ? coefficients->data() : nullptr, params.data(), r, K);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) out.mutable_data()[i * n + j] = K[i * e.tangent_stride + j];
    return out;
}

py::tuple layout(const Element& e) {
    py::list fields;
    for (const restshape::Field& field : e.layout)
        fields.append(py::make_tuple(field.name, field.nodes, field.components));
    return py::tuple(fields);
}

constexpr const char* element_doc = R"(An element: a family on a shape, found by its name.

X are material coordinates (n, dim) [m], x the unknowns (n, fields): the displacement [m] of solids, the position [m] of
cloth, the acceleration of masses. params is (np,) for all cells or (ne, np); `parameters` names its columns. Tangent and
design derivative come from dual numbers.

Cells (ne, nodes) name the nodes whose X and `coefficients` (n, c) an element reads, dofs (ne, dof_nodes) the nodes whose
unknowns it reads: the cells themselves unless given. Of an element with a `layout` an unknown is a row of x (m, 1), and
dofs name single unknowns, in the layout's order: field after field, in a field node after node.)";

}  // namespace

void bind_elements(py::module_& m) {
    m.def(
        "element_names",
        [] {
            py::list names;
            for (const Element& e : restshape::elements()) names.append(e.name);
            return names;
        },
        "Names of all elements.");

    py::class_<Element>(m, "Element", element_doc)
        .def(py::init([](const std::string& name) { return restshape::element(name); }), py::arg("name"))
        .def_readonly("name", &Element::name)
        .def_readonly("family", &Element::family, "The law or effect, such as linear_elastic.")
        .def_readonly("shape", &Element::shape, "The kind of cell, such as tri6.")
        .def_readonly("nodes", &Element::nodes, "Nodes of a cell.")
        .def_readonly("dim", &Element::dim, "Material coordinates of a node.")
        .def_readonly("dof_nodes", &Element::dof_nodes, "Columns of dofs: the nodes unless there is a layout.")
        .def_readonly("fields", &Element::fields, "Unknowns of a node.")
        .def_property_readonly("layout", &layout,
                               "Name, nodes (the first of the cell) and components of each field; empty where all "
                               "nodes have the same unknowns.")
        .def_readonly("symmetric", &Element::symmetric, "Whether the tangent is symmetric.")
        .def_readonly("stress_components", &Element::stress_components, "Columns of `stress`; 0 where there is none.")
        .def_property_readonly("has_tangent", [](const Element& e) { return e.has_tangent(); })
        .def_property_readonly("parameters", [](const Element& e) { return py::tuple(py::cast(e.parameters)); })
        .def_property_readonly(
            "coefficients", [](const Element& e) { return py::tuple(py::cast(e.coefficients)); },
            "Names of the nodal coefficients.")
        .def("residual", &residual, py::arg("X"), py::arg("x"), py::arg("cells"), py::arg("params"),
             py::arg("out").noconvert(), py::arg("subset") = py::none(), py::arg("coefficients") = py::none(),
             py::arg("dofs") = py::none(),
             "Adds the residuals of all cells, or of those in subset, to out, of the shape of x.")
        .def("energy", &energy, py::arg("X"), py::arg("x"), py::arg("cells"), py::arg("params"),
             py::arg("coefficients") = py::none(), py::arg("dofs") = py::none(),
             "Energy of each cell (ne,), whose derivative in x is the residual.")
        .def("design", &design, py::arg("X"), py::arg("dX"), py::arg("x"), py::arg("cells"), py::arg("params"),
             py::arg("out").noconvert(), py::arg("dx") = py::none(), py::arg("coefficients") = py::none(),
             py::arg("dw") = py::none(), py::arg("dofs") = py::none(),
             "Adds (dr/dX) dX + (dr/dw) dw + (dr/dx) dx to out, of the shape of x; x is constant without dx, and "
             "the coefficients w are without dw.")
        .def("stress", &stress, py::arg("X"), py::arg("x"), py::arg("cells"), py::arg("params"),
             py::arg("out").noconvert(), py::arg("points") = py::none(), py::arg("coefficients") = py::none(),
             py::arg("dofs") = py::none(),
             "Writes Cauchy stresses to out: xx yy xy zz in 2D (zz of plane strain), xx yy xy zz yz xz in 3D [Pa], of "
             "membranes "
             "the second Piola-Kirchhoff tensions xx yy xy [N/m]; at "
             "the centroids, out (ne, components), or at reference coordinates points (m, dim), out (ne, m, "
             "components).")
        .def("tangent_block", &tangent_block, py::arg("X"), py::arg("x"), py::arg("params"),
             py::arg("coefficients") = py::none(),
             "Tangent (dof_nodes*fields, dof_nodes*fields) of one cell with nodes X and unknowns x.");
}
