#include "algebra/node_cholesky.hpp"

#include <petsc/private/matimpl.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "algebra/block_factor.hpp"
#include "algebra/block_substitution.hpp"
#include "algebra/factor_pattern.hpp"
#include "algebra/node_graph.hpp"
#include "algebra/within_memory.hpp"

// PETSc's factor in symmetric blocks takes the natural order alone, and an analysis that grows with the square of its
// rows. This one is found by rows (`factor_pattern`), made by rows of alike columns (`BlockFactor`), and substituted in
// its place, or by what has been told (`Substitution`).
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

struct NodeCholesky {
    UpperBlocks blocks;
    PetscInt made = 0;  // factors of this pattern
    FactorPattern pattern;
    std::unique_ptr<double[]> values;            // pivots inverted, before all rows, and rows of -U
    std::vector<double> right, solution;         // in elimination order
    std::shared_ptr<Substitution> substitution;  // another one, of this pattern
    bool substituted = false;                    // which has the present numbers
    BlockFactor<1> singles;
    BlockFactor<2> pairs;
    BlockFactor<3> triples;
    PetscInt zero = 0;               // blocks without an inverse, each counted once
    PetscInt border = 0;             // the last unknowns, which are no pivots
    PetscInt fields = 0;             // unknowns a node where they are given; else the pattern shows them
    std::vector<double> complement;  // of them, by rows
    // Of a rank's rows in two parts: entries in the first one, and lengths of rows in the second.
    PetscInt first_part = std::numeric_limits<PetscInt>::max();
    std::vector<PetscInt> second_length;
    PetscInt pivots() const { return static_cast<PetscInt>(blocks.order.size()) - border / blocks.size; }
    BlockRows rows() const {
        return {static_cast<PetscInt>(blocks.order.size()), pattern.start.data(), pattern.column.data(), values.get()};
    }
    std::size_t numbers() const { return pattern.column.size() * blocks.size * blocks.size; }
};

NodeCholesky* of(Mat F) { return static_cast<NodeCholesky*>(F->data); }

PetscErrorCode destroy(Mat F) {
    PetscFunctionBegin;
    delete of(F);
    F->data = nullptr;
    PetscFunctionReturn(0);
}

// Lays out the pattern of what is factored, in an order by this elimination.
using LayOut = std::function<PetscErrorCode(Elimination)>;

// The same of a pattern that is at hand.
PetscErrorCode lay_out_pattern(NodeCholesky* c, const Pattern& a, Elimination by) {
    const PetscInt size = block_size(a, c->fields);
    PetscFunctionBegin;
    PetscCheck(c->border % size == 0, PETSC_COMM_SELF, PETSC_ERR_SUP, "node_blocks keeps whole nodes");
    PetscCall(make_blocks(a, size, &c->blocks, c->border / size, by));
    PetscFunctionReturn(0);
}

// Room for the numbers of the factor of blocks that are laid out: there is none until all is there.
PetscErrorCode with_room(Mat F, const std::function<PetscErrorCode()>& lay_out) {
    NodeCholesky* c = of(F);
    PetscFunctionBegin;
    c->substitution.reset();
    c->substituted = false;
    c->values.reset();
    PetscCall(lay_out());
    c->pattern = factor_pattern(c->blocks);
    c->right.resize(F->rmap->n);
    c->solution.resize(F->rmap->n);
    c->values.reset(new double[c->numbers()]);
    PetscFunctionReturn(0);
}

PetscErrorCode numeric(Mat F, Mat A, const MatFactorInfo* info);

// Of a sequential AIJ matrix.
PetscErrorCode lay_out(Mat F, Mat A, Elimination by) {
    PetscFunctionBegin;
    PetscCall(with_room(F, [&]() -> PetscErrorCode {
        Pattern a;
        PetscBool done;
        PetscFunctionBegin;
        PetscCall(MatGetRowIJ(A, 0, PETSC_FALSE, PETSC_FALSE, &a.rows, &a.starts, &a.columns, &done));
        PetscCheck(done, PETSC_COMM_SELF, PETSC_ERR_SUP, "node_blocks needs rows and columns of a sequential matrix");
        PetscCall(lay_out_pattern(of(F), a, by));
        PetscCall(MatRestoreRowIJ(A, 0, PETSC_FALSE, PETSC_FALSE, &a.rows, &a.starts, &a.columns, &done));
        PetscFunctionReturn(0);
    }));
    F->ops->choleskyfactornumeric = numeric;
    PetscFunctionReturn(0);
}

