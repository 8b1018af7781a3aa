"""Lengths of a shape without a unit that are far longer than those with one: a forgotten "mm" is the likely cause."""

from __future__ import annotations

from collections.abc import Iterator

from restshape.errors import UserError, ValueProblem
from restshape.scene.dimensions import powers_of_formula, powers_of_number
from restshape.scene.expressions import Expression
from restshape.scene.model import Scene
from restshape.scene.plain_values import table_in
from restshape.scene.units import DIMENSIONS, Powers, quantity, reads_as_quantity

LONG, FAR = 10.0, 300.0
"""Metres, and times the longest length with a unit, from which on a length without one is hardly meant in metres."""
TABLES = ("vertices", "edges", "holes", "regions", "points")
UNMEASURED = ("bulge", "knots")
"""Keys of edges that are pure numbers."""


def bare_lengths(scene: Scene) -> list[str]:
    """What is odd about lengths of a shape, a line each, which names the key: parameters come first."""
    written, shape = table_in(scene.raw, "parameters"), table_in(scene.raw, "shape")
    places = [one for table in TABLES for one in _numbers(shape.get(table), f"shape.{table}")]
    formulas = [text for _, text in places if isinstance(text, str) and not reads_as_quantity(text)]
    powers = {name: known for name, one in written.items() if (known := _powers(one)) is not None}
    lengths = [(f"parameters.{name}", one) for name, one in written.items() if _is_length(name, one, formulas, powers)]
    lengths += [(key, one) for key, one in places if one not in formulas]
    longest = max((abs(_metres(one)) for _, one in lengths if isinstance(one, str)), default=0.0)
    bare = [(key, float(one)) for key, one in lengths if isinstance(one, int | float) and abs(one) >= LONG]
    return [
        f"{key}: a length without a unit is in metres, and {value:g} m is far longer than all with a unit here, of at "
        f'most {longest:g} m: "{value:g} mm" or "{value:g} m"?'
        for key, value in bare
        if longest and abs(value) >= FAR * longest
    ]


def with_bare_lengths(error: UserError, scene: Scene) -> UserError:
    """The error of a shape that makes no sense, with the first length that may be why."""
    odd = bare_lengths(scene)
    if not odd:
        return error
    key, _, words = odd[0].partition(": ")
    named = scene.located(UserError(words, key))
    return UserError(error.what, error.where, f"look at {named.where} first: {words}")


def _numbers(value: object, key: str) -> Iterator[tuple[str, float | str]]:
    """The numbers and texts that may be lengths in a plain table, with their keys."""
    if isinstance(value, dict):
        for name, one in value.items():
            if name not in UNMEASURED:
                yield from _numbers(one, f"{key}.{name}")
    elif isinstance(value, list):
        for place, one in enumerate(value):
            yield from _numbers(one, f"{key}.{place}")
    elif isinstance(value, int | float | str) and not isinstance(value, bool):
        yield key, value


def _powers(written: object) -> Powers | None:
    """The powers of a parameter with a unit; None of others."""
    try:
        return powers_of_number(written) if isinstance(written, str) and reads_as_quantity(written) else None
    except ValueProblem:
        return None


def _is_length(name: str, written: object, formulas: list[str], powers: dict[str, Powers]) -> bool:
    """Whether a parameter is a length: by its unit, or because a formula of the shape is one only if it is."""
    if isinstance(written, str):
        return powers.get(name) == DIMENSIONS["length"]
    return not isinstance(written, bool) and any(_needs(name, text, powers) for text in formulas)


def _needs(name: str, text: str, powers: dict[str, Powers]) -> bool:
    """Whether a formula is a length only with a parameter that is one."""
    try:
        if name not in Expression(text).names:
            return False
        found = powers_of_formula(text, {**powers, name: DIMENSIONS["length"]}, set())
    except ValueProblem:
        return False
    return found == DIMENSIONS["length"]


def _metres(written: str) -> float:
    """A length with a unit [m]; 0 of another text."""
    try:
        return quantity(written, "length") if reads_as_quantity(written) else 0.0
    except ValueProblem:
        return 0.0
