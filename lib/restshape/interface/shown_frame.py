"""Frames for programs: what a simulation shows of its shape after each step of an edit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Self, TypeVar

from restshape.errors import UserError
from restshape.findings import Finding, decode_findings
from restshape.replay.cell_types import CELL_TYPES
from restshape.replay.columns import quantity_names

if TYPE_CHECKING:
    from restshape.analysis.row_values import RowValues
    from restshape.arrays import AnyArray, Indices, Reals
    from restshape.replay.loop import Replay
    from restshape.replay.request import Request
    from restshape.scene.model import Scene

QUANTITY = "q_"
"""Before the name of a quantity, in the column that has it."""
Array = TypeVar("Array", bound="AnyArray")


def read_only(array: Array) -> Array:
    """An array that nobody else writes into, for reading alone."""
    array.flags.writeable = False
    return array


class LastAnswer:
    """What frames read their arrays from, while they are the last one.

    Args:
        replay: whose answers they show; request: what is replayed.

    Attributes:
        count: of frames so far; closed: none can be read any more.
    """

    def __init__(self, replay: Replay, request: Request) -> None:
        self.replay, self.request = replay, request
        self.count, self.closed = 0, False
        self._cells: tuple[tuple[int, int], Indices] | None = None

    def mesh(self) -> ShownMesh:
        """The mesh of the last frame; frames of one topology share the array of its cells."""
        space = self.replay.solver.space
        version = (id(space), space.topology)
        if self._cells is None or self._cells[0] != version:
            self._cells = version, read_only(space.cells.copy())
        return ShownMesh(read_only(space.X.copy()), self._cells[1], CELL_TYPES[space.cells.shape[1]])

    def frame(self, row: RowValues) -> ShownFrame:
        """The frame of a row, which is the last one from now on."""
        self.count += 1
        return ShownFrame(row, self)


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


class ShownFrame:
    """One frame of an edit: its row, and the answer that it shows.

    The row and the quantities stay. Mesh and fields are read when they are first asked for, while the frame is the last
    one; from then on they stay, too. So do those of the last frame before a hand lets go, or a simulation is closed.
    Arrays can be read alone; to change one, copy it. Fields are those of the solver without a copy, for it makes new
    ones in each frame that changes them.

    Attributes:
        row: a value a column, as `restshape replay --csv` writes them; times are in ms.
    """

    def __init__(self, row: RowValues, answer: LastAnswer) -> None:
        self.row = row
        self._answer, self._count = answer, answer.count

    @property
    def index(self) -> int:
        """Its number in the edit, from 0."""
        return int(self.row["index"])

    @property
    def refused(self) -> str:
        """Why it shows the last shape, or the last answer, instead of what was asked for; empty where it does not."""
        return str(self.row["refused"])

    @property
    def quantities(self) -> dict[str, float]:
        """The scene's quantities by name, in SI units; not numbers where the frame has no answer."""
        return {name: float(self.row[QUANTITY + name]) for name in quantity_names(list(self.row))}

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What there is to know of the frame besides numbers, such as limits that do not hold."""
        return tuple(decode_findings(str(self.row["findings"])))

    @cached_property
    def fields(self) -> dict[str, Reals]:
        """Fields by name: (n,) or (n, c) of the nodes, (ne,) or (ne, c) of the cells, as recordings have them.

        In SI units, without a copy, for reading alone: the solver makes new ones in each frame. The frame of a refused
        edit has those of the last solution, one without an answer NaN.

        Raises:
            UserError: the frame is not the last one any more.
        """
        replay = self._replay()
        space, known = replay.solver.space, replay.solver.known
        at_nodes, in_cells = replay.analysis.fields() if known else replay.analysis.blank_fields(space)
        return {name: read_only(field.view()) for name, field in (in_cells | at_nodes).items()}

    @cached_property
    def mesh(self) -> ShownMesh:
        """Nodes and cells, which fields are of; the arrays are no views of the solver's.

        Raises:
            UserError: the frame is not the last one any more.
        """
        self._replay()
        return self._answer.mesh()

    @cached_property
    def scene(self) -> Scene:
        """The scene with the values that hold in this frame; the shape is that of the mesh, not its ``[shape]``.

        Raises:
            UserError: the frame is not the last one any more.
        """
        return self._replay().session.scene

    @property
    def displacement(self) -> Reals:
        """(n, 2) or (n, 3) [m] displacement of the nodes.

        Raises:
            UserError: this physics has none, or the frame is not the last one any more.
        """
        return self.field("displacement")

    @property
    def von_mises(self) -> Reals:
        """(n,) [Pa] von Mises stress at the nodes, recovered from that of the cells.

        Where regions of different materials meet it jumps, and the field "von_mises_in_cells" has it instead: (ne, k)
        at the nodes of each cell.

        Raises:
            UserError: this physics has none, or the frame is not the last one any more.
        """
        return self.field("von_mises")

    def derivative(self, of: str) -> dict[str, Reals]:
        """How each quantity changes with the design at this frame, by its name.

        It is computed beside the edit, on a copy of the mesh: no row, and nothing that follows, changes.

        Args:
            of: an entity of the shape, such as "window": then (2,) by a drag of it in x and in y, in the quantity's
                unit a metre, with the design derivative of the answer. Or a number of the scene, with a dot, such as
                "material.steel.E" or "parameters.depth": then () in the quantity's unit a SI unit of the number, by two
                solves on the mesh as it lies.

        Raises:
            UserError: there is no such entity or number, the frame has no steady solution, or is not the last one.
        """
        from restshape.replay.quantity_rates import Rates

        rates = Rates(self._replay(), self._answer.request)
        return rates.by_number(of) if "." in of else rates.along_entity(of)

    def keep(self) -> Self:
        """The frame, with mesh, fields and scene read, so that they stay when the edit goes on.

        Raises:
            UserError: the frame is not the last one any more.
        """
        _ = self.mesh, self.fields, self.scene
        return self

    def field(self, name: str) -> Reals:
        """A field of `fields`.

        Raises:
            UserError: there is no such field, or the frame is not the last one any more.
        """
        if name not in self.fields:
            known = ", ".join(self.fields) or "none"
            raise UserError(f"there is no field {name!r}", f"frame {self.index}", f"use one of those it has: {known}")
        return self.fields[name]

    def _replay(self) -> Replay:
        """What holds its answer."""
        answer = self._answer
        where = f"frame {self.index}"
        if answer.closed:
            raise UserError("the simulation of this frame is closed", where, "read what you need of it before")
        if self._count != answer.count:
            what = f"the edit has gone on, to frame {answer.count - 1}, and its answer is another one"
            raise UserError(what, where, "read mesh and fields of a frame before the next one")
        return answer.replay

    def __repr__(self) -> str:
        """What it is, in one line."""
        found = ", ".join(f"{name}={value:.6g}" for name, value in self.quantities.items())
        return f"<frame {self.index}: {self.refused or found or self.row['event']}>"