// Where the blocks of a pattern of a rank's rows are: what is laid out has them where the pattern has.
void find_in_rows(NodeCholesky* c, const SharedRows& rows, const PetscInt* number, const BorderedPattern& found) {
    UpperBlocks& u = c->blocks;
    const auto size = static_cast<std::size_t>(u.size);
    std::vector<PetscInt> row_of(found.start.size() - 1, -1);
    for (PetscInt row = 0; row < rows.count(); ++row)
        if (number[row] >= 0 && number[row] < static_cast<PetscInt>(row_of.size()) - c->border)
            row_of[number[row]] = row;
    c->first_part = rows.entries();
    c->second_length.assign(u.order.size(), 0);
    for (std::size_t k = 0; k < u.order.size(); ++k) {
        const PetscInt row = row_of[size * u.order[k]], wide = u.length[k];
        if (row >= 0) u.length[k] = rows.length(row), c->second_length[k] = rows.other_length(row);
        for (PetscInt j = u.starts[k]; j < u.starts[k + 1]; ++j) {
            const PetscInt at = u.from[j], first = u.from[j] = found.entry[at];
            const PetscInt length = first < c->first_part ? u.length[k] : c->second_length[k];
            for (std::size_t r = 0; r < size && first >= 0; ++r)
                for (std::size_t d = 0; d < size; ++d)
                    if (found.entry[at + r * wide + d] != static_cast<PetscInt>(first + r * length + d))
                        throw std::invalid_argument("the unknowns of a node do not lie side by side");
        }
    }
}

PetscErrorCode lay_out_rows(Mat F, const SharedRows& rows, const PetscInt* number, Elimination by) {
    PetscFunctionBegin;
    PetscCall(with_room(F, [&]() -> PetscErrorCode {
        NodeCholesky* c = of(F);
        const PetscInt border = c->border, inside = F->rmap->n - border;
        PetscFunctionBegin;
        const BorderedPattern found = bordered_pattern(rows, number, inside, border, std::max<PetscInt>(c->fields, 1));
        PetscCall(lay_out_pattern(c, {F->rmap->n, found.start.data(), found.column.data()}, by));
        find_in_rows(c, rows, number, found);
        PetscFunctionReturn(0);
    }));
    PetscFunctionReturn(0);
}

PetscErrorCode symbolic(Mat F, Mat A, IS, const MatFactorInfo*) {
    PetscFunctionBegin;
    of(F)->made = 0;
    PetscCall(within_memory(F, [&] { return lay_out(F, A, Elimination::minimum_degree); }));
    F->factorerrortype = MAT_FACTOR_NOERROR;
    PetscFunctionReturn(0);
}

// Products of two blocks that a factor takes, about.
double count_products(const FactorPattern& pattern) {
    double products = 0.0;
    for (std::size_t k = 0; k + 1 < pattern.start.size(); ++k) {
        const auto wide = static_cast<double>(pattern.start[k + 1] - pattern.start[k] + 1);
        products += 0.5 * wide * (wide + 1.0);
    }
    return products;
}

// Orders a pattern by nested dissection once it has been factored several times, a very large one before, where that
// takes fewer products: in slender bodies it does not.
PetscErrorCode dissect_if_due(Mat F, const LayOut& lay_out) {
    NodeCholesky* c = of(F);
    PetscFunctionBegin;
    const auto nodes = static_cast<PetscInt>(c->blocks.order.size());
    const PetscInt made_before = nodes >= dissected_at_once ? 0 : several;
    const bool due = c->made++ == made_before && c->blocks.size == 3 && c->border == 0 && has_dissection();
    if (!due || nodes < large) PetscFunctionReturn(0);
    const double before = count_products(c->pattern);
    PetscCall(lay_out(Elimination::dissection));
    if (!(count_products(c->pattern) < before)) PetscCall(lay_out(Elimination::minimum_degree));
    PetscFunctionReturn(0);
}

// The factor's diagonal blocks, inverted, stored before its rows: A = U' D U with D in blocks, so that D has the
// inertia of A (Sylvester).
template <int size>
using Block = Eigen::Matrix<double, size, size>;

// A count of them, for a size that is known.
using Count = PetscInt (*)(PetscInt pivots, const double* inverses);

