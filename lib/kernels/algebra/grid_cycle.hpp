// Cycles of algebraic multigrid in single precision, in place of PETSc's own, on the grids that PETSc has made.
#pragma once

#include <petscpc.h>

namespace restshape {

// Has a preconditioner of type gamg that has been set up go by V-cycles with a sweep of Gauss and Seidel's down the
// rows before each coarse grid and one up the rows behind it, on matrices in single precision; the coarsest grid stays
// PETSc's. `done` is whether it does: not where the matrix is not known to be positive definite, or not of type aij, or
// where its nodes have other numbers of unknowns. To be called again after each set-up.
PetscErrorCode cycle_in_single(PC pc, PetscBool* done);

// Lets go of what cycle_in_single has made.
PetscErrorCode forget_cycle(PC pc);

// Frees what a preconditioner of type gamg that has been set up keeps to make its coarse matrices again from another
// matrix with the same interpolation: parts of products and transposed copies. It will find their patterns again.
PetscErrorCode forget_products(PC pc);

}  // namespace restshape
