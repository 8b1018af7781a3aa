// Factors of ours that PETSc, which is C, asks for: nothing may be thrown through it.
#pragma once

#include <petsc/private/matimpl.h>

#include <new>

namespace restshape {

// Makes what PETSc has asked for. A factor gives no numbers until it is made, which PETSc tries again after this
// error alone.
template <class Make>
PetscErrorCode within_memory(Mat F, const Make& make) {
    F->factorerrortype = MAT_FACTOR_NUMERIC_ZEROPIVOT;
    try {
        return make();
    } catch (const std::bad_alloc&) {
        SETERRQ(PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for a factor in blocks of nodes");
    }
}

}  // namespace restshape
