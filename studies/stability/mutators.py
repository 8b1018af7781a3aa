"""Hypothesis strategies of damage to a scene and its edit script, by name: as of a slip, a program or an enemy."""

import json
import math
from collections.abc import Callable
from typing import Any

from hypothesis import strategies as st
from restshape_studies.stability.damage import keys_of, plain_values, replaced, spliced, splices, values, without
from restshape_studies.stability.shape_strategies import Table
from restshape_studies.stability.tables import toml

Path = tuple[str | int, ...]
Texts = tuple[str, str]
DIGITS = {"@400": "7" * 400, "@5000": "7" * 5000, "@1e999": "1e999"}
"""Numbers that Python writes no text of, by what stands for them until the text is written."""
HUGE = [1e9, 1e12, 1e17, 1e150, 1e308, -1e308, 1e-9, 1e-160, 1e-308, 2**31, 2**63, 10**30, *DIGITS]
NOT_NUMBERS = [math.nan, math.inf, -math.inf, -0.0, "nan", "1e999 m", "--1", "1 m^-999", "@1e999"]
DEPTHS = [1, 2, 31, 33, 500, 5000]
NAMES = ["", " ", "a.b", "__class__", "ä", "n" * 300, "all", "outline", "\u202e", "$x^$", "%s", "-", "0"]
"""Names that are none, mean something already, or are hard to print."""


def leaves(value: Any, before: Path = ()) -> list[Path]:
    """The place of every number, text and boolean in nested tables and lists."""
    if isinstance(value, dict | list):
        pairs = value.items() if isinstance(value, dict) else enumerate(value)
        return [place for key, one in pairs for place in leaves(one, (*before, key))]
    return [before]


def at(value: Any, place: Path) -> Any:
    """What stands at a place."""
    for key in place:
        value = value[key]
    return value


def put(value: Any, place: Path, new: Any) -> Any:
    """A copy with something else at a place."""
    if not place:
        return new
    inner = put(value[place[0]], place[1:], new)
    if isinstance(value, dict):
        return {**value, place[0]: inner}
    return [*value[: place[0]], inner, *value[place[0] + 1 :]]


def renamed(value: Any, place: Path, name: str) -> Any:
    """A copy with the last key of a place under another name; lists have none."""
    table = at(value, place[:-1])
    if not isinstance(table, dict):
        return value
    return put(value, place[:-1], {name if key == place[-1] else key: one for key, one in table.items()})


def texts(scene: Table, lines: list[Table]) -> Texts:
    """The text of a scene and of its script, with numbers that are too long for Python."""
    found = toml(scene), "".join(json.dumps(line) + "\n" for line in lines)
    for mark, digits in DIGITS.items():
        found = found[0].replace(f'"{mark}"', digits), found[1].replace(f'"{mark}"', digits)
    return found


def of_values(change: Callable[[st.DrawFn, Any], Any], numeric: bool = False) -> Callable[..., Texts]:
    """What changes one value of the scene or of the script."""

    def mutate(draw: st.DrawFn, scene: Table, lines: list[Table]) -> Texts:
        whole = {"scene": scene, "lines": lines}
        places = [place for place in leaves(whole) if not numeric or _is_number(at(whole, place))]
        place = draw(st.sampled_from(places or leaves(whole)))
        whole = put(whole, place, change(draw, at(whole, place)))
        return texts(whole["scene"], whole["lines"])

    return mutate


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _retyped(draw: st.DrawFn, value: Any) -> Any:
    number = value if _is_number(value) else 1
    return draw(st.sampled_from([str(value), [value], {"a": value}, True, "", [], {}, number + 0.5, [[value]], -1, 0]))


def _near(draw: st.DrawFn, value: Any) -> Any:
    if isinstance(value, bool):
        return not value
    if isinstance(value, str):
        word = value or "x"
        return draw(st.sampled_from([word.upper(), word[:-1], word[1:], word + "s", f" {word}", f"{word} m", word * 2]))
    number = float(value) if _is_number(value) else 1.0
    parts = [number * (1 + 1e-12), number + 1e-9, number * 0.5, number * 2, -number, 0.0, math.nextafter(number, 9e9)]
    return draw(st.sampled_from([*parts, number + 1e-3, int(number), number * 1e3, number * 1e-3]))


def _nested(draw: st.DrawFn, value: Any) -> Any:
    # Deeper tables than Python writes are made of text.
    return f"@nest{draw(st.sampled_from(DEPTHS))}{draw(st.sampled_from('[{'))}"


