#include "algebra/node_graph.hpp"

#include <algorithm>
#include <utility>

namespace restshape {
namespace {

bool in_blocks(const Pattern& a, PetscInt b) {
    if (a.rows % b) return false;
    for (PetscInt r = 0; r < a.rows; r += b) {
        const PetscInt first = a.starts[r], wide = a.starts[r + 1] - first;
        if (wide % b) return false;
        for (PetscInt k = 1; k < b; ++k) {
            const PetscInt row = a.starts[r + k];
            if (a.starts[r + k + 1] - row != wide) return false;
            if (!std::equal(a.columns + first, a.columns + first + wide, a.columns + row)) return false;
        }
        for (PetscInt k = 0; k < wide; k += b) {
            const PetscInt c = a.columns[first + k];
            if (c % b) return false;
            for (PetscInt l = 1; l < b; ++l)
                if (a.columns[first + k + l] != c + l) return false;
        }
    }
    return true;
}

// Nodes and their neighbours; each row's columns stand as in the matrix.
void node_pattern(const Pattern& a, PetscInt b, std::vector<PetscInt>* starts, std::vector<PetscInt>* columns) {
    const PetscInt n = a.rows / b;
    starts->assign(n + 1, 0);
    columns->resize(a.starts[a.rows] / (b * b));
    PetscInt at = 0;
    for (PetscInt i = 0; i < n; ++i) {
        for (PetscInt k = a.starts[b * i]; k < a.starts[b * i + 1]; k += b) (*columns)[at++] = a.columns[k] / b;
        (*starts)[i + 1] = at;
    }
}

PetscErrorCode elimination_order(std::vector<PetscInt>& starts, std::vector<PetscInt>& columns,
                                 std::vector<PetscInt>* order) {
    const PetscInt n = static_cast<PetscInt>(starts.size()) - 1;
    std::vector<PetscScalar> none(columns.size(), 1.0);
    Mat graph;
    IS rows, columns_too;
    const PetscInt* sequence;
    PetscFunctionBegin;
    order->clear();
    if (n == 0) PetscFunctionReturn(0);
    PetscCall(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, starts.data(), columns.data(), none.data(), &graph));
    PetscCall(MatGetOrdering(graph, MATORDERINGAMD, &rows, &columns_too));
    PetscCall(ISGetIndices(rows, &sequence));
    order->assign(sequence, sequence + n);
    PetscCall(ISRestoreIndices(rows, &sequence));
    PetscCall(ISDestroy(&rows));
    PetscCall(ISDestroy(&columns_too));
    PetscCall(MatDestroy(&graph));
    PetscFunctionReturn(0);
}

// The upper triangle in elimination order, and where each block of the matrix's node rows goes, -1 below the diagonal.
void lay_out(const std::vector<PetscInt>& starts, const std::vector<PetscInt>& columns, UpperBlocks* u,
             std::vector<PetscInt>* block_of) {
    const PetscInt n = static_cast<PetscInt>(u->order.size());
    std::vector<PetscInt> place(n);
    for (PetscInt k = 0; k < n; ++k) place[u->order[k]] = k;
    u->starts.assign(1, 0);
    u->columns.clear();
    block_of->assign(columns.size(), -1);
    std::vector<std::pair<PetscInt, PetscInt>> row;  // column, block of the node row
    for (PetscInt k = 0; k < n; ++k) {
        row.clear();
        for (PetscInt j = starts[u->order[k]]; j < starts[u->order[k] + 1]; ++j)
            if (place[columns[j]] >= k) row.emplace_back(place[columns[j]], j);
        std::sort(row.begin(), row.end());
        for (const auto& [column, j] : row) {
            (*block_of)[j] = static_cast<PetscInt>(u->columns.size());
            u->columns.push_back(column);
        }
        u->starts.push_back(static_cast<PetscInt>(u->columns.size()));
    }
}

}  // namespace

PetscInt block_size(const Pattern& a) {
    if (a.rows == 0) return 1;
    for (PetscInt b : {3, 2})
        if (in_blocks(a, b)) return b;
    return 1;
}

PetscErrorCode make_blocks(const Pattern& a, PetscInt size, UpperBlocks* u) {
    std::vector<PetscInt> starts, columns, block_of;
    PetscFunctionBegin;
    u->size = size;
    node_pattern(a, size, &starts, &columns);
    PetscCall(elimination_order(starts, columns, &u->order));
    lay_out(starts, columns, u, &block_of);
    u->places.assign(a.starts[a.rows], -1);
    for (PetscInt r = 0; r < a.rows; ++r) {
        const PetscInt node = r / size, within = r % size;
        for (PetscInt k = a.starts[r]; k < a.starts[r + 1]; ++k) {
            const PetscInt wide = k - a.starts[r], block = block_of[starts[node] + wide / size];
            if (block >= 0) u->places[k] = (block * size + wide % size) * size + within;
        }
    }
    PetscFunctionReturn(0);
}

void copy_values(const double* a, const UpperBlocks& u, double* blocks) {
    const std::size_t count = u.places.size();
    for (std::size_t k = 0; k < count; ++k)
        if (u.places[k] >= 0) blocks[u.places[k]] = a[k];
}

}  // namespace restshape
