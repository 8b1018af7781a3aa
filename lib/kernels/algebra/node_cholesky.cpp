#include "algebra/node_cholesky.hpp"

#include <petsc/private/matimpl.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "algebra/block_factor.hpp"
#include "algebra/block_substitution.hpp"
#include "algebra/node_graph.hpp"
#include "algebra/number_rows.hpp"

// PETSc's factor in symmetric blocks takes the natural order alone: the blocks are copied in elimination order before.
// Its pattern and substitutions are PETSc's; its numbers are made by BlockFactor, which is faster.
// A large pattern that has been factored a few times is ordered anew, by nested dissection, which pays off then; a very
// large one is dissected at once.
// P. R. Amestoy, T. A. Davis and I. S. Duff, SIAM J. Matrix Anal. Appl. 17 (1996), 886; A. George, SIAM J. Numer. Anal.
// 10 (1973), 345.

namespace restshape {
namespace {

// Nodes of three unknowns, and factors of one pattern by minimum degree, from which on it is dissected: on a sheet of
// 10,784 nodes that takes as long as half of such a factor, and saves a third of each.
constexpr PetscInt large = 4000, several = 2;
// Such nodes from which on dissection takes less than it saves of the first factor.
constexpr PetscInt dissected_at_once = 20000;
// Numbers of a factor from which on they are substituted in place: in half of PETSc's time, as panels take, which would
// need as much memory again.
constexpr std::size_t in_place = std::size_t{1} << 24;

struct NodeCholesky {
    UpperBlocks blocks;
    PetscInt made = 0;  // factors of this pattern
    std::vector<double> right, solution;
    Mat upper = nullptr, factor = nullptr;
    Vec b = nullptr, x = nullptr;
    BlockFactor<1> singles;
    BlockFactor<2> pairs;
    BlockFactor<3> triples;
    NumberRows numbers;              // of blocks of one number, which PETSc lays out otherwise
    PetscInt zero = 0;               // blocks without an inverse, each counted once
    PetscInt border = 0;             // the last unknowns, which are no pivots
    PetscInt fields = 0;             // unknowns a node where they are given; else the pattern shows them
    std::vector<double> complement;  // of them, by rows
    PetscInt pivots() const { return static_cast<PetscInt>(blocks.order.size()) - border / blocks.size; }
};

NodeCholesky* of(Mat F) { return static_cast<NodeCholesky*>(F->data); }

PetscErrorCode release(NodeCholesky* c) {
    PetscFunctionBegin;
    PetscCall(MatDestroy(&c->factor));
    PetscCall(MatDestroy(&c->upper));
    PetscCall(VecDestroy(&c->b));
    PetscCall(VecDestroy(&c->x));
    PetscFunctionReturn(0);
}

PetscErrorCode destroy(Mat F) {
    PetscFunctionBegin;
    PetscCall(release(of(F)));
    delete of(F);
    F->data = nullptr;
    PetscFunctionReturn(0);
}

// The pattern of a sequential AIJ matrix, for a call.
template <class Use>
PetscErrorCode with_pattern(Mat A, const Use& use) {
    Pattern a;
    PetscBool done;
    PetscFunctionBegin;
    PetscCall(MatGetRowIJ(A, 0, PETSC_FALSE, PETSC_FALSE, &a.rows, &a.starts, &a.columns, &done));
    PetscCheck(done, PETSC_COMM_SELF, PETSC_ERR_SUP, "node_blocks needs rows and columns of a sequential AIJ matrix");
    PetscCall(use(a));
    PetscCall(MatRestoreRowIJ(A, 0, PETSC_FALSE, PETSC_FALSE, &a.rows, &a.starts, &a.columns, &done));
    PetscFunctionReturn(0);
}

// Rows of PETSc's factor, for a call, without values.
template <class Use>
PetscErrorCode with_rows(Mat factor, const Use& use) {
    BlockRows own{};
    PetscBool done;
    PetscFunctionBegin;
    PetscCall(MatGetRowIJ(factor, 0, PETSC_FALSE, PETSC_TRUE, &own.count, &own.start, &own.column, &done));
    PetscCheck(done, PETSC_COMM_SELF, PETSC_ERR_SUP, "node_blocks needs the rows of PETSc's factor");
    PetscCall(use(own));
    PetscCall(MatRestoreRowIJ(factor, 0, PETSC_FALSE, PETSC_TRUE, &own.count, &own.start, &own.column, &done));
    PetscFunctionReturn(0);
}

PetscErrorCode numeric(Mat F, Mat A, const MatFactorInfo* info);

PetscErrorCode lay_out(Mat F, Mat A, const MatFactorInfo* info, Elimination by) {
    NodeCholesky* c = of(F);
    UpperBlocks& u = c->blocks;
    IS rows, columns;
    PetscFunctionBegin;
    PetscCall(release(c));
    PetscCall(with_pattern(A, [&](const Pattern& a) {
        const PetscInt size = block_size(a, c->fields);
        PetscCheck(c->border % size == 0, PETSC_COMM_SELF, PETSC_ERR_SUP, "node_blocks keeps whole nodes");
        return make_blocks(a, size, &u, c->border / size, by);
    }));
    const PetscInt n = A->rmap->n;
    PetscCall(MatCreate(PETSC_COMM_SELF, &c->upper));
    PetscCall(MatSetSizes(c->upper, n, n, n, n));
    PetscCall(MatSetType(c->upper, MATSEQSBAIJ));
    PetscCall(MatSeqSBAIJSetPreallocationCSR(c->upper, u.size, u.starts.data(), u.columns.data(), nullptr));
    PetscCall(MatGetFactor(c->upper, MATSOLVERPETSC, MAT_FACTOR_CHOLESKY, &c->factor));
    PetscCall(MatGetOrdering(c->upper, MATORDERINGNATURAL, &rows, &columns));
    PetscCall((*c->factor->ops->choleskyfactorsymbolic)(c->factor, c->upper, rows, info));
    PetscCall(ISDestroy(&rows));
    PetscCall(ISDestroy(&columns));
    if (u.size == 1)
        PetscCall(with_rows(c->factor, [c](const BlockRows& own) {
            c->numbers.set_pattern(own.count, own.start, own.column);
            return PetscErrorCode(0);
        }));
    c->right.resize(n);
    c->solution.resize(n);
    PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, u.size, n, c->right.data(), &c->b));
    PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, u.size, n, c->solution.data(), &c->x));
    F->ops->choleskyfactornumeric = numeric;
    PetscFunctionReturn(0);
}

