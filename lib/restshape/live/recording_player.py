"""Shows the frames of a recording in a live session, as they are in the file."""

# More than 15 modules: meshes, fields and shapes of a recording meet what pages are told of them here.

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from restshape.application import application_of
from restshape.errors import UserError
from restshape.live.frame_header import columns_of, errors_of, limits_of_frame
from restshape.live.grab_parts import OutlineParts
from restshape.live.moment import Moment
from restshape.live.moved_marks import MovedMarks
from restshape.live.recorded_extremes import RecordedExtremes, RecordedSpace, recorded_answer
from restshape.live.recorded_marks import recorded_marks
from restshape.live.shape_surface import MODE, ShapeSurface, mode_of
from restshape.live.shown_colours import colours_of
from restshape.live.shown_marks import shown_with
from restshape.live.welcome import columns_said
from restshape.replay.sessions import session_of
from restshape.report.field import IN_CELLS, physics_of, shown_field
from restshape.report.recorded_quantities import limits_of, quantity_units
from restshape.report.tables import refused
from restshape.scene.edit_script import Script, read_script
from restshape.scene.load import recorded_scene
from restshape.scene.physics import PictureField
from restshape.scene.plain_values import table_in

if TYPE_CHECKING:
    from restshape.arrays import Indices, Reals
    from restshape.interface.simulation import Predict
    from restshape.live.live_simulation import Progress
    from restshape.live.script_player import Watch
    from restshape.live.shown_marks import Mark
    from restshape.replay.recording.recording import Recording
    from restshape.scene.model import Scene
    from restshape.shape.outline import Outline

    RecordedShape = tuple[Outline | None, Scene]
    """The outline of a frame, and the values that hold in it."""


@dataclass(frozen=True, eq=False)
class PlayedMesh:
    """The mesh of a frame of a recording.

    Args:
        X: (n, d) [m]; cells: (ne, k); topology: equal numbers, equal cells.
    """

    X: Reals
    cells: Indices
    topology: int


