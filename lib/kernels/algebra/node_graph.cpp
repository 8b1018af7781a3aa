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

// The same with the last nodes behind the others.
PetscErrorCode order_before(PetscInt kept, std::vector<PetscInt>& starts, std::vector<PetscInt>& columns,
                            std::vector<PetscInt>* order) {
    const PetscInt n = static_cast<PetscInt>(starts.size()) - 1, pivots = n - kept;
    PetscFunctionBegin;
    if (kept == 0) {
        PetscCall(elimination_order(starts, columns, order));
        PetscFunctionReturn(0);
    }
    std::vector<PetscInt> own_starts(1, 0), own_columns;
    for (PetscInt i = 0; i < pivots; ++i) {
        for (PetscInt j = starts[i]; j < starts[i + 1]; ++j)
            if (columns[j] < pivots) own_columns.push_back(columns[j]);
        own_starts.push_back(static_cast<PetscInt>(own_columns.size()));
    }
    PetscCall(elimination_order(own_starts, own_columns, order));
    for (PetscInt i = pivots; i < n; ++i) order->push_back(i);
    PetscFunctionReturn(0);
}

// The upper triangle in elimination order, and where each block of it stands among those of the matrix's node rows.
void lay_out(const std::vector<PetscInt>& starts, const std::vector<PetscInt>& columns, UpperBlocks* u,
             std::vector<PetscInt>* of_block) {
    const PetscInt n = static_cast<PetscInt>(u->order.size());
    std::vector<PetscInt> place(n), next(n + 1, 0), at(n);
    for (PetscInt k = 0; k < n; ++k) place[u->order[k]] = k;
    for (PetscInt i = 0; i < n; ++i)
        for (PetscInt j = starts[i]; j < starts[i + 1]; ++j) next[place[i] + 1] += place[columns[j]] >= place[i];
    for (PetscInt k = 0; k < n; ++k) next[k + 1] += next[k];
    u->starts = next;
    u->columns.resize(next[n]);
    of_block->resize(next[n]);
    // The pattern is symmetric: taken column by column, its rows come out sorted.
    for (PetscInt k = 0; k < n; ++k)
        for (PetscInt j = starts[u->order[k]]; j < starts[u->order[k] + 1]; ++j)
            if (place[columns[j]] <= k) u->columns[next[place[columns[j]]]++] = k;
    for (PetscInt k = 0; k < n; ++k) {
        for (PetscInt j = u->starts[k]; j < u->starts[k + 1]; ++j) at[u->columns[j]] = j;
        for (PetscInt j = starts[u->order[k]]; j < starts[u->order[k] + 1]; ++j)
            if (place[columns[j]] >= k) (*of_block)[at[place[columns[j]]]] = j - starts[u->order[k]];
    }
}

}  // namespace

PetscInt block_size(const Pattern& a) {
    if (a.rows == 0) return 1;
    for (PetscInt b : {3, 2})
        if (in_blocks(a, b)) return b;
    return 1;
}

PetscErrorCode make_blocks(const Pattern& a, PetscInt size, UpperBlocks* u, PetscInt kept) {
    std::vector<PetscInt> starts, columns;
    PetscFunctionBegin;
    u->size = size;
    node_pattern(a, size, &starts, &columns);
    PetscCall(order_before(kept, starts, columns, &u->order));
    lay_out(starts, columns, u, &u->from);
    const PetscInt n = static_cast<PetscInt>(u->order.size());
    u->length.resize(n);
    for (PetscInt k = 0; k < n; ++k) {
        const PetscInt row = size * u->order[k], first = a.starts[row];
        u->length[k] = a.starts[row + 1] - first;
        for (PetscInt j = u->starts[k]; j < u->starts[k + 1]; ++j) u->from[j] = first + size * u->from[j];
    }
    PetscFunctionReturn(0);
}

void copy_values(const double* a, const UpperBlocks& u, double* blocks) {
    const PetscInt size = u.size, n = static_cast<PetscInt>(u.order.size());
    for (PetscInt k = 0; k < n; ++k)
        for (PetscInt j = u.starts[k]; j < u.starts[k + 1]; ++j)
            for (PetscInt c = 0; c < size; ++c)
                for (PetscInt r = 0; r < size; ++r) *blocks++ = a[u.from[j] + r * u.length[k] + c];
}

}  // namespace restshape