PetscErrorCode symbolic(Mat F, Mat A, IS, const MatFactorInfo* info) {
    PetscFunctionBegin;
    of(F)->made = 0;
    PetscCall(lay_out(F, A, info, Elimination::minimum_degree));
    PetscFunctionReturn(0);
}

// Products of two blocks that a factor takes, about.
PetscErrorCode count_products(Mat factor, double* products) {
    PetscFunctionBegin;
    *products = 0.0;
    PetscCall(with_rows(factor, [products](const BlockRows& own) {
        for (PetscInt k = 0; k < own.count; ++k) {
            const auto wide = static_cast<double>(own.start[k + 1] - own.start[k]);
            *products += 0.5 * wide * (wide + 1.0);
        }
        return PetscErrorCode(0);
    }));
    PetscFunctionReturn(0);
}

// Orders a pattern by nested dissection once it has been factored several times, a very large one before, where that
// takes fewer products: in slender bodies it does not.
PetscErrorCode dissect_if_due(Mat F, Mat A, const MatFactorInfo* info) {
    NodeCholesky* c = of(F);
    double before, after;
    PetscFunctionBegin;
    const auto nodes = static_cast<PetscInt>(c->blocks.order.size());
    const PetscInt made_before = nodes >= dissected_at_once ? 0 : several;
    const bool due = c->made++ == made_before && c->blocks.size == 3 && c->border == 0 && has_dissection();
    if (!due || nodes < large) PetscFunctionReturn(0);
    PetscCall(count_products(c->factor, &before));
    PetscCall(lay_out(F, A, info, Elimination::dissection));
    PetscCall(count_products(c->factor, &after));
    if (!(after < before)) PetscCall(lay_out(F, A, info, Elimination::minimum_degree));
    PetscFunctionReturn(0);
}

// The factor's diagonal blocks, inverted, stored before its rows: A = U' D U with D in blocks, so that D has the
// inertia of A (Sylvester).
template <int size>
using Block = Eigen::Matrix<double, size, size>;

