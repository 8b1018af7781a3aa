// Bindings of the elements: their residuals, energies, stresses and derivatives on the cells of a mesh.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <stdexcept>

#include "element.hpp"
#include "operator.hpp"

namespace py = pybind11;
using restshape::Element;
using restshape::Purpose;

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Output = py::array_t<double, py::array::c_style>;
using Cells = py::array_t<int32_t, py::array::c_style | py::array::forcecast>;

void require(bool holds, const std::string& message) {
    if (!holds) throw std::invalid_argument(message);
}

// The arguments that all loops share, checked once.
struct Loop {
    Loop(const Element& e, const Doubles& X, const Doubles& x, const Cells& cells, const Doubles& params)
        : element(e), X(X.data()), x(x.data()), cells(cells.data()), parameters(params.data()) {
        require(cells.ndim() == 2 && cells.shape(1) == e.nodes,
                e.name + " needs cells of shape (ne, " + std::to_string(e.nodes) + ")");
        require(X.ndim() == 2 && X.shape(1) == e.dim, e.name + " needs X of shape (n, " + std::to_string(e.dim) + ")");
        nodes = X.shape(0);
        count = cells.shape(0);
        require(x.size() == nodes * e.fields, e.name + " needs x of shape (n, " + std::to_string(e.fields) + ")");
        const auto np = static_cast<py::ssize_t>(e.parameters.size());
        const bool each = params.ndim() == 2 && params.shape(0) == count && params.shape(1) == np;
        require(each || (params.ndim() == 1 && params.size() == np),
                e.name + " needs params of shape (" + std::to_string(np) + ",) or (ne, " + std::to_string(np) + ")");
        stride = each ? np : 0;
    }

    void require_output(const Output& out, py::ssize_t rows, py::ssize_t columns) const {
        require(
            out.size() == rows * columns && out.writeable(),
            "out must be a writeable array of shape (" + std::to_string(rows) + ", " + std::to_string(columns) + ")");
    }

    [[noreturn]] void refuse(py::ssize_t cell, int32_t node) const {
        throw std::invalid_argument("cell " + std::to_string(cell) + " names node " + std::to_string(node) +
                                    ", which does not exist");
    }

    const int32_t* gather(py::ssize_t e) {
        const int32_t* cell = cells + e * element.nodes;
        for (int i = 0; i < element.nodes; ++i) {
            if (cell[i] < 0 || cell[i] >= nodes) refuse(e, cell[i]);
            for (int a = 0; a < element.dim; ++a)
                Xe[i * element.dim + a] = X[static_cast<size_t>(cell[i]) * element.dim + a];
            for (int a = 0; a < element.fields; ++a)
                xe[i * element.fields + a] = x[static_cast<size_t>(cell[i]) * element.fields + a];
        }
        p = parameters + e * stride;
        return cell;
    }

    void scatter(const int32_t* cell, const double* r, double* out) const {
        for (int i = 0; i < element.nodes; ++i)
            for (int a = 0; a < element.fields; ++a)
                out[static_cast<size_t>(cell[i]) * element.fields + a] += r[i * element.fields + a];
    }

    const Element& element;
    const double *X, *x;
    const int32_t* cells;
    const double *parameters, *p = nullptr;
    py::ssize_t nodes, count, stride;
    alignas(64) double Xe[restshape::max_coordinates];
    alignas(64) double xe[restshape::max_unknowns];
};