PetscInt count_pivots(const NodeCholesky& c, const Count (&of_size)[3]) {
    return of_size[c.blocks.size - 1](c.pivots(), c.values.get());
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
PetscErrorCode make_blocks_of(NodeCholesky& c, const StoredBlocks& from, BlockFactor<size>& maker) {
    PetscFunctionBegin;
    const double products = maker.make(from, c.rows(), c.border / size);
    if (c.border) take_complement<size>(c, c.rows());
    PetscCall(PetscLogFlops(2.0 * size * size * size * products));
    PetscFunctionReturn(0);
}

// The factor of values of a matrix, in one part or two, whose pattern is laid out where it is not yet.
PetscErrorCode make_numbers(Mat F, const LayOut& lay_out, const double* values, const double* second = nullptr) {
    NodeCholesky* c = of(F);
    PetscFunctionBegin;
    // Memory has not held the order before.
    if (!c->values) PetscCall(lay_out(Elimination::minimum_degree));
    PetscCall(dissect_if_due(F, lay_out));
    const UpperBlocks& u = c->blocks;
    const StoredBlocks from{static_cast<PetscInt>(u.order.size()),
                            u.starts.data(),
                            u.columns.data(),
                            u.from.data(),
                            u.length.data(),
                            values,
                            c->first_part,
                            c->second_length.data(),
                            second};
    c->substituted = false;
    if (u.size == 1) PetscCall(make_blocks_of(*c, from, c->singles));
    if (u.size == 2) PetscCall(make_blocks_of(*c, from, c->pairs));
    if (u.size == 3) PetscCall(make_blocks_of(*c, from, c->triples));
    c->zero = count_pivots(*c, {count_zero<1>, count_zero<2>, count_zero<3>});
    F->factorerrortype = c->zero ? MAT_FACTOR_NUMERIC_ZEROPIVOT : MAT_FACTOR_NOERROR;
    PetscFunctionReturn(0);
}

PetscErrorCode numeric(Mat F, Mat A, const MatFactorInfo*) {
    const double* values;
    PetscFunctionBegin;
    PetscCall(MatSeqAIJGetArrayRead(A, &values));
    PetscCall(within_memory(F, [&] {
        return make_numbers(
            F, [&](Elimination by) { return lay_out(F, A, by); }, values);
    }));
    PetscCall(MatSeqAIJRestoreArrayRead(A, &values));
    PetscFunctionReturn(0);
}

// Calls with the size of a block.
template <class Visit>
void with_size(PetscInt size, Visit visit) {
    if (size == 1) return visit(std::integral_constant<int, 1>{});
    if (size == 2) return visit(std::integral_constant<int, 2>{});
    visit(std::integral_constant<int, 3>{});
}

// Forward substitution of `right` into `solution`, and backward from there into `right`.
void go_forward(NodeCholesky* c) {
    if (c->substituted) return c->substitution->forward(c->right.data(), c->solution.data());
    std::copy(c->right.begin(), c->right.end(), c->solution.begin());
    with_size(c->blocks.size, [c](auto size) { substitute_forward<size()>(c->rows(), c->solution.data()); });
}
void go_backward(NodeCholesky* c) {
    if (c->substituted) return c->substitution->backward(c->solution.data(), c->right.data());
    std::copy(c->solution.begin(), c->solution.end(), c->right.begin());
    with_size(c->blocks.size, [c](auto size) { substitute_backward<size()>(c->rows(), c->right.data()); });
}

// Both substitutions of `right`, in its place.
void go_both(NodeCholesky* c) {
    if (c->substituted) return c->substitution->solve(c->right.data(), c->right.data());
    with_size(c->blocks.size, [c](auto size) { substitute<size()>(c->rows(), c->right.data()); });
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
        go_forward(c);
        std::fill(c->solution.end() - c->border, c->solution.end(), 0.0);
        go_backward(c);
    } else {
        go_both(c);
    }
    PetscCall(PetscLogFlops(4.0 * static_cast<double>(c->numbers())));
    PetscCall(VecGetArrayWrite(x, &to));
    for (PetscInt k = 0; k < n; ++k)
        for (PetscInt d = 0; d < size; ++d) to[size * order[k] + d] = c->right[size * k + d];
    PetscCall(VecRestoreArrayWrite(x, &to));
    PetscFunctionReturn(0);
}

PetscErrorCode inertia(Mat F, PetscInt* negative, PetscInt* zero, PetscInt* positive) {
    NodeCholesky* c = of(F);
    PetscFunctionBegin;
    const PetscInt below = count_pivots(*c, {count_negative<1>, count_negative<2>, count_negative<3>});
    if (negative) *negative = below;
    if (zero) *zero = c->zero;
    if (positive) *positive = F->rmap->n - c->border - below - c->zero;
    PetscFunctionReturn(0);
}

PetscErrorCode get_info(Mat F, MatInfoType, MatInfo* info) {
    const NodeCholesky* c = of(F);
    PetscFunctionBegin;
    *info = MatInfo{};
    info->block_size = c->blocks.size;
    info->nz_allocated = info->nz_used = static_cast<PetscLogDouble>(c->numbers());
    info->memory = static_cast<PetscLogDouble>(c->numbers() * sizeof(double) +
                                               (c->pattern.column.size() + c->pattern.start.size()) * sizeof(PetscInt));
    PetscFunctionReturn(0);
}

