"""Complete factors and products of a plate's stiffness: restshape's beside those that PETSc offers, in turns.

OMP_NUM_THREADS=1 python scripts/factors.py [SIDE ...]

Each SIDE is one of a square plate of SIDE x SIDE nodes, two unknowns a node; without any, 32 and 100. Times are the
least of several, in ms: of a factor on a new pattern with its ordering, of one on the same pattern, of a solve; and of
a product with a vector. PETSc's own blocks take no order: they are given the nodes in elimination order, the time of
which is left out. At last, what a nonzero takes with one unknown a node over one with two, of as many unknowns,
in a box of tetrahedra over the plate, and in an incomplete factor over a complete one.
"""

import sys
import time
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.preconditioner import order_factor
from restshape.measurement import box, measure_factor, measure_gamg, median_seconds, plate, plate_system

ROUNDS = 7


class Way(NamedTuple):
    """A way to factor and solve."""

    name: str
    set_up: Callable[[PETSc.PC], None]
    panels: bool = False
    single: bool = False
    permuted: bool = False


def library(name: str, ordering: str | None = None) -> Callable[[PETSc.PC], None]:
    """What has a factor made by a library that PETSc calls, or by PETSc."""

    def set_up(pc: PETSc.PC) -> None:
        pc.setFactorSolverType(name)
        if ordering:
            pc.setFactorOrdering(ordering)

    return set_up


WAYS = (
    Way("PETSc, single numbers", library("petsc", "amd")),
    Way("PETSc, the same blocks", library("petsc", "natural"), permuted=True),
    Way("CHOLMOD", library("cholmod")),
    Way("MUMPS", library("mumps")),
    Way("node blocks", order_factor),
    Way("node blocks, panels", order_factor, panels=True),
    Way("the same, single", order_factor, panels=True, single=True),
)


def in_blocks(mat: PETSc.Mat) -> PETSc.Mat:
    """A matrix of two unknowns a node in symmetric blocks, in the elimination order of its nodes."""
    nodes = mat.createSubMatrix(*[PETSc.IS().createStride(mat.getSize()[0] // 2, 0, 2, comm=PETSc.COMM_SELF)] * 2)
    order = PETSc.IS().createBlock(2, nodes.getOrdering("amd")[0].getIndices(), comm=PETSc.COMM_SELF)
    rows = mat.permute(order, order)
    rows.setBlockSize(2)
    rows.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    return rows.convert("seqsbaij")


def seconds(run: Callable[[], object]) -> float:
    """Of one call."""
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def times(way: Way, mat: PETSc.Mat, x: PETSc.Vec, b: PETSc.Vec) -> list[float]:
    """Seconds of a new pattern, of new values, of a solve."""
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setType("cholesky")
    way.set_up(pc)
    pc.setOperators(mat)
    found = [seconds(pc.setUp)]
    mat.setValue(0, 0, mat.getValue(0, 0))
    mat.assemble()
    found.append(seconds(pc.setUp))
    if way.panels:
        _kernels.solve_by_panels(pc.getFactorMatrix().handle, way.single)
    pc.apply(b, x)
    found.append(min(seconds(lambda: pc.apply(b, x)) for _ in range(5)))
    pc.destroy()
    return found


def products(X: np.ndarray, cells: np.ndarray) -> dict[str, float]:
    """Seconds of a product by rows of single numbers, as PETSc makes it, and by the two rows of a node at once."""
    mat, x, b, _ = plate_system(X, cells)
    own = PETSc.Mat().createAIJ(mat.getSizes(), csr=mat.getValuesCSR(), comm=PETSc.COMM_SELF)
    ways = {"PETSc": own, "both rows of a node": mat}
    least = dict.fromkeys(ways, float("inf"))
    for _ in range(100 * ROUNDS):
        for name, matrix in ways.items():
            least[name] = min(least[name], seconds(partial(matrix.mult, b, x)))
    return least


def nonzero_seconds(side: int, fields: int) -> dict[str, float]:
    """Seconds a nonzero of a plate, or a box with three unknowns a node: of its factor, of its grids, of its matrix."""
    system = plate_system(*(box(side) if fields == 3 else plate(side)), fields)
    filled, factor = measure_factor(system, "cholesky")
    grids, gamg = measure_gamg(system)
    product = median_seconds(lambda: system.mat.mult(system.b, system.x))
    found = {name: seconds / filled for name, seconds in factor.items()}
    found |= {name: seconds / grids for name, seconds in gamg.items()}
    return {**found, "product": product / system.mat.getInfo()["nz_used"]}


def main(sides: list[int]) -> None:
    """Print a table a size."""
    for side in sides:
        mat, x, b, _ = plate_system(*plate(side))
        least = {way: [float("inf")] * 3 for way in WAYS}
        for _ in range(ROUNDS):
            for way in WAYS:
                taken = times(way, in_blocks(mat) if way.permuted else mat, x, b)
                least[way] = [min(pair) for pair in zip(least[way], taken)]
        print(f"\n{mat.getSize()[0]} unknowns: new pattern, new values, solve [ms]")
        for way, found in least.items():
            print(f"{way.name:24}" + "".join(f"{1e3 * value:10.3g}" for value in found))
        print("product [ms]")
        for name, taken in products(*plate(side)).items():
            print(f"{name:24}{1e3 * taken:10.3g}")
        single, pairs = nonzero_seconds(round(2**0.5 * side), 1), nonzero_seconds(side, 2)
        print("a nonzero with one unknown a node, over one with two")
        print("  ".join(f"{name} {single[name] / pairs[name]:.2f}" for name in single))
        rooms = nonzero_seconds(round((2 / 3 * side**2) ** (1 / 3)), 3)
        print("a nonzero in a box of tetrahedra, over one of the plate, of as many unknowns")
        print("  ".join(f"{name} {rooms[name] / pairs[name]:.2f}" for name in rooms))
        filled, incomplete = measure_factor(plate_system(*plate(side)), "icc")
        print("a nonzero of ICC(3), over one of a complete factor")
        print("  ".join(f"{name} {taken / filled / pairs[name]:.2f}" for name, taken in incomplete.items()))


if __name__ == "__main__":
    main([int(word) for word in sys.argv[1:]] or [32, 100])