// A count of them, for a size that is known.
using Count = PetscInt (*)(PetscInt pivots, const double* inverses);

PetscErrorCode count_pivots(NodeCholesky& c, const Count (&of_size)[3], PetscInt* found) {
    const Count count = of_size[c.blocks.size - 1];
    double* inverses = c.numbers.pivots();
    PetscFunctionBegin;
    if (c.blocks.size > 1) PetscCall(MatSeqSBAIJGetArray(c.factor, &inverses));
    *found = count(c.pivots(), inverses);
    if (c.blocks.size > 1) PetscCall(MatSeqSBAIJRestoreArray(c.factor, &inverses));
    PetscFunctionReturn(0);
}

// Blocks that have no inverse in numbers. One that has, however near singular, stays: inverse iteration lives of it.
template <int size>
PetscInt count_zero(PetscInt pivots, const double* inverses) {
    PetscInt found = 0;
    for (PetscInt k = 0; k < pivots; ++k) {
        const Eigen::Map<const Block<size>> inverse(inverses + k * size * size);
        found += !inverse.allFinite() || inverse.isZero(0.0);
    }
    return found;
}

// Whether a symmetric block is positive definite beyond doubt: its pivots are far above the rounding of its diagonal.
template <int size>
bool surely_positive(Block<size> a) {
    const Eigen::Matrix<double, size, 1> least = 1e-10 * a.diagonal();
    for (int k = 0; k < size; ++k) {
        if (!(a(k, k) > 0.0 && a(k, k) > least[k])) return false;
        for (int i = k + 1; i < size; ++i)
            for (int j = k + 1; j <= i; ++j) a(i, j) -= a(i, k) * a(j, k) / a(k, k);
    }
    return true;
}

template <int size>
PetscInt count_negative(PetscInt pivots, const double* inverses) {
    PetscInt found = 0;
    for (PetscInt k = 0; k < pivots; ++k) {
        const Eigen::Map<const Block<size>> raw(inverses + k * size * size);
        const Block<size> inverse = 0.5 * (raw + raw.transpose()) / raw.cwiseAbs().maxCoeff();
        if (surely_positive<size>(inverse)) continue;
        // By iteration: closed forms give small eigenvalues of graded blocks the wrong sign.
        const Eigen::SelfAdjointEigenSolver<Block<size>> solver(inverse, Eigen::EigenvaluesOnly);
        found += (solver.eigenvalues().array() < 0.0).count();
    }
    return found;
}

// Takes the Schur complement of the border out of the rows that it has in a factor, which are left as those of ones: a
// forward substitution leaves there what the border's equations have on their right, without the inside.
template <int size>
void take_complement(NodeCholesky& c, const BlockRows& own) {
    const PetscInt first = c.pivots(), wide = c.border, numbers = size * size;
    c.complement.assign(static_cast<std::size_t>(wide) * wide, 0.0);
    const auto take = [&](PetscInt i, PetscInt j, double* block) {
        for (PetscInt column = 0; column < size; ++column)
            for (PetscInt row = 0; row < size; ++row) {
                const PetscInt at = size * (i - first) + row, to = size * (j - first) + column;
                c.complement[at * wide + to] = c.complement[to * wide + at] = block[column * size + row];
            }
        std::fill_n(block, numbers, 0.0);
    };
    for (PetscInt k = first; k < own.count; ++k) {
        take(k, k, own.value + k * numbers);
        for (PetscInt d = 0; d < size; ++d) own.value[k * numbers + d * (size + 1)] = 1.0;
        for (PetscInt j = own.start[k]; j < own.start[k + 1]; ++j) take(k, own.column[j], own.value + j * numbers);
    }
}

