"""The frame of a replay that is exported: its shape and its scene, from a script or a recording, without solving."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from restshape.application import application_of
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.importer import read_mesh
from restshape.mesh.sizing import sizing_of
from restshape.mesh.thickness import Thickness
from restshape.replay.recording.recording import Recording
from restshape.replay.sessions import session_of
from restshape.scene.darts import without_darts
from restshape.scene.edit_script import Script, read_script
from restshape.scene.expressions import Expression
from restshape.scene.load import recorded_scene
from restshape.scene.model import Scene
from restshape.scene.plain_values import Table, table_in
from restshape.shape.outline import Outline


@dataclass(frozen=True)
class EditedFrame:
    """What an edit has made of a scene at one frame.

    Args:
        row: its place among the frames, from 0; count: how many there are.
        t: edit time [s].
        scene: with all values as they are then, but for the shape.
        outline: the shape.
        refused: why the frame has the shape of the one before it; empty where it has its own.
    """

    row: int
    count: int
    t: float
    scene: Scene
    outline: Outline
    refused: str


def frame_of_script(scene: Scene, script: Script, number: int) -> EditedFrame:
    """A frame of a script.

    Args:
        scene: where it starts; script: its edits; number: of the frame, from 0, or from -1 backwards.

    Raises:
        UserError: there is no such frame, or the scene has no outline.
    """
    refuse_shapeless(scene)
    imported = None if scene.mesh.file is None else read_mesh(scene.folder / scene.mesh.file, scene.mesh.unit)[1]
    frames = list(session_of(scene, script, imported).frames())
    row = row_of(number, len(frames), "the script")
    frame = frames[row]
    assert frame.outline is not None, "shapeless scenes are refused"
    return EditedFrame(row, len(frames), frame.t, frame.scene, frame.outline, frame.refused or "")


def frame_of_recording(recording: Recording, row: int) -> EditedFrame:
    """A frame of a recording, whose script is followed up to it; frames that its replay refused change nothing.

    Args:
        recording: of a scene with an outline; row: of the frame, from 0.

    Raises:
        UserError: the recording does not hold scene and script, or its scene names a file or has no outline.
    """
    scene = scene_of(recording)
    refuse_shapeless(scene)
    session = session_of(scene, script_of(recording, scene))
    refused = dict(zip(map(int, recording.table["index"]), _texts(recording, "refused")))
    wanted = int(recording.table["index"][row])
    for frame in session.frames():
        why = refused.get(frame.index, "")
        if why and not frame.refused and frame.change != "none":
            session.rollback()
        if frame.index == wanted:
            outline = session.outline
            assert outline is not None, "shapeless scenes are refused"
            return EditedFrame(row, recording.n, frame.t, session.scene, outline, why or frame.refused or "")
    what = f"its script ends before frame {wanted}"
    raise UserError(what, str(recording.path), "replay the scene again, and export the new recording")


def scene_of(recording: Recording) -> Scene:
    """The scene that a recording holds.

    Raises:
        UserError: it holds none, or one that names a file.
    """
    raw = recording.header.get("scene_values")
    if not isinstance(raw, dict):
        raise UserError("the recording holds no scene", str(recording.path), "replay the scene again")
    for table in ("shape", "mesh"):
        if file := table_in(raw, table).get("file"):
            what = f"its scene takes {table}.file = {file!r}, which the recording does not hold"
            do = "restshape export SCENE --edits FILE reads it; vtu and csv need the recording alone"
            raise UserError(what, str(recording.path), do)
    return recorded_scene(raw, Path(str(recording.header.get("scene") or "scene.toml")).with_suffix(".toml"))


def script_of(recording: Recording, scene: Scene) -> Script:
    """The script that a recording holds, up to a bad line."""
    text = str(recording.header.get("script_text") or "")
    name = Path(str(recording.header.get("script") or "script.jsonl"))
    return read_script(text, name, scene, keep_good=True) if text.strip() else Script.empty(scene)


def _texts(recording: Recording, column: str) -> Sequence[str]:
    """A column of texts, empty ones where the recording lacks it."""
    return [str(text) for text in recording.table.get(column, [""] * recording.n)]


def row_of(number: int, count: int, what: str) -> int:
    """The place of a frame from 0.

    Args:
        number: from 0, or from -1 backwards; count: of frames; what: has them, for messages.

    Raises:
        UserError: there is no such frame.
    """
    if -count <= number < count:
        return number % count
    frames = f"{count} frames, 0 to {count - 1}" if count > 1 else "one frame, 0"
    raise UserError(f"{what} has {frames}", f"--frame {number}", "--frame -1 is the last one")


def refuse_shapeless(scene: Scene) -> None:
    """Refuses a scene of an application that edits no outline.

    Raises:
        UserError: it is one.
    """
    if not application_of(scene).editing.has_mesh:
        what = f"a scene of {scene.app!r} has no outline that could be drawn"
        raise UserError(what, str(scene.path), "export it as toml, or a recording of it as stl, vtu or csv")


def thickness_of(scene: Scene) -> float | None:
    """The thickness [m] that all materials of a scene have; None where one leaves it out, or they differ."""
    found = set()
    for material in scene.material.values():
        given = getattr(material, "thickness", None) if "thickness" in material.model_fields_set else None
        found.add(given if isinstance(given, float) else None)
    return found.pop() if len(found) == 1 else None


def thickness_over(scene: Scene, X: np.ndarray) -> float | np.ndarray | None:
    """The thickness of a body over a plane mesh: a number [m], or (n,) at its nodes X (n, 2) [m] by a formula.

    None where a material leaves it out, or where materials differ.

    Raises:
        UserError: it is not positive somewhere.
    """
    number = thickness_of(scene)
    formulas = [
        value for one in scene.material.values() if isinstance(value := getattr(one, "thickness", 0.0), Expression)
    ]
    if number is not None or len(formulas) != len(scene.material) or len({one.text for one in formulas}) != 1:
        return number
    try:
        return Thickness(formulas[0], scene.parameters).at(X)
    except ReplayProblem as problem:
        raise UserError(str(problem), "material", "mend the formula of its thickness") from problem


def plain_scene(frame: EditedFrame, shape: Table) -> Table:
    """The plain tables of a frame's scene with others in place of its shape or panels, which are in no file.

    A scene whose mesh is from a file, without a size, gets that of new meshes.
    """
    raw = {key: value for key, value in without_darts(frame.scene).items() if key not in ("shape", *shape)}
    mesh = {key: value for key, value in table_in(raw, "mesh").items() if key not in ("file", "unit")}
    if frame.scene.mesh.file and frame.scene.mesh.size is None:
        mesh["size"] = float(f"{sizing_of(frame.outline, frame.scene.mesh).size:.3g}")
    first = {key: raw.pop(key) for key in ("format", "version", "app", "title", "parameters") if key in raw}
    return first | shape | raw | ({"mesh": mesh} if "mesh" in raw else {})
