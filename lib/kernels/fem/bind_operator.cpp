// Bindings of the operator: topology, constraints, values, and the PETSc matrix for petsc4py.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "fem/operator.hpp"
#include "require.hpp"

namespace py = pybind11;
using restshape::Block;
using restshape::Element;
using restshape::Operator;
using restshape::require;

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Output = py::array_t<double, py::array::c_style>;
using Indices = py::array_t<int32_t, py::array::c_style | py::array::forcecast>;

using HeldCells = py::array_t<int32_t, py::array::c_style>;

HeldCells held(py::handle item) {
    // A converted copy would not see the flips of the mesh.
    require(py::isinstance<HeldCells>(item), "cells must be C-contiguous int32 arrays: they are held, not copied");
    auto cells = py::reinterpret_borrow<HeldCells>(item);
    require(cells.ndim() == 2, "cells must have the shape (ne, nodes)");
    return cells;
}

void set_topology(Operator& op, const py::list& arrays) {
    std::vector<Block> blocks;
    for (py::handle item : arrays) {
        const bool pair = py::isinstance<py::tuple>(item);
        require(!pair || py::len(item) == 2, "a block is an array of cells, or a tuple (geometry, dofs)");
        const auto given = pair ? py::reinterpret_borrow<py::tuple>(item) : py::make_tuple(item, item);
        auto arrays = std::make_shared<std::pair<HeldCells, HeldCells>>(held(given[0]), held(given[1]));
        const auto& [geometry, dofs] = *arrays;
        require(geometry.shape(0) == dofs.shape(0), "geometry and dofs must have a row for each element");
        Block b;
        b.geometry = geometry.data();
        b.dofs = dofs.data();
        b.count = static_cast<int>(dofs.shape(0));
        b.nodes = static_cast<int>(geometry.shape(1));
        b.dof_nodes = static_cast<int>(dofs.shape(1));
        b.owner = std::move(arrays);
        blocks.push_back(std::move(b));
    }
    op.set_topology(std::move(blocks));
}

void patch(Operator& op, int block, const Indices& changed) {
    op.patch(block, changed.data(), static_cast<int>(changed.size()));
}

void set_constraints(Operator& op, const py::array_t<uint8_t, py::array::c_style | py::array::forcecast>& mask) {
    require(mask.size() == static_cast<py::ssize_t>(op.nodes()) * op.fields(),
            "mask must have an entry for each of the " + std::to_string(op.nodes()) + " nodes times " +
                std::to_string(op.fields()) + " fields");
    op.set_constraints(mask.data());
}

void set_sliding(Operator& op, const Indices& list, const Doubles& kept) {
    require(kept.size() == 3 * list.size(), "sliding nodes need xx, xy and yy of a projection each");
    op.set_sliding(list.data(), static_cast<int>(list.size()), kept.data());
}

// A term as Python gives it: its arrays stay alive through the tuple.
restshape::Term term_of(const Operator& op, const Element& e, const Doubles& x, const Doubles& params, double coef,
                        double residual_coef, const Doubles& coefficients, py::ssize_t rows, py::ssize_t count) {
    const py::ssize_t n = op.nodes(), np = static_cast<py::ssize_t>(e.parameters.size());
    require(x.size() == n * e.fields,
            e.name + " needs x of shape (" + std::to_string(n) + ", " + std::to_string(e.fields) + ")");
    const bool each = params.ndim() == 2 && params.shape(0) == count && params.shape(1) == np;
    require(each || (params.ndim() == 1 && params.size() == np),
            e.name + " needs params of shape (" + std::to_string(np) + ",) or (" + std::to_string(count) + ", " +
                std::to_string(np) + ")");
    require(coefficients.size() == (e.coefficients.empty() ? 0 : rows * e.coefficient_count()),
            e.name + " needs coefficients of shape (" + std::to_string(rows) + ", " +
                std::to_string(e.coefficient_count()) + ")");
    const double* w = e.coefficients.empty() ? nullptr : coefficients.data();
    return {&e, x.data(), w, params.data(), each ? static_cast<int>(np) : 0, coef, residual_coef};
}