template <int size>
PetscErrorCode make_blocks_of(NodeCholesky& c, const double* values, BlockFactor<size>& maker) {
    const UpperBlocks& u = c.blocks;
    const StoredBlocks from{static_cast<PetscInt>(u.order.size()),
                            u.starts.data(),
                            u.columns.data(),
                            u.from.data(),
                            u.length.data(),
                            values};
    PetscFunctionBegin;
    PetscCall(with_rows(c.factor, [&](BlockRows own) {
        double* held;
        PetscFunctionBegin;
        PetscCall(MatSeqSBAIJGetArray(c.factor, &held));
        if constexpr (size == 1)
            own = c.numbers.rows();
        else
            own.value = held;
        const double products = maker.make(from, own, c.border / size);
        if (c.border) take_complement<size>(c, own);
        if constexpr (size == 1) c.numbers.copy(held);
        PetscCall(MatSeqSBAIJRestoreArray(c.factor, &held));
        PetscCall(PetscLogFlops(2.0 * size * size * size * products));
        PetscFunctionReturn(0);
    }));
    PetscFunctionReturn(0);
}

// PETSc's substitutions in natural order, which it sets with the numbers of a factor: those of a matrix of one block.
PetscErrorCode set_substitutions(Mat factor, PetscInt size) {
    static _MatOps known[4];
    PetscFunctionBegin;
    if (!known[size].solve) {
        const PetscInt start[] = {0, 1}, column[] = {0};
        const PetscScalar triple[] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}, pair[] = {1.0, 0.0, 0.0, 1.0};
        MatFactorInfo info;
        Mat single, made;
        IS rows, columns;
        PetscCall(MatFactorInfoInitialize(&info));
        PetscCall(MatCreate(PETSC_COMM_SELF, &single));
        PetscCall(MatSetSizes(single, size, size, size, size));
        PetscCall(MatSetType(single, MATSEQSBAIJ));
        PetscCall(MatSeqSBAIJSetPreallocationCSR(single, size, start, column, size == 2 ? pair : triple));
        PetscCall(MatGetFactor(single, MATSOLVERPETSC, MAT_FACTOR_CHOLESKY, &made));
        PetscCall(MatGetOrdering(single, MATORDERINGNATURAL, &rows, &columns));
        PetscCall((*made->ops->choleskyfactorsymbolic)(made, single, rows, &info));
        PetscCall((*made->ops->choleskyfactornumeric)(made, single, &info));
        known[size] = *made->ops;
        PetscCall(ISDestroy(&rows));
        PetscCall(ISDestroy(&columns));
        PetscCall(MatDestroy(&made));
        PetscCall(MatDestroy(&single));
    }
    factor->ops->solve = known[size].solve;
    factor->ops->solvetranspose = known[size].solvetranspose;
    factor->ops->forwardsolve = known[size].forwardsolve;
    factor->ops->backwardsolve = known[size].backwardsolve;
    // Of single numbers PETSc's halves take roots of pivots, which may be negative.
    if (size == 1) factor->ops->forwardsolve = factor->ops->backwardsolve = nullptr;
    factor->assembled = factor->preallocated = PETSC_TRUE;
    PetscFunctionReturn(0);
}

PetscErrorCode numeric(Mat F, Mat A, const MatFactorInfo* info) {
    PetscFunctionBegin;
    PetscCall(dissect_if_due(F, A, info));
    NodeCholesky* c = of(F);
    const PetscInt size = c->blocks.size;
    const double* values;
    c->factor->factorerrortype = MAT_FACTOR_NOERROR;
    c->zero = 0;
    PetscCall(MatSeqAIJGetArrayRead(A, &values));
    if (size == 1) PetscCall(make_blocks_of(*c, values, c->singles));
    if (size == 2) PetscCall(make_blocks_of(*c, values, c->pairs));
    if (size == 3) PetscCall(make_blocks_of(*c, values, c->triples));
    PetscCall(MatSeqAIJRestoreArrayRead(A, &values));
    PetscCall(set_substitutions(c->factor, size));
    PetscCall(count_pivots(*c, {count_zero<1>, count_zero<2>, count_zero<3>}, &c->zero));
    F->factorerrortype = c->zero ? MAT_FACTOR_NUMERIC_ZEROPIVOT : MAT_FACTOR_NOERROR;
    PetscFunctionReturn(0);
}

// Forward substitution of `right` into `solution`, and backward from there into `right`.
PetscErrorCode go_forward(NodeCholesky* c) {
    if (c->factor->ops->forwardsolve) return (*c->factor->ops->forwardsolve)(c->factor, c->b, c->x);
    std::copy(c->right.begin(), c->right.end(), c->solution.begin());
    substitute_forward<1>(c->numbers.rows(), c->solution.data());
    return 0;
}
PetscErrorCode go_backward(NodeCholesky* c) {
    if (c->factor->ops->backwardsolve) return (*c->factor->ops->backwardsolve)(c->factor, c->x, c->b);
    std::copy(c->solution.begin(), c->solution.end(), c->right.begin());
    substitute_backward<1>(c->numbers.rows(), c->right.data());
    return 0;
}

