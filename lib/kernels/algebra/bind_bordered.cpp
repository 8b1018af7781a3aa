// Bindings of what a rank has of a matrix whose rows ranks share, as a factor of its inside wants it.
#include <petscmat.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "algebra/bordered_pattern.hpp"
#include "algebra/node_cholesky.hpp"

namespace py = pybind11;
using restshape::check;
using restshape::SharedRows;
using Integers = py::array_t<PetscInt, py::array::c_style>;
using Reals = py::array_t<double, py::array::c_style>;

namespace {

SharedRows rows_of(intptr_t handle) { return SharedRows(reinterpret_cast<Mat>(handle)); }

// An array that takes a vector's place.
Integers array_of(std::vector<PetscInt>&& values) {
    auto* kept = new std::vector<PetscInt>(std::move(values));
    const py::capsule owner(kept, [](void* known) { delete static_cast<std::vector<PetscInt>*>(known); });
    return Integers(static_cast<py::ssize_t>(kept->size()), kept->data(), owner);
}

const PetscInt* of_columns(const SharedRows& rows, const Integers& of_each) {
    if (of_each.ndim() != 1 || of_each.size() != rows.columns())
        throw std::invalid_argument("a number for each column of the rows is wanted");
    return of_each.data();
}

py::tuple couplings(intptr_t handle) {
    const SharedRows rows = rows_of(handle);
    std::vector<PetscInt> row_of, column_of;
    row_of.reserve(rows.other_entries());
    column_of.reserve(rows.other_entries());
    for (PetscInt row = 0; row < rows.count(); ++row)
        rows.each(row, [&](PetscInt column, PetscInt) {
            if (column < rows.count()) return;
            row_of.push_back(row);
            column_of.push_back(rows.columns_of_others()[column - rows.count()]);
        });
    const PetscInt *first = rows.columns_of_others(), *end = first + (rows.columns() - rows.count());
    return py::make_tuple(array_of(std::move(row_of)), array_of(std::move(column_of)), array_of({first, end}));
}

Integers met_by_inside(intptr_t handle, const Integers& place) {
    const SharedRows rows = rows_of(handle);
    const PetscInt* known = of_columns(rows, place);
    std::vector<PetscInt> met(rows.columns(), 0);
    for (PetscInt row = 0; row < rows.count(); ++row)
        if (known[row] < 0) rows.each(row, [&](PetscInt column, PetscInt) { met[column] = 1; });
    return array_of(std::move(met));
}

py::tuple between(intptr_t handle, const Integers& place) {
    const SharedRows rows = rows_of(handle);
    const PetscInt* known = of_columns(rows, place);
    std::vector<PetscInt> row_of, column_of, entry_of;
    for (PetscInt row = 0; row < rows.count(); ++row) {
        if (known[row] < 0) continue;
        rows.each(row, [&](PetscInt column, PetscInt entry) {
            if (known[column] < 0) return;
            row_of.push_back(known[row]);
            column_of.push_back(known[column]);
            entry_of.push_back(entry);
        });
    }
    return py::make_tuple(array_of(std::move(row_of)), array_of(std::move(column_of)), array_of(std::move(entry_of)));
}

py::tuple pattern(intptr_t handle, const Integers& number, PetscInt inside, PetscInt border) {
    const SharedRows rows = rows_of(handle);
    auto found = restshape::bordered_pattern(rows, of_columns(rows, number), inside, border, 0);
    return py::make_tuple(array_of(std::move(found.start)), array_of(std::move(found.column)),
                          array_of(std::move(found.entry)));
}

void take(intptr_t handle, const Integers& entries, Reals out) {
    if (entries.size() != out.size()) throw std::invalid_argument("out must be as long as entries");
    restshape::take_entries(rows_of(handle), entries.data(), static_cast<size_t>(entries.size()), out.mutable_data());
}

bool finite_rows(intptr_t handle) {
    const SharedRows rows = rows_of(handle);
    const auto all = [](const double* values, PetscInt count) {
        return std::all_of(values, values + count, [](double value) { return std::isfinite(value); });
    };
    return all(rows.values(), rows.entries()) && all(rows.other_values(), rows.other_entries());
}

void factor(intptr_t factor, intptr_t handle, const Integers& number) {
    const SharedRows rows = rows_of(handle);
    check(restshape::factor_shared_rows(reinterpret_cast<Mat>(factor), rows, of_columns(rows, number)),
          "factor_shared_rows");
}

}  // namespace

void bind_bordered(py::module_& m) {
    m.def("couplings_of_ranks", &couplings, py::arg("handle"),
          "Rows (k,), by their places among this rank's, and columns (k,) of the entries in columns of other ranks of "
          "PETSc's matrix of this handle, whose rows ranks share; and these columns (c,), each once. Own columns, and "
          "behind them these, are the columns of the rows in what follows.");
    m.def("met_by_inside", &met_by_inside, py::arg("handle"), py::arg("place").noconvert(),
          "1 for each column of this rank's rows (c,) with an entry in a row inside, 0 for others; place: (c,) in the "
          "border, -1 inside. See couplings_of_ranks.");
    m.def("between_ranks", &between, py::arg("handle"), py::arg("place").noconvert(),
          "Rows and columns (k,) in the border, and numbers (k,) of this rank's entries there; see met_by_inside.");
    m.def("bordered_pattern", &pattern, py::arg("handle"), py::arg("number").noconvert(), py::arg("inside"),
          py::arg("border"),
          "Starts (n + 1,), columns and numbers of entries (k,) of a pattern by rows: those inside, and so many of the "
          "border behind, which have a zero on the diagonal, of number -1. number: (c,) of each column of this rank's "
          "rows its place there, -1 for none. See couplings_of_ranks.");
    m.def("take_entries", &take, py::arg("handle"), py::arg("entries").noconvert(), py::arg("out").noconvert(),
          "Writes entries (k,) of this rank's rows, by the numbers that bordered_pattern gives them, into out (k,).");
    m.def("finite_rows", &finite_rows, py::arg("handle"),
          "Whether all entries of this rank's rows are numbers. See couplings_of_ranks.");
    m.def("factor_shared_rows", &factor, py::arg("factor"), py::arg("handle"), py::arg("number").noconvert(),
          "Makes the factor with the first handle, of NODE_BLOCKS, of this rank's rows inside of the matrix with the "
          "second one, and of the border that it keeps: its rows have what is inside in their columns, and zeros in "
          "the blocks of its nodes. number: as of bordered_pattern. See keep_border.");
}
