// What a rank has of a matrix whose rows ranks share: its rows inside, and the border that these couple with, as one
// sequential pattern whose entries are read where PETSc keeps them. No copy of the matrix is made on the way.
#pragma once

#include <petscmat.h>

#include <stdexcept>
#include <vector>

#include "algebra/matrix_rows.hpp"

namespace restshape {

// This rank's rows of a matrix by rows (MPIAIJ): columns of its own, and, numbered behind them, those of other ranks.
class SharedRows {
 public:
    explicit SharedRows(Mat mat) : SharedRows(blocks_of(mat)) {}

    PetscInt count() const { return own_.n; }
    PetscInt columns() const { return own_.n + other_columns_; }
    const PetscInt* columns_of_others() const { return names_; }
    PetscInt entries() const { return own_.start[own_.n]; }
    PetscInt other_entries() const { return others_.start[others_.n]; }
    PetscInt length(PetscInt row) const { return own_.start[row + 1] - own_.start[row]; }
    PetscInt other_length(PetscInt row) const { return others_.start[row + 1] - others_.start[row]; }
    const double* values() const { return own_.value; }
    const double* other_values() const { return others_.value; }

    // Calls visit(column, entry) for a row; entries of others' columns are numbered behind those of own ones.
    template <class Visit>
    void each(PetscInt row, Visit&& visit) const {
        for (PetscInt k = own_.start[row]; k < own_.start[row + 1]; ++k) visit(own_.column[k], k);
        for (PetscInt k = others_.start[row]; k < others_.start[row + 1]; ++k)
            visit(own_.n + others_.column[k], entries() + k);
    }

    double value(PetscInt entry) const {
        return entry < entries() ? own_.value[entry] : others_.value[entry - entries()];
    }

 private:
    struct Blocks {
        Mat own, others;
        const PetscInt* names;
    };

    static Blocks blocks_of(Mat mat) {
        PetscBool shared = PETSC_FALSE;
        check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(mat), MATMPIAIJ, &shared), "PetscObjectTypeCompare");
        if (!shared) throw std::invalid_argument("not a matrix whose rows ranks share (mpiaij)");
        Blocks found{};
        check(MatMPIAIJGetSeqAIJ(mat, &found.own, &found.others, &found.names), "MatMPIAIJGetSeqAIJ");
        return found;
    }

    explicit SharedRows(const Blocks& blocks) : own_(blocks.own), others_(blocks.others), names_(blocks.names) {
        check(MatGetSize(blocks.others, nullptr, &other_columns_), "MatGetSize");
        if (!own_.done || !others_.done) throw std::invalid_argument("a matrix without rows and columns");
    }

    MatrixRows own_, others_;
    const PetscInt* names_;
    PetscInt other_columns_ = 0;
};

// Rows of a sequential matrix, and of each entry where it is in `SharedRows`; -1: zero.
struct BorderedPattern {
    std::vector<PetscInt> start, column, entry;
};

// The pattern of rows inside and of a border behind them.
//
// Args:
//     number: (columns) of each column of the rows its place in the pattern, those inside, which ascend, before
//         `inside`; -1: none.
//     inside, border: how many.
//     nodes: unknowns of a node of the border: its rows have the entries that rows inside have in them, and zeros in
//         the block of each node; 0: they have a zero on the diagonal.
inline BorderedPattern bordered_pattern(const SharedRows& rows, const PetscInt* number, PetscInt inside,
                                        PetscInt border, PetscInt nodes) {
    const PetscInt size = inside + border;
    BorderedPattern found;
    found.start.assign(size + 1, 0);
    const auto each = [&](auto&& visit) {
        for (PetscInt row = 0; row < rows.count(); ++row) {
            const PetscInt i = number[row];
            if (i < 0 || i >= inside) continue;
            rows.each(row, [&](PetscInt column, PetscInt entry) {
                if (number[column] < 0 || number[column] >= size)
                    throw std::invalid_argument("a row inside couples with what is not the border");
                visit(i, number[column], entry);
            });
        }
    };
    each([&](PetscInt i, PetscInt j, PetscInt) {
        ++found.start[i + 1];
        if (nodes && j >= inside) ++found.start[j + 1];
    });
    const PetscInt own = nodes ? nodes : 1;
    for (PetscInt i = inside; i < size; ++i) found.start[i + 1] += own;
    for (PetscInt i = 0; i < size; ++i) found.start[i + 1] += found.start[i];
    found.column.resize(found.start[size]);
    found.entry.resize(found.start[size]);
    std::vector<PetscInt> next(found.start.begin(), found.start.end() - 1);
    const auto put = [&](PetscInt i, PetscInt j, PetscInt entry) {
        // Columns of the border come in no order, behind the others.
        PetscInt at = next[i]++;
        for (; at > found.start[i] && found.column[at - 1] > j; --at) {
            found.column[at] = found.column[at - 1];
            found.entry[at] = found.entry[at - 1];
        }
        found.column[at] = j;
        found.entry[at] = entry;
    };
    each([&](PetscInt i, PetscInt j, PetscInt entry) {
        put(i, j, entry);
        if (nodes && j >= inside) put(j, i, entry);
    });
    for (PetscInt i = inside; i < size; ++i)
        for (PetscInt k = 0; k < own; ++k) put(i, nodes ? inside + (i - inside) / nodes * nodes + k : i, -1);
    return found;
}

// Writes entries of rows.
inline void take_entries(const SharedRows& rows, const PetscInt* entry, std::size_t count, double* out) {
    const PetscInt most = rows.entries() + rows.other_entries();
    for (std::size_t k = 0; k < count; ++k) {
        if (entry[k] >= most) throw std::invalid_argument("an entry that the matrix does not have");
        out[k] = entry[k] < 0 ? 0.0 : rows.value(entry[k]);
    }
}

}  // namespace restshape