// Adds the terms of a block. Of a sum each tuple has the block before its element and X behind it, `skipped` items.
void add_terms(Operator& op, int block, const Doubles& X, const std::vector<py::tuple>& parts, size_t skipped,
               std::optional<Output>& rhs, const std::optional<Indices>& subset) {
    const Block& b = op.block(block);
    const py::ssize_t count = subset ? subset->size() : b.count;
    restshape::Terms terms{X.data(), rhs ? rhs->mutable_data() : nullptr, {}};
    if (subset) {
        if (!count) return;
        terms.subset = subset->data();
        terms.subset_count = static_cast<int>(count);
    }
    std::vector<Doubles> converted;  // copies live until the loop is done
    for (const py::tuple& given : parts) {
        const size_t size = given.size() - skipped;
        require(given.size() >= skipped && size >= 4 && size <= 6,
                "a term is (element, x, params, coef[, residual_coef[, coefficients]])");
        // X of a sum stands behind its element.
        const auto at = [&](size_t k) { return py::object(given[k ? skipped + k : skipped ? 1 : 0]); };
        const auto& e = at(0).cast<const Element&>();
        const py::ssize_t rows = b.geometry == b.dofs ? op.nodes() : X.size() / e.dim;
        require(X.size() == rows * e.dim && rows >= b.geometry_end,
                e.name + " needs X of shape (" + std::to_string(std::max<py::ssize_t>(rows, b.geometry_end)) + ", " +
                    std::to_string(e.dim) + ")");
        converted.push_back(at(1).cast<Doubles>());
        converted.push_back(at(2).cast<Doubles>());
        const bool has_coefficients = size == 6 && !at(5).is_none();
        converted.push_back(has_coefficients ? at(5).cast<Doubles>() : Doubles(0));
        const Doubles* arrays = converted.data() + converted.size() - 3;
        const double coef = at(3).cast<double>(), residual_coef = size > 4 ? at(4).cast<double>() : coef;
        terms.list.push_back(term_of(op, e, arrays[0], arrays[1], coef, residual_coef, arrays[2], rows, count));
    }
    require(!rhs || (rhs->size() == static_cast<py::ssize_t>(op.nodes()) * op.fields() && rhs->writeable()),
            "rhs must be a writeable array of " + std::to_string(op.nodes() * op.fields()) + " numbers");
    op.add(block, terms);
}

void add(Operator& op, int block, const Doubles& X, const py::list& parts, std::optional<Output> rhs,
         const std::optional<Indices>& subset) {
    std::vector<py::tuple> terms;
    for (py::handle part : parts) terms.push_back(py::cast<py::tuple>(part));
    add_terms(op, block, X, terms, 0, rhs, subset);
}

// Terms of a block that follow one another on the same X are one sum of each cell.
void add_sum(Operator& op, const py::sequence& terms, std::optional<Output> rhs) {
    const size_t count = terms.size();
    std::vector<py::tuple> parts;
    for (size_t k = 0; k < count; ++k) {
        parts.push_back(py::cast<py::tuple>(terms[k]));
        const py::tuple& own = parts.front();
        require(parts.back().size() > 2, "a term of a sum is (block, element, X, x, params, coef[, ...])");
        if (k + 1 < count) {
            const auto next = py::cast<py::tuple>(terms[k + 1]);
            require(next.size() > 2, "a term of a sum is (block, element, X, x, params, coef[, ...])");
            const bool whole = py::isinstance<py::int_>(own[0]) && py::isinstance<py::int_>(next[0]);
            const bool same = whole ? own[0].equal(next[0]) : py::object(next[0]).is(own[0]);
            if (same && py::object(next[2]).is(own[2])) continue;
        }
        const auto X = py::cast<Doubles>(own[2]);
        if (py::isinstance<py::int_>(own[0])) {
            add_terms(op, py::cast<int>(own[0]), X, parts, 2, rhs, std::nullopt);
        } else {
            const std::optional<Indices> cells = py::cast<Indices>(own[0].attr("cells"));
            add_terms(op, py::cast<int>(own[0].attr("block")), X, parts, 2, rhs, cells);
        }
        parts.clear();
    }
}

void assemble(Operator& op, const py::sequence& terms, std::optional<Output> rhs, bool kept) {
    op.begin(kept);
    add_sum(op, terms, std::move(rhs));
    op.end();
}

// petsc4py's own constructor, which takes a reference; petsc4py publishes it as a capsule for C code.
py::object petsc4py_mat(const Operator& op) {
    using New = PyObject* (*)(Mat);
    static const New wrap = [] {
        py::dict api = py::module_::import("petsc4py.PETSc").attr("__pyx_capi__");
        py::capsule capsule = api["PyPetscMat_New"];
        return reinterpret_cast<New>(capsule.get_pointer<void>());
    }();
    PyObject* wrapped = wrap(op.mat());
    if (!wrapped) throw py::error_already_set();
    return py::reinterpret_steal<py::object>(wrapped);
}

