"""Effects that physics have, and what follows from a scene without being named."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from pydantic import BaseModel

from restshape.scene.model import Scene
from restshape.scene.plain_values import Table


@dataclass(frozen=True)
class ResolvedSettings:
    """What an effect's settings resolve to for one scene.

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
class SettingsResolver(Protocol):
    """An effect model with keys that the scene as a whole decides."""

    def resolve(self, scene: Scene) -> ResolvedSettings:
        """The decision for a scene whose `mesh.order` is None where nobody has named one.

        Raises:
            UserError: what the keys ask for makes no sense with this scene.
        """


@dataclass(frozen=True)
class StartOnly:
    """The annotation of an effect's key that matters at the start alone: no edit can change it."""


@dataclass(frozen=True)
class Effect:
    """One physical effect that an application knows.

    Args:
        model: pydantic model of the keys that ``[effects.NAME]`` may hold; it may be `SettingsResolver`.
        summary: one line for people.
        required: the application makes no sense without it.
        fixed: the analysis is another one with it, so that an edit can switch it neither on nor off.
        drives: it loads the body or sets it in motion.
        transient: a frame goes on from the one before it, so that none can be left out; or the key of its model with
            which it does.
        acceleration: the key of its model that is a vector of acceleration of all bodies; empty without one.
        quantities: kinds of quantities that there are with it only.
        kernels: how the names of elements begin that are there for it alone.
        repeats: effects whose work is done again for what this one adds, or that need it: its price is that of a scene
            without them.
        without: the plain tables of a scene with these effects on, copied, without what makes no sense once this one is
            left out; None where there is nothing such.
    """

    model: type[BaseModel]
    summary: str
    required: bool = False
    fixed: bool = False
    drives: bool = False
    transient: bool | str = False
    acceleration: str = ""
    quantities: tuple[str, ...] = ()
    kernels: tuple[str, ...] = ()
    repeats: tuple[str, ...] = ()
    without: Callable[[Table, frozenset[str]], Table] | None = None

    def goes_on(self, settings: Table) -> bool:
        """Whether a frame goes on from the one before it under these plain settings."""
        return settings.get(self.transient) is not None if isinstance(self.transient, str) else self.transient

    @property
    def start_keys(self) -> list[str]:
        """The keys of its model that matter at the start alone."""
        fields = self.model.model_fields.items()
        return [key for key, field in fields if any(isinstance(said, StartOnly) for said in field.metadata)]


@dataclass(frozen=True)
class DerivedEffect:
    """A part of the physics that no ``[effects.NAME]`` names: it follows from what else a scene holds.

    Args:
        summary: one line for people.
        cause: why a scene with these effects on calls for it; empty where nothing does.
        idle: what is said where nothing does.
        without: the plain tables of a scene with these effects on, copied, with nothing left that calls for it; None
            where it is no part that could be left out.
        drives: it loads the body or sets it in motion.
        needs: the effect without which it cannot be.
        remembers: equilibria depend on the path to them, so that one from rest is another one than one that goes on.
    """

    summary: str
    cause: Callable[[Scene, frozenset[str]], str]
    idle: str
    without: Callable[[Table, frozenset[str]], Table] | None = None
    drives: bool = False
    needs: str = ""
    remembers: bool = False
