"""Which values keys of a scene take in a sweep, as the words after --set say."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from itertools import product
from shlex import quote

from restshape import bounds
from restshape.errors import UserError
from restshape.scene.source import split_key
from restshape.scene.units import NONE, SYMBOLS, ZEROS, UnitError, in_units, spelled, unit

NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\d\s:,\[\]{}\"'][^:,\[\]{}\"']*)?")
"""A number, and its unit if any."""
OPENING, CLOSING, QUOTES = "[{(", "]})", "\"'"
ROUNDED = 1e-9
"""Steps by which the last value of a range may lie beyond its end."""
EXAMPLE = "write for example --set material.steel.E=60GPa:80GPa:5GPa, or KEY=a,b,c"


@dataclass(frozen=True)
class SweptKey:
    """A key of the scene that takes one value after the other.

    Args:
        key: dotted.
        values: as they stand after ``--set KEY=``.
        numbers: the same as numbers in `unit`; empty where one of them is no number, or they have several units.
        unit: as it was written; empty without one.
    """

    key: str
    values: tuple[str, ...]
    numbers: tuple[float, ...] = ()
    unit: str = ""


def swept_keys(words: Sequence[str]) -> tuple[list[str], list[SweptKey]]:
    """The overrides that hold for all runs, and the keys that take several values.

    Args:
        words: ``KEY=VALUE``, ``KEY=FROM:TO:STEP`` or ``KEY=A,B,C``, as after --set.

    Raises:
        UserError: a range is none, no key takes several values, or there are more runs than `bounds.SWEEP_VALUES`.
    """
    fixed: list[str] = []
    swept: list[SweptKey] = []
    for word in words:
        found = _swept_key(word)
        if found is None:
            fixed.append(word)
        else:
            swept.append(found)
    if not swept:
        raise UserError("no key takes several values", "--set", EXAMPLE)
    runs = math.prod(len(one.values) for one in swept)
    if runs > bounds.SWEEP_VALUES:
        what = f"{runs:,} runs are more than {bounds.SWEEP_VALUES:,}"
        raise UserError(what, "--set", "take larger steps, or fewer keys")
    if twice := {one.key for one in swept if [other.key for other in swept].count(one.key) > 1}:
        raise UserError(f"{min(twice)} is swept twice", "--set", "name each key once")
    return fixed, swept


def combinations(swept: Sequence[SweptKey]) -> Iterator[tuple[int, ...]]:
    """Of each run the place of its value of each key; the last key changes fastest."""
    yield from product(*(range(len(one.values)) for one in swept))


def _swept_key(word: str) -> SweptKey | None:
    """The swept key of a word; None where it gives one value."""
    key, equals, text = word.partition("=")
    if not equals or not split_key(key):
        raise UserError(f"{word!r} is not key=value", "--set", EXAMPLE)
    if (ends := [_number(part) for part in text.split(":")]) and len(ends) == 3 and all(ends):
        return _range(key.strip(), text, [end for end in ends if end])
    parts = [part.strip() for part in _outside(text, ",")]
    if len(parts) == 1:
        return None
    if not all(parts):
        raise UserError(f"{text!r} has an empty value", f"--set {key}", EXAMPLE)
    numbers = [_number(part) for part in parts]
    _refuse_bare(key.strip(), parts, numbers)
    units = {found[1] for found in numbers if found}
    known = all(numbers) and len(units) == 1
    values = tuple(_written(*found) if found else part for found, part in zip(numbers, parts))
    plain = tuple(float(found[0]) for found in numbers if found) if known else ()
    return SweptKey(key.strip(), values, plain, units.pop() if known else "")


def _refuse_bare(key: str, parts: Sequence[str], numbers: Sequence[tuple[str, str] | None]) -> None:
    """Refuses numbers without a unit beside such with one: 4 of 4,6mm is hardly meant as 4 m; 0 is 0 in all units.

    A share such as 50% is a number, as 0.2 beside it is.

    Raises:
        UserError: there are some; it proposes the unit of the next value that has one, or else of the last, and the SI
            unit, where that is another one.
    """
    symbols = [_si_unit(found[1]) if found else "" for found in numbers]
    bare = [found[0] for found in numbers if found and not found[1] and float(found[0]) != 0.0]
    if not any(symbols) or not bare:
        return
    known = [found[1] if found and symbol else "" for found, symbol in zip(numbers, symbols)]
    readings = [_with_units(parts, numbers, units) for units in (known, symbols)]
    what = f"{bare[0]} has no unit, but other values of the list have one"
    lists = dict.fromkeys(",".join(one) for one in readings)
    words = " or ".join(f"--set {quote(f'{key}={one}')}" for one in lists)
    raise UserError(what, f"--set {key}={','.join(parts)}", f"write {words}")


def _si_unit(text: str) -> str:
    """The SI unit of what a unit measures; empty of shares, and of what is no unit."""
    if text in ZEROS:
        return SYMBOLS["temperature"]
    try:
        powers = unit(text)[1] if text else NONE
    except UnitError:
        return ""
    return "" if powers == NONE else SYMBOLS.get(spelled(powers)) or in_units(powers)


def _with_units(parts: Sequence[str], numbers: Sequence[tuple[str, str] | None], units: Sequence[str]) -> Iterator[str]:
    """Values, the bare numbers of them with the unit of the next one that has one, or else of the last."""
    for k, (part, found) in enumerate(zip(parts, numbers)):
        following = [one for one in units[k:] if one] or [one for one in units if one][-1:]
        yield found[0] + (found[1] or following[0]) if found else part


def _number(text: str) -> tuple[str, str] | None:
    """A number and its unit, both as written; None where a text is no number."""
    text = text.strip()
    if len(text) > 1 and text[0] in QUOTES and text[-1] == text[0]:
        text = text[1:-1].strip()
    found = NUMBER.fullmatch(text) if len(text) <= bounds.QUANTITY_CHARACTERS else None
    return (found[1], (found[2] or "").strip()) if found else None


def _written(number: str, unit: str) -> str:
    """A number as TOML takes it: text where it has a unit."""
    if unit:
        return f'"{number} {unit}"'
    return number if re.fullmatch(r"[-+]?(0|[1-9]\d*)", number) else repr(float(number))


def _range(key: str, text: str, ends: Sequence[tuple[str, str]]) -> SweptKey:
    """The values FROM, FROM + STEP ... up to TO, each the nearest decimal number."""
    where = f"--set {key}={text}"
    units = {unit for _, unit in ends if unit}
    first, last, step = (float(number) for number, _ in ends)
    if step == 0.0:
        words = [number + unit for number, unit in ends[:2]]
        example = ":".join([*words, f"{(last - first) / 4.0:g}{ends[1][1]}"]) if last != first else words[0]
        raise UserError("STEP is 0: no steps lead from FROM to TO", where, f"write for example --set {key}={example}")
    if len(units) > 1:
        raise UserError("the three numbers of a range have several units", where, "write all three in one unit")
    unit = units.pop() if units else ""
    if unit and not ends[2][1]:
        example = ":".join(f"{number}{unit}" for number, _ in ends)
        raise UserError("STEP has no unit, but the range has one", where, f"write --set {key}={example}")
    if not all(abs(value) <= bounds.NUMBER for value in (first, last, step)):
        raise UserError(f"a number is larger than {bounds.NUMBER:g}", where, "take a smaller one, or another unit")
    if (last - first) / step < 0.0:
        raise UserError("no number of these steps leads to the end of the range", where, "give STEP another sign")
    count = (last - first) / step + ROUNDED
    if count >= bounds.SWEEP_VALUES:
        what = f"the range has more than {bounds.SWEEP_VALUES:,} values"
        raise UserError(what, where, "take a larger step")
    start, by = Decimal(ends[0][0]), Decimal(ends[2][0])
    texts = [format(start + i * by, "f") for i in range(int(count) + 1)]
    return SweptKey(key, tuple(_written(one, unit) for one in texts), tuple(map(float, texts)), unit)


def _outside(text: str, mark: str) -> list[str]:
    """The parts of a text between marks that stand in no brackets and no quotes."""
    parts, depth, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in QUOTES:
            quote = letter
        depth += 0 if quote else (letter in OPENING) - (letter in CLOSING)
        if letter == mark and not depth and not quote:
            parts.append("")
        else:
            parts[-1] += letter
    return parts
