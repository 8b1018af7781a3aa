"""Plain tables from files, before they are validated: nothing in them is too deep, too long or too large."""

from collections.abc import Iterator, Mapping

from restshape import bounds

Key = tuple[str, ...]
Table = dict[str, object]
"""A plain table: texts, numbers, dates, lists and tables by key. Who reads a value sees what it is by `isinstance`."""


def table_in(raw: object, key: str) -> Table:
    """The table under a key of a plain table; empty where there is none."""
    found = raw.get(key) if isinstance(raw, Mapping) else None
    return found if isinstance(found, dict) else {}


def tables_in(raw: object, key: str) -> dict[str, Table]:
    """The tables by name in the table under a key, such as those of ``[loads.NAME]``."""
    return {name: table for name, table in table_in(raw, key).items() if isinstance(table, dict)}


def named_files(raw: Table) -> list[tuple[Key, str]]:
    """The files that tables of a scene name, by key: those of ``shape``, ``mesh`` and each effect."""
    tables: list[tuple[Key, Table]] = [((key,), table_in(raw, key)) for key in ("shape", "mesh")]
    tables += [(("effects", name), table) for name, table in tables_in(raw, "effects").items()]
    return [((*key, "file"), file) for key, table in tables if isinstance(file := table.get("file"), str)]


def excess(table: Table) -> tuple[Key, str, str] | None:
    """The first place in plain tables that is beyond a bound: its key, what is wrong, what to do; None without one."""
    waiting: list[tuple[Key, object]] = [((), table)]
    while waiting:
        key, value = waiting.pop()
        found = _excess_of(key, value)
        if found:
            return (key, *found)
        if isinstance(value, dict | list):
            waiting += reversed([((*key, name), one) for name, one in _entries(value)])
    return None


def _entries(value: Table | list[object]) -> Iterator[tuple[str, object]]:
    """What a table or a list holds that can be beyond a bound, with its key or place."""
    pairs = value.items() if isinstance(value, dict) else ((str(place), one) for place, one in enumerate(value))
    for name, one in pairs:
        if isinstance(value, dict) or not isinstance(one, float):
            yield name, one


def _excess_of(key: Key, value: object) -> tuple[str, str] | None:
    """What is wrong with one value, or with its name."""
    if len(key) > bounds.NESTING:
        return f"there are more than {bounds.NESTING} tables and lists within each other", "write a flatter table"
    if key and len(key[-1].encode(errors="replace")) > bounds.NAME_CHARACTERS:
        return f"a name has more than {bounds.NAME_CHARACTERS} characters", "choose a shorter one"
    if isinstance(value, int) and abs(value) > bounds.WHOLE_NUMBER:
        return "the whole number has more than 64 bits", "write a smaller number"
    return None
