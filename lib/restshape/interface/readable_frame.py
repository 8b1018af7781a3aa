"""What frames of simulations and of recordings have in common: a row of values, a mesh, and fields on it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from restshape.analysis.row_values import number, whole
from restshape.errors import UserError
from restshape.findings import Finding, decode_findings
from restshape.replay.columns import quantity_names

if TYPE_CHECKING:
    from restshape.analysis.row_values import RowValues
    from restshape.arrays import Indices, Reals

QUANTITY = "q_"
"""Before the name of a quantity, in the column that has it."""


@dataclass(frozen=True)
class ShownMesh:
    """The mesh of a frame, in arrays that can be read alone and stay as they are when the edit goes on.

    The places are a copy, for those of the solver change in place. So are the cells, which all frames share whose mesh
    has the same ones.

    Args:
        points: (n, 2) or (n, 3) places [m] of the nodes in the rest shape.
        cells: (ne, k) int32 nodes of each cell, corners first.
        cell_type: VTK's number of their shape and order, such as 5 for triangles and 22 for those of second order.
    """

    points: Reals
    cells: Indices
    cell_type: int


class ReadableFrame(ABC):
    """One frame of an edit.

    Attributes:
        row: a value a column, as `restshape replay --csv` writes them; times are in ms.
    """

    row: RowValues

    @property
    @abstractmethod
    def mesh(self) -> ShownMesh:
        """Nodes and cells, which fields are of."""

    @property
    @abstractmethod
    def fields(self) -> Mapping[str, Reals]:
        """Fields by name."""

    @property
    def index(self) -> int:
        """Its number in the edit, from 0."""
        return whole(self.row, "index")

    @property
    def refused(self) -> str:
        """Why it shows the last shape, or the last answer, instead of what was asked for; empty where it does not."""
        return str(self.row["refused"])

    @property
    def quantities(self) -> dict[str, float]:
        """The scene's quantities by name, in SI units; not numbers where the frame has no answer."""
        return {name: number(self.row, QUANTITY + name) for name in quantity_names(list(self.row))}

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What there is to know of the frame besides numbers, such as limits that do not hold."""
        return tuple(decode_findings(str(self.row["findings"])))

    @property
    def displacement(self) -> Reals:
        """(n, 2) or (n, 3) [m] displacement of the nodes.

        Raises:
            UserError: this physics has none, or the frame cannot be read any more.
        """
        return self.field("displacement")

    @property
    def von_mises(self) -> Reals:
        """(n,) [Pa] von Mises stress at the nodes, recovered from that of the cells.

        Where regions of different materials meet it jumps, and the field "von_mises_in_cells" has it instead: (ne, k)
        at the nodes of each cell.

        Raises:
            UserError: this physics has none, or the frame cannot be read any more.
        """
        return self.field("von_mises")

    def field(self, name: str) -> Reals:
        """A field of `fields`.

        Raises:
            UserError: there is no such field, or the frame cannot be read any more.
        """
        if name not in self.fields:
            known = ", ".join(self.fields) or "none"
            raise UserError(f"there is no field {name!r}", f"frame {self.index}", f"use one of those it has: {known}")
        return self.fields[name]

    def __repr__(self) -> str:
        """What it is, in one line."""
        found = ", ".join(f"{name}={value:.6g}" for name, value in self.quantities.items())
        return f"<frame {self.index}: {self.refused or found or self.row['event']}>"
