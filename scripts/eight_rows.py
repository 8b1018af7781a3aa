"""Products of eight rows with a matrix of a solid, and with each other, beside PETSc's and numpy's: least times in ms.

OMP_NUM_THREADS=1 python scripts/eight_rows.py [SIDE]

The solid has SIDE x SIDE x 9 nodes of three unknowns each, coupled to all 26 around them; SIDE is 12 without a word.
"""

import sys
import time
from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.row_products import combined, row_products

COUNT, BASIS, ROUNDS = 8, 24, 30


def least(run: Callable[[], object]) -> float:
    """Milliseconds of one call, the least of several."""
    found = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        run()
        found.append(time.perf_counter() - start)
    return 1e3 * min(found)


def solid(side: int) -> PETSc.Mat:
    """A matrix with the pattern of the solid."""
    line = [sp.diags([1.0, 2.5, 1.0], [-1, 0, 1], (n, n)) for n in (side, side, 9)]
    nodes = sp.kron(sp.kron(line[0], line[1]), line[2])
    one = sp.kron(nodes, np.array([[3.0, 1, 1], [1, 3, 1], [1, 1, 3]])).tocsr()
    one.sort_indices()
    rows, columns = (part.astype(PETSc.IntType) for part in (one.indptr, one.indices))
    return PETSc.Mat().createAIJ(one.shape, csr=(rows, columns, one.data), comm=PETSc.COMM_SELF)


def main(side: int) -> None:
    """Print the table."""
    mat = solid(side)
    n = mat.getSize()[0]
    rng = np.random.default_rng(0)
    rows, basis, weights = rng.normal(size=(COUNT, n)), rng.normal(size=(BASIS, n)), rng.normal(size=(COUNT, BASIS))
    out = np.empty_like(rows)
    vectors = [(PETSc.Vec().createWithArray(a), PETSc.Vec().createWithArray(b)) for a, b in zip(rows, out)]
    dense = PETSc.Mat().createDense((n, COUNT), array=np.asfortranarray(rows.T), comm=PETSc.COMM_SELF)
    product = mat.matMult(dense)
    table = {
        "matrix, PETSc's MatMult, row by row": lambda: [mat.mult(x, y) for x, y in vectors],
        "matrix, PETSc's MatMatMult": lambda: mat.matMult(dense, result=product),
        "matrix, eight rows at once": lambda: _kernels.matrix_products(mat.handle, rows, out),
        f"with {BASIS} rows, numpy": lambda: rows @ basis.T,
        f"with {BASIS} rows": lambda: row_products(rows, basis),
        f"sums of {BASIS} rows, numpy": lambda: weights @ basis,
        f"sums of {BASIS} rows": lambda: combined(weights, basis),
    }
    print(f"{COUNT} rows of {n} numbers [ms]")
    for name, run in table.items():
        print(f"{name:40}{least(run):8.3f}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if sys.argv[1:] else 12)
