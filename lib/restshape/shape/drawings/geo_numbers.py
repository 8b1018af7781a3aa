"""Numbers of a Gmsh .geo file: arithmetic, variables, lists and ranges."""

from __future__ import annotations

import math
from collections.abc import Callable

from restshape.shape.drawings.geo_tokens import Cursor

LONGEST = 100_000
"""Numbers in a list at most."""
FUNCTIONS: dict[str, Callable[..., float]] = {
    "Sin": math.sin,
    "Cos": math.cos,
    "Tan": math.tan,
    "Asin": math.asin,
    "Acos": math.acos,
    "Atan": math.atan,
    "Atan2": math.atan2,
    "Sinh": math.sinh,
    "Cosh": math.cosh,
    "Tanh": math.tanh,
    "Sqrt": math.sqrt,
    "Exp": math.exp,
    "Log": math.log,
    "Log10": math.log10,
    "Abs": abs,
    "Fabs": abs,
    "Floor": math.floor,
    "Ceil": math.ceil,
    "Round": lambda x: math.floor(x + 0.5),
    "Fmod": math.fmod,
    "Modulo": math.fmod,
    "Hypot": math.hypot,
    "Min": min,
    "Max": max,
}
DYADIC: tuple[dict[str, Callable[[float, float], float]], ...] = (
    {"||": lambda a, b: float(bool(a) or bool(b))},
    {"&&": lambda a, b: float(bool(a) and bool(b))},
    {"==": lambda a, b: float(a == b), "!=": lambda a, b: float(a != b)},
    {
        "<": lambda a, b: float(a < b),
        "<=": lambda a, b: float(a <= b),
        ">": lambda a, b: float(a > b),
        ">=": lambda a, b: float(a >= b),
    },
    {"+": lambda a, b: a + b, "-": lambda a, b: a - b},
    {"*": lambda a, b: a * b, "/": lambda a, b: a / b, "%": math.fmod},
)
"""Operators of two numbers, those that bind least first."""

Values = list[float]
"""Numbers of a list of a .geo file."""