class RecordingPlayer:
    """Shows frames of a recording.

    Args:
        recording: open.

    Attributes:
        at: number of the frame that is shown, which who shows it sets; frames: how many there are.
        field: that gives the colours; empty: none does.
        marks: they are shown.
    """

    def __init__(self, recording: Recording) -> None:
        self.recording = recording
        self.at, self.frames, self.marks = 0, recording.n, True
        shown = shown_field(recording)
        self.field = shown.name if shown else next(iter(self.looks), "")
        self._surface, self._outline = ShapeSurface(), OutlineParts()
        self._known: tuple[int, PlayedMesh] | None = None
        self._shapes: list[RecordedShape] = []
        self._moved_marks = MovedMarks()
        self._extremes = RecordedExtremes()
        self._looked_at: RecordedSpace | None = None

    @cached_property
    def looks(self) -> dict[str, PictureField]:
        """The fields that may be shown."""
        known = {name: look for one in physics_of(self.recording) for name, look in one.pictured.items()}
        names = dict.fromkeys(name.removesuffix(IN_CELLS) for name in self.recording.fields)
        return {name: known.get(name) or PictureField(name.replace("_", " "), "") for name in names}

    @cached_property
    def scene(self) -> Scene:
        """The recorded scene.

        Raises:
            UserError: it names a file, or is none any more.
        """
        header, path = self.recording.header, self.recording.path
        return recorded_scene(table_in(header, "scene_values"), path.with_name(_name(header.get("scene"), "scene")))

    @property
    def policy(self) -> str | None:
        """What was reused from frame to frame; None: as the scene says."""
        return str(self.recording.header.get("policy") or "") or None

    @property
    def predict(self) -> Predict:
        """How frames of drags were predicted."""
        how = self.recording.header.get("predict")
        return how if how in ("linear", "gmls") else "none"

    @cached_property
    def script(self) -> Script:
        """The recorded script; errors as of `scene`."""
        scene, name = self.scene, _name(self.recording.header.get("script"), "script")
        if not self.text:
            return Script.empty(scene)
        return read_script(self.text, self.recording.path.with_name(name), scene, keep_good=True)

    @property
    def text(self) -> str:
        """Of the recorded script; empty without one."""
        return str(self.recording.header.get("script_text", ""))

    @cached_property
    def _sessions(self) -> Iterator[RecordedShape]:
        """The shape of each frame, where the scene can be edited again without a solve; nothing where it cannot."""
        try:
            session = session_of(self.scene, self.script)
        except UserError:
            return iter(())
        stopped = refused(self.recording)

        def shapes() -> Iterator[RecordedShape]:
            for frame in session.frames():
                if frame.index < self.frames and stopped[frame.index] and not frame.refused and frame.change != "none":
                    # It had no solution.
                    session.rollback()
                yield session.outline, session.scene

        return shapes()

    def shape(self, i: int) -> RecordedShape | None:
        """The shape of a frame; None where none can be had."""
        while len(self._shapes) <= i:
            found = next(self._sessions, None)
            if found is None:
                return None
            self._shapes.append(found)
        return self._shapes[i]

    def mesh(self, i: int) -> PlayedMesh:
        """The mesh of a frame; those of one topology have the same cells."""
        number = self.recording.topology(i)
        if self._known is None or self._known[0] != number:
            self._known = number, PlayedMesh(self.recording.points(i), self.recording.cells(i), number)
        return self._known[1]

    def show(self, number: int, progress: Progress | None = None, interrupted: Watch | None = None) -> Moment:
        """What a page sees of a frame."""
        recording = self.recording
        at_nodes: dict[str, Reals] = {}
        in_cells: dict[str, Reals] = {}
        for name, info in recording.fields.items():
            wanted = name.removesuffix(IN_CELLS) == self.field or name == "displacement" or name.startswith(MODE)
            if wanted and info.first_frame <= number:
                (at_nodes if info.where == "point_data" else in_cells)[name] = recording.field(number, name)
        mesh = self.mesh(number)
        X = recording.points(number)
        part = self._surface.placed(mesh, X, at_nodes, in_cells, colours_of(self.field, at_nodes, in_cells))
        row = {name: _plain(values[number]) for name, values in recording.table.items()}
        said = {"errors": errors_of(row, self._units), "limits": limits_of_frame(row, self._limited)}
        header = {"type": "frame", "number": number, "columns": columns_of(row), "held": None, **said}
        outline, scene = self.shape(number) or (None, None)
        parts = [part, *self._outline(outline)]
        found: Sequence[Mark] = ()
        if self.marks and outline is not None and scene is not None and X.shape[1] == 2:
            seen = recorded_answer(recording, number, row, self._space(number), scene)
            extremes = [] if row["refused"] else self._extremes(seen)
            found = shown_with([*recorded_marks(scene, outline, row, X), *extremes], mode_of(self.field))
        return Moment(header, parts, self._moved_marks(found, parts), float(recording.times[number]))

    def marked(self, moment: Moment, marks: Sequence[Mark]) -> Moment:
        """A frame with other marks, put where its shape is drawn."""
        shown = shown_with(marks, mode_of(self.field)) if self.marks else ()
        return replace(moment, marks=self._moved_marks(shown, moment.parts))

    def _space(self, number: int) -> RecordedSpace:
        """The mesh of a frame, for marks; the same object where nothing has moved to other cells."""
        mesh = self.mesh(number)
        if self._looked_at is None or self._looked_at.topology != mesh.topology:
            self._looked_at = RecordedSpace(self.recording.points(number), mesh.cells, mesh.topology)
        else:
            self._looked_at.X = self.recording.points(number)
        return self._looked_at

    @cached_property
    def _units(self) -> dict[str, str]:
        """Of the quantities."""
        return quantity_units(self.recording.header)

    @cached_property
    def _limited(self) -> list[str]:
        """The quantities that have a limit."""
        return [*limits_of(self.recording)] if "findings" in self.recording.table else []

    def forget(self) -> None:
        """Frames are read again each time: nothing is to be forgotten."""

    @property
    def in_space(self) -> bool:
        """Whether the shape is drawn in space."""
        deep = any(one.components == 3 and one.where == "point_data" for one in self.recording.fields.values())
        return deep or self.recording.dimension == 3

    def quantities(self) -> list[dict[str, object]]:
        """The quantities with the limits of the first frame."""
        limits = limits_of(self.recording)
        names = {"min": "limitLow", "max": "limitHigh"}
        found: list[dict[str, object]] = [
            {"name": name, "unit": unit} | {names[key]: value for key, value in limits.get(name, {}).items()}
            for name, unit in self._units.items()
        ]
        with suppress(UserError):
            shown = application_of(self.scene).shown_columns(self.scene)
            found += [columns_said(one) for one in shown if one.name in self.recording.table]
        return found


def _name(given: object, other: str) -> str:
    """The name of a file that a header names, without folders; another one where it names none."""
    return Path(str(given or other)).name or other


def _plain(value: object) -> Any:
    """A value of a table as Python has it."""
    return value.item() if isinstance(value, np.generic) else value
