#include "algebra/grid_cycle.hpp"

#include <petsc/private/pcimpl.h>
#include <petscksp.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "algebra/ghosts.hpp"
#include "algebra/grid_matrix.hpp"
#include "algebra/grid_transfer.hpp"

namespace restshape {
namespace {

constexpr const char* key = "restshape_cycle";

struct Grid {
    std::unique_ptr<GridMatrix> matrix;
    std::unique_ptr<GridTransfer> transfer;
    Ghosts neighbours, coarse_neighbours;
    std::vector<double> right, x, rest, change;
};

struct Cycle {
    std::vector<std::unique_ptr<Grid>> grids;  // the coarsest of these is one above PETSc's coarsest
    std::vector<double> right, x;              // of PETSc's coarsest
    Vec b = nullptr, solution = nullptr;
    KSP coarsest = nullptr;
    double flops = 0.0;
    PetscErrorCode (*own)(PC, Vec, Vec) = nullptr;  // PETSc's

    Cycle() = default;
    ~Cycle() {
        (void)VecDestroy(&b);
        (void)VecDestroy(&solution);
    }
    Cycle(const Cycle&) = delete;
    Cycle& operator=(const Cycle&) = delete;
};

PetscErrorCode release(void* context) {
    delete static_cast<Cycle*>(context);
    return 0;
}

PetscErrorCode cycle_of(PC pc, Cycle** found) {
    PetscObject container = nullptr;
    void* context = nullptr;
    PetscFunctionBegin;
    PetscCall(PetscObjectQuery(reinterpret_cast<PetscObject>(pc), key, &container));
    if (container) PetscCall(PetscContainerGetPointer(reinterpret_cast<PetscContainer>(container), &context));
    *found = static_cast<Cycle*>(context);
    PetscFunctionReturn(0);
}

// x = 0 and the cycle below a grid, for b.
PetscErrorCode descend(Cycle& c, std::size_t level, const double* b, double* x) {
    PetscFunctionBegin;
    if (level == 0) {
        PetscCall(VecPlaceArray(c.b, b));
        PetscCall(VecPlaceArray(c.solution, x));
        PetscCall(KSPSolve(c.coarsest, c.b, c.solution));
        PetscCall(VecResetArray(c.b));
        PetscCall(VecResetArray(c.solution));
        PetscFunctionReturn(0);
    }
    Grid& g = *c.grids[level - 1];
    std::vector<double>& right = level == 1 ? c.right : c.grids[level - 2]->right;
    std::vector<double>& below = level == 1 ? c.x : c.grids[level - 2]->x;
    g.matrix->down(b, x, g.rest.data());
    if (!g.neighbours.none()) {
        PetscCall(g.neighbours.fetch(x));
        g.matrix->couple(g.neighbours.values.data(), g.rest.data());
    }
    std::fill(right.begin(), right.end(), 0.0);
    std::fill(g.coarse_neighbours.values.begin(), g.coarse_neighbours.values.end(), 0.0);
    g.transfer->restrict_to(g.rest.data(), right.data(), g.coarse_neighbours.values.data());
    PetscCall(g.coarse_neighbours.add_to(right.data()));
    PetscCall(descend(c, level - 1, right.data(), below.data()));
    PetscCall(g.coarse_neighbours.fetch(below.data()));
    g.transfer->prolong(below.data(), g.coarse_neighbours.values.data(), g.change.data());
    if (!g.neighbours.none()) {
        PetscCall(g.neighbours.fetch(g.change.data()));
        g.matrix->couple(g.neighbours.values.data(), g.rest.data());
    }
    g.matrix->up(g.change.data(), x, g.rest.data());
    PetscFunctionReturn(0);
}

PetscErrorCode apply(PC pc, Vec b, Vec x) {
    Cycle* c;
    const double* right;
    double* left;
    PetscFunctionBegin;
    PetscCall(cycle_of(pc, &c));
    PetscCall(VecGetArrayRead(b, &right));
    PetscCall(VecGetArrayWrite(x, &left));
    PetscCall(descend(*c, c->grids.size(), right, left));
    PetscCall(VecRestoreArrayWrite(x, &left));
    PetscCall(VecRestoreArrayRead(b, &right));
    PetscCall(PetscLogFlops(c->flops));
    PetscFunctionReturn(0);
}

std::unique_ptr<GridMatrix> matrix_of(PetscInt size) {
    switch (size) {
        case 1:
            return std::make_unique<BlockGridMatrix<1>>();
        case 2:
            return std::make_unique<BlockGridMatrix<2>>();
        case 3:
            return std::make_unique<BlockGridMatrix<3>>();
        case 6:
            return std::make_unique<BlockGridMatrix<6>>();
        default:
            return nullptr;
    }
}

std::unique_ptr<GridTransfer> transfer_of(PetscInt fine, PetscInt coarse) {
    switch (10 * fine + coarse) {
        case 11:
            return std::make_unique<BlockGridTransfer<1, 1>>();
        case 22:
            return std::make_unique<BlockGridTransfer<2, 2>>();
        case 23:
            return std::make_unique<BlockGridTransfer<2, 3>>();
        case 33:
            return std::make_unique<BlockGridTransfer<3, 3>>();
        case 36:
            return std::make_unique<BlockGridTransfer<3, 6>>();
        case 66:
            return std::make_unique<BlockGridTransfer<6, 6>>();
        default:
            return nullptr;
    }
}

PetscErrorCode stored(Mat mat, StoredRows* rows) {
    PetscBool done;
    PetscFunctionBegin;
    PetscCall(MatGetRowIJ(mat, 0, PETSC_FALSE, PETSC_FALSE, &rows->rows, &rows->start, &rows->column, &done));
    PetscCheck(done, PETSC_COMM_SELF, PETSC_ERR_SUP, "the rows of a matrix are not to be had");
    PetscCall(MatSeqAIJGetArrayRead(mat, &rows->value));
    PetscFunctionReturn(0);
}

PetscErrorCode restore(Mat mat, StoredRows* rows) {
    PetscBool done;
    PetscFunctionBegin;
    PetscCall(MatSeqAIJRestoreArrayRead(mat, &rows->value));
    PetscCall(MatRestoreRowIJ(mat, 0, PETSC_FALSE, PETSC_FALSE, &rows->rows, &rows->start, &rows->column, &done));
    PetscFunctionReturn(0);
}

// Takes a matrix of PETSc's in, with the ghosts that it reads.
template <class Part>
PetscErrorCode take(Mat mat, PetscInt columns, Part* part, Ghosts* ghosts) {
    PetscBool shared;
    Mat own = mat, coupling = nullptr;
    StoredRows inside, outside;
    PetscFunctionBegin;
    PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(mat), MATMPIAIJ, &shared));
    if (shared) PetscCall(MatMPIAIJGetSeqAIJ(mat, &own, &coupling, nullptr));
    PetscCall(ghosts->set(mat, columns));
    PetscCall(stored(own, &inside));
    if (coupling) PetscCall(stored(coupling, &outside));
    part->set(inside, outside, ghosts->place);
    if (coupling) PetscCall(restore(coupling, &outside));
    PetscCall(restore(own, &inside));
    PetscFunctionReturn(0);
}

