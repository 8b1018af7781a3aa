"""Single keys of a scene's plain tables, set by --set and by edits."""

import tomllib
from functools import cache

from restshape.application import applications
from restshape.errors import UserError
from restshape.scene.application_registry import installed_physics
from restshape.scene.key_aliases import other_name
from restshape.scene.model import Scene
from restshape.scene.plain_values import Table
from restshape.scene.scene_type import joined_sections
from restshape.scene.source import split_key, suggestion

NAMED = ("parameters", "material", "supports", "loads", "quantities")
FOR_ALL = ("quantities", "error")
"""A key beside names that a scene gives."""
NAMED_OF_SHAPE = ("vertices", "edges", "holes", "regions", "points", "groups")


def parse_override(text: str) -> tuple[tuple[str, ...], object]:
    """The key and the value of ``key=value``; a value that is not TOML is taken as text.

    Raises:
        UserError: no key or no equals sign.
    """
    key, equals, value = text.partition("=")
    parts = split_key(key)
    if not equals or not parts:
        raise UserError(f"{text!r} is not key=value", "--set", 'write for example --set material.steel.E="70 GPa"')
    try:
        return parts, tomllib.loads(f"value = {value.strip()}")["value"]
    except (ValueError, RecursionError):
        # What is too large or too deep for TOML, as text, suits no key either.
        return parts, value.strip()


def put(raw: Table, key: tuple[str, ...], value: object, where: str, adds: bool = False) -> None:
    """Sets one dotted key in plain tables, in place; a whole number as a part is the place in a list.

    Args:
        raw: the tables.
        key, value: what is set to what.
        where: for messages.
        adds: the last part may be a new name in a table whose keys are names that a scene gives.

    Raises:
        UserError: no such key.
    """
    if not key:
        raise UserError("there is no key", where, "write a dotted key such as material.steel.E")
    _spread_directions(raw, key)
    here: object = raw
    left_out = False
    for depth, part in enumerate(key):
        last = depth == len(key) - 1
        if left_out and last and part.isdigit() and not isinstance(value, dict):
            whole = ".".join(key[:depth])
            what = f"the scene leaves out {whole}, which cannot be given by its entry {part} alone"
            raise UserError(what, where, f"set all of its entries: {whole} = [...]")
        if isinstance(here, list):
            if not part.isdigit() or int(part) >= len(here):
                places = f"a list of {len(here)} entries"
                raise UserError(
                    f"{'.'.join(key[:depth])} is {places}, so {part!r} is no place in it", where, "count from 0"
                )
        elif not isinstance(here, dict):
            raise UserError(
                f"{'.'.join(key[:depth])} is a single value and has no key {part!r}", where, "shorten the key"
            )
        elif part not in here and key != FOR_ALL and not (adds and last) and _has_names(key[:depth]):
            do = suggestion(part, sorted(here)) or _by_its_table(key[:depth], part)
            raise UserError(f"there is no {'.'.join(key[: depth + 1])}", where, do)
        if isinstance(here, list):
            if last:
                here[int(part)] = value
            here = here[int(part)]
        elif last:
            if other := other_name(key):
                here.pop(other[-1], None)
            here[part] = value
        else:
            left_out = part not in here
            here = here.setdefault(part, {})


def _spread_directions(raw: Table, key: tuple[str, ...]) -> None:
    """Lets a support that lists its directions have a table of them, each 0, where one is given a number by itself."""
    if len(key) != 4 or (key[0], key[2]) != ("supports", "fix") or key[3].isdigit():
        return
    supports = raw.get("supports")
    support = supports.get(key[1]) if isinstance(supports, dict) else None
    listed = support.get("fix") if isinstance(support, dict) else None
    if isinstance(support, dict) and isinstance(listed, list) and all(isinstance(one, str) for one in listed):
        support["fix"] = dict.fromkeys(listed, 0)


def branched(raw: Table, key: tuple[str, ...]) -> Table:
    """A copy of plain tables that shares with them all that does not lie on the way to the key."""
    if len(key) < 2:
        return dict(raw)
    inner, rest = raw.get(key[0]), key[1:]
    if isinstance(inner, dict):
        return {**raw, key[0]: branched(inner, rest)}
    return {**raw, key[0]: _branched_list(inner, rest)} if isinstance(inner, list) else dict(raw)


def _branched_list(entries: list[object], key: tuple[str, ...]) -> list[object]:
    """A copy of a list of plain values, likewise."""
    found = list(entries)
    place = int(key[0]) if key[0].isdigit() else len(entries)
    if len(key) > 1 and place < len(entries):
        inner = entries[place]
        if isinstance(inner, dict):
            found[place] = branched(inner, key[1:])
        elif isinstance(inner, list):
            found[place] = _branched_list(inner, key[1:])
    return found


def _by_its_table(key: tuple[str, ...], name: str) -> str:
    """What to do about a name in a named table that is empty: to give all of what it names, with the keys it needs."""
    if key[0] == "shape":
        return f"set the whole table: {'.'.join(key)} = {{ {name} = ... }}"
    section = joined_sections(installed_physics(applications().values())).get(key[0]) if len(key) == 1 else None
    fields = section.model.model_fields if section else {}
    needed = ", ".join(field.alias or name for name, field in fields.items() if field.is_required())
    return f"add it by its table{f', with {needed}' if needed else ''}"


def _has_names(table: tuple[str, ...]) -> bool:
    """Whether the keys of a table are names that a scene gives."""
    if len(table) == 2:
        return table[0] == "shape" and table[1] in NAMED_OF_SHAPE
    if len(table) != 1 or table[0] in NAMED:
        return len(table) == 1
    # Physics add tables, none of those that all scenes have; to load all that are installed takes 0.04 s.
    return table[0] not in Scene.model_fields and table[0] in _named_of_physics()


@cache
def _named_of_physics() -> frozenset[str]:
    """Tables of installed physics whose keys are names that a scene gives."""
    sections = joined_sections(installed_physics(applications().values()))
    return frozenset(key for key, section in sections.items() if section.named)
