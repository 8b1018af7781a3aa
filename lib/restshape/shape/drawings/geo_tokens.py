"""Words of a Gmsh .geo file with their lines, handed out one by one within a budget."""

from __future__ import annotations

import re
from dataclasses import dataclass

from restshape.errors import UserError

MOST_BYTES = 1_000_000
"""Length of a file that is read at most."""
MOST_STEPS = 3_000_000
"""Words that are looked at in all, loops counted as often as they are run."""
MAX_DEPTH = 60
"""Parentheses, braces, loops and conditions within one another."""

TOKEN = re.compile(
    r"""(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)
      | (?P<name>[A-Za-z_]\w*)
      | (?P<text>"[^"\n]*"|'[^'\n]*')
      | (?P<sign>\+\+|--|\+=|-=|\*=|/=|==|!=|<=|>=|&&|\|\||[-+*/^%=<>!?:;,.(){}\[\]#~&|@$\\])""",
    re.VERBOSE,
)


@dataclass(frozen=True)
class Token:
    """A word of the file: its kind ("number", "name", "text", "sign" or "end"), what it says, and its line."""

    kind: str
    text: str
    line: int


def tokens_of(text: str, where: str) -> list[Token]:
    """The words of a file, its comments left out, closed by one of kind "end".

    Raises:
        UserError: a character that no .geo file holds, or a comment without end.
    """
    found, at, line = [], 0, 1
    while at < len(text):
        if text[at] in " \t\r\n\f\v":
            line += text[at] == "\n"
            at += 1
        elif text.startswith("//", at):
            end = text.find("\n", at)
            at = len(text) if end < 0 else end
        elif text.startswith("/*", at):
            end = text.find("*/", at + 2)
            if end < 0:
                raise UserError("the comment has no end", f"{where} (line {line})", "close it by */")
            line += text.count("\n", at, end)
            at = end + 2
        elif match := TOKEN.match(text, at):
            found.append(Token(str(match.lastgroup), match[0], line))
            at = match.end()
        else:
            raise UserError(f"{text[at]!r} has no meaning here", f"{where} (line {line})", "remove it")
    return [*found, Token("end", "", line)]


class Cursor:
    """Where one reads in the words of a file.

    Args:
        words: as `tokens_of` gave them.
        where: the file, for messages.
    """

    def __init__(self, words: list[Token], where: str) -> None:
        self.words, self.where = words, where
        self.at = self.steps = self.depth = 0

    def peek(self, ahead: int = 0) -> Token:
        """A word that is not taken."""
        return self.words[min(self.at + ahead, len(self.words) - 1)]

    def next(self) -> Token:
        """The next word, taken."""
        word = self.peek()
        self.at += word.kind != "end"
        self.spend(1)
        return word

    def spend(self, steps: int) -> None:
        """Takes work off the budget.

        Raises:
            UserError: it is used up.
        """
        self.steps += steps
        if self.steps > MOST_STEPS:
            raise self.error("the file asks for too much work", "write fewer statements, or loops of fewer rounds")

    def sees(self, *texts: str) -> bool:
        """Whether the next words say this."""
        seen = (self.peek(ahead) for ahead in range(len(texts)))
        return all(word.text == text and word.kind != "text" for word, text in zip(seen, texts, strict=True))

    def takes(self, *texts: str) -> bool:
        """Takes the next words if they say this."""
        if not self.sees(*texts):
            return False
        for _ in texts:
            self.next()
        return True

    def expect(self, text: str) -> None:
        """Takes the next word.

        Raises:
            UserError: it is another one.
        """
        if not self.takes(text):
            raise self.error(f"{text!r} is wanted here, not {self.peek().text or 'the end of the file'!r}")

    def enter(self) -> None:
        """Goes one level deeper.

        Raises:
            UserError: too deep.
        """
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self.error(f"this is nested more than {MAX_DEPTH} times", "write it flatter")

    def leave(self) -> None:
        """Comes back up one level."""
        self.depth -= 1

    def error(self, what: str, do: str = "", line: int = 0) -> UserError:
        """The error that names file and line."""
        return UserError(what, f"{self.where} (line {line or self.peek().line})", do)
