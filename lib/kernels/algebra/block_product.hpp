// Products of matrices in blocks of three or four unknowns a node with vectors, in place of PETSc's own.
#pragma once

#include <petscmat.h>

namespace restshape {

// Has MatMult of a matrix of type seqbaij take a column of a block in one register; other sizes keep PETSc's own.
PetscErrorCode multiply_in_registers(Mat mat);

}  // namespace restshape