PetscErrorCode view(Mat F, PetscViewer viewer) {
    PetscFunctionBegin;
    PetscCall(PetscViewerASCIIPrintf(viewer, "  blocks of one node, ordered by minimum degree or dissection\n"));
    PetscCall(PetscViewerASCIIPrintf(viewer, "  %" PetscInt_FMT " unknowns a node, %.0f nonzeros\n", of(F)->blocks.size,
                                     static_cast<double>(of(F)->numbers())));
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

bool in_node_blocks(Mat factor) { return factor->ops->destroy == destroy; }

BlockRows factor_rows(Mat factor) { return of(factor)->rows(); }
PetscInt factor_block_size(Mat factor) { return of(factor)->blocks.size; }
std::shared_ptr<Substitution> kept_substitution(Mat factor) { return of(factor)->substitution; }
bool substituted_by_it(Mat factor) { return of(factor)->substituted; }

void substitute_by(Mat factor, std::shared_ptr<Substitution> way) {
    of(factor)->substitution = std::move(way);
    of(factor)->substituted = true;
}

void substitute_in_place(Mat factor, double* x) {
    with_size(of(factor)->blocks.size, [&](auto size) { substitute<size()>(of(factor)->rows(), x); });
}

PetscErrorCode keep_border(Mat factor, PetscInt unknowns, PetscInt fields) {
    PetscFunctionBegin;
    PetscCheck(in_node_blocks(factor), PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "not a factor of node_blocks");
    of(factor)->border = unknowns;
    of(factor)->fields = fields;
    PetscFunctionReturn(0);
}

PetscErrorCode kept_border(Mat factor, PetscInt* unknowns) {
    PetscFunctionBegin;
    PetscCheck(in_node_blocks(factor), PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "not a factor of node_blocks");
    *unknowns = of(factor)->border;
    PetscFunctionReturn(0);
}

PetscErrorCode factor_shared_rows(Mat F, const SharedRows& rows, const PetscInt* number) {
    const auto lay_out = [&](Elimination by) { return lay_out_rows(F, rows, number, by); };
    PetscFunctionBegin;
    PetscCheck(in_node_blocks(F), PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "not a factor of node_blocks");
    PetscCheck(!of(F)->values || of(F)->first_part == rows.entries(), PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG,
               "rows of another pattern");
    // As PETSc counts its own calls.
    PetscCall(PetscLogEventBegin(MAT_CholeskyFactorNumeric, F, 0, 0, 0));
    PetscCall(within_memory(F, [&] { return make_numbers(F, lay_out, rows.values(), rows.other_values()); }));
    PetscCall(PetscLogEventEnd(MAT_CholeskyFactorNumeric, F, 0, 0, 0));
    PetscCall(PetscObjectStateIncrease(reinterpret_cast<PetscObject>(F)));
    PetscFunctionReturn(0);
}

PetscErrorCode border_complement(Mat factor, double* complement) {
    PetscFunctionBegin;
    PetscCheck(in_node_blocks(factor), PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "not a factor of node_blocks");
    std::copy(of(factor)->complement.begin(), of(factor)->complement.end(), complement);
    PetscFunctionReturn(0);
}

PetscErrorCode eliminate_inside(Mat factor, const double* inside, double* border) {
    PetscFunctionBegin;
    PetscCheck(in_node_blocks(factor), PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "not a factor of node_blocks");
    NodeCholesky* c = of(factor);
    const PetscInt size = c->blocks.size, pivots = c->pivots();
    const PetscInt* order = c->blocks.order.data();
    for (PetscInt k = 0; k < pivots; ++k) std::copy_n(inside + size * order[k], size, c->right.begin() + size * k);
    std::fill(c->right.end() - c->border, c->right.end(), 0.0);
    go_forward(c);
    for (PetscInt k = pivots; k < pivots + c->border / size; ++k)
        std::copy_n(c->solution.begin() + size * k, size, border + size * (order[k] - pivots));
    PetscFunctionReturn(0);
}

PetscErrorCode complete_inside(Mat factor, const double* border, double* inside) {
    PetscFunctionBegin;
    PetscCheck(in_node_blocks(factor), PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "not a factor of node_blocks");
    NodeCholesky* c = of(factor);
    const PetscInt size = c->blocks.size, pivots = c->pivots();
    const PetscInt* order = c->blocks.order.data();
    for (PetscInt k = pivots; k < pivots + c->border / size; ++k)
        std::copy_n(border + size * (order[k] - pivots), size, c->solution.begin() + size * k);
    go_backward(c);
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