// Both substitutions of `right` in the place of a large factor, into `solution`; `taken` is whether the factor is one.
PetscErrorCode substitute_in_place(NodeCholesky* c, bool* taken) {
    PetscFunctionBegin;
    *taken = false;
    if (c->blocks.size != 3) PetscFunctionReturn(0);
    PetscCall(with_rows(c->factor, [c, taken](BlockRows own) {
        const std::size_t numbers = 9 * static_cast<std::size_t>(own.start[own.count]);
        PetscFunctionBegin;
        *taken = numbers > in_place;
        if (!*taken) PetscFunctionReturn(0);
        PetscCall(MatSeqSBAIJGetArray(c->factor, &own.value));
        std::copy(c->right.begin(), c->right.end(), c->solution.begin());
        substitute<3>(own, c->solution.data());
        PetscCall(MatSeqSBAIJRestoreArray(c->factor, &own.value));
        PetscCall(PetscLogFlops(4.0 * static_cast<double>(numbers)));
        PetscFunctionReturn(0);
    }));
    PetscFunctionReturn(0);
}

PetscErrorCode solve(Mat F, Vec b, Vec x) {
    NodeCholesky* c = of(F);
    const PetscInt size = c->blocks.size, n = static_cast<PetscInt>(c->blocks.order.size());
    const PetscInt* order = c->blocks.order.data();
    const double* from;
    double* to;
    PetscFunctionBegin;
    PetscCall(VecGetArrayRead(b, &from));
    for (PetscInt k = 0; k < n; ++k)
        for (PetscInt d = 0; d < size; ++d) c->right[size * k + d] = from[size * order[k] + d];
    PetscCall(VecRestoreArrayRead(b, &from));
    if (c->border) {
        PetscCall(go_forward(c));
        std::fill(c->solution.end() - c->border, c->solution.end(), 0.0);
        PetscCall(go_backward(c));
        std::copy(c->right.begin(), c->right.end(), c->solution.begin());
    } else {
        bool taken;
        PetscCall(substitute_in_place(c, &taken));
        if (!taken) PetscCall((*c->factor->ops->solve)(c->factor, c->b, c->x));
    }
    PetscCall(VecGetArrayWrite(x, &to));
    for (PetscInt k = 0; k < n; ++k)
        for (PetscInt d = 0; d < size; ++d) to[size * order[k] + d] = c->solution[size * k + d];
    PetscCall(VecRestoreArrayWrite(x, &to));
    PetscFunctionReturn(0);
}

PetscErrorCode inertia(Mat F, PetscInt* negative, PetscInt* zero, PetscInt* positive) {
    NodeCholesky* c = of(F);
    PetscInt below;
    PetscFunctionBegin;
    PetscCall(count_pivots(*c, {count_negative<1>, count_negative<2>, count_negative<3>}, &below));
    if (negative) *negative = below;
    if (zero) *zero = c->zero;
    if (positive) *positive = F->rmap->n - c->border - below - c->zero;
    PetscFunctionReturn(0);
}

PetscErrorCode get_info(Mat F, MatInfoType type, MatInfo* info) {
    PetscFunctionBegin;
    PetscCall(MatGetInfo(of(F)->factor, type, info));
    PetscFunctionReturn(0);
}

PetscErrorCode view(Mat F, PetscViewer viewer) {
    PetscFunctionBegin;
    PetscCall(PetscViewerASCIIPrintf(viewer, "  blocks of one node, ordered by minimum degree or dissection\n"));
    if (of(F)->factor) PetscCall(MatView(of(F)->factor, viewer));
    PetscFunctionReturn(0);
}

PetscErrorCode get_solver(Mat, MatSolverType* type) {
    *type = NODE_BLOCKS;
    return 0;
}

