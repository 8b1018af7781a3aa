// Conjugate gradients with symmetric over-relaxation by nodes, which read a matrix in blocks once an iteration:
// PETSc's KSP type node_ssor.
#pragma once

#include <petscsys.h>

namespace restshape {

constexpr char NODE_SSOR[] = "node_ssor";

// Makes PETSc know the type; more than once does no harm.
PetscErrorCode register_node_relaxation();

}  // namespace restshape