// The commonest loop, with its inner counts known to the compiler for the commonest elements.
template <class Sizes>
void add_residuals(Sizes sizes, const Loop& loop, const int32_t* subset, py::ssize_t count, double* out) {
    const Element& e = loop.element;
    const int nodes = sizes.nodes(), dim = sizes.dim(), fields = sizes.fields();
    alignas(64) double X[restshape::max_coordinates], x[restshape::max_unknowns], r[restshape::max_unknowns];
    for (py::ssize_t k = 0; k < count; ++k) {
        const py::ssize_t index = subset ? subset[k] : k;
        // No text is made unless it is needed: it would cost more than the element.
        if (index < 0 || index >= loop.count)
            throw std::invalid_argument("subset names cell " + std::to_string(index) + ", which does not exist");
        const int32_t* cell = loop.cells + index * nodes;
        for (int i = 0; i < nodes; ++i) {
            if (cell[i] < 0 || cell[i] >= loop.nodes) loop.refuse(index, cell[i]);
            for (int a = 0; a < dim; ++a) X[i * dim + a] = loop.X[static_cast<size_t>(cell[i]) * dim + a];
            for (int a = 0; a < fields; ++a) x[i * fields + a] = loop.x[static_cast<size_t>(cell[i]) * fields + a];
        }
        e.residual(X, x, loop.parameters + index * loop.stride, r);
        for (int i = 0; i < nodes; ++i)
            for (int a = 0; a < fields; ++a) out[static_cast<size_t>(cell[i]) * fields + a] += r[i * fields + a];
    }
}

void residual(const Element& e, const Doubles& X, const Doubles& x, const Cells& cells, const Doubles& params,
              Output out, const std::optional<Cells>& subset) {
    const Loop loop(e, X, x, cells, params);
    loop.require_output(out, loop.nodes, e.fields);
    double* target = out.mutable_data();
    const py::ssize_t count = subset ? subset->size() : loop.count;
    e.tally->add(Purpose::residual, count);
    restshape::with_sizes(
        e, [&](auto sizes) { add_residuals(sizes, loop, subset ? subset->data() : nullptr, count, target); });
}

void design(const Element& e, const Doubles& X, const Doubles& dX, const Doubles& x, const Cells& cells,
            const Doubles& params, Output out, const std::optional<Doubles>& dx) {
    Loop loop(e, X, x, cells, params);
    require(dX.size() == X.size(), "dX must have the shape of X");
    require(!dx || dx->size() == x.size(), "dx must have the shape of x");
    e.tally->add(Purpose::design, loop.count);
    loop.require_output(out, loop.nodes, e.fields);
    double* target = out.mutable_data();
    double dXe[restshape::max_coordinates], dxe[restshape::max_unknowns], r[restshape::max_unknowns];
    for (py::ssize_t k = 0; k < loop.count; ++k) {
        const int32_t* cell = loop.gather(k);
        for (int i = 0; i < e.nodes; ++i)
            for (int a = 0; a < e.dim; ++a) dXe[i * e.dim + a] = dX.data()[static_cast<size_t>(cell[i]) * e.dim + a];
        for (int i = 0; dx && i < e.nodes; ++i)
            for (int a = 0; a < e.fields; ++a)
                dxe[i * e.fields + a] = dx->data()[static_cast<size_t>(cell[i]) * e.fields + a];
        e.design(loop.Xe, dXe, loop.xe, dx ? dxe : nullptr, loop.p, r);
        loop.scatter(cell, r, target);
    }
}

py::array_t<double> energy(const Element& e, const Doubles& X, const Doubles& x, const Cells& cells,
                           const Doubles& params) {
    Loop loop(e, X, x, cells, params);
    require(e.energy != nullptr, e.name + " has no energy");
    e.tally->add(Purpose::energy, loop.count);
    py::array_t<double> out(loop.count);
    for (py::ssize_t k = 0; k < loop.count; ++k) {
        loop.gather(k);
        out.mutable_data()[k] = e.energy(loop.Xe, loop.xe, loop.p);
    }
    return out;
}

void stress(const Element& e, const Doubles& X, const Doubles& x, const Cells& cells, const Doubles& params, Output out,
            const std::optional<Doubles>& points) {
    Loop loop(e, X, x, cells, params);
    require(e.stress != nullptr, e.name + " has no stress");
    const double centre[3] = {1.0 / (e.dim + 1), 1.0 / (e.dim + 1), 1.0 / (e.dim + 1)};
    require(!points || (points->ndim() == 2 && points->shape(1) == e.dim),
            e.name + " needs points of shape (m, " + std::to_string(e.dim) + ")");
    const double* at = points ? points->data() : centre;
    const py::ssize_t count = points ? points->shape(0) : 1;
    loop.require_output(out, loop.count, count * e.stress_components);
    e.tally->add(Purpose::stress, loop.count);
    double* target = out.mutable_data();
    for (py::ssize_t k = 0; k < loop.count; ++k) {
        loop.gather(k);
        for (py::ssize_t m = 0; m < count; ++m, target += e.stress_components)
            e.stress(loop.Xe, loop.xe, loop.p, at + m * e.dim, target);
    }
}

