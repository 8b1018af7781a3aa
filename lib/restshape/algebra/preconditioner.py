"""PETSc's preconditioners: set up on one rank or several, and the nonzeros in them counted."""

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.arrays import Reals

COMPLETE = ("cholesky", "lu")
FACTORS = (*COMPLETE, "icc", "ilu")


def set_preconditioner(
    ksp: PETSc.KSP,
    kind: str,
    levels: int,
    pivots: bool = False,
    blocks: bool = True,
    shifts: bool = True,
    overlap: int = 0,
    symmetric: bool = False,
) -> list[str]:
    """Give a solver a preconditioner; what PETSc's options say of it goes first.

    On several ranks a factor is that of the ranks' own rows (block Jacobi), so that the bits repeat; one with exchanges
    of rows is that of the whole matrix: blocks of an indefinite matrix may be singular.

    Args:
        ksp: without a set-up, or just reset.
        kind: PETSc's type.
        levels: of fill, where incomplete.
        pivots: a complete factor exchanges rows: MUMPS makes it, for PETSc's own do not.
        blocks: a complete Cholesky factor is made in blocks of a node.
        shifts: incomplete factors are made positive definite; matrices in blocks of a node (BAIJ) cannot be shifted so.
        overlap: layers of other ranks' rows that a rank's factor has besides.
        symmetric: what these layers give is added (additive Schwarz), as conjugate gradients need it; else each rank
            takes what its own factor gives (restricted).

    Returns: names of options that were put into PETSc's database, to be taken out after the set-up.
    """
    pc = ksp.getPC()
    wanted: dict[str, object] = {}
    whole = pivots and kind in COMPLETE
    if kind in FACTORS and not whole and ksp.getComm().size > 1:
        # Block Jacobi is additive Schwarz without overlap: petsc4py 3.18 gives the blocks' solvers for that only.
        pc.setType("asm")
        pc.setASMOverlap(overlap)
        if symmetric:
            pc.setASMType(PETSc.PC.ASMType.BASIC)
        wanted = {"sub_ksp_type": "preonly", "sub_pc_type": kind, **_factor_options(kind, levels, blocks, shifts)}
        _kernels.register_node_cholesky()
    else:
        wanted = _set_whole(pc, kind, levels, whole, blocks, shifts)
    options = PETSc.Options(ksp.getOptionsPrefix() or "")
    given = [key for key in wanted if not options.hasName(key)]
    for key in given:
        options.setValue(key, wanted[key])
    pc.setFromOptions()
    return given


def substitute_by_panels(ksp: PETSc.KSP, single: bool) -> None:
    """Let a complete Cholesky factor, as it is now, substitute by panels, which are worth making for several solves.

    Of another kind it stays as it is.

    Args:
        ksp: a solver of one matrix on this rank, or with a factor that ranks share; it is set up.
        single: of single precision, for which an iteration makes up.

    Source: docs/theory/levels-of-reuse.md.
    """
    pc = ksp.getPC()
    if pc.getType() == "python":
        pc.getPythonContext().substitute_by_panels(single)
    elif pc.getType() == "cholesky":
        factor = pc.getFactorMatrix().handle
        if not _kernels.panel_value_bytes(factor):
            _kernels.solve_by_panels(factor, single)


def _set_whole(pc: PETSc.PC, kind: str, levels: int, mumps: bool, blocks: bool, shifts: bool) -> dict[str, object]:
    """Set a preconditioner of the whole matrix up to its options, which are returned; arguments as of the above."""
    if mumps:
        # MUMPS has orders of its own: of another factor there before, PETSc would go on to set the order.
        pc.setType("none")
    pc.setType(kind)
    if kind == "gamg":
        return {"pc_gamg_reuse_interpolation": True}
    if mumps:
        pc.setFactorSolverType("mumps")
    elif kind in COMPLETE:
        order_factor(pc, blocks)
    elif kind in FACTORS:
        pc.setFactorLevels(levels)
        if shifts:
            # Slender parts make incomplete factors indefinite, for which CG has no use.
            pc.setFactorShift(PETSc.Mat.FactorShiftType.POSITIVE_DEFINITE)
    return {}


