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

// Has a factor of this type, not made yet, keep the last unknowns, whole nodes of them: they are no pivots. Solutions
// are then those with these unknowns 0. A node has so many unknowns (`fields`), which small patterns do not show.
PetscErrorCode keep_border(Mat factor, PetscInt unknowns, PetscInt fields);
PetscErrorCode kept_border(Mat factor, PetscInt* unknowns);

// The Schur complement of what a factor keeps, by rows.
PetscErrorCode border_complement(Mat factor, double* complement);

// A solution with unknowns of the border that are not 0, in two halves: what the equations of the border have on their
// right without the inside, from its right side; and the inside's unknowns, once those of the border are known. Nothing
// else is solved with the factor in between.
PetscErrorCode eliminate_inside(Mat factor, const double* inside, double* border);
PetscErrorCode complete_inside(Mat factor, const double* border, double* inside);

}  // namespace restshape
