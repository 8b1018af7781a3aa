"""Hypothesis strategies of damage to files of other programs, by name."""

import re
from collections.abc import Callable

from hypothesis import strategies as st

WORDS = [
    *(
        b"1e308",
        b"-1e308",
        b"1e17",
        b"nan",
        b"inf",
        b"-1",
        b"0",
        b"99999999999",
        b"10000000000",
        b"1e-300",
        b"",
        b"0x1",
    ),
    *(b"9" * 400, b"9" * 5000, b"*", b"$", b"<", b"THRU", b"../../etc/passwd", b"\xff\xfe", b"\0", b"\xc3\xa9" * 200),
]
"""What may stand in the place of a word."""


def _places(draw: st.DrawFn, size: int, most: int = 8) -> list[int]:
    return draw(st.lists(st.integers(0, max(size - 1, 0)), min_size=1, max_size=most))


def _bytes(draw: st.DrawFn, data: bytes) -> bytes:
    found = bytearray(data)
    for place in _places(draw, len(data)):
        found[place : place + 1] = bytes([draw(st.integers(0, 255))])
    return bytes(found)


def _cut(draw: st.DrawFn, data: bytes) -> bytes:
    return data[: draw(st.integers(0, len(data)))]


def _words(draw: st.DrawFn, data: bytes) -> bytes:
    for _ in range(draw(st.integers(1, 3))):
        spans = [found.span() for found in re.finditer(rb'[^\s",<>={}();]+', data)]
        if spans:
            start, end = draw(st.sampled_from(spans))
            data = data[:start] + draw(st.sampled_from(WORDS)) + data[end:]
    return data


def _numbers(draw: st.DrawFn, data: bytes) -> bytes:
    spans = [found.span() for found in re.finditer(rb"(?<![\w.])-?\d+(?:\.\d*)?(?:[eE][+-]?\d+)?", data)]
    if not spans:
        return data
    start, end = draw(st.sampled_from(spans))
    number = float(data[start:end])
    changed = draw(st.sampled_from([number * 1e6, number + 1, -number, number * (1 + 1e-12), 0.0, number * 1e-9]))
    whole = b"." not in data[start:end]
    return data[:start] + (b"%d" % int(changed) if whole else b"%.17g" % changed) + data[end:]


def _lines(draw: st.DrawFn, data: bytes) -> bytes:
    lines = data.splitlines(keepends=True)
    first, second = (draw(st.integers(0, max(len(lines) - 1, 0))) for _ in range(2))
    if not lines:
        return data
    match draw(st.sampled_from(["twice", "gone", "exchanged", "often"])):
        case "twice":
            lines.insert(second, lines[first])
        case "gone":
            del lines[min(first, second) : max(first, second)]
        case "exchanged":
            lines[first], lines[second] = lines[second], lines[first]
        case _:
            lines[first:first] = [lines[first]] * 300
    return b"".join(lines)


def _empty_block(draw: st.DrawFn, data: bytes) -> bytes:
    start = draw(st.integers(0, len(data)))
    size = draw(st.sampled_from([1, 16, 256, 4096]))
    return data[:start] + bytes(len(data[start : start + size])) + data[start + size :]


BYTES: dict[str, Callable[[st.DrawFn, bytes], bytes]] = {
    "bytes": _bytes,
    "cut": _cut,
    "words": _words,
    "numbers": _numbers,
    "lines": _lines,
    "zeros": _empty_block,
}
"""What may be done to the bytes of a file, by name."""