py::array_t<double> tangent_block(const Element& e, const Doubles& X, const Doubles& x, const Doubles& params) {
    const int n = e.unknowns();
    require(
        X.size() == e.nodes * e.dim && x.size() == n && params.size() == static_cast<py::ssize_t>(e.parameters.size()),
        e.name + " needs X (" + std::to_string(e.nodes) + ", " + std::to_string(e.dim) + "), x (" +
            std::to_string(e.nodes) + ", " + std::to_string(e.fields) + ") and " + std::to_string(e.parameters.size()) +
            " params");
    py::array_t<double> out({n, n});
    std::fill(out.mutable_data(), out.mutable_data() + n * n, 0.0);
    if (!e.residual_tangent) return out;
    alignas(64) double r[restshape::max_unknowns], K[restshape::max_tangent];
    e.residual_tangent(X.data(), x.data(), params.data(), r, K);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) out.mutable_data()[i * n + j] = K[i * e.tangent_stride + j];
    return out;
}

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

    py::class_<Element>(m, "Element", R"(An element: a shape with a law, found by its name.

X are material coordinates (n, dim) [m], x the unknowns (n, fields): the displacement [m] of solids, the position [m] of
cloth, the acceleration of masses. params is (np,) for all cells or (ne, np); `parameters` names its columns. Tangent and design derivative
come from dual numbers.)")
        .def(py::init([](const std::string& name) { return restshape::element(name); }), py::arg("name"))
        .def_readonly("name", &Element::name)
        .def_readonly("nodes", &Element::nodes, "Nodes of a cell.")
        .def_readonly("dim", &Element::dim, "Material coordinates of a node.")
        .def_readonly("fields", &Element::fields, "Unknowns of a node.")
        .def_readonly("symmetric", &Element::symmetric, "Whether the tangent is symmetric.")
        .def_readonly("stress_components", &Element::stress_components, "Columns of `stress`; 0 where there is none.")
        .def_property_readonly("has_tangent", [](const Element& e) { return e.residual_tangent != nullptr; })
        .def_property_readonly("parameters", [](const Element& e) { return py::tuple(py::cast(e.parameters)); })
        .def("residual", &residual, py::arg("X"), py::arg("x"), py::arg("cells"), py::arg("params"),
             py::arg("out").noconvert(), py::arg("subset") = py::none(),
             "Adds the residuals of all cells, or of those in subset, to out (n, fields).")
        .def("energy", &energy, py::arg("X"), py::arg("x"), py::arg("cells"), py::arg("params"),
             "Energy of each cell (ne,), whose derivative in x is the residual.")
        .def("design", &design, py::arg("X"), py::arg("dX"), py::arg("x"), py::arg("cells"), py::arg("params"),
             py::arg("out").noconvert(), py::arg("dx") = py::none(),
             "Adds (dr/dX) dX + (dr/dx) dx to out (n, fields); x is constant without dx.")
        .def("stress", &stress, py::arg("X"), py::arg("x"), py::arg("cells"), py::arg("params"),
             py::arg("out").noconvert(), py::arg("points") = py::none(),
             "Writes Cauchy stresses to out: xx yy xy zz in 2D (zz of plane strain), xx yy xy zz yz xz in 3D [Pa], of "
             "membranes "
             "the second Piola-Kirchhoff tensions xx yy xy [N/m]; at "
             "the centroids, out (ne, components), or at reference coordinates points (m, dim), out (ne, m, "
             "components).")
        .def("tangent_block", &tangent_block, py::arg("X"), py::arg("x"), py::arg("params"),
             "Tangent (nodes*fields, nodes*fields) of one cell with nodes X and unknowns x.");
}
