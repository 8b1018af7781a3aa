"""A complete factor that memory does not hold is an error of PETSc's, and is made once memory holds it."""

import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import ctypes
import resource
import numpy as np
from petsc4py import PETSc
from restshape import _kernels
from restshape.algebra.preconditioner import order_factor
from restshape.measurement import box, plate_system

# What is freed goes back: M_MMAP_MAX and M_MMAP_THRESHOLD of the C library.
ctypes.CDLL(None).mallopt(-4, 65536)
ctypes.CDLL(None).mallopt(-3, 1 << 20)
system = plate_system(*box(17), 3)
system.mat.setOption(PETSc.Mat.Option.SPD, True)
pc = PETSc.PC().create(PETSc.COMM_SELF)
pc.setType("cholesky")
order_factor(pc)
pc.setOperators(system.mat)
pc.setFactorSetUpSolverType()
assert not _kernels.solve_by_panels(pc.getFactorMatrix().handle)
for _ in range({before}):
    system.mat.scale(2.0)
    pc.setOperators(system.mat)
    pc.setUp()
# Nothing besides what the process has.
soft, hard = resource.getrlimit(resource.RLIMIT_AS)
system.mat.scale(2.0)
pc.setOperators(system.mat)
resource.setrlimit(resource.RLIMIT_AS, (1 << 20, hard))
try:
    pc.setUp()
    code = 0
except PETSc.Error as error:
    code = error.ierr
finally:
    resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
assert code == 55, code
assert not _kernels.solve_by_panels(pc.getFactorMatrix().handle)
if {before}:
    # PETSc takes it for made.
    pc.apply(system.b, system.x)
    assert not system.x.norm() < np.inf
system.mat.scale(2.0)
pc.setOperators(system.mat)
pc.apply(system.b, system.x)
left = (system.mat * system.x - system.b).norm() / system.b.norm()
assert left < 1e-11, left
"""


@pytest.mark.cli
@pytest.mark.parametrize("before", [0, 2], ids=["the first one", "the one that is dissected"])
def test_a_factor_that_memory_does_not_hold_is_made_later(before):
    done = subprocess.run([sys.executable, "-c", PROGRAM.format(before=before)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]


LU_PROGRAM = """
import ctypes
import resource
import sys
sys.path.insert(0, {folder!r})
import numpy as np
from petsc4py import PETSc
from restshape import _kernels
from test_node_lu import grid

ctypes.CDLL(None).mallopt(-4, 65536)
ctypes.CDLL(None).mallopt(-3, 1 << 16)
full, mat = grid(34, 3)
_kernels.register_node_lu()
pc = PETSc.PC().create(PETSc.COMM_SELF)
pc.setType("lu")
pc.setFactorSolverType(_kernels.node_lu)
pc.setOperators(mat)
soft, hard = resource.getrlimit(resource.RLIMIT_AS)
resource.setrlimit(resource.RLIMIT_AS, (1 << 20, hard))
try:
    pc.setUp()
    code = 0
except PETSc.Error as error:
    code = error.ierr
finally:
    resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
assert code == 55, code
b, x = mat.createVecs()
b.set(1.0)
mat.scale(2.0)
pc.setOperators(mat)
pc.apply(b, x)
if not x.norm() < np.inf:
    mat.scale(1.0)
    mat.stateIncrease()
    pc.setOperators(mat)
    pc.setUp()
    pc.apply(b, x)
left = (mat * x - b).norm() / b.norm()
assert left < 1e-11, left
"""


@pytest.mark.cli
def test_a_factor_in_blocks_of_flows_that_memory_does_not_hold_is_made_later():
    program = LU_PROGRAM.format(folder=str(Path(__file__).parent))
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
