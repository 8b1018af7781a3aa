"""What an application, or a physics, adds to scenes and edit scripts: tables, events, kinds of quantities, checks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NoReturn

from pydantic import BaseModel, Field, create_model

from restshape.errors import UserError
from restshape.scene.event_line import EventLine
from restshape.scene.model import Scene
from restshape.scene.quantity import Quantity, QuantityKind, quantity_type
from restshape.scene.source import Source
from restshape.scene.values import Name


@dataclass(frozen=True)
class Section:
    """A table at the top of a scene.

    Args:
        model: of its keys.
        summary: one line for people.
        named: it holds tables of such keys by name, as ``[loads.NAME]`` does.
        required: a scene must have it; without it it has the defaults of its keys, or no names.
    """

    model: type[BaseModel]
    summary: str
    named: bool = False
    required: bool = False

    @property
    def field(self) -> tuple[Any, Any]:
        """Its annotation and its default, for pydantic."""
        kind: Any = dict[Name, self.model] if self.named else self.model
        if self.required:
            return kind, Field(description=self.summary)
        return kind, Field(default_factory=dict if self.named else self.model, description=self.summary)


@dataclass(frozen=True)
class SceneExtension:
    """What a scene and its edit script may hold besides.

    Args:
        sections: tables by key.
        events: of edit scripts by name, beside those that every session has.
        quantities: kinds by name.
        check: what models alone cannot check in a scene; raises a `UserError` made by `Source.error`.
    """

    sections: Mapping[str, Section] = field(default_factory=dict)
    events: Mapping[str, type[EventLine]] = field(default_factory=dict)
    quantities: Mapping[str, QuantityKind] = field(default_factory=dict)
    check: Callable[[Scene, Source], None] | None = None

    @cached_property
    def scene_type(self) -> type[Scene]:
        """The model of scenes with these tables and kinds of quantities; unit strings and formulas work in them."""
        kind = quantity_type(self.quantities) if self.quantities else Quantity
        fields = {key: section.field for key, section in self.sections.items()}
        fields["quantities"] = (dict[Name, kind], {})
        return create_model("Scene", __base__=Scene, __doc__=Scene.__doc__, **fields)


def joined(extensions: Iterable[SceneExtension]) -> SceneExtension:
    """One extension with the tables, none required, and the quantities of several; `refuse_clashes` comes first."""
    sections, quantities = {}, {}
    for extension in extensions:
        sections |= {
            key: Section(section.model, section.summary, section.named) for key, section in extension.sections.items()
        }
        quantities |= extension.quantities
    return SceneExtension(sections, quantities=quantities)


def refuse_clashes(
    extensions: Mapping[str, SceneExtension], events: Mapping[str, Mapping[str, type[EventLine]]]
) -> None:
    """Makes sure that each key of scenes and each event of edit scripts has one meaning.

    Args:
        extensions: by the name of what registers them.
        events: that the edit scripts of each of these have without it.

    Raises:
        UserError: two register different tables or kinds of quantity by one key, or one takes what is there already.
    """
    owners: dict[tuple[str, str], tuple[str, Any]] = {("table", key): ("", None) for key in Scene.model_fields}
    owners |= {("quantity", key): ("", None) for key in Quantity.model_fields}
    for name, extension in extensions.items():
        added = [("table", key, section) for key, section in extension.sections.items()]
        added += [("quantity", key, kind) for key, kind in extension.quantities.items()]
        for what, key, meaning in added:
            owner, known = owners.setdefault((what, key), (name, meaning))
            if known != meaning:
                _refuse(name, what, key, f"{owner!r} does too" if owner else "every scene has one")
        for key, model in extension.events.items():
            if events[name].get(key, model) is not model:
                _refuse(name, "event", key, "its edit scripts have one")


def _refuse(name: str, what: str, key: str, other: str) -> NoReturn:
    raise UserError(f"{name!r} adds the {what} {key!r}, and {other}", name, "give one another key, or uninstall it")