constexpr const char* operator_doc =
    R"(A sparse matrix assembled from elements, with supports eliminated inside the elements.

Args:
  world: on PETSC_COMM_WORLD; otherwise on PETSC_COMM_SELF.
  fields: unknowns of a node; unknown `a` of node i is row i*fields + a.
  node_offsets: int32 (ranks + 1); nodes of rank r are node_offsets[r]:node_offsets[r + 1].
  rank: this process's.
  backend: "csr" (own arrays, cheap patches) or "bcsr" (one rank; in blocks of the unknowns of two nodes, PETSc's BAIJ,
    which products and relaxation read faster; PETSc has no multigrid for it, and no relaxation for its copies).

Use: set_topology, set_constraints, then for each set of values begin, add ..., end. Then `mat` (a petsc4py Mat that holds
a reference of its own; fetch it again when `generation` has changed). PETSc must be initialised. Every rank holds all
nodes and cells and fills its own rows, from the cells that touch its nodes; set_topology and patch are collective.
PETSc's log has the events RestshapePattern, RestshapePatch, RestshapeValues.)";

}  // namespace

void bind_operator(py::module_& m) {
    py::class_<Operator>(m, "Operator", operator_doc)
        .def(py::init(&Operator::create), py::arg("world"), py::arg("fields"), py::arg("node_offsets"),
             py::arg("rank") = 0, py::arg("backend") = "csr")
        .def("set_topology", &set_topology, py::arg("blocks"),
             "Sets a new pattern from a list of blocks: int32 (ne, nodes) cells, or a tuple of (ne, nodes) geometry, "
             "whose X and coefficients elements read, and (ne, dof_nodes) dofs, whose unknowns they read. The arrays "
             "are held and may change in place.")
        .def("patch", &patch, py::arg("block"), py::arg("changed_cells"),
             "Takes in the cells that changed in place. csr: adds only the pairs that are new; old ones stay as zeros "
             "until the next set_topology, and the matrix is another one only if there were new pairs, on any rank.")
        .def("set_constraints", &set_constraints, py::arg("mask"),
             "Marks constrained unknowns: mask uint8 (n*fields,) is 1 there.")
        .def("set_sliding", &set_sliding, py::arg("nodes"), py::arg("kept"),
             "Nodes int32 (k,) whose first two unknowns have only what symmetric projections keep of them, (k, 3) of "
             "xx, "
             "xy and yy: rows and columns of the rest are left out, its diagonal gets a sum of |coef * K_ii|.")
        .def("begin", &Operator::begin, py::arg("kept") = false,
             "Starts new values at zero, or at those that `keep` has noted.")
        .def("keep", &Operator::keep,
             "Notes the values added since begin, of terms that stay, until the topology, a patch or the constraints "
             "change.")
        .def("add", &add, py::arg("block"), py::arg("X"), py::arg("terms"), py::arg("rhs").noconvert() = py::none(),
             py::arg("cells") = py::none(),
             "For each term (element, x, params, coef[, residual_coef[, coefficients]]) of a list, adds coef * tangent "
             "to the "
             "matrix "
             "and subtracts residual_coef * residual (coef unless given) from own rows of rhs (n*fields,); all terms "
             "of a cell are scattered together. Constrained rows and columns are left out, their diagonal gets the "
             "sum of |coef * K_ii|, their rhs nothing. With cells (m,), which may name one more than once, these alone "
             "are "
             "assembled, and parameters have a row for each.")
        .def("add_sum", &add_sum, py::arg("terms"), py::arg("rhs").noconvert() = py::none(),
             "Adds terms (block, element, X, x, params, coef[, residual_coef[, coefficients]]) as `add` does; those of "
             "a "
             "block and one X that follow one another together. A block may be an object with its number, `block`, and "
             "`cells` (m,).")
        .def("assemble", &assemble, py::arg("terms"), py::arg("rhs").noconvert() = py::none(), py::arg("kept") = false,
             "begin, add_sum and end in one call.")
        .def("end", &Operator::end, "Hands the values to PETSc.")
        .def_property_readonly("mat", &petsc4py_mat, "The matrix as a petsc4py Mat with a reference of its own.")
        .def_property_readonly(
            "handle", [](const Operator& op) { return reinterpret_cast<intptr_t>(op.mat()); },
            "PETSc's Mat as an integer (borrowed).")
        .def_property_readonly("generation", &Operator::generation, "Counts the matrices: it grows with each new one.")
        .def_property_readonly("nnz", &Operator::nonzeros, "Stored entries of this rank's rows.");
}
