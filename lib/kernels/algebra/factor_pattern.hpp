// Where a complete Cholesky factor has blocks.
//
// PETSc analyses a matrix in blocks of two or more in a time that grows with the square of its rows: of each it clears
// a list as long as all of them.
#pragma once

#include <petscsys.h>

#include <algorithm>
#include <vector>

#include "algebra/node_graph.hpp"

namespace restshape {

// Rows of blocks right of the diagonal, which ascend; the first one starts at the number of rows, as pivots are stored
// before all rows.
struct FactorPattern {
    std::vector<PetscInt> start, column;
};

// The pattern of the factor of blocks that are laid out. A row has what the matrix has there, and what rows have whose
// first column it is: S. C. Eisenstat, M. C. Gursky, M. H. Schultz and A. H. Sherman, Yale sparse matrix package I,
// Int. J. Numer. Meth. Engng 18 (1982) 1145.
inline FactorPattern factor_pattern(const UpperBlocks& u) {
    const auto n = static_cast<PetscInt>(u.order.size());
    FactorPattern found{{n}, std::vector<PetscInt>(n)};
    // Rows whose first column is a row: the last one found, and of each the one before.
    std::vector<PetscInt> last(n, -1), before(n, -1), row, joined;
    for (PetscInt k = 0; k < n; ++k) {
        row.assign(u.columns.begin() + u.starts[k] + 1, u.columns.begin() + u.starts[k + 1]);
        for (PetscInt above = last[k]; above >= 0; above = before[above]) {
            const auto first = found.column.begin() + found.start[above] + 1,
                       end = found.column.begin() + found.start[above + 1];
            joined.resize(row.size() + (end - first));
            joined.erase(std::set_union(row.begin(), row.end(), first, end, joined.begin()), joined.end());
            row.swap(joined);
        }
        found.column.insert(found.column.end(), row.begin(), row.end());
        found.start.push_back(static_cast<PetscInt>(found.column.size()));
        if (row.empty()) continue;
        before[k] = last[row.front()];
        last[row.front()] = k;
    }
    return found;
}

}  // namespace restshape
