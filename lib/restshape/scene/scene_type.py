"""Models of scenes: what all scenes hold, and what the physics of one add."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from types import GenericAlias
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BeforeValidator, ConfigDict, Field, WithJsonSchema, create_model
from typing_extensions import TypedDict

from restshape.scene.load_kind import LoadKind
from restshape.scene.materials import MATERIALS
from restshape.scene.model import Load, Material, Scene, Support, read_fix
from restshape.scene.physics import Physics, Section
from restshape.scene.quantity import QuantityKind, quantity_type
from restshape.scene.values import Name, Strict, annotation_of, value_of

Kind = TypeVar("Kind", LoadKind, QuantityKind)


@cache
def scene_type(physics: tuple[Physics, ...]) -> type[Scene]:
    """The model of scenes of these physics; unit strings and formulas work in all that they add."""
    materials = [one.material for one in physics if one.material]
    supports = [one.support for one in physics if one.support]
    return _scene_of(physics, _mixed(Material, materials), _mixed(Support, supports), joined_sections(physics))


def any_scene_type(physics: Iterable[Physics]) -> type[Scene]:
    """The model of scenes of any of these physics, in which nothing that one of them adds is required."""
    physics = tuple(physics)
    materials = [_loosened(Material, model) for model in dict.fromkeys(one.material for one in physics) if model]
    supports = [_loosened(Support, model) for model in dict.fromkeys(one.support for one in physics) if model]
    sections = {key: replace(section, required=False) for key, section in joined_sections(physics).items()}
    return _scene_of(physics, _mixed(Material, materials), _mixed(Support, supports), sections)


def joined_sections(physics: Iterable[Physics]) -> dict[str, Section]:
    """The tables of several physics by key."""
    return {key: section for one in physics for key, section in one.sections.items()}


def known_materials(physics: Iterable[Physics]) -> dict[str, dict[str, Any]]:
    """What is known of materials by their names: what the library knows, and what physics add."""
    known = {name: dict(values) for name, values in MATERIALS.items()}
    for one in physics:
        for name, values in one.materials.items():
            known[name] = {**known.get(name, {}), **values}
    return known


def _scene_of(
    physics: Sequence[Physics], material: type[Material], support: type[Support], sections: Mapping[str, Section]
) -> type[Scene]:
    known = known_materials(physics)
    name: tuple[Any, None] = (Literal[tuple(known)] | None, None)
    made = create_model("Material", __base__=material, __doc__=material.__doc__, name=name)
    made.known = known
    boundary = {component: dimension for one in physics for component, dimension in one.boundary.items()}
    fields: dict[str, Any] = {key: section.field for key, section in sections.items()}
    fields["material"] = (Annotated[_by_name(made), Field(min_length=1)], {})
    fields["supports"] = (_by_name(support_type(support, boundary)), {})
    fields["loads"] = (_by_name(load_type(_united(one.loads for one in physics))), {})
    fields["quantities"] = (_by_name(quantity_type(_united(one.quantities for one in physics))), {})
    return create_model("Scene", __base__=Scene, __doc__=Scene.__doc__, **fields)


def _by_name(model: type[Strict]) -> Any:
    """The annotation of a table of tables of such keys by name."""
    return GenericAlias(dict, (Name, model))


def _mixed(core: type[Strict], models: Sequence[type[Strict]]) -> type[Any]:
    """One model with the keys and the checks of several."""
    different = dict.fromkeys(models)
    own = tuple(one for one in different if not any(other is not one and issubclass(other, one) for other in different))
    if len(own) < 2:
        return own[0] if own else core
    return create_model(core.__name__, __base__=own, __doc__=core.__doc__)


def _loosened(core: type[Strict], model: type[Strict]) -> type[Any]:
    """A model with the same keys, of which none is required, and no checks of several at once."""
    keys: dict[str, Any] = {
        key: (annotation_of(info) | None, Field(None, description=info.description))
        for key, info in model.model_fields.items()
        if key not in core.model_fields
    }
    return create_model(core.__name__, __base__=core, __doc__=model.__doc__, **keys)


def _united(added: Iterable[Mapping[str, Kind]]) -> dict[str, Kind]:
    """Kinds by name; what several have may hold what any of them takes."""
    found: dict[str, Kind] = {}
    for kinds in added:
        for key, kind in kinds.items():
            known = found.get(key, kind)
            found[key] = kind if known.value == kind.value else replace(known, value=known.value | kind.value)
    return found


def _table_type(keys: Mapping[str, Any]) -> Any:
    """The annotation of a table that may hold some of these keys, and no others."""
    # Type checkers know tables of fixed keys alone.
    make: Any = TypedDict
    table = make("Components", keys, total=False)
    table.__pydantic_config__ = ConfigDict(extra="forbid", arbitrary_types_allowed=True)
    return table


def support_type(support: type[Support], boundary: Mapping[str, str]) -> type[Support]:
    """The model of supports that may prescribe these components, each by its dimension."""
    components = _table_type({key: value_of(of) for key, of in boundary.items()})
    schema = {
        "anyOf": [{"type": "array", "items": {"enum": list(boundary)}}, {"type": "object"}],
        "description": "components, with their values",
    }
    fix: tuple[Any, dict[str, Any]] = (Annotated[components, BeforeValidator(read_fix), WithJsonSchema(schema)], {})
    made = create_model("Support", __base__=support, __doc__=support.__doc__, fix=fix)
    made.boundary = boundary
    return made


def load_type(kinds: Mapping[str, LoadKind]) -> type[Load]:
    """The model of loads of these kinds."""
    fields: dict[str, Any] = {
        key: (kind.value | None, Field(None, description=kind.summary or None)) for key, kind in kinds.items()
    }
    made = create_model("Load", __base__=Load, __doc__=Load.__doc__, **fields)
    made.kinds = kinds
    return made
