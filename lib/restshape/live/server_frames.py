"""Frames as the server keeps them: the newest of each array, and the union of what a page has missed."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass, field
from math import prod
from typing import Any

LENGTH = struct.Struct("<I")
ALIGNED = 8
ITEM_BYTES = {"f4": 4, "u2": 2, "u4": 4, "u1": 1}

Table = dict[str, Any]
"""An object of JSON."""


class BadFrame(ValueError):
    """Bytes that are no frame."""


@dataclass
class KeptArray:
    """An array of a part, where it changed last."""

    place: Table
    content: memoryview
    changed: int


@dataclass
class KeptPart:
    """A part of the picture; one that is gone is kept for pages that have not heard of it."""

    keys: Table
    changed: int
    arrays: dict[str, KeptArray] = field(default_factory=dict)


@dataclass
class KeptMark:
    """A mark, and the arrays of the frame that it came with."""

    said: Table
    content: memoryview
    changed: int


class KeptFrames:
    """The state that all frames so far have led to.

    Attributes:
        count: frames that have come; that of a page is how many of them it has seen.
    """

    def __init__(self) -> None:
        self.count = 0
        self._last = b""
        self._whole = False
        self._keys: Table = {}
        self._parts: dict[str, KeptPart] = {}
        self._marks: list[KeptMark] = []
        self._marks_changed = 0
        self._begun_again = False

    def says(self, key: str) -> bool:
        """Whether the last frame has a key that holds."""
        return bool(self._keys.get(key))

    def begin_again(self) -> None:
        """The simulating process is another one: parts that its first frame does not have are gone."""
        self._begun_again = True

    def add(self, message: bytes) -> Table:
        """Takes the next frame; its header.

        Raises:
            BadFrame: it is none.
        """
        header, content = parsed(message)
        known = self._parts
        came = [taken_part(part, content, known.get(part["name"]), self.count + 1) for part in header.pop("parts")]
        if "marks" in header or self._begun_again:
            self._marks = taken_marks(header.pop("marks", []), content, self._marks, self.count + 1)
            self._marks_changed = self.count + 1
        self.count += 1
        self._keys, self._last, self._whole = header, message, not self._begun_again
        if self._begun_again:
            left = set(known) - {part.keys["name"] for part in came}
            came += [KeptPart(gone_keys(known[name].keys), self.count) for name in left]
            self._begun_again = False
        known.update({part.keys["name"]: part for part in came})
        return header

    def since(self, seen: int) -> bytes:
        """One frame that leads a page that has seen so many frames to the state of now."""
        if self._whole and seen == self.count - 1:
            return self._last
        pieces: list[memoryview] = []
        places = Places(pieces)
        parts = []
        for part in self._parts.values():
            if part.changed <= seen or (part.keys.get("gone") and not seen):
                continue
            changed = {name: one for name, one in part.arrays.items() if one.changed > seen}
            arrays = {name: places.add(one.place, one.content) for name, one in changed.items()}
            parts.append(part.keys | {"arrays": arrays})
        header = self._keys | {"parts": parts}
        if self._marks_changed > seen:
            header["marks"] = [
                moved(one.said, one.content, places) if one.changed > seen else None for one in self._marks
            ]
        return joined(header, pieces)


class Places:
    """Where arrays begin in a new frame.

    Args:
        pieces: that come after its header, to which theirs are added.
    """

    def __init__(self, pieces: list[memoryview]) -> None:
        self._pieces, self._end = pieces, 0

    def add(self, place: Table, content: memoryview) -> Table:
        """The place of an array of this content."""
        found = place | {"at": self._end}
        filled = -len(content) % ALIGNED
        self._pieces += [content, memoryview(bytes(filled))]
        self._end += len(content) + filled
        return found


def parsed(message: bytes) -> tuple[Table, memoryview]:
    """Header and arrays of a frame.

    Raises:
        BadFrame: it is none.
    """
    try:
        (length,) = LENGTH.unpack_from(message)
        header = json.loads(message[LENGTH.size : LENGTH.size + length])
    except (struct.error, ValueError) as error:
        raise BadFrame(str(error)) from error
    if not isinstance(header, dict) or not isinstance(header.get("parts"), list):
        raise BadFrame("its header has no parts")
    return header, memoryview(message)[LENGTH.size + length :]


def joined(header: Table, pieces: list[memoryview]) -> bytes:
    """The bytes of a frame."""
    text = json.dumps(header, ensure_ascii=False, separators=(",", ":")).encode()
    text += b" " * (-(LENGTH.size + len(text)) % ALIGNED)
    return b"".join([LENGTH.pack(len(text)), text, *pieces])


def taken_part(part: Table, content: memoryview, before: KeptPart | None, count: int) -> KeptPart:
    """A part with the arrays that it has now: those that came with this frame, and of before those that did not."""
    came = part.get("arrays", {})
    arrays = dict(before.arrays) if before and not part.get("gone") and not before.keys.get("gone") else {}
    arrays |= {name: KeptArray(place, array_of(content, place), count) for name, place in came.items()}
    return KeptPart({key: value for key, value in part.items() if key != "arrays"}, count, arrays)


def taken_marks(came: list[Any], content: memoryview, before: list[KeptMark], count: int) -> list[KeptMark]:
    """The marks of a frame: those that came with it, and of before those in whose places None came.

    Raises:
        BadFrame: there was none in such a place.
    """
    if any(one is None for one in came[len(before) :]):
        raise BadFrame("a mark stays that there was not")
    return [before[place] if one is None else KeptMark(one, content, count) for place, one in enumerate(came)]


def gone_keys(keys: Table) -> Table:
    """The keys of a part that is shown no more."""
    return keys | {"gone": True}


def array_of(content: memoryview, place: Table) -> memoryview:
    """The bytes of an array.

    Raises:
        BadFrame: they are not all there.
    """
    begin, size = place["at"], ITEM_BYTES[place["type"]] * prod(place["shape"])
    if begin < 0 or begin + size > len(content):
        raise BadFrame("an array does not lie in the frame")
    return content[begin : begin + size]


def is_place(value: object) -> bool:
    """Whether a value of a header says where an array is."""
    return isinstance(value, dict) and value.keys() == {"at", "type", "shape"} and value["type"] in ITEM_BYTES


def moved(value: Any, content: memoryview, places: Places) -> Any:
    """A copy of a mark whose arrays lie in another frame."""
    if is_place(value):
        return places.add(value, array_of(content, value))
    if isinstance(value, dict):
        return {key: moved(one, content, places) for key, one in value.items()}
    return [moved(one, content, places) for one in value] if isinstance(value, list) else value
