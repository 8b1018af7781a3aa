"""Models of scenes: what all scenes hold, and what the physics of one add."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from types import GenericAlias
from typing import Annotated, Literal, TypeVar

from pydantic import BaseModel, BeforeValidator, Field, WithJsonSchema
from pydantic.config import JsonDict

from restshape.scene.annotations import Definition, annotated, extended, optional, table_of, union_of
from restshape.scene.load_kind import LoadKind
from restshape.scene.model import Load, Material, Scene, Support, read_fix
from restshape.scene.physics import Physics, Section
from restshape.scene.quantity import ALL_ERRORS, QuantityKind, quantity_type, with_errors
from restshape.scene.values import Name, Strict, annotation_of, value_of

ERRORS: JsonDict = {
    "properties": {ALL_ERRORS: {"type": "boolean", "description": "estimate the errors of all quantities"}}
}
Kind = TypeVar("Kind", LoadKind, QuantityKind)
Core = TypeVar("Core", bound=BaseModel)
OneMaterial = TypeVar("OneMaterial", bound=Material)


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
    found: dict[str, list[Section]] = {}
    for one in physics:
        for key, section in one.sections.items():
            found.setdefault(key, []).append(section)
    return {key: _joined(sections) for key, sections in found.items()}


def _joined(sections: Sequence[Section]) -> Section:
    """One table with the keys and the checks of several; of those that share none, the last."""
    models = [section.model for section in sections]
    return replace(sections[-1], model=_mixed(Strict, models)) if sections[-1].shared else sections[-1]


def known_materials(physics: Iterable[Physics]) -> dict[str, dict[str, object]]:
    """What physics know of materials by their names."""
    known: dict[str, dict[str, object]] = {}
    for one in physics:
        for name, values in one.materials.items():
            known[name] = {**known.get(name, {}), **values}
    return known


def material_type(material: type[OneMaterial], known: Mapping[str, Mapping[str, object]]) -> type[OneMaterial]:
    """The model of a material that may be one of those that are known, by its name."""
    if not known:
        return material
    made = extended(material, {"name": (optional(Literal[tuple(known)]), None)}, name="Material")
    made.known = known
    return made


def _scene_of(
    physics: Sequence[Physics], material: type[Material], support: type[Support], sections: Mapping[str, Section]
) -> type[Scene]:
    made = material_type(material, known_materials(physics))
    boundary = {component: dimension for one in physics for component, dimension in one.boundary.items()}
    fields: dict[str, Definition] = {key: section.field for key, section in sections.items()}
    fields["material"] = (Annotated[_by_name(made), Field(min_length=1)], {})
    fields["supports"] = (_by_name(support_type(support, boundary)), {})
    fields["loads"] = (_by_name(load_type(_united(one.loads for one in physics))), {})
    quantities = _by_name(quantity_type(_united(one.quantities for one in physics)))
    fields["quantities"] = (Annotated[quantities, BeforeValidator(with_errors), Field(json_schema_extra=ERRORS)], {})
    scene = extended(Scene, fields)
    scene.tables = {section.model: key for key, section in sections.items()}
    return scene


def _by_name(model: type[Strict]) -> object:
    """The annotation of a table of tables of such keys by name."""
    return GenericAlias(dict, (Name, model))


def _mixed(core: type[Core], models: Sequence[type[Core]]) -> type[Core]:
    """One model with the keys and the checks of several."""
    different = dict.fromkeys(models)
    own = tuple(one for one in different if not any(other is not one and issubclass(other, one) for other in different))
    if len(own) < 2:
        return own[0] if own else core
    name, doc = (own[0].__name__, own[0].__doc__) if core is Strict else (core.__name__, core.__doc__)
    return extended(own[0], {}, *own[1:], name=name, doc=doc)


def _loosened(core: type[Core], model: type[Core]) -> type[Core]:
    """A model with the same keys, of which none is required, and no checks of several at once."""
    keys: dict[str, Definition] = {
        key: (optional(annotation_of(info)), Field(None, description=info.description))
        for key, info in model.model_fields.items()
        if key not in core.model_fields
    }
    return extended(core, keys, doc=model.__doc__)


def _united(added: Iterable[Mapping[str, Kind]]) -> dict[str, Kind]:
    """Kinds by name; what several have may hold what any of them takes."""
    found: dict[str, Kind] = {}
    for kinds in added:
        for key, kind in kinds.items():
            known = found.get(key, kind)
            found[key] = kind if known.value == kind.value else replace(known, value=union_of(known.value, kind.value))
    return found


def _table_type(keys: Mapping[str, object]) -> object:
    """The annotation of a table that may hold some of these keys, and no others."""
    return table_of("Components", keys)


def support_type(support: type[Support], boundary: Mapping[str, str]) -> type[Support]:
    """The model of supports that may prescribe these components, each by its dimension."""
    components = _table_type({key: value_of(of) for key, of in boundary.items()})
    schema = {
        "anyOf": [{"type": "array", "items": {"enum": list(boundary)}}, {"type": "object"}],
        "description": "components, with their values",
    }
    warm = frozenset(key for key, of in boundary.items() if of == "temperature")
    fix = annotated(components, BeforeValidator(partial(read_fix, warm=warm)), WithJsonSchema(schema))
    made = extended(support, {"fix": (fix, {})}, name="Support")
    made.boundary = boundary
    return made


def load_type(kinds: Mapping[str, LoadKind]) -> type[Load]:
    """The model of loads of these kinds."""
    fields: dict[str, Definition] = {
        key: (optional(kind.value), Field(None, description=kind.summary or None)) for key, kind in kinds.items()
    }
    made = extended(Load, fields)
    made.kinds = kinds
    return made
