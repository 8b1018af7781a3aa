#include "algebra/node_lu.hpp"

#include <petsc/private/matimpl.h>

#include <limits>
#include <memory>

#include "algebra/lu_rows.hpp"
#include "algebra/within_memory.hpp"

namespace restshape {
namespace {

struct NodeLu {
    virtual ~NodeLu() = default;
    virtual void numbers(const double* value) = 0;
    virtual void solve(const double* b, double* x) = 0;
    virtual PetscInt zero() const = 0;
    virtual int size() const = 0;

    LuPattern matrix, factor;
    LuSources from;
    std::vector<PetscInt> order;
    double products = 0.0;
    bool whole = false;
};

template <int blocks, class Value>
struct NodeLuOf final : NodeLu {
    void numbers(const double* value) override {
        products = rows.make(matrix, from, value, factor);
        substitution.set(factor, rows);
    }
    void solve(const double* b, double* x) override { substitution.solve(factor, order.data(), b, x); }
    PetscInt zero() const override { return rows.zero(); }
    int size() const override { return blocks; }

    LuRows<blocks> rows;
    LuSubstitution<blocks, Value> substitution;
};

// What a factor holds: whether it is of single precision, and what has been made of a pattern.
struct Held {
    bool single;
    std::unique_ptr<NodeLu> made;
};

Held* of(Mat F) { return static_cast<Held*>(F->data); }

std::unique_ptr<NodeLu> made(PetscInt size, bool single) {
    if (size == 3 && single) return std::make_unique<NodeLuOf<3, float>>();
    if (size == 3) return std::make_unique<NodeLuOf<3, double>>();
    if (size == 4 && single) return std::make_unique<NodeLuOf<4, float>>();
    if (size == 4) return std::make_unique<NodeLuOf<4, double>>();
    return nullptr;
}

// Lays the entries out in elimination order; returns whether each has one across.
bool lay_out(PetscInt n, const PetscInt* start, const PetscInt* column, NodeLu& lu) {
    std::vector<PetscInt> place(n);
    for (PetscInt k = 0; k < n; ++k) place[lu.order[k]] = k;
    lu.from.diagonal.assign(n, -1);
    std::vector<std::pair<PetscInt, PetscInt>> own;
    for (PetscInt k = 0; k < n; ++k) {
        const PetscInt i = lu.order[k];
        own.clear();
        for (PetscInt j = start[i]; j < start[i + 1]; ++j) {
            if (column[j] == i) lu.from.diagonal[k] = j;
            if (place[column[j]] > k) own.emplace_back(place[column[j]], j);
        }
        if (lu.from.diagonal[k] < 0) return false;
        std::sort(own.begin(), own.end());
        for (const auto& [to, j] : own) {
            const PetscInt *first = column + start[lu.order[to]], *last = column + start[lu.order[to] + 1];
            const PetscInt* across = std::lower_bound(first, last, i);
            if (across == last || *across != i) return false;
            lu.matrix.column.push_back(to);
            lu.from.upper.push_back(j);
            lu.from.lower.push_back(static_cast<PetscInt>(across - column));
        }
        lu.matrix.start.push_back(static_cast<PetscInt>(lu.matrix.column.size()));
    }
    // Each entry left of the diagonal is one across: there are as many as right of it.
    return start[n] == n + 2 * static_cast<PetscInt>(lu.matrix.column.size());
}

PetscErrorCode order_nodes(PetscInt n, const PetscInt* start, const PetscInt* column, NodeLu& lu) {
    std::vector<PetscScalar> none(start[n], 1.0);
    Mat graph;
    IS rows, columns;
    const PetscInt* sequence;
    PetscFunctionBegin;
    PetscCall(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, const_cast<PetscInt*>(start),
                                        const_cast<PetscInt*>(column), none.data(), &graph));
    PetscCall(MatGetOrdering(graph, MATORDERINGAMD, &rows, &columns));
    PetscCall(ISGetIndices(rows, &sequence));
    lu.order.assign(sequence, sequence + n);
    PetscCall(ISRestoreIndices(rows, &sequence));
    PetscCall(ISDestroy(&rows));
    PetscCall(ISDestroy(&columns));
    PetscCall(MatDestroy(&graph));
    PetscFunctionReturn(0);
}

PetscErrorCode make_numbers(Mat F, Mat A) {
    NodeLu& lu = *of(F)->made;
    double* value;
    PetscFunctionBegin;
    lu.whole = false;
    PetscCall(MatSeqBAIJGetArray(A, &value));
    lu.numbers(value);
    PetscCall(MatSeqBAIJRestoreArray(A, &value));
    lu.whole = true;
    F->factorerrortype = lu.zero() ? MAT_FACTOR_NUMERIC_ZEROPIVOT : MAT_FACTOR_NOERROR;
    PetscCall(PetscLogFlops(2.0 * lu.size() * lu.size() * lu.size() * lu.products));
    PetscFunctionReturn(0);
}

PetscErrorCode numeric(Mat F, Mat A, const MatFactorInfo*) {
    PetscFunctionBegin;
    PetscCall(within_memory(F, [&] { return make_numbers(F, A); }));
    PetscFunctionReturn(0);
}

PetscErrorCode analyse(Mat F, Mat A) {
    PetscInt size, n;
    const PetscInt *start, *column;
    PetscBool done;
    PetscFunctionBegin;
    PetscCall(MatGetBlockSize(A, &size));
    of(F)->made = made(size, of(F)->single);
    PetscCheck(of(F)->made, PETSC_COMM_SELF, PETSC_ERR_SUP, "node_lu needs blocks of three or four rows");
    NodeLu& lu = *of(F)->made;
    PetscCall(MatGetRowIJ(A, 0, PETSC_FALSE, PETSC_TRUE, &n, &start, &column, &done));
    PetscCheck(done, PETSC_COMM_SELF, PETSC_ERR_SUP, "node_lu needs rows and columns of blocks");
    if (n) PetscCall(order_nodes(n, start, column, lu));
    const bool good = lay_out(n, start, column, lu);
    PetscCall(MatRestoreRowIJ(A, 0, PETSC_FALSE, PETSC_TRUE, &n, &start, &column, &done));
    PetscCheck(good, PETSC_COMM_SELF, PETSC_ERR_SUP, "node_lu needs a symmetric pattern with its whole diagonal");
    lu.factor = LuPattern::filled(lu.matrix);
    F->ops->lufactornumeric = numeric;
    F->factorerrortype = MAT_FACTOR_NOERROR;
    PetscFunctionReturn(0);
}

PetscErrorCode symbolic(Mat F, Mat A, IS, IS, const MatFactorInfo*) {
    PetscFunctionBegin;
    PetscCall(within_memory(F, [&] { return analyse(F, A); }));
    PetscFunctionReturn(0);
}

PetscErrorCode solve(Mat F, Vec b, Vec x) {
    NodeLu& lu = *of(F)->made;
    const double* from;
    double* to;
    PetscFunctionBegin;
    // PETSc takes one for made whose numbers memory did not hold.
    if (!lu.whole) {
        PetscCall(VecSet(x, std::numeric_limits<double>::quiet_NaN()));
        PetscFunctionReturn(0);
    }
    PetscCall(VecGetArrayRead(b, &from));
    PetscCall(VecGetArrayWrite(x, &to));
    lu.solve(from, to);
    PetscCall(VecRestoreArrayWrite(x, &to));
    PetscCall(VecRestoreArrayRead(b, &from));
    const double blocks = 2.0 * static_cast<double>(lu.factor.column.size()) + lu.factor.rows();
    PetscCall(PetscLogFlops(2.0 * lu.size() * lu.size() * blocks));
    PetscFunctionReturn(0);
}

PetscErrorCode get_info(Mat F, MatInfoType, MatInfo* info) {
    PetscFunctionBegin;
    PetscCall(PetscMemzero(info, sizeof *info));
    if (const NodeLu* lu = of(F)->made.get())
        info->nz_used = info->nz_allocated =
            lu->size() * lu->size() * (2.0 * static_cast<double>(lu->factor.column.size()) + lu->factor.rows());
    PetscFunctionReturn(0);
}

PetscErrorCode view(Mat, PetscViewer viewer) {
    return PetscViewerASCIIPrintf(viewer, "  LU in blocks of one node, ordered by minimum degree\n");
}

PetscErrorCode destroy(Mat F) {
    delete of(F);
    F->data = nullptr;
    return 0;
}

PetscErrorCode get_solver(Mat F, MatSolverType* type) {
    *type = of(F)->single ? NODE_LU_SINGLE : NODE_LU;
    return 0;
}

template <bool single>
PetscErrorCode get_factor(Mat A, MatFactorType type, Mat* F) {
    PetscFunctionBegin;
    PetscCall(MatCreate(PetscObjectComm(reinterpret_cast<PetscObject>(A)), F));
    PetscCall(MatSetSizes(*F, A->rmap->n, A->cmap->n, A->rmap->n, A->cmap->n));
    PetscCall(PetscStrallocpy(NODE_LU, &reinterpret_cast<PetscObject>(*F)->type_name));
    PetscCall(MatSetUp(*F));
    (*F)->data = new Held{single, nullptr};
    (*F)->ops->lufactorsymbolic = symbolic;
    (*F)->ops->solve = solve;
    (*F)->ops->getinfo = get_info;
    (*F)->ops->view = view;
    (*F)->ops->destroy = destroy;
    (*F)->factortype = type;
    (*F)->assembled = PETSC_TRUE;
    PetscCall(PetscFree((*F)->solvertype));
    PetscCall(PetscStrallocpy(single ? NODE_LU_SINGLE : NODE_LU, &(*F)->solvertype));
    PetscCall(PetscObjectComposeFunction(reinterpret_cast<PetscObject>(*F), "MatFactorGetSolverType_C", get_solver));
    PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode register_node_lu() {
    static bool known = false;
    PetscFunctionBegin;
    if (!known) {
        PetscCall(MatSolverTypeRegister(NODE_LU, MATSEQBAIJ, MAT_FACTOR_LU, get_factor<false>));
        PetscCall(MatSolverTypeRegister(NODE_LU_SINGLE, MATSEQBAIJ, MAT_FACTOR_LU, get_factor<true>));
    }
    known = true;
    PetscFunctionReturn(0);
}

}  // namespace restshape
