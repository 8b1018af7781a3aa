#include "algebra/ghosts.hpp"

#include <algorithm>

namespace restshape {

void Ghosts::release() {
    (void)VecDestroy(&own_);
    (void)VecDestroy(&ghost_);
    (void)VecScatterDestroy(&scatter_);
}

PetscErrorCode Ghosts::set(Mat mat, PetscInt size) {
    PetscBool shared;
    PetscFunctionBegin;
    release();
    place.clear();
    values.clear();
    PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(mat), MATMPIAIJ, &shared));
    if (!shared) PetscFunctionReturn(0);
    Mat own, coupling;
    const PetscInt* column;
    PetscInt count, rows, all;
    IS from;
    PetscCall(MatMPIAIJGetSeqAIJ(mat, &own, &coupling, &column));
    PetscCall(MatGetSize(coupling, nullptr, &count));
    PetscInt last = -1, nodes = 0;
    place.resize(count);
    for (PetscInt k = 0; k < count; ++k) {
        if (column[k] / size != last) ++nodes;
        last = column[k] / size;
        place[k] = (nodes - 1) * size + column[k] % size;
    }
    values.assign(static_cast<std::size_t>(nodes) * size, 0.0);
    PetscCall(MatGetLocalSize(mat, nullptr, &rows));
    PetscCall(MatGetSize(mat, nullptr, &all));
    PetscCall(VecCreateMPIWithArray(PetscObjectComm(reinterpret_cast<PetscObject>(mat)), 1, rows, all, nullptr, &own_));
    PetscCall(VecCreateSeq(PETSC_COMM_SELF, count, &ghost_));
    PetscCall(ISCreateGeneral(PETSC_COMM_SELF, count, column, PETSC_COPY_VALUES, &from));
    PetscCall(VecScatterCreate(own_, from, ghost_, nullptr, &scatter_));
    PetscCall(ISDestroy(&from));
    PetscFunctionReturn(0);
}

PetscErrorCode Ghosts::fetch(const double* own) {
    const double* found;
    PetscFunctionBegin;
    if (none()) PetscFunctionReturn(0);
    PetscCall(VecPlaceArray(own_, own));
    PetscCall(VecScatterBegin(scatter_, own_, ghost_, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecScatterEnd(scatter_, own_, ghost_, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecResetArray(own_));
    PetscCall(VecGetArrayRead(ghost_, &found));
    for (std::size_t k = 0; k < place.size(); ++k) values[place[k]] = found[k];
    PetscCall(VecRestoreArrayRead(ghost_, &found));
    PetscFunctionReturn(0);
}

PetscErrorCode Ghosts::add_to(double* own) {
    double* given;
    PetscFunctionBegin;
    if (none()) PetscFunctionReturn(0);
    PetscCall(VecGetArrayWrite(ghost_, &given));
    for (std::size_t k = 0; k < place.size(); ++k) given[k] = values[place[k]];
    PetscCall(VecRestoreArrayWrite(ghost_, &given));
    PetscCall(VecPlaceArray(own_, own));
    PetscCall(VecScatterBegin(scatter_, ghost_, own_, ADD_VALUES, SCATTER_REVERSE));
    PetscCall(VecScatterEnd(scatter_, ghost_, own_, ADD_VALUES, SCATTER_REVERSE));
    PetscCall(VecResetArray(own_));
    PetscFunctionReturn(0);
}

}  // namespace restshape
