"""The stiffness operator: nonzero pattern kept over a topology, values refreshed each frame."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.arrays import Bytes, Indices, Reals

Block = Indices | tuple[Indices, Indices]
"""Cells (m, k) int32; a pair where the nodes of unknowns are others than those of X: cells, and dofs (m, kd) int32."""


@dataclass(frozen=True, eq=False)
class CellSubset:
    """Some cells of a block, which the parameters of a term have a row for each of.

    Args:
        block: its number.
        cells: (m,) int32; one may stand there more than once.
    """

    block: int
    cells: Indices


def same_blocks(some: Sequence[Block], others: Sequence[Block]) -> bool:
    """Whether blocks hold the same entities in the same order."""
    pairs = [[one if isinstance(one, tuple) else (one,) for one in blocks] for blocks in (some, others)]
    alike = [len(a) == len(b) and all(map(np.array_equal, a, b)) for a, b in zip(*pairs)]
    return len(some) == len(others) and all(alike)


MatrixTerm = tuple[int | CellSubset, _kernels.Element, Reals, Reals, Reals, float, *tuple[float | Reals, ...]]
"""Block or cells of one, element, X, x, parameters, coefficient[, residual factor[, nodal coefficients]] of a term."""


class Operator:
    """A PETSc matrix over the nodes of a mesh whose pattern is set once a topology and patched after flips.

    Args:
        comm: PETSc communicator.
        fields: unknowns a node.
        node_offsets: (ranks + 1,) int32 nodes of rank r are node_offsets[r]:node_offsets[r + 1].
        backend: `csr` (own arrays, patched after flips; the default) or `bcsr` (one rank, blocks of nodes, for solvers
            by products and relaxation).
        symmetric: every matrix is, which PETSc is informed of.
        definite: and positive definite.

    Attributes:
        version: another one whenever pattern, constraints or values may be others.
    """

    def __init__(
        self,
        comm: PETSc.Comm,
        fields: int,
        node_offsets: Indices,
        backend: str | None = None,
        symmetric: bool = True,
        definite: bool = True,
    ) -> None:
        self.comm, self.fields, self.symmetric, self.definite = comm, fields, symmetric, symmetric and definite
        offsets = np.ascontiguousarray(node_offsets, dtype=np.int32)
        self.rows = slice(int(offsets[comm.rank]) * fields, int(offsets[comm.rank + 1]) * fields)
        self.backend = backend or "csr"
        self.core = _kernels.Operator(comm.size > 1, fields, offsets.tolist(), comm.rank, self.backend)
        self.mat = PETSc.Mat()
        self._generation, self.version, self.slides = -1, 0, False

    def set_topology(self, blocks: Sequence[Block], mask: Bytes) -> None:
        """Make a new pattern for blocks of cells (ne, nn) int32; `mask` (n * f,) uint8 marks constrained unknowns.

        A pair of arrays is cells whose X elements read, and the nodes (ne, nd) whose unknowns they have.
        """
        self.core.set_topology(list(blocks))
        self.set_constraints(mask)

    def set_constraints(self, mask: Bytes) -> None:
        """Mark constrained unknowns (n * f,) uint8; the pattern stays."""
        self.version += 1
        self.core.set_constraints(np.ascontiguousarray(mask, dtype=np.uint8).ravel())

    def set_sliding(self, nodes: Indices, kept: Reals) -> None:
        """Keep of the first two unknowns of nodes (k,) what symmetric projections do; the pattern stays.

        Args:
            nodes: int32.
            kept: (k, 3) components xx, xy and yy of each projection.
        """
        self.version += 1
        self.slides = len(nodes) > 0
        self.core.set_sliding(nodes, kept)

    def patch(self, block: int, changed: Indices) -> None:
        """Add to the pattern what the flipped cells `changed` of a block need; nothing else is set up again."""
        self.version += 1
        self.core.patch(block, changed)

    def keep(self, terms: Sequence[MatrixTerm]) -> None:
        """Note the matrix of terms that stay, for `assemble` to start from; flips and new constraints forget it."""
        self.core.begin()
        self.core.add_sum(terms, None)
        self.core.keep()
        self.core.end()

    def assemble(self, terms: Sequence[MatrixTerm], rhs: Reals | None, kept: bool = False) -> PETSc.Mat:
        """The matrix of a sum of terms (block, element, X, x, params, coefficient[, factor]).

        rhs (n * f,), where given, loses the terms' residuals at x times the factor, by default the coefficient. With
        `kept` the matrix contains what `keep` has noted, and rhs nothing of it.
        """
        self.version += 1
        self.core.assemble(terms, rhs, kept)
        if self.core.generation != self._generation:
            self._generation = self.core.generation
            self.mat = self.core.mat
            self.mat.setOption(PETSc.Mat.Option.SPD, self.definite)
            if not self.symmetric:
                # Relaxation takes the place of products of symmetric ones.
                _kernels.multiply_in_registers(self.mat.handle)
            elif not self.definite:
                self.mat.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        return self.mat
