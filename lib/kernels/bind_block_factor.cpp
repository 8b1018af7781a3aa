// Binding of the block factor, as the inside of PETSc's shell preconditioner.
#include <petscpc.h>
#include <pybind11/pybind11.h>

#include "block_factor.hpp"
#include "operator.hpp"

namespace py = pybind11;
using restshape::BlockFactor;
using restshape::check;

namespace {

PetscErrorCode set_up(PC pc) {
    BlockFactor* factor = nullptr;
    Mat mat = nullptr;
    PetscFunctionBegin;
    PetscCall(PCShellGetContext(pc, &factor));
    PetscCall(PCGetOperators(pc, nullptr, &mat));
    PetscCheck(factor->compute(mat), PETSC_COMM_SELF, PETSC_ERR_SUP,
               "block_factor needs rows in threes of one pattern");
    PetscFunctionReturn(0);
}

PetscErrorCode apply(PC pc, Vec r, Vec z) {
    BlockFactor* factor = nullptr;
    const PetscScalar* from = nullptr;
    PetscScalar* to = nullptr;
    PetscFunctionBegin;
    PetscCall(PCShellGetContext(pc, &factor));
    PetscCall(VecGetArrayRead(r, &from));
    PetscCall(VecGetArrayWrite(z, &to));
    factor->solve(from, to);
    PetscCall(VecRestoreArrayWrite(z, &to));
    PetscCall(VecRestoreArrayRead(r, &from));
    PetscFunctionReturn(0);
}

PetscErrorCode release(PC pc) {
    BlockFactor* factor = nullptr;
    PetscFunctionBegin;
    PetscCall(PCShellGetContext(pc, &factor));
    delete factor;
    PetscFunctionReturn(0);
}

void set_block_factor(intptr_t handle, double shift) {
    PC pc = reinterpret_cast<PC>(handle);
    check(PCSetType(pc, PCNONE), "PCSetType");  // lets go of what it was
    check(PCSetType(pc, PCSHELL), "PCSetType");
    check(PCShellSetName(pc, "block_factor"), "PCShellSetName");
    check(PCShellSetContext(pc, new BlockFactor(shift)), "PCShellSetContext");
    check(PCShellSetSetUp(pc, set_up), "PCShellSetSetUp");
    check(PCShellSetApply(pc, apply), "PCShellSetApply");
    check(PCShellSetDestroy(pc, release), "PCShellSetDestroy");
}

int kept_pivots(intptr_t handle) {
    BlockFactor* factor = nullptr;
    check(PCShellGetContext(reinterpret_cast<PC>(handle), &factor), "PCShellGetContext");
    return factor->kept_pivots();
}

}  // namespace

void bind_block_factor(py::module_& m) {
    m.def("set_block_factor", &set_block_factor, py::arg("pc"), py::arg("shift") = 0.01,
          "Makes a petsc4py preconditioner (its `handle`) one by an incomplete Cholesky factor without fill, of 3 by 3 "
          "blocks, of a csr operator's matrix with its diagonal larger by the share `shift`. It is symmetric and "
          "positive definite for every matrix whose 3 by 3 diagonal blocks are, in single precision.");
    m.def("block_factor_kept_pivots", &kept_pivots, py::arg("pc"),
          "How many pivots of such a preconditioner are the matrix's own, as the updates left them indefinite.");
}
