"""Recordings for programs: the frames of a replay that was recorded, as those of one that runs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Self, overload

from restshape.errors import UserError
from restshape.interface.readable_frame import ReadableFrame, ShownMesh
from restshape.replay.recording.recording import Recording
from restshape.scene.edit_script import Script, read_script
from restshape.scene.load import recorded_scene
from restshape.scene.plain_values import table_in

if TYPE_CHECKING:
    from restshape.arrays import Reals
    from restshape.scene.model import Scene


class OpenedRecording(Recording):
    """A recording opened by `restshape.recording`; close it, or use it in a ``with`` statement.

    Attributes:
        frames: of the replay, in order; n: their number.
        table: by column its values (n,): arrays of numbers, and of texts.
        header: what the replay wrote of itself: scene, script, options, versions, calibration.
        fields: by name where a field is, how many components it has (0: a number), and the first frame that has it.
        status: "done", or why it ended early.
    """

    @cached_property
    def frames(self) -> Sequence[FrameOnFile]:
        """The frames, each read from the file when it is first asked for."""
        return Frames(self)

    @cached_property
    def scene(self) -> Scene:
        """The scene that was replayed.

        Raises:
            UserError: it is none that this version knows.
        """
        name = Path(str(self.header.get("scene", ""))).name or "scene"
        return recorded_scene(table_in(self.header, "scene_values"), self.path.with_name(name))

    @cached_property
    def script(self) -> Script:
        """The script that was replayed; without edits the empty one.

        Raises:
            UserError: it is none that this version knows.
        """
        text = str(self.header.get("script_text", ""))
        if not text:
            return Script.empty(self.scene)
        name = Path(str(self.header.get("script", ""))).name or "script"
        return read_script(text, self.path.with_name(name), self.scene, keep_good=True)

    @property
    def closed(self) -> bool:
        """Whether its file is closed: of its frames there is then what has been read."""
        return not self._file

    def __enter__(self) -> Self:
        """The recording."""
        return self

    def _repr_png_(self) -> bytes | None:
        """The sheet of frames that `restshape report` draws, for notebooks; None where it draws none, or is closed."""
        from restshape.report.sheet import sheet

        return None if self.closed else sheet(self)

    def __repr__(self) -> str:
        """What it is, in one line."""
        return f"<recording {self.path.name}: {self.summary}>"


class FrameOnFile(ReadableFrame):
    """One frame of a recording, with what a frame of a simulation has: row, quantities, findings, mesh and fields.

    What has been read stays when the recording is closed.
    """

    def __init__(self, recording: OpenedRecording, i: int) -> None:
        self._recording, self._i = recording, i
        self.row = {
            name: values[i].item() if hasattr(values[i], "item") else values[i]
            for name, values in recording.table.items()
        }

    @cached_property
    def mesh(self) -> ShownMesh:
        """Nodes and cells, which fields are of.

        Raises:
            UserError: the recording is closed.
        """
        recording = self._opened()
        points, cells = recording.mesh(self._i)
        return ShownMesh(points, cells, recording.cell_type(self._i))

    @cached_property
    def fields(self) -> dict[str, Reals]:
        """Fields by name, as they were recorded: (n,) or (n, c) of the nodes, (ne,) or (ne, c) of the cells; SI.

        Raises:
            UserError: the recording is closed.
        """
        recording = self._opened()
        known = recording.fields.items()
        return {name: recording.field(self._i, name) for name, one in known if one.first_frame <= self._i}

    def _repr_png_(self) -> bytes | None:
        """The frame as `restshape report` draws it, in the colours of all frames; None once the recording is closed."""
        from restshape.report.sheet import sheet

        return None if self._recording.closed else sheet(self._recording, self._i)

    def _opened(self) -> OpenedRecording:
        """The recording, whose file can be read."""
        if self._recording.closed:
            do = "read mesh and fields of its frames before"
            raise UserError("the recording is closed", f"{self._recording.path.name}: frame {self._i}", do)
        return self._recording


class Frames(Sequence[FrameOnFile]):
    """The frames of a recording, made when they are asked for."""

    def __init__(self, recording: OpenedRecording) -> None:
        self._recording = recording

    def __len__(self) -> int:
        """Their number."""
        return self._recording.n

    @overload
    def __getitem__(self, i: int) -> FrameOnFile: ...
    @overload
    def __getitem__(self, i: slice) -> list[FrameOnFile]: ...

    def __getitem__(self, i: int | slice) -> FrameOnFile | list[FrameOnFile]:
        """One frame, from the last one back where the number is negative; or a list of some."""
        if isinstance(i, slice):
            return [FrameOnFile(self._recording, k) for k in range(self._recording.n)[i]]
        return FrameOnFile(self._recording, range(self._recording.n)[i])

    def __iter__(self) -> Iterator[FrameOnFile]:
        """Each frame."""
        return (FrameOnFile(self._recording, k) for k in range(self._recording.n))


def recording(path: str | Path) -> OpenedRecording:
    """A recording that `restshape replay --out` wrote, opened for reading.

    Args:
        path: a .vtkhdf file.

    Raises:
        UserError: there is none, it is damaged, or it is being written.
    """
    return OpenedRecording(path)
