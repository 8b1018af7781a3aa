"""What the choice of a preconditioner expects of second-order systems, against PETSc's own factors and iterations."""

import pytest
from petsc4py import PETSc
from small_scenes import make_replay, plate, rows_of, write_scene

from restshape.algebra.reuse.candidates import CHOLESKY, ICC
from restshape.algebra.reuse.choice import Choice
from restshape.algebra.reuse.prices import ROW, Size, prices
from restshape.calibration import Calibration


def solved(mat: PETSc.Mat, b: PETSc.Vec, kind: str, prefix: str) -> tuple[float, int]:
    """Nonzeros of a factor, and the iterations of conjugate gradients with it down to 1e-6."""
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setOptionsPrefix(prefix)
    ksp.setType("cg")
    ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    ksp.setTolerances(rtol=1e-6)
    pc = ksp.getPC()
    pc.setType(kind)
    if kind == "icc":
        pc.setFactorLevels(3)
        pc.setFactorShift(PETSc.Mat.FactorShiftType.POSITIVE_DEFINITE)
    else:
        pc.setFactorOrdering("amd")
    ksp.setOperators(mat)
    x = b.duplicate()
    ksp.solve(b, x)
    found = pc.getFactorMatrix().getInfo()["nz_used"], ksp.getIterationNumber()
    ksp.destroy()
    return found


@pytest.mark.slow
@pytest.mark.parametrize("size", [0.08, 0.035])
def test_fill_and_iterations(tmp_path, size):
    made = make_replay(write_scene(tmp_path, plate(size)), overrides=["mesh.order=2"])
    rows_of(made)
    mat, b = made.analysis.state.system.mat, made.analysis.state.system.b
    system = Size(mat.getSize()[0], mat.getInfo()["nz_used"])
    assert system.width > 1.5
    choice = Choice(Calibration.load())
    filled, _ = solved(mat, b, "cholesky", f"whole_{size}_")
    assert choice.filled(CHOLESKY, system) == pytest.approx(filled, rel=0.1)
    filled, iterations = solved(mat, b, "icc", f"part_{size}_")
    assert choice.filled(ICC, system) == pytest.approx(filled, rel=0.1)
    assert choice.expected(ICC, system)[0] == pytest.approx(iterations, rel=0.3)


def test_first_order_is_what_priors_were_measured_on():
    assert Size(1000, 13.9 * 1000).width == 1.0 and Size(1000, 2 * ROW * 1000).width == 2.0
    assert Size(1000, 40_000, dimension=3).width == 1.0


def test_factors_of_single_numbers_cost_more_than_those_in_blocks():
    known = Calibration.load()
    blocks, single = (prices("cholesky", Size(2_000, 28_000.0, fields=f), 56_000.0, known) for f in (2, 1))
    assert all(1.2 < dear / cheap < 5.0 for dear, cheap in zip(single[:3], blocks[:3]))
    # Incomplete factors have no blocks on any problem.
    same = [prices("icc", Size(2_000, 28_000.0, fields=f), 56_000.0, known) for f in (2, 1)]
    assert same[0] == same[1]
