#include "algebra/node_graph.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

// Of SuiteSparse, which PETSc links where it has its orderings; elsewhere the symbols are null.
#if __has_include(<suitesparse/cholmod.h>)
#include <suitesparse/cholmod.h>
#pragma weak cholmod_start
#pragma weak cholmod_finish
#pragma weak cholmod_nested_dissection
#pragma weak cholmod_version
#define RESTSHAPE_DISSECTION 1
#else
#define RESTSHAPE_DISSECTION 0
#endif

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

// The order of nested dissection, with parts below some size left to minimum degree; returns whether there is one.
template <class Integer>
bool dissected(std::vector<Integer>& starts, std::vector<Integer>& columns, std::vector<Integer>* order) {
#if RESTSHAPE_DISSECTION
    if constexpr (std::is_same_v<Integer, int>) {
        constexpr double small_part = 100.0;
        if (!has_dissection()) return false;
        const std::size_t n = starts.size() - 1;
        cholmod_common common;
        cholmod_sparse graph{};
        cholmod_start(&common);
        graph.nrow = graph.ncol = n;
        graph.nzmax = columns.size();
        graph.p = starts.data(), graph.i = columns.data();
        graph.stype = graph.packed = 1;
        graph.itype = CHOLMOD_INT, graph.xtype = CHOLMOD_PATTERN, graph.dtype = CHOLMOD_DOUBLE;
        common.method[0].nd_small = small_part;
        common.print = 0;
        std::vector<int> parts(n), member(n);
        order->resize(n);
        const auto found =
            cholmod_nested_dissection(&graph, nullptr, 0, order->data(), parts.data(), member.data(), &common);
        cholmod_finish(&common);
        return found > 0;
    }
#endif
    return false;
}

// The same with the last nodes behind the others.
PetscErrorCode order_before(PetscInt kept, Elimination by, std::vector<PetscInt>& starts,
                            std::vector<PetscInt>& columns, std::vector<PetscInt>* order) {
    const PetscInt n = static_cast<PetscInt>(starts.size()) - 1, pivots = n - kept;
    PetscFunctionBegin;
    if (kept == 0) {
        if (by == Elimination::dissection && n > 0 && dissected(starts, columns, order)) PetscFunctionReturn(0);
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

PetscInt block_size(const Pattern& a, PetscInt fields) {
    if (a.rows == 0) return 1;
    if (fields) return in_blocks(a, fields) ? fields : 1;
    for (PetscInt b : {3, 2})
        if (in_blocks(a, b)) return b;
    return 1;
}

bool has_dissection() {
#if RESTSHAPE_DISSECTION
    // Structures of another version have other members: PETSc may have come with one of its own beside the system's.
    static const bool fits = [] {
        int version[3] = {};
        if (!(cholmod_start && cholmod_finish && cholmod_nested_dissection && cholmod_version)) return false;
        cholmod_version(version);
        return std::is_same_v<PetscInt, int> && version[0] == CHOLMOD_MAIN_VERSION && version[1] == CHOLMOD_SUB_VERSION;
    }();
    return fits;
#else
    return false;
#endif
}

PetscErrorCode make_blocks(const Pattern& a, PetscInt size, UpperBlocks* u, PetscInt kept, Elimination by) {
    std::vector<PetscInt> starts, columns;
    PetscFunctionBegin;
    u->size = size;
    node_pattern(a, size, &starts, &columns);
    PetscCall(order_before(kept, by, starts, columns, &u->order));
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

}  // namespace restshape