class Numbers:
    """Reads numbers and lists, and keeps the variables.

    Args:
        cursor: at the words to read.
        fresh: the next free tag for a word such as ``newp``; None for a word of another kind.
    """

    def __init__(self, cursor: Cursor, fresh: Callable[[str], int | None]) -> None:
        self.cursor, self.fresh = cursor, fresh
        self.values: dict[str, float] = {}
        self.lists: dict[str, Values] = {}

    def number(self) -> float:
        """The value of the expression that follows.

        Raises:
            UserError: it has none.
        """
        line = self.cursor.peek().line
        self.cursor.enter()
        try:
            value = float(self._choice())
        except (ArithmeticError, ValueError, TypeError) as error:
            raise self.cursor.error(f"this has no value: {error}", "mend the expression", line) from None
        self.cursor.leave()
        if not math.isfinite(value):
            raise self.cursor.error("this is not a finite number", "mend the expression", line)
        return value

    def tag(self) -> int:
        """The same, as the number of an entity."""
        line = self.cursor.peek().line
        return self.whole(self.number(), line)

    def whole(self, value: float, line: int = 0) -> int:
        """A number as that of an entity.

        Raises:
            UserError: it is none.
        """
        if value != int(value) or abs(value) > 1e9:
            raise self.cursor.error(f"{value:g} is not the number of an entity", "write a whole number", line)
        return int(value)

    def tags(self) -> list[int]:
        """The list that follows, as numbers of entities."""
        line = self.cursor.peek().line
        return [self.whole(value, line) for value in self.list()]

    def list(self) -> Values:
        """The numbers in the braces that follow, or of the list or number there."""
        if not self.cursor.sees("{"):
            return self._item()
        self.cursor.enter()
        self.cursor.expect("{")
        found: Values = []
        while not self.cursor.sees("}"):
            found += self._item()
            self.refuse_long(len(found))
            if not self.cursor.takes(","):
                break
        self.cursor.expect("}")
        self.cursor.leave()
        return found

    def _item(self) -> Values:
        """A number, a range ``a:b`` or ``a:b:c``, or a whole list, as a list."""
        negative = self.cursor.sees("-") and self._is_list(1)
        if negative:
            self.cursor.next()
        if self._is_list(0):
            name = self.cursor.next().text
            self.cursor.next(), self.cursor.next()
            values = self._named(name)
            self.cursor.spend(len(values))
            return [-value for value in values] if negative else list(values)
        if self.cursor.sees("{"):
            return self.list()
        first = self.number()
        return self.range(first) if self.cursor.takes(":") else [first]

    def range(self, first: float) -> Values:
        """The numbers from one to another, whose colon has been read."""
        last = self.number()
        step = self.number() if self.cursor.takes(":") else math.copysign(1.0, last - first)
        if not step or (last - first) * step < 0:
            return []
        count = (last - first) / step * (1 + 1e-12) + 1
        self.refuse_long(count)
        self.cursor.spend(int(count))
        return [first + step * i for i in range(int(count))]

    def refuse_long(self, count: float) -> None:
        """Makes sure that a list is not too long.

        Raises:
            UserError: it is.
        """
        if count > LONGEST:
            raise self.cursor.error(f"the list has more than {LONGEST} numbers", "take fewer")

    def _is_list(self, ahead: int) -> bool:
        name, first, last = (self.cursor.peek(ahead + i) for i in range(3))
        return name.kind == "name" and (first.text, last.text) in (("[", "]"), ("(", ")"))

    def _named(self, name: str) -> Values:
        if name in self.lists:
            return self.lists[name]
        if name in self.values:
            return [self.values[name]]
        raise self.cursor.error(f"there is no list {name!r}", "set it first")

    def _choice(self) -> float:
        condition = self._dyadic(0)
        if not self.cursor.takes("?"):
            return condition
        first = self.number()
        self.cursor.expect(":")
        second = self.number()
        return first if condition else second

    def _dyadic(self, rank: int) -> float:
        if rank == len(DYADIC):
            return self._signed()
        value = self._dyadic(rank + 1)
        while self.cursor.peek().kind == "sign" and (operator := DYADIC[rank].get(self.cursor.peek().text)):
            self.cursor.next()
            value = operator(value, self._dyadic(rank + 1))
        return value

    def _signed(self) -> float:
        signs = []
        while self.cursor.peek().text in ("-", "+", "!") and self.cursor.peek().kind == "sign":
            signs.append(self.cursor.next().text)
        value = self._primary()
        if self.cursor.takes("^"):
            self.cursor.enter()
            value = math.pow(value, self._signed())
            self.cursor.leave()
        for sign in reversed(signs):
            value = -value if sign == "-" else float(not value) if sign == "!" else value
        return value

    def _primary(self) -> float:
        word = self.cursor.next()
        if word.kind == "number":
            return float(word.text)
        if word.text == "(":
            value = self.number()
            self.cursor.expect(")")
            return value
        if word.text == "#" and self._is_list(0):
            name = self.cursor.next().text
            self.cursor.next(), self.cursor.next()
            return float(len(self._named(name)))
        if word.kind == "name":
            return self._of_name(word.text, word.line)
        raise self.cursor.error(f"a number is wanted here, not {word.text or 'the end of the file'!r}", line=word.line)

    def _of_name(self, name: str, line: int) -> float:
        if name == "Pi":
            return math.pi
        if name in FUNCTIONS:
            return FUNCTIONS[name](*self._arguments())
        if (tag := self.fresh(name)) is not None:
            return float(tag)
        if name in self.lists and self.cursor.peek().text in ("[", "("):
            (place,) = self._arguments()
            if not 0 <= place < len(self.lists[name]):
                raise self.cursor.error(f"the list {name!r} has no number {place:g}", "count from 0", line)
            return self.lists[name][int(place)]
        if name in self.values:
            return self.values[name]
        if self.cursor.peek().text in ("[", "("):
            raise self.cursor.error(f"{name} is not read here", "write the number itself, or trust the file", line)
        raise self.cursor.error(f"there is no number {name!r}", "set it first", line)

    def _arguments(self) -> Values:
        close = {"(": ")", "[": "]"}.get(self.cursor.next().text)
        if close is None:
            raise self.cursor.error("arguments in parentheses are wanted here")
        found = [self.number()]
        while self.cursor.takes(","):
            found.append(self.number())
        self.cursor.expect(close)
        return found
