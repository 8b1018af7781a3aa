"""Errors that a user can cause: each says what is wrong, where, and what to do."""

from typing import Self


def printable(text: str) -> str:
    """A text without control characters, which a terminal would obey; ends of lines and tabs stay."""
    return "".join(c for c in text if c in "\n\t" or not (ord(c) < 32 or 127 <= ord(c) < 160 or c in DIRECTIONS))


def one_line(path: object) -> str:
    """The name of a file as a message shows it: on one line, without what a terminal would obey."""
    return " ".join(printable(str(path)).split("\n"))


def quoted(text: str, most: int = 60) -> str:
    """A text in quotes, for a message; of a long one its beginning."""
    return repr(text if len(text) <= most else f"{text[: most - 3]}...")


DIRECTIONS = "\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
"""Characters that turn the direction of what follows."""


class Refusal(str):
    """Why an event was refused, in one line, of which `what` is wrong and `do` is what to do about it.

    Args:
        text: the whole of it, as tables hold it.
        what: what is wrong; None: all of the text.
        do: what to do about it.
    """

    what: str
    do: str

    def __new__(cls, text: str, what: str | None = None, do: str = "") -> Self:
        refusal = super().__new__(cls, text)
        refusal.what, refusal.do = text if what is None else what, do
        return refusal


class UserError(Exception):
    """Something in the user's input or surroundings that stops a command; exit code 2.

    Args:
        what: what is wrong, one sentence.
        where: file, and line or key, e.g. ``plate.toml: material.steel.E``.
        do: what to do about it.
    """

    def __init__(self, what: str, where: str = "", do: str = "") -> None:
        self.what, self.where, self.do = what, where, do
        super().__init__(str(self))

    def __str__(self) -> str:
        lines = [f"{self.where}: {self.what}" if self.where else self.what]
        return "\n".join([*lines, f"  try: {self.do}"] if self.do else lines)

    @property
    def one_line(self) -> Refusal:
        """The message as a table holds it."""
        what = f"{self.where}: {self.what}" if self.where else self.what
        return Refusal("; try: ".join(filter(None, (what, self.do))), what, self.do)


class ValueProblem(ValueError):
    """Something in one value of the user's input, raised where its place is not known; who knows it adds it.

    Args:
        what: what is wrong, one sentence.
        do: what to do about it.
    """

    def __init__(self, what: str, do: str = "") -> None:
        self.what, self.do = what, do
        super().__init__(f"{what}: {do}" if do else what)


class ReplayProblem(Exception):
    """A frame that cannot be computed (no equilibrium, no mesh): recorded as refused, the replay goes on."""
