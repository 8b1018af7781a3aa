// A complete LU factor in blocks of one node, without exchanges of rows between blocks, as a solver type of PETSc's for
// matrices of type seqbaij: -pc_factor_mat_solver_type node_lu, or node_lu_single with substitutions in single
// precision.
#pragma once

#include <petscmat.h>

namespace restshape {

constexpr char NODE_LU[] = "node_lu", NODE_LU_SINGLE[] = "node_lu_single";

// Makes both types known to PETSc, which must have been initialised; calls after the first do nothing.
PetscErrorCode register_node_lu();

}  // namespace restshape