PetscErrorCode get_factor(Mat A, MatFactorType type, Mat* F) {
    PetscFunctionBegin;
    PetscCall(MatCreate(PetscObjectComm(reinterpret_cast<PetscObject>(A)), F));
    PetscCall(MatSetSizes(*F, A->rmap->n, A->cmap->n, A->rmap->n, A->cmap->n));
    PetscCall(PetscStrallocpy(NODE_BLOCKS, &reinterpret_cast<PetscObject>(*F)->type_name));
    PetscCall(MatSetUp(*F));
    (*F)->data = new NodeCholesky;
    (*F)->ops->choleskyfactorsymbolic = symbolic;
    (*F)->ops->solve = (*F)->ops->solvetranspose = solve;
    (*F)->ops->getinertia = inertia;
    (*F)->ops->getinfo = get_info;
    (*F)->ops->view = view;
    (*F)->ops->destroy = destroy;
    (*F)->factortype = type;
    (*F)->assembled = PETSC_TRUE;
    PetscCall(PetscFree((*F)->solvertype));
    PetscCall(PetscStrallocpy(NODE_BLOCKS, &(*F)->solvertype));
    PetscCall(PetscObjectComposeFunction(reinterpret_cast<PetscObject>(*F), "MatFactorGetSolverType_C", get_solver));
    PetscFunctionReturn(0);
}

}  // namespace

Mat factor_in_blocks(Mat factor) { return factor->ops->destroy == destroy ? of(factor)->factor : nullptr; }

PetscErrorCode keep_border(Mat factor, PetscInt unknowns, PetscInt fields) {
    PetscFunctionBegin;
    PetscCheck(factor->ops->destroy == destroy, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "not a factor of node_blocks");
    of(factor)->border = unknowns;
    of(factor)->fields = fields;
    PetscFunctionReturn(0);
}

PetscErrorCode kept_border(Mat factor, PetscInt* unknowns) {
    PetscFunctionBegin;
    PetscCheck(factor->ops->destroy == destroy, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "not a factor of node_blocks");
    *unknowns = of(factor)->border;
    PetscFunctionReturn(0);
}

PetscErrorCode border_complement(Mat factor, double* complement) {
    PetscFunctionBegin;
    PetscCheck(factor->ops->destroy == destroy, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "not a factor of node_blocks");
    std::copy(of(factor)->complement.begin(), of(factor)->complement.end(), complement);
    PetscFunctionReturn(0);
}

PetscErrorCode eliminate_inside(Mat factor, const double* inside, double* border) {
    PetscFunctionBegin;
    PetscCheck(factor->ops->destroy == destroy, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "not a factor of node_blocks");
    NodeCholesky* c = of(factor);
    const PetscInt size = c->blocks.size, pivots = c->pivots();
    const PetscInt* order = c->blocks.order.data();
    for (PetscInt k = 0; k < pivots; ++k) std::copy_n(inside + size * order[k], size, c->right.begin() + size * k);
    std::fill(c->right.end() - c->border, c->right.end(), 0.0);
    PetscCall(go_forward(c));
    for (PetscInt k = pivots; k < pivots + c->border / size; ++k)
        std::copy_n(c->solution.begin() + size * k, size, border + size * (order[k] - pivots));
    PetscFunctionReturn(0);
}

PetscErrorCode complete_inside(Mat factor, const double* border, double* inside) {
    PetscFunctionBegin;
    PetscCheck(factor->ops->destroy == destroy, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "not a factor of node_blocks");
    NodeCholesky* c = of(factor);
    const PetscInt size = c->blocks.size, pivots = c->pivots();
    const PetscInt* order = c->blocks.order.data();
    for (PetscInt k = pivots; k < pivots + c->border / size; ++k)
        std::copy_n(border + size * (order[k] - pivots), size, c->solution.begin() + size * k);
    PetscCall(go_backward(c));
    for (PetscInt k = 0; k < pivots; ++k) std::copy_n(c->right.begin() + size * k, size, inside + size * order[k]);
    PetscFunctionReturn(0);
}

PetscErrorCode register_node_cholesky() {
    static bool known = false;
    PetscFunctionBegin;
    if (!known) PetscCall(MatSolverTypeRegister(NODE_BLOCKS, MATSEQAIJ, MAT_FACTOR_CHOLESKY, get_factor));
    known = true;
    PetscFunctionReturn(0);
}

}  // namespace restshape
