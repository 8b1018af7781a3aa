"""Frames for programs: what a simulation shows of its shape after each step of an edit."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Self, TypeVar

from restshape.errors import UserError
from restshape.interface.readable_frame import ReadableFrame, ShownMesh
from restshape.replay.recording.cell_types import CELL_TYPES

if TYPE_CHECKING:
    from restshape.analysis.row_values import RowValues
    from restshape.arrays import AnyArray, Indices, Reals
    from restshape.replay.frame_counts import Counts
    from restshape.replay.loop import Replay
    from restshape.replay.request import Request
    from restshape.scene.model import Scene
    from restshape.shape.script_frame import ScriptFrame

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

    def frame(self, row: RowValues, counts: Counts | None = None) -> ShownFrame:
        """The frame of a row, which is the last one from now on."""
        self.count += 1
        return ShownFrame(row, self, counts)


class ShownFrame(ReadableFrame):
    """One frame of an edit: its row, and the answer that it shows.

    The row and the quantities stay. Mesh and fields are read when they are first asked for, while the frame is the last
    one; from then on they stay, too. So do those of the last frame before a hand lets go, or a simulation is closed.
    Arrays can be read alone; to change one, copy it. Fields are those of the solver without a copy, for it makes new
    ones in each frame that changes them.

    Attributes:
        row: a value a column, as `restshape replay --csv` writes them; times are in ms.
        counts: what it has done, of a replay that counts; else None.
    """

    def __init__(self, row: RowValues, answer: LastAnswer, counts: Counts | None = None) -> None:
        self.row, self.counts = row, counts
        self._answer, self._count = answer, answer.count
        self._fields: tuple[dict[str, Reals], dict[str, Reals]] | None = None

    @property
    def fields(self) -> dict[str, Reals]:
        """Fields by name: (n,) or (n, c) of the nodes, (ne,) or (ne, c) of the cells, as recordings have them.

        In SI units, without a copy, for reading alone: the solver makes new ones in each frame. The frame of a refused
        edit has those of the last solution, one without an answer NaN.

        Raises:
            UserError: the frame is not the last one any more.
        """
        at_nodes, in_cells = self.fields_apart
        return in_cells | at_nodes if in_cells else at_nodes

    @property
    def fields_apart(self) -> tuple[dict[str, Reals], dict[str, Reals]]:
        """Fields of the nodes, and those of the cells; as of `fields`, with its errors."""
        if self._fields is None:
            replay = self._replay()
            solver = replay.solver
            own = replay.analysis.fields() if solver.known else replay.analysis.blank_fields(solver.space)
            found: tuple[dict[str, Reals], dict[str, Reals]] = {}, {}
            for fields, views in zip(own, found):
                for name, values in fields.items():
                    view = views[name] = values.view()
                    view.setflags(write=False)
            self._fields = found
        return self._fields

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
        _ = self.mesh, self.fields, self.scene, self._of_session
        return self

    @cached_property
    def _of_session(self) -> tuple[ScriptFrame, dict[str, object]]:
        """The frame of the session, and what a recording says besides."""
        replay = self._replay()
        assert replay.rows.edit is not None, "there is a frame"
        return replay.rows.edit, {"singular": dict(replay.errors.singular.ever)}

    def _repr_png_(self) -> bytes | None:
        """The frame as `restshape report` draws it, for notebooks; None where it was not kept, or none is drawn."""
        from restshape.replay.recording.frame_recording import FrameRecording
        from restshape.report.sheet import sheet

        try:
            mesh, fields, (edit, extra) = self.mesh, self.fields_apart, self._of_session
        except UserError:
            return None
        return sheet(FrameRecording(self._answer.request, extra, edit, self.row, mesh.points, mesh.cells, *fields), 0)

    def _replay(self) -> Replay:
        """What holds its answer."""
        answer = self._answer
        if self._count == answer.count and not answer.closed:
            return answer.replay
        where = f"frame {self.index}"
        if answer.closed:
            raise UserError("the simulation of this frame is closed", where, "read what you need of it before")
        what = f"the edit has gone on, to frame {answer.count - 1}, and its answer is another one"
        raise UserError(what, where, "read mesh, fields and derivatives of a frame before the next one")
