"""The text a user wrote: where each key stands in it, and how an error names the place."""

import re
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path

from restshape.errors import UserError, printable
from restshape.scene.key_aliases import other_name

KEY = r"""(?:[A-Za-z0-9_-]+|"[^"\n]*"|'[^'\n]*')"""
DOTTED = rf"{KEY}(?:\s*\.\s*{KEY})*"
HEADER = re.compile(rf"^\s*\[\[?\s*({DOTTED})\s*\]\]?\s*(?:#.*)?$")
ASSIGNMENT = re.compile(rf"^\s*({DOTTED})\s*=")
INLINE = re.compile(rf"[{{,]\s*({DOTTED})\s*=")


def split_key(text: str) -> tuple[str, ...]:
    """The parts of a dotted key, without quotes."""
    return tuple(part.strip("\"'") for part in re.findall(KEY, text))


def suggestion(word: str, known: Sequence[str]) -> str:
    """What to do about a word that is not known: the nearest known one, or the list of them."""
    spelled = {name.lower(): name for name in known}
    near = get_close_matches(word.lower(), spelled, n=3, cutoff=0.55)
    if near:
        # Of names that are as near, letters that have changed places are the likeliest slip.
        swapped = [name for name in near if sorted(name) == sorted(word.lower())]
        return f"did you mean {spelled[(swapped or near)[0]]!r}?"
    return f"use one of: {', '.join(known)}" if known else ""


def name_suggestion(word: str, known: Sequence[str], always: Sequence[str]) -> str:
    """The same of a name in a scene; of the names that there are always, a wrong one hardly means another beginning.

    Args:
        word: that is not known.
        known: names, with those that there are always.
        always: such as "all", which is near to "wall".
    """
    likely = [name for name in known if name not in always or name[:2] == word.lower()[:2]]
    found = suggestion(word, likely)
    return found if found.startswith("did") else f"use one of: {', '.join(known)}"


def read_text(path: Path, kind: str, most: int) -> str:
    """The text of a file.

    Args:
        path: the file.
        kind: what it should be, for messages.
        most: bytes that it may have.

    Raises:
        UserError: the file is missing, cannot be read, is too long, or is not text.
    """
    try:
        with path.open("rb") as file:
            data = file.read(most + 1)
        if len(data) > most:
            raise UserError(f"this {kind} is longer than {most} bytes", str(path), "name another file")
        return data.decode("utf-8-sig")
    except FileNotFoundError as error:
        raise UserError(f"there is no such {kind}", str(path), "check the path") from error
    except IsADirectoryError as error:
        raise UserError(f"this is a folder, not a {kind}", str(path), "name the file in it") from error
    except UnicodeDecodeError as error:
        raise UserError(
            f"this is not a text file in UTF-8, so it is no {kind}", str(path), "save it as UTF-8, or name another file"
        ) from error
    except OSError as error:
        raise UserError(f"the {kind} cannot be read: {error.strerror}", str(path), "check its permissions") from error
    # The name of a file that no file can have.
    except ValueError as error:
        raise UserError(f"there is no such {kind}: {error}", printable(str(path)), "check the path") from error


@dataclass
class Source:
    """A scene's text with the lines of its keys.

    Args:
        path: the file, for messages.
        text: what it holds; empty when the tables did not come from text.
        overridden: dotted keys given on the command line or by an edit, which stand on no line.
        named: files that the command line names itself, wherever they lie.
        recorded: the tables come from a recording, which names no file that is read.
        edited: parts of the shape that edits have made, which the tables may name, and what each is.
        revised: a key was changed after the scene was read.
    """

    path: Path
    text: str = ""
    overridden: tuple[tuple[str, ...], ...] = ()
    named: tuple[str, ...] = ()
    recorded: bool = False
    edited: Mapping[str, str] = field(default_factory=dict)
    revised: bool = False
    lines: dict[tuple[str, ...], int] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        table: tuple[str, ...] = ()
        key: tuple[str, ...] = ()
        for number, line in enumerate(self.text.splitlines(), start=1):
            if header := HEADER.match(line):
                table = key = split_key(header[1])
            elif assignment := ASSIGNMENT.match(line):
                key = table + split_key(assignment[1])
            else:
                continue
            self.lines.setdefault(key, number)
            for inner in INLINE.finditer(line):
                # inline tables may nest: the last part of the key is enough to find the line
                self.lines.setdefault((*key, split_key(inner[1])[-1]), number)

    def overriding(self, key: tuple[str, ...]) -> "Source":
        """The same text, shared, with one more key that stands on no line."""
        source = copy(self)
        source.revised = True
        if key not in self.overridden:
            source.overridden = (*self.overridden, key)
        return source

    def with_parts(self, kinds: Mapping[str, str]) -> "Source":
        """The same text, shared, whose tables may name parts that edits have made."""
        source = copy(self)
        source.edited = kinds
        return source

    def line(self, key: tuple[str, ...]) -> int | None:
        """The line of a key, or of the nearest table around it that has one."""
        if any(key[: len(over)] == over for over in self.overridden):
            return None
        other = other_name(key)
        if other in self.lines:
            return self.lines[other]
        for length in range(len(key), 0, -1):
            if key[:length] in self.lines:
                return self.lines[key[:length]]
        return None

    def error(self, key: Sequence[str | int], what: str, do: str = "") -> UserError:
        """The error that names file, key and line of what is wrong."""
        parts = tuple(str(part) for part in key)
        where = f"{self.path.name}: {'.'.join(parts)}" if parts else self.path.name
        line = self.line(parts)
        return UserError(what, f"{where} (line {line})" if line else where, do)
