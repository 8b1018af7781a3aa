// A complete Cholesky factor in blocks of one node, as a solver type of PETSc's: -pc_factor_mat_solver_type
// node_blocks.
#pragma once

#include <petscmat.h>

namespace restshape {

constexpr char NODE_BLOCKS[] = "node_blocks";

// Makes the solver type known to PETSc, which must have been initialised; calls after the first do nothing.
PetscErrorCode register_node_cholesky();

// PETSc's own factor in blocks that one of this type is made of, in elimination order; null of other factors.
Mat factor_in_blocks(Mat factor);

}  // namespace restshape
