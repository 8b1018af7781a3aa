"""The Krylov method of a KSP, set up to see the true residual."""

from petsc4py import PETSc

from restshape.algebra.reuse.prices import RESTART

LEAST = 1e-300
"""A relative tolerance that ends nothing."""


def set_krylov(ksp: PETSc.KSP, kind: str) -> None:
    """Have a KSP iterate by a method of PETSc's, "cg", "gmres", "fgmres" or "bcgs", from the guess that it is given.

    Flexible GMRES keeps what each application gives, and so bears one that is rounded to single precision.
    """
    ksp.setType(kind)
    if kind in ("gmres", "fgmres"):
        ksp.setGMRESRestart(RESTART)
    if kind != "cg":
        # The true residual is what these see with the preconditioner on the right.
        ksp.setPCSide(PETSc.PC.Side.RIGHT)
    ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    ksp.setInitialGuessNonzero(True)


def solve_from(ksp: PETSc.KSP, b: PETSc.Vec, x: PETSc.Vec) -> None:
    """Solve for b from the guess in x.

    With the preconditioner on the right, PETSc's BiCGStab adds the last guess that was not zero to what it finds from
    zero (3.18). It is never given one: what the guess leaves of b is solved for.
    """
    if ksp.getType() != "bcgs":
        ksp.solve(b, x)
        return
    ksp.setInitialGuessNonzero(False)
    if x.norm() == 0.0:
        ksp.solve(b, x)
        return
    rest, way, (rtol, atol) = b.duplicate(), x.duplicate(), ksp.getTolerances()[:2]
    ksp.getOperators()[0].mult(x, rest)
    rest.aypx(-1.0, b)
    ksp.setTolerances(rtol=LEAST, atol=max(atol, rtol * b.norm()))
    ksp.solve(rest, way)
    ksp.setTolerances(rtol=rtol, atol=atol)
    x.axpy(1.0, way)
    rest.destroy()
    way.destroy()