def apply_to(pc: PETSc.PC, right: Reals, out: Reals) -> None:
    """Apply the preconditioner of a sequential matrix to `right` (n,), into `out` (n,)."""
    b, x = (PETSc.Vec().createWithArray(one, comm=PETSc.COMM_SELF) for one in (right, out))
    pc.apply(b, x)
    free(b, x)


def free(*parts: PETSc.Object | None) -> None:
    """Destroy what there is of these."""
    for part in parts:
        if part is not None:
            part.destroy()


def cycle_in_single(pc: PETSc.PC) -> bool:
    """Have algebraic multigrid that has been set up go by restshape's own cycles, in single precision.

    One sweep of Gauss and Seidel's before each coarse grid and one behind it read each matrix once, with half the
    bytes. PETSc's own cycles, by Chebyshev's iteration, stay where its options say how grids are smoothed, and where
    matrices are not positive definite.

    Returns: whether they do.
    """
    prefix = PETSc.Options(pc.getOptionsPrefix() or "")
    if any(key.startswith(("mg_", "pc_mg_")) for key in prefix.getAll()):
        _kernels.forget_cycle(pc.handle)
        return False
    return _kernels.cycle_in_single(pc.handle)


def order_factor(pc: PETSc.PC, blocks: bool = True) -> None:
    """Have a complete factor on one rank made in an order of little fill, Cholesky's in blocks of a node.

    Args:
        pc: of type `cholesky` or `lu`.
        blocks: else of single numbers, which bear better what is nearly singular.

    Source: P. R. Amestoy, T. A. Davis and I. S. Duff, SIAM J. Matrix Anal. Appl. 17 (1996), 886.
    """
    if pc.getType() == "cholesky" and blocks:
        _kernels.register_node_cholesky()
        pc.setFactorSolverType(_kernels.node_blocks)
    else:
        pc.setFactorSolverType("petsc")
        pc.setFactorOrdering("amd")
        # PETSc's least pivot is one of no unit: a sheet of micrometres has smaller ones, which are no zeros.
        pc.setFactorPivot(zeropivot=0.0)


def _factor_options(kind: str, levels: int, blocks: bool, shifts: bool) -> dict[str, object]:
    if kind == "cholesky" and blocks:
        return {"sub_pc_factor_mat_solver_type": _kernels.node_blocks}
    if kind in COMPLETE:
        return {"sub_pc_factor_mat_ordering_type": "amd"}
    shift = {"sub_pc_factor_shift_type": "positive_definite"} if shifts else {}
    return {"sub_pc_factor_levels": levels, **shift}


def set_rigid_motions(mat: PETSc.Mat, X: Reals) -> None:
    """Give a matrix the rigid motions of the body, which algebraic multigrid must interpolate well.

    Args:
        mat: of as many unknowns a node as X has columns.
        X: (n, d) places of this rank's nodes [m].
    """
    places = PETSc.Vec().createWithArray(np.ascontiguousarray(X).ravel().copy(), comm=mat.getComm())
    places.setBlockSize(X.shape[1])
    motions = PETSc.NullSpace().createRigidBody(places)
    mat.setNearNullSpace(motions)
    for part in (motions, places):
        part.destroy()


def kind_of(pc: PETSc.PC) -> str:
    """PETSc's type of a preconditioner, or of the ranks' own ones that it consists of."""
    return pc.getASMSubKSP()[0].getPC().getType() if pc.getType() == "asm" else pc.getType()


def nonzeros(pc: PETSc.PC) -> float:
    """Nonzeros of the factors, or of the matrices of all grids, on all ranks; 0 for other preconditioners."""
    comm = pc.getComm()
    if pc.getType() == "gamg":
        grids = (pc.getMGSmoother(k).getOperators()[0] for k in range(pc.getMGLevels()))
        return sum(grid.getInfo(PETSc.Mat.InfoType.GLOBAL_SUM)["nz_used"] for grid in grids)
    blocks = pc.getType() == "asm"
    parts = [ksp.getPC() for ksp in pc.getASMSubKSP()] if blocks else [pc]
    factors = [part.getFactorMatrix() for part in parts if part.getType() in FACTORS]
    filled = sum(factor.getInfo()["nz_used"] for factor in factors)
    # A factor of the whole matrix counts the nonzeros of all ranks by itself.
    return comm.tompi4py().allreduce(filled) if blocks else filled
