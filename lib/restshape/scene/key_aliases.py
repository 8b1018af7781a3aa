"""Keys that had another name in version 0.1: both are read, and a note reports the name of today."""

from collections.abc import Mapping

from restshape.scene.plain_values import tables_in
from restshape.scene.units import UnitError

OLD_NAMES: dict[str, str] = {}
"""Every renamed key by its name today: what version 0.1 called it."""


def by_todays_names(raw: object, renamed: Mapping[str, str]) -> object:
    """Plain tables with their keys under the names of today, in their order.

    Args:
        raw: as the user wrote them.
        renamed: old names by new ones.

    Raises:
        UnitError: both names of a key are there.
    """
    if not isinstance(raw, dict) or not any(old in raw for old in renamed.values()):
        return raw
    today = {old: new for new, old in renamed.items()}
    for old, new in today.items():
        if old in raw and new in raw:
            raise UnitError(f"{old!r} and {new!r} are two names of one key", f"keep {new!r}")
    return {today.get(key, key): value for key, value in raw.items()}


def other_name(key: tuple[str, ...]) -> tuple[str, ...] | None:
    """The same key under its other name, new or old; None where it has but one.

    Args:
        key: dotted, such as ``("quantities", "peak", "max")``.
    """
    if len(key) != 3 or key[0] not in ("quantities", "effects"):
        return None
    names = OLD_NAMES | {old: new for new, old in OLD_NAMES.items()}
    return (*key[:2], names[key[2]]) if key[2] in names else None


def notes(raw: Mapping[str, object]) -> list[str]:
    """What plain tables of a scene hold under old names, and the new ones, for people."""
    today = {old: new for new, old in OLD_NAMES.items()}
    found = []
    for table in ("quantities", "effects"):
        for name, keys in tables_in(raw, table).items():
            found += [f"{table}.{name}.{key} is called {today[key]} now" for key in keys if key in today]
    return found