// Whether a matrix is of type aij with these unknowns a node, whole nodes of them on this rank.
PetscErrorCode fits(Mat mat, PetscInt* rows, PetscInt* columns, PetscBool* good) {
    PetscBool alone, shared;
    PetscInt m, n;
    PetscFunctionBegin;
    PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(mat), MATSEQAIJ, &alone));
    PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(mat), MATMPIAIJ, &shared));
    PetscCall(MatGetBlockSizes(mat, rows, columns));
    PetscCall(MatGetLocalSize(mat, &m, &n));
    *good = (alone || shared) && m % *rows == 0 && n % *columns == 0 ? PETSC_TRUE : PETSC_FALSE;
    PetscFunctionReturn(0);
}

PetscErrorCode make_grid(PC pc, PetscInt level, std::unique_ptr<Grid>* made) {
    KSP smoother;
    Mat A, P;
    PetscInt rows, size, same, coarse;
    PetscBool good, also;
    PetscFunctionBegin;
    PetscCall(PCMGGetSmoother(pc, level, &smoother));
    PetscCall(KSPGetOperators(smoother, nullptr, &A));
    PetscCall(PCMGGetInterpolation(pc, level, &P));
    PetscCall(fits(P, &size, &coarse, &also));
    PetscCall(fits(A, &same, &same, &good));
    if (!good || !also || same != size) PetscFunctionReturn(0);
    auto grid = std::make_unique<Grid>();
    grid->matrix = matrix_of(size);
    grid->transfer = transfer_of(size, coarse);
    if (!grid->matrix || !grid->transfer) PetscFunctionReturn(0);
    PetscCall(take(A, size, grid->matrix.get(), &grid->neighbours));
    PetscCall(take(P, coarse, grid->transfer.get(), &grid->coarse_neighbours));
    PetscCall(MatGetLocalSize(A, &rows, nullptr));
    for (auto* values : {&grid->right, &grid->x, &grid->rest, &grid->change}) values->assign(rows, 0.0);
    *made = std::move(grid);
    PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode forget_cycle(PC pc) {
    Cycle* known;
    PetscFunctionBegin;
    PetscCall(cycle_of(pc, &known));
    if (known && pc->ops->apply == apply) pc->ops->apply = known->own;
    PetscCall(PetscObjectCompose(reinterpret_cast<PetscObject>(pc), key, nullptr));
    PetscFunctionReturn(0);
}

PetscErrorCode forget_products(PC pc) {
    PetscInt levels;
    KSP smoother;
    Mat grid;
    PetscFunctionBegin;
    PetscCall(PCMGGetLevels(pc, &levels));
    for (PetscInt level = 0; level + 1 < levels; ++level) {
        PetscCall(PCMGGetSmoother(pc, level, &smoother));
        PetscCall(KSPGetOperators(smoother, nullptr, &grid));
        PetscCall(MatProductClear(grid));
    }
    PetscFunctionReturn(0);
}

PetscErrorCode cycle_in_single(PC pc, PetscBool* done) {
    PetscInt levels, rows, all;
    PetscBool known, symmetric;
    PetscContainer container;
    Mat matrix, coarse;
    PetscFunctionBegin;
    *done = PETSC_FALSE;
    PetscCall(forget_cycle(pc));
    PetscCall(PCGetOperators(pc, nullptr, &matrix));
    PetscCall(MatIsSPDKnown(matrix, &known, &symmetric));
    if (!known || !symmetric) PetscFunctionReturn(0);
    PetscCall(PCMGGetLevels(pc, &levels));
    auto cycle = std::make_unique<Cycle>();
    for (PetscInt level = 1; level < levels; ++level) {
        std::unique_ptr<Grid> grid;
        PetscCall(make_grid(pc, level, &grid));
        if (!grid) PetscFunctionReturn(0);
        cycle->flops += 4.0 * grid->matrix->entries();
        cycle->grids.push_back(std::move(grid));
    }
    PetscCall(PCMGGetCoarseSolve(pc, &cycle->coarsest));
    PetscCall(KSPGetOperators(cycle->coarsest, &coarse, nullptr));
    PetscCall(MatGetLocalSize(coarse, &rows, nullptr));
    PetscCall(MatGetSize(coarse, &all, nullptr));
    cycle->right.assign(rows, 0.0);
    cycle->x.assign(rows, 0.0);
    for (Vec* vector : {&cycle->b, &cycle->solution}) {
        VecType type;
        PetscCall(MatGetVecType(coarse, &type));
        PetscCall(VecCreate(PetscObjectComm(reinterpret_cast<PetscObject>(coarse)), vector));
        PetscCall(VecSetSizes(*vector, rows, all));
        PetscCall(VecSetType(*vector, type));
    }
    cycle->own = pc->ops->apply;
    pc->ops->apply = apply;
    PetscCall(PetscContainerCreate(PETSC_COMM_SELF, &container));
    PetscCall(PetscContainerSetPointer(container, cycle.release()));
    PetscCall(PetscContainerSetUserDestroy(container, release));
    PetscCall(PetscObjectCompose(reinterpret_cast<PetscObject>(pc), key, reinterpret_cast<PetscObject>(container)));
    PetscCall(PetscContainerDestroy(&container));
    *done = PETSC_TRUE;
    PetscFunctionReturn(0);
}

}  // namespace restshape