def _nest(draw: st.DrawFn, scene: Table, lines: list[Table]) -> Texts:
    found = of_values(_nested)(draw, scene, lines)
    return _deep(found[0], "{a = "), _deep(found[1], '{"a": ')


def _deep(text: str, table: str) -> str:
    """The text with lists and tables in the place of marks; `table` begins one."""
    for depth in DEPTHS:
        for mark, opening, closing in (("[", "[", "]"), ("{", table, "}")):
            text = text.replace(f'"@nest{depth}{mark}"', opening * depth + "1" + closing * depth)
    return text


def _rename(draw: st.DrawFn, scene: Table, lines: list[Table]) -> Texts:
    whole = {"scene": scene, "lines": lines}
    named = [("scene", *key) for key in keys_of(scene)] + [
        ("lines", i, key) for i, one in enumerate(lines) for key in one
    ]
    place = draw(st.sampled_from(named))
    others = [key for key in at(whole, place[:-1])]
    word = str(place[-1])
    name = draw(st.sampled_from([*NAMES, *others, word.upper(), word[:-1], word + "s"]))
    whole = renamed(whole, place, name)
    return texts(whole["scene"], whole["lines"])


def _of_lines(change: Callable[[st.DrawFn, list[str]], list[str]]) -> Callable[..., Texts]:
    """What changes the lines of one of the two texts."""

    def mutate(draw: st.DrawFn, scene: Table, lines: list[Table]) -> Texts:
        found = list(texts(scene, lines))
        which = draw(st.integers(0, 1))
        found[which] = "".join(change(draw, found[which].splitlines(keepends=True)))
        return found[0], found[1]

    return mutate


def _duplicate(draw: st.DrawFn, lines: list[str]) -> list[str]:
    k = draw(st.integers(0, len(lines) - 1))
    return [*lines[: k + 1], *[lines[k]] * draw(st.sampled_from([1, 1, 2, 50])), *lines[k + 1 :]]


def _reorder(draw: st.DrawFn, lines: list[str]) -> list[str]:
    return draw(st.permutations(lines))


def _truncate(draw: st.DrawFn, lines: list[str]) -> list[str]:
    text = "".join(lines)
    return [text[: draw(st.integers(0, len(text)))]]


def _binary(draw: st.DrawFn, lines: list[str]) -> list[str]:
    text = "".join(lines)
    where = draw(st.integers(0, len(text)))
    kind = draw(st.sampled_from(["bytes", "all", "nulls", "mark", "wide"]))
    noise = draw(st.binary(min_size=1, max_size=30)).decode("utf-8", "surrogateescape")
    match kind:
        case "bytes":
            return [text[:where] + noise + text[where:]]
        case "all":
            return [noise * 9]
        case "nulls":
            return [text[:where] + "\0" * 20 + text[where:]]
        case "mark":
            return ["\ufeff" * draw(st.integers(1, 2)) + text]
    return [text.encode("utf-16").decode("utf-8", "surrogateescape")]


def _replace(draw: st.DrawFn, scene: Table, lines: list[Table]) -> Texts:
    return texts(replaced(scene, draw(st.sampled_from(keys_of(scene))), draw(plain_values)), lines)


def _remove(draw: st.DrawFn, scene: Table, lines: list[Table]) -> Texts:
    return texts(without(scene, draw(st.sampled_from(keys_of(scene)))), lines)


def _replace_in_event(draw: st.DrawFn, scene: Table, lines: list[Table]) -> Texts:
    line = draw(st.integers(0, len(lines) - 1))
    changed = {**lines[line], draw(st.sampled_from(list(lines[line]))): draw(values)}
    return texts(scene, [*lines[:line], changed, *lines[line + 1 :]])


def _splice(draw: st.DrawFn, lines: list[str]) -> list[str]:
    return [spliced("".join(lines), draw(st.lists(splices, min_size=1, max_size=3)))]


MUTATORS: dict[str, Callable[[st.DrawFn, Table, list[Table]], Texts]] = {
    "retyped": of_values(_retyped),
    "renamed": _rename,
    "duplicated": _of_lines(_duplicate),
    "reordered": _of_lines(_reorder),
    "huge": of_values(lambda draw, value: draw(st.sampled_from(HUGE)), numeric=True),
    "not a number": of_values(lambda draw, value: draw(st.sampled_from(NOT_NUMBERS)), numeric=True),
    "nested": _nest,
    "truncated": _of_lines(_truncate),
    "binary": _of_lines(_binary),
    "near": of_values(_near),
    "replaced": _replace,
    "removed": _remove,
    "replaced in an event": _replace_in_event,
    "spliced": _of_lines(_splice),
}
"""What may be done to a scene and a script, by name."""
