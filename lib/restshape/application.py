"""Applications: what composes the library for one kind of object, found through entry points."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, cast, overload

from restshape.declared_paths import declared
from restshape.errors import UserError

if TYPE_CHECKING:
    import numpy.typing as npt

    from restshape.mesh.follower import Follower
    from restshape.scene.effect import DerivedEffect, Effect
    from restshape.scene.event_line import EventLine
    from restshape.scene.model import Scene
    from restshape.scene.physics import Physics
    from restshape.scene.source import Source
    from restshape.shape.protocol import Session

VERIFICATION = "restshape.verification"
"""Group of entry points of what verifies applications, by their names; each has `commands`, as an application has."""

Rows = Sequence[Mapping[str, object]]
"""Of the frames of a replay, each with its columns by name."""


@dataclass(frozen=True)
class ScriptLines:
    """Lines of text that `restshape script` makes edit scripts of, where a session is the application's own.

    Args:
        grammar: what lines may be, for people.
        interpreter: path ``module:attribute`` of the `shape.script_language.LineInterpreter` of a scene.
    """

    grammar: str
    interpreter: str


@dataclass(frozen=True)
class MeshReuse:
    """What a mesh that follows the edits lets frames reuse, as reports and studies show it.

    Args:
        levels: path ``module:attribute`` of what draws the level of reuse of each frame of a recording into a file.
    """

    levels: str

    def draw_levels(self, recording: object, path: Path) -> None:
        """Draws the level of reuse of each frame."""
        _function(self.levels)(recording, path)


@dataclass(frozen=True)
class Editing:
    """What edit scripts edit, and what follows it from frame to frame; each but `mesh` a path ``module:attribute``.

    Args:
        session: makes the `Session` of a scene, a script, the application and, where the shape is not the scene's own,
            its outline.
        replayed: makes the session and what follows its frames, a `Follower`, of a scene, a script, the application, a
            policy and a communicator.
        events: of its scripts by name, besides those that physics add.
        check: of a scene, the application and its source; raises a `UserError` of what makes no sense.
        contents: of a scene and its plan, what is in it: for programs, as rows for people, and its outline if any.
        mesh: what frames reuse of the mesh; None: what is edited has none.
        restated: of a frame without an outline, the plain tables of a scene that has its shape; empty: there are none.
        drawn: draws a scene without an outline into a file, for `restshape check --picture`; empty: nothing does.
        grabbed: of the last frame of a simulation, what a hand may take hold of, each one a
            `restshape.live.grab_parts.Thing`; empty: entities of the outline, bodies and supports.
    """

    session: str
    replayed: str
    events: str
    check: str
    contents: str
    mesh: MeshReuse | None = None
    restated: str = ""
    drawn: str = ""
    grabbed: str = ""

    @property
    def has_mesh(self) -> bool:
        """Whether what is edited is a shape with an outline, which a mesh fills and follows."""
        return self.mesh is not None

    def restate(self, frame: object) -> Mapping[str, object]:
        """The plain tables of a scene that has the shape of a frame, whose maker is imported now."""
        return cast("Mapping[str, object]", _function(self.restated)(frame))

    def draw(self, scene: Scene, path: Path) -> None:
        """Draws a scene without an outline, by what is imported now.

        Raises:
            UserError: it makes no sense.
            OSError: the file cannot be written.
        """
        _function(self.drawn)(scene, path)

    def things(self, simulation: object) -> Sequence[object] | None:
        """What a hand may take hold of after the last frame of a simulation; None: `grabbed` is empty."""
        return cast("Sequence[object]", _function(self.grabbed)(simulation)) if self.grabbed else None

    def make_session(self, scene: Scene, *script_application: object) -> Session:
        """The session, whose maker is imported now."""
        return cast("Session", _function(self.session)(scene, *script_application))

    def start(self, scene: Scene, *script_application_policy_communicator: object) -> tuple[Session, Follower]:
        """The session and what follows its frames."""
        found = _function(self.replayed)(scene, *script_application_policy_communicator)
        return cast("tuple[Session, Follower]", found)

    def shared_events(self) -> Mapping[str, type[EventLine]]:
        """The events of its scripts by name, besides those that physics add."""
        return cast("Mapping[str, type[EventLine]]", declared(self.events))

    def check_scene(self, scene: Scene, application: Application, source: Source) -> None:
        """Makes sure that a scene makes sense.

        Raises:
            UserError: it does not.
        """
        _function(self.check)(scene, application, source)

    def checked(self, scene: Scene, effects: object) -> tuple[dict[str, object], list[tuple[str, str]], object]:
        """What a scene holds: for programs, as rows for people, and its outline; None without one."""
        found = _function(self.contents)(scene, effects)
        return cast("tuple[dict[str, object], list[tuple[str, str]], object]", found)


SHAPES = Editing(
    session="restshape.shape.session:EditSession",
    replayed="restshape.replay.shapes:replayed_shape",
    events="restshape.scene.edit_script:EVENTS",
    check="restshape.scene.checks:check_shaped",
    contents="restshape.cli.check_scene:checked_shape",
    mesh=MeshReuse(levels="restshape.report.levels:draw_levels"),
)
"""Scripts that edit an outline, whose mesh follows."""


@dataclass(frozen=True)
class Reporting:
    """What is reported of replays besides what all have; each a path ``module:attribute`` of a function.

    Args:
        summary: of `Rows`, the keys that their summary has besides.
        tables: prints tables of `Rows`.
        pictures: draws a recording into a folder, as the options of `restshape report` say; the paths of its pictures.
        sheet: draws the frame of a number, or of None the characteristic ones, into one PNG, whose path follows.
        true_scale: why what is drawn cannot be exaggerated; no path.
        arguments: adds options to the parser of `restshape report`; empty: there are none.
        check: raises a `UserError` of options that make no sense; empty: all do.
    """

    summary: str
    tables: str
    pictures: str
    sheet: str
    true_scale: str
    arguments: str = ""
    check: str = ""

    def summarised(self, rows: Rows) -> dict[str, object]:
        """The keys that a summary of these rows has besides."""
        return cast("dict[str, object]", _function(self.summary)(rows)) if rows else {}

    def print_tables(self, rows: Rows) -> None:
        """Prints the tables of these rows."""
        if rows:
            _function(self.tables)(rows)

    def add_arguments(self, parser: ArgumentParser) -> None:
        """Adds options to `restshape report`."""
        if self.arguments:
            _function(self.arguments)(parser)

    def check_arguments(self, options: Namespace) -> None:
        """Makes sure that the options make sense."""
        if self.check:
            _function(self.check)(options)

    def draw(self, recording: object, folder: Path, options: Namespace) -> list[Path]:
        """Draws a recording; the paths of the pictures."""
        return cast("list[Path]", _function(self.pictures)(recording, folder, options))

    def draw_sheet(self, recording: object, at: int | None, path: Path) -> None:
        """Draws the frame of a number, or of None the characteristic ones, into one PNG."""
        _function(self.sheet)(recording, at, path)


@dataclass(frozen=True)
class Exporting:
    """What `restshape export` does of its scenes besides what it does of all; paths ``module:attribute`` of functions.

    Args:
        arguments: adds options to the parser of `restshape export`.
        check: raises a `UserError` of options that make no sense for a format.
        formats: of files that its scenes alone are written as; each is given a frame, the options and the file to
            write, and returns what there is to note.
        engraved: of a frame and the options, the `export.cut_drawing.Engraving` of a drawing for a workshop.
        shaped: of a frame and the options, the frame whose shape is written in formats of all scenes, the same where
            the options change nothing, and what there is to note.
        layers: what layers of drawings are where nothing says so, "names" or "cut".
    """

    arguments: str
    check: str
    formats: Mapping[str, str]
    engraved: str
    shaped: str
    layers: str = "names"

    def add_arguments(self, parser: ArgumentParser) -> None:
        """Adds options to `restshape export`."""
        _function(self.arguments)(parser)

    def check_arguments(self, options: Namespace) -> None:
        """Makes sure that the options make sense."""
        _function(self.check)(options)

    def write(self, kind: str, frame: object, options: Namespace, path: Path) -> list[str]:
        """Writes a frame in a format of its own; what there is to note."""
        return cast("list[str]", _function(self.formats[kind])(frame, options, path))

    def engraving(self, frame: object, options: Namespace) -> object:
        """What is engraved and drilled besides what the shape says."""
        return _function(self.engraved)(frame, options)

    def shape(self, frame: object, options: Namespace) -> tuple[object, list[str]]:
        """The frame whose shape is written in formats of all scenes, and what there is to note."""
        return cast("tuple[object, list[str]]", _function(self.shaped)(frame, options))


class Declared(Sequence["Physics"]):
    """Physics by paths ``module:attribute``, imported where somebody first looks at them: lists and helps do not.

    Args:
        paths: one for each, in order.
    """

    def __init__(self, *paths: str) -> None:
        self.paths = paths

    @cached_property
    def _found(self) -> tuple[Physics, ...]:
        return tuple(cast("Physics", declared(path)) for path in self.paths)

    @overload
    def __getitem__(self, index: int) -> Physics: ...

    @overload
    def __getitem__(self, index: slice) -> Sequence[Physics]: ...

    def __getitem__(self, index: int | slice) -> Physics | Sequence[Physics]:
        """One of them, or a slice."""
        return self._found[index]

    def __len__(self) -> int:
        """How many there are."""
        return len(self.paths)


@dataclass(frozen=True)
class Command:
    """A command of `restshape` that an application, or what verifies it, brings along.

    Args:
        name: as it is typed after ``restshape``.
        summary: one line for people.
        module: path of the module with ``arguments(parser)`` and ``run(args)``, imported when the command is used.
    """

    name: str
    summary: str
    module: str

    def load(self) -> ModuleType:
        """The module, imported now."""
        return import_module(self.module)


@dataclass(frozen=True)
class ShownColumn:
    """A column of the frames that live sessions show beside the quantities of a scene.

    Args:
        name: of the column; unit: SI, empty for pure numbers.
        least, most: between which it should be; None: there is no such limit.
        effect: without which it has no values; empty: it always has some.
    """

    name: str
    unit: str = ""
    least: float | None = None
    most: float | None = None
    effect: str = ""


@dataclass(frozen=True)
class HandMarks:
    """What live sessions show at the hand; each a path ``module:attribute`` of a function.

    Args:
        shown: of a `restshape.interface.simulation.Simulation` after a frame, its marks, each a
            `restshape.live.shown_marks.Mark`; empty: there are none.
        struck: of such a simulation and a place [m], or None, the `restshape.live.shown_marks.Tone` of its shape struck
            there; empty: it has none.
        columns: that are shown and plotted as quantities are.
    """

    shown: str = ""
    struck: str = ""
    columns: tuple[ShownColumn, ...] = ()


@dataclass(frozen=True)
class Explanation:
    """What `restshape explain` says of an application besides what it says of all.

    Args:
        parts: path ``module:attribute`` of what each part of a frame is, by its name; empty: as of all.
        costs: path ``module:attribute`` of a function of a scene that gives lines, each what, which, why: what
            commands of the application cost.
    """

    parts: str = ""
    costs: str = ""


@dataclass(frozen=True)
class SceneKind:
    """What is different in scenes of an application that have a table of their own, such as ``[fluid]``.

    Args:
        physics, analysis, needs: in place of the application's.
    """

    physics: Sequence[Physics]
    analysis: str
    needs: tuple[str, ...] = ()


@dataclass(frozen=True)
class Application:
    """A kind of object: its physics, its analysis, and the folder of its scenes.

    Args:
        name: as scenes name it in ``app``.
        summary: one line for people.
        folder: holds ``scenes/*.toml`` and ``edits/*.jsonl``.
        physics: what its scenes may say, each declared once for all applications that have it; `Declared` by paths.
        analysis: path ``module:attribute`` of its analysis class, imported at the first solve.
        editing: what its scripts edit.
        lines: what `restshape script` understands; None: what it understands of shapes.
        report: None: nothing but what all have.
        exports: likewise.
        explained: what `restshape explain` says of it.
        marks: what live sessions show of a frame at the hand.
        takes: names of the effects of its physics that its scenes may name; None: all of them.
        needs: those among them without which it makes no sense, besides those that its physics require.
        commands: that it adds to `restshape`.
        kinds: by a table of their own, its scenes of another kind, with other physics: `for_scene`.
    """

    name: str
    summary: str
    folder: Path
    physics: Sequence[Physics]
    analysis: str
    editing: Editing = SHAPES
    lines: ScriptLines | None = None
    report: Reporting | None = None
    exports: Exporting | None = None
    explained: Explanation = Explanation()
    marks: HandMarks = HandMarks()
    takes: tuple[str, ...] | None = None
    needs: tuple[str, ...] = ()
    commands: tuple[Command, ...] = ()
    kinds: Mapping[str, SceneKind] = field(default_factory=dict)

    @cached_property
    def _of_kinds(self) -> dict[str, Application]:
        """The application as its scenes with a table see it, by that table."""
        return {
            table: replace(self, kinds={}, physics=kind.physics, analysis=kind.analysis, needs=kind.needs)
            for table, kind in self.kinds.items()
        }

    @property
    def as_seen(self) -> tuple[Application, ...]:
        """The application as each kind of its scenes sees it, the usual one first."""
        return (self, *self._of_kinds.values())

    def for_scene(self, tables: Collection[str]) -> Application:
        """The application as a scene with these tables at its top sees it."""
        return next((one for table, one in self._of_kinds.items() if table in tables), self)

    @cached_property
    def effects(self) -> dict[str, Effect]:
        """Every effect that its scenes may name, in its own order."""
        known = {name: effect for one in self.physics for name, effect in one.effects.items()}
        taken = {name: known[name] for name in (known if self.takes is None else self.takes)}
        return taken | {name: replace(taken[name], required=True) for name in self.needs}

    @cached_property
    def derived(self) -> dict[str, DerivedEffect]:
        """Parts of its physics that follow from a scene without being named, by name."""
        return {name: part for one in self.physics for name, part in one.derived.items()}

    @property
    def orders(self) -> tuple[int, ...]:
        """Element orders that all of its physics have, the default first."""
        first, *others = (one.orders for one in self.physics)
        return tuple(order for order in first if all(order in orders for orders in others))

    @property
    def order_why(self) -> str:
        """Why elements are of that order where nothing says so, for people."""
        first = self.physics[0]
        reason = f": {first.order_why}" if first.order_why and self.orders[0] == first.orders[0] else ""
        return f"the default of {self.name}{reason}"

    @property
    def mesh_keys(self) -> frozenset[str]:
        """The keys of ``[mesh]`` that all of its physics have, besides those of all scenes."""
        first, *others = (frozenset[str](one.mesh_keys) for one in self.physics)
        return first.intersection(*others)

    @property
    def events(self) -> dict[str, type[EventLine]]:
        """The events of edit scripts that its physics add, by name."""
        return {name: event for one in self.physics for name, event in one.events.items()}

    def transient(self, scene: Scene) -> bool:
        """Whether a frame of a scene goes on from the one before it, so that none can be left out."""
        on = ((name, effect) for name, effect in self.effects.items() if effect.required or name in scene.effects)
        return any(effect.goes_on(scene.effects.get(name, {})) for name, effect in on)

    def interpreter(self) -> Callable[..., object]:
        """The composer of its edit scripts, imported now; it has `lines`."""
        assert self.lines is not None, "an application without lines has those of shapes"
        return _function(self.lines.interpreter)

    def frame_parts(self, usual: Mapping[str, str]) -> Mapping[str, str]:
        """What each part of a frame is, by its name."""
        return cast("Mapping[str, str]", declared(self.explained.parts)) if self.explained.parts else usual

    def command_costs(self, scene: Scene) -> Sequence[tuple[str, str, str]]:
        """What commands of this application cost in a scene, for `restshape explain`: what, which, why."""
        costs = self.explained.costs
        return cast("Sequence[tuple[str, str, str]]", _function(costs)(scene)) if costs else ()

    def marked(self, simulation: object) -> Sequence[object]:
        """What is shown at the hand after the last frame of a simulation, by what is imported now."""
        return cast("Sequence[object]", _function(self.marks.shown)(simulation)) if self.marks.shown else ()

    def struck(self, simulation: object, at: Sequence[float] | None = None) -> object | None:
        """The tone of the shape of a simulation struck at a place [m]; None where it has none.

        Raises:
            UserError: the place is off the shape.
        """
        return _function(self.marks.struck)(simulation, at) if self.marks.struck else None

    def shown_columns(self, scene: Scene) -> list[ShownColumn]:
        """The columns of a scene that live sessions show as quantities; none by the name of a quantity."""
        on = {name for name, effect in self.effects.items() if effect.required or name in scene.effects}
        known = (one for one in self.marks.columns if not one.effect or one.effect in on)
        return [one for one in known if one.name not in scene.quantities]

    def make_analysis(self) -> Callable[..., object]:
        """The factory of this application's analysis, imported now.

        Raises:
            UserError: there is none at the declared path.
        """
        return _function(self.analysis, f"the application {self.name!r}")

    def own_columns(self, scene: Scene) -> dict[str, npt.DTypeLike]:
        """Names and types of the columns that only this application has; simulated time [s] where a frame goes on."""
        added = [one.columns(scene) for one in self.physics if one.columns]
        own = {name: of for columns in added for name, of in columns.items()}
        if self.transient(scene):
            own["time"] = float
        return own

    def scenes(self) -> list[Path]:
        """The scene files that ship with this application, sorted by name."""
        return sorted((self.folder / "scenes").glob("*.toml"))


@cache
def _function(path: str, owner: str = "an application") -> Callable[..., object]:
    """The function, or the class, that a path names."""
    return cast("Callable[..., object]", declared(path, owner))


@cache
def applications() -> dict[str, Application]:
    """All installed applications by name.

    Raises:
        UserError: one of them cannot be imported.
    """
    return {entry.name: _loaded(entry) for entry in sorted(entry_points(group="restshape.applications"))}


def _loaded(entry: EntryPoint) -> Application:
    """An installed application, imported now."""
    try:
        return cast("Application", entry.load())
    except Exception as error:
        what = f"the application {entry.name!r} cannot be imported: {type(error).__name__}: {error}"
        raise UserError(what, entry.value, "mend it, or uninstall its package") from error


def brought_commands() -> dict[str, tuple[Command, ...]]:
    """The commands that come with each installed application: its own, then those of what verifies it."""
    known = applications()
    beside = {entry.name: entry for entry in entry_points(group=VERIFICATION) if entry.name in known}
    return {
        name: (*app.commands, *(beside[name].load().commands if name in beside else ())) for name, app in known.items()
    }


def application(name: str, where: str = "app") -> Application:
    """The installed application of that name.

    Raises:
        UserError: no such application.
    """
    known = applications()
    if name not in known:
        do = f"use one of: {', '.join(known)}, or install the one that it is for"
        raise UserError(f"no application is installed that is named {name!r}", where, do)
    return known[name]


def application_of(scene: Scene) -> Application:
    """The installed application of a scene, as scenes of its kind see it.

    Raises:
        UserError: there is none.
    """
    return application(scene.app).for_scene(type(scene).model_fields)


def as_scenes_see(known: Iterable[Application]) -> list[Application]:
    """Applications as each kind of their scenes sees them."""
    return [seen for one in known for seen in one.as_seen]
