"""The frame of a replay whose shape its application states as a scene, without an outline."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from restshape.application import application_of
from restshape.errors import UserError
from restshape.export.edited_frame import row_of, scene_of, script_of
from restshape.export.toml_scene import toml_text
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import EXPORT_MARK
from restshape.replay.recording.recording import Recording
from restshape.replay.sessions import session_of
from restshape.scene.edit_script import Script
from restshape.scene.load import remade
from restshape.scene.model import Scene
from restshape.scene.plain_values import Table
from restshape.shape.script_frame import ScriptFrame


@dataclass(frozen=True)
class RestatedFrame:
    """A frame as a scene.

    Args:
        row: its place among the frames, from 0; count: how many there are.
        t: edit time [s].
        scene: with its settings; tables: plain ones, with the shape too.
        refused: why the frame has the shape of the one before it; empty where it has its own.
    """

    row: int
    count: int
    t: float
    scene: Scene
    tables: Table
    refused: str

    def write(self, path: Path) -> list[str]:
        """Writes the scene as TOML; returns notes of what it leaves out.

        Raises:
            UserError: its tables make no scene.
            OSError: it cannot be written.
        """
        remade(self.scene, self.tables)
        write_whole(path, f"# {EXPORT_MARK}\n{toml_text(self.tables)}")
        gone = [f"quantities.{name}" for name in self.scene.quantities if name not in self.tables["quantities"]]
        return [f"left out, for edits have deleted what it names: {name}" for name in gone]


def restates(scene: Scene) -> bool:
    """Whether frames of a scene are exported so."""
    return bool(application_of(scene).editing.restated)


def restated_of_script(scene: Scene, script: Script, number: int) -> RestatedFrame:
    """A frame of a script; arguments and errors as of `frame_of_script`."""
    frames = list(session_of(scene, script).frames())
    row = row_of(number, len(frames), "the script")
    return _restated(frames[row], row, len(frames), "")


def restated_of_recording(recording: Recording, row: int) -> RestatedFrame:
    """A frame of a recording, whose script is followed up to it; errors as of `frame_of_recording`."""
    scene = scene_of(recording)
    session = session_of(scene, script_of(recording, scene))
    refused = dict(zip(map(int, recording.table["index"]), map(str, recording.table["refused"])))
    wanted = int(recording.table["index"][row])
    for frame in session.frames():
        why = refused.get(frame.index, "")
        if why and not frame.refused and frame.change != "none":
            session.rollback()
        if frame.index == wanted:
            return _restated(frame, row, recording.n, why)
    what = f"its script ends before frame {wanted}"
    raise UserError(what, str(recording.path), "replay the scene again, and export the new recording")


def _restated(frame: ScriptFrame, row: int, count: int, why: str) -> RestatedFrame:
    tables: Mapping[str, object] = application_of(frame.scene).editing.restate(frame)
    return RestatedFrame(row, count, frame.t, frame.scene, dict(tables), why or frame.refused or "")
