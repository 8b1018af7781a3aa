"""Applications: what composes the library for one kind of object, found through entry points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from restshape.errors import UserError

if TYPE_CHECKING:
    from pydantic import BaseModel

    from restshape.scene.model import Scene


@dataclass(frozen=True)
class Decision:
    """What an effect settles for one scene.

    Args:
        settings: its keys, with nothing left open.
        why: for people; empty where there was nothing to decide.
        order: the element order that it wants where the scene names none; None: it does not matter.
        warns: the scene's own keys make the answer bad: True where `why` says how, else these words.
        tolerance: `solve.tolerance` where the scene names none; None: the usual one.
    """

    settings: BaseModel
    why: str = ""
    order: int | None = None
    warns: bool | str = False
    tolerance: float | None = None


@runtime_checkable
class Deciding(Protocol):
    """An effect model with keys that the scene as a whole decides."""

    def decide(self, scene: Scene) -> Decision:
        """The decision for a scene whose `mesh.order` is None where nobody has named one.

        Raises:
            UserError: what the keys ask for makes no sense with this scene.
        """


@dataclass(frozen=True)
class Effect:
    """One physical effect that an application knows.

    Args:
        model: pydantic model of the keys that ``[effects.NAME]`` may hold; it may be `Deciding`.
        summary: one line for people.
        required: the application makes no sense without it.
        fixed: the analysis is another one with it, so that an edit can switch it neither on nor off.
        drives: it loads the body or sets it in motion.
        quantities: kinds of quantities that there are with it only.
        kernels: how the names of elements begin that are there for it alone.
        carries: effects whose work is done again for what this one adds: its price is that of a scene without them.
    """

    model: type[BaseModel]
    summary: str
    required: bool = False
    fixed: bool = False
    drives: bool = False
    quantities: tuple[str, ...] = ()
    kernels: tuple[str, ...] = ()
    carries: tuple[str, ...] = ()


@dataclass(frozen=True)
class Implied:
    """A part of the physics that no ``[effects.NAME]`` names: it follows from what else a scene holds.

    Args:
        summary: one line for people.
        cause: why a scene with these effects on calls for it; empty where nothing does.
        idle: what is said where nothing does.
        without: the plain tables of a scene with these effects on, copied, with nothing left that calls for it; None
            where it is no part that could be left out.
        drives: it loads the body or sets it in motion.
        needs: the effect without which it cannot be.
    """

    summary: str
    cause: Callable[[Scene, frozenset[str]], str]
    idle: str
    without: Callable[[dict[str, Any], frozenset[str]], dict[str, Any]] | None = None
    drives: bool = False
    needs: str = ""


@dataclass(frozen=True)
class Application:
    """A kind of object: its effects, its analysis, and the folder of its scenes.

    Args:
        name: as scenes name it in ``app``.
        summary: one line for people.
        effects: every effect that its scenes may name.
        folder: holds ``scenes/*.toml`` and ``edits/*.jsonl``.
        analysis: path ``module:attribute`` of its analysis class, imported at the first solve.
        orders: element orders that it supports.
        directions: that supports may fix.
        layered: bodies have a thickness, which may be a formula, and layers of elements over it.
        nested: its fields, of first order, may live on a mesh nested in coarser ones.
        cloth: it knows sheets in space: bodies, a start, planes of symmetry, a bending stiffness.
        session: path ``module:attribute`` of the class that edits what has neither outline nor mesh, which are planks;
            empty for all others. Of a scene and a script it makes their frames, and models of them.
        columns: path ``module:attribute`` of the function that names the columns of a replay that only this application
            has, with their types, for a scene.
        transient: a frame goes on from the one before it, so that none can be left out.
        implied: parts of its physics that follow from a scene without being named, by name.
    """

    name: str
    summary: str
    effects: dict[str, Effect]
    folder: Path
    analysis: str
    orders: tuple[int, ...] = (1,)
    directions: tuple[str, ...] = ("x", "y")
    layered: bool = False
    nested: bool = False
    cloth: bool = False
    session: str = ""
    columns: str = ""
    transient: bool = False
    implied: dict[str, Implied] = field(default_factory=dict)

    @property
    def planks(self) -> bool:
        """Whether its objects are made of planks, which have no mesh."""
        return bool(self.session)

    def make_session(self) -> Callable[..., Any]:
        """The class of sessions of planks, imported now."""
        return _attribute(self.session)

    def make_analysis(self) -> Callable[..., Any]:
        """The factory of this application's analysis, imported now."""
        return _attribute(self.analysis)

    def own_columns(self, scene: Scene) -> dict[str, Any]:
        """Names and types of the columns that only this application has."""
        return _attribute(self.columns)(scene) if self.columns else {}

    def scenes(self) -> list[Path]:
        """The scene files that ship with this application, sorted by name."""
        return sorted((self.folder / "scenes").glob("*.toml"))


def _attribute(path: str) -> Any:
    module, attribute = path.split(":")
    return getattr(import_module(module), attribute)


@cache
def applications() -> dict[str, Application]:
    """All installed applications by name."""
    return {entry.name: entry.load() for entry in sorted(entry_points(group="restshape.applications"))}


def application(name: str, where: str = "app") -> Application:
    """The installed application of that name.

    Raises:
        UserError: no such application.
    """
    known = applications()
    if name not in known:
        raise UserError(f"no application is named {name!r}", where, f"use one of: {', '.join(known)}")
    return known[name]
